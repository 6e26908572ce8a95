"""Find what grows out of all proportion where a run cannot continue. Imported only on the way to an error."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import HeunError, LimitError, Problem, SolveError
from heuncli.motion.integration.diagnosis.domains import evaluate_coordinates, find_grown
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array


def find_growing(
    scene: Evaluator, t: float, state: Array, passed_states: Sequence[tuple[float, Array]]
) -> list[Problem]:
    """Find the expressions that have grown so since a quarter of the time; passed_states: instants and states,
    ascending.
    """
    earlier, earlier_state = next((k for k in reversed(passed_states) if k[0] <= 0.25 * t), passed_states[0])
    evaluation = scene.evaluate(np.array([earlier, t]), np.array([earlier_state, state]))
    coordinates = [evaluate_coordinates(scene.layout, evaluation, k) for k in range(2)]
    return find_grown(scene.layout.mechanism, (t, coordinates[1]), (earlier, coordinates[0]))


def stalled_error(problems: Sequence[Problem], done_text: str, needed_steps: float, cause: str = "") -> HeunError:
    """Explain why a run does not advance: what grows, else how many steps it would need, and for which cause (a
    sentence).
    """
    if problems:
        return SolveError(*problems)
    needed = f"about {needed_steps:.1g} would be needed" if needed_steps < math.inf else "no number of steps suffices"
    hint = "check for loads, rates, stiffness or friction far above the others, or an inertia far below; or end earlier"
    message = f"{done_text}; for the whole run {needed}, the limit is {tolerances.MOST_STEPS}"
    message += f"; {cause}" if cause else ""
    return LimitError(Problem("step-limit", message, hint=hint))


def describe_largest_load(mechanism: Mechanism, evaluation: Evaluation) -> str:
    """Describe the largest load at the first instant; empty if there is none."""
    rows = evaluation.loads[0]
    sizes = [(float(np.abs(rows["value"][k]).max(initial=0.0)), load.path) for load, k in mechanism.iter_load_rows()]
    finite = [(value, name) for value, name in sizes if 0.0 < value < math.inf]
    return "the largest load is {1}, {0:.3g}".format(*max(finite)) if finite else ""
