"""Tolerances that may be asked for, the check of a run, and what is told of its error."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np

from heuncli.analyses.work_precision.reference import count_valid_instants
from heuncli.analyses.work_precision.results import COMPLETED, ChartRow, ChartRun, mark_front
from heuncli.motion.integration.check.runs import has_shared_steps
from heuncli.motion.integration.run.progress import find_hopeless_steps
from heuncli.output.tables.page import make_page
from heuncli.study.quantities.labels import make_labels
from heuncli.study.queries.study import make_friction_warning
from tests.honesty.boundaries.part import Part, Row
from tests.honesty.boundaries.scenes import bar, read
from tests.shared.scenes import near, study


def steady_pace(x: float) -> str:
    """A run of which a hundred steps were done, at a pace that would take x times what may be left: 1e6 of 10,000."""
    return "told" if find_hopeless_steps(np.arange(1.0, 101.0), x * 1e5, 10_000) else "goes on"


def steps_given(x: float) -> str:
    """A run whose check run goes in x steps, quarters of those given."""
    return read(bar(tail=f"analysis: {{duration: 1, method: RK4, step: {4.0 / x!r}}}\n"))


def step_in_common(x: float) -> str:
    """Of two runs of 1 s, of which the one has steps of 1 s and x s, and the other the latter alone of them."""
    return "shared" if has_shared_steps(np.array([1.0, 1.0 + x]), np.array([0.4, 1.0, 1.0 + x])) else "apart"


def step_beside(x: float) -> str:
    """Of two runs of one step, x of it longer in the one."""
    return "shared" if has_shared_steps(np.array([1.0]), np.array([1.0 + x])) else "apart"


def judged(x: float) -> str:
    """Two references that agree, differ by x and then by everything."""
    error = np.array([0.0, 1e-14, x, 1.0])
    pair: Any = SimpleNamespace(error=error, first=SimpleNamespace(times=np.arange(4.0)))
    return {2: "not judged", 3: "judged"}[count_valid_instants(pair)[0]]


def off_by(x: float) -> str:
    """A run that came to its end, alone in its chart."""
    row = ChartRow("RK4", "quaternion", True, 0.1)
    (run,) = mark_front([ChartRun(row, COMPLETED, 1.0, 1, 10, 40, {"motion": x, "reactions": x, "sections": None})])
    return "on the front" if run.front else "lost"


def tolerance(x: float) -> str:
    return read(bar(tail=f"analysis: {{duration: 1, samples: 3, tolerance: {x!r}}}"))


def left_of(x: float) -> str:
    """The table's word for the force in a weld that is left of 1 N by 1 - x N."""
    run = study(
        f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{b: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{o: [0, 0, 0]}}}}}}
joints: {{w: {{type: weld, from: ground.O, to: b.o}}}}
forces:
  one: {{type: force, on: b.o, vector: [1, 0, 0]}}
  other: {{type: force, on: b.o, vector: [{x - 1.0!r}, 0, 0]}}
""",
        requested_reports=frozenset({"joints"}),
    )
    near(run.results.joints["w"]["force"], [[-x, 0.0, 0.0]], 1.0, 1e-15)
    (table,) = make_page(run.results, make_labels(run.spec), run.magnitudes).make_tables_at_instants(run.results)
    return "0" if table.notes == ("all values 0",) else "a number"


def friction_of_a_sledge(x: float) -> str:
    """A sledge whose friction lacks x of its value, tanh(rate/speed) = 1 - x: whether that is told."""
    rate = math.atanh(1.0 - x)
    run = study(f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{b: {{mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {{o: [0, 0, 0]}}}}}}
joints: {{guide: {{type: slide, from: ground.O, to: b.o, axis: [1, 0, 0], initial: {{travel: 0, speed: {rate!r}}}}}}}
forces: {{rub: {{type: friction, joint: guide, force: 3, speed: 1}}}}
analysis: {{type: state}}
""", requested_reports=frozenset({"motion", "forces"}))  # fmt: skip
    near(run.results.forces["rub"]["value"], [-3.0 * (1.0 - x)], 1.0)
    word = make_friction_warning(run, "coordinates.guide.acceleration", 0.0)
    return "full" if word is None else "told"


PART = Part(
    ("", "accuracy"),
    rows=(
        Row("LEAST_ASKED", tolerance, "refused: tolerance", "fine"),
        Row("MOST_ASKED", tolerance, "fine", "refused: tolerance"),
        Row("WRITTEN", left_of, "0", "a number"),
        Row("FRICTION_LACKS", friction_of_a_sledge, "full", "told"),
        Row("JUDGED", judged, "judged", "not judged"),
        Row("LOST", off_by, "on the front", "lost"),
        Row("MOST_STEPS", steps_given, "fine", "refused: step"),
        Row("HOPELESS", steady_pace, "goes on", "told"),
        Row("SHARED_STEP", step_in_common, "apart", "shared"),
        Row("SAME_STEP", step_beside, "shared", "apart"),
    ),
    exempt={
        "MOST_FOREIGN": "when an independent check is given up that does not get on: after minutes, or more of them",
        "CHECK_STEPS": "how much finer a check run goes: 2 |A - B| is no less than the error on either side of 4",
        "INTEGRATED": "whether a stretch is halved once more: the integral is right to rounding on either side",
        "UNSEEN_RATE": "whether a stretch is halved once more; tests/spec/test_integrals.py has pulses that hide",
        "BEFORE_FAILURE": "where a search ends that lies before an error; of what is later the error is told",
        "EPS": "the rounding of one operation; others are told by it",
        "QUADRATURE": "ends a quadrature",
        "PLACE_ROUNDING": "a summand of the estimate",
        "START_ROUNDING": "where the check run starts: what it grows to is the estimate",
        "SUM_ROUNDING": "a summand of the estimate",
        "ROUNDING_MATTERS": "when rounding is followed in a run of its own: half of the estimate at most",
        "UNKNOWN": "the estimate where there is none",
        "LEAST_RATE": "what steps are judged by where nothing moves: the estimate says what they are worth",
        "LEAST_TOLERANCE": "where finer runs are not tried: the estimate says what was reached",
        "COARSEST_RETRY": "where coarser runs are not tried: a collapse is refused, what came through has its estimate",
        "MOST_SOLVED": "time and memory; tests/convergence/test_collocation.py has a scene beyond",
    },
    wanted={
        "CLAIMED": "the horizon",
        "BOUNDLESS": "the words on a run that fails",
    },
)
