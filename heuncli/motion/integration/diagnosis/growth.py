"""What grows out of all proportion where a run cannot go on. Imported only on the way to an error."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import HeunError, LimitError, Problem, SolveError
from heuncli.motion.integration.diagnosis.domains import coordinates_at, grown
from heuncli.motion.integration.evaluator import Evaluator, Recovered
from heuncli.multibody.mechanism.model import Mechanism, path_of_load
from heuncli.results.results import Array


def growing(scene: Evaluator, t: float, state: Array, kept: Sequence[tuple[float, Array]]) -> list[Problem]:
    """The expressions that have grown so since a quarter of the time; kept: instants and states passed, ascending."""
    earlier, then = next((k for k in reversed(kept) if k[0] <= 0.25 * t), kept[0])
    pair = scene.recovered(np.array([earlier, t]), np.array([then, state]))
    coordinates = [coordinates_at(scene.layout, pair, k) for k in range(2)]
    return grown(scene.layout.mechanism, (t, coordinates[1]), (earlier, coordinates[0]))


def stalled(problems: Sequence[Problem], done: str, projected: float, cause: str = "") -> HeunError:
    """Why a run does not get on: what grows, else how many steps it would take, and for which cause, a sentence."""
    if problems:
        return SolveError(*problems)
    needed = f"about {projected:.1g} would be needed" if projected < math.inf else "no number of them will do"
    hint = "look for loads, rates, stiffness or friction far beyond the others, or an inertia far below; or end earlier"
    message = f"{done}; for all of it {needed}, and {tolerances.MOST_STEPS} is the most"
    message += f"; {cause}" if cause else ""
    return LimitError(Problem("step-limit", message, hint=hint))


def largest_load(mechanism: Mechanism, recovered: Recovered) -> str:
    """The largest load at the first instant, in words; empty where there is none."""
    rows = recovered.loads[0]
    named = [
        (float(np.abs(rows["value"][k]).max(initial=0.0)), path_of_load(load)) for load, k in mechanism.load_rows()
    ]
    finite = [(value, name) for value, name in named if 0.0 < value < math.inf]
    return "the largest load is {1}, {0:.3g}".format(*max(finite)) if finite else ""
