"""Choose the method that a motion begins with, say why, and forecast from its first part what the run costs.

Driven motions that leave no freedom are followed and not integrated (motion/integration/integrated_scene.py). A motion
that turns out to be stiff, or cut by events at nearly every step, is restarted (motion/integration/run/supervision.py).

Impure: reads the clock.
"""

from __future__ import annotations

import math
import time
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import LimitError, SolveError
from heuncli.base.method_rows import DEFAULT, find_method
from heuncli.base.spelling import format_count, list_some
from heuncli.motion.integration.check.runs import Runs, try_fewer_stages
from heuncli.motion.integration.integrated_scene import find_discontinuities
from heuncli.motion.integration.methods.method import Method, load_method_by_name
from heuncli.motion.integration.run.kernel_loop import depends_on_state
from heuncli.motion.integration.run.request import EventfulRun, MotionTask, StiffRun, StoppingRules
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec

if TYPE_CHECKING:  # it imports this module
    from heuncli.study.model.setup import Setup

FINE_METHOD = "Verner98"
LONG_MOTION = 100.0  # turns or swings from which on a conservative motion is called long
MAY_BE_STIFF = (
    "monitored for stiffness due to {}: if explicit steps stay short, the run is restarted with an implicit "
    "method where that is faster"
)
NOTHING_STIFF = "not expected to be stiff: no spring, damper, friction or force law in coordinates"


def choose_first_method(layout: Layout, spec: Spec) -> Method:
    """Choose the method for a motion that is not known to be stiff.

    layout: of the scene that is integrated
    """
    is_fine = spec.analysis.tolerance <= tolerances.VERNER98 and is_smooth(layout)
    return load_method_by_name(
        FINE_METHOD if is_fine and not find_discontinuities(layout.mechanism, end_time(spec)) else DEFAULT
    )


def end_time(spec: Spec) -> float:
    """Return the end of a motion [s]."""
    return float(spec.analysis.times[-1])


def is_smooth(layout: Layout) -> bool:
    """Return whether only jumps in time can end a step early, apart from the step's own error."""
    return not (layout.pack.branch_count or layout.contacts or layout.mechanism.impulses)


def explain_method(method: Method, layout: Layout, spec: Spec) -> list[str]:
    """Explain in sentences why a motion begins with that method."""
    sentence = f"{method.name}, explicit, order {method.order}: "
    if method.name == FINE_METHOD:
        sentence += "fewest evaluations for smooth motions at so small a tolerance"
    else:
        sentence += "fewest evaluations for smooth motions, at six or more digits"
    return [*describe_length(layout, end_time(spec)), sentence, describe_stiffness(layout.mechanism)]


def explain_restart(reason: str, method: Method) -> str:
    """Explain why a run was restarted, and by which method."""
    return f"{reason}; restarted with {method.name}"


def describe_stiffness(mechanism: Mechanism) -> str:
    """Say in a sentence what may turn out to be stiff."""
    names = list(dict.fromkeys(load.name for load in mechanism.loads if depends_on_state(load)))
    return MAY_BE_STIFF.format(list_some([f"`{name}`" for name in names])) if names else NOTHING_STIFF


def describe_length(layout: Layout, last: float) -> list[str]:
    """Say in a sentence whether the motion is long and conservative, or short; empty if it is neither."""
    swings = last * estimate_typical_rate(layout) / (2.0 * math.pi)
    if swings < 1.0:
        return ["short motion: less than one revolution or oscillation"]
    if swings >= LONG_MOTION and is_conservative(layout):
        rounded = float(f"{swings:.2g}")
        return [
            f"long and conservative, about {rounded:,.0f} revolutions or oscillations: the error "
            "estimate of the check run holds to "
            "the end; a symmetric method (Gauss6 with a given step) is worthwhile only above about 100,000"
        ]
    return []


def is_conservative(layout: Layout) -> bool:
    """Return whether nothing adds or takes energy: only weight and springs act; no drives, impulses or contacts."""
    mechanism = layout.mechanism
    is_driven = bool(mechanism.laws)
    return not (is_driven or layout.contacts or mechanism.impulses) and all(
        load.is_conservative for load in mechanism.loads
    )


def estimate_typical_rate(layout: Layout) -> float:
    """Return how fast the scene turns, or would swing as a pendulum of its size [rad/s]."""
    gravity = float(np.sqrt(np.sum(np.square(layout.mechanism.gravity))))
    return max(find_largest_rate(layout), math.sqrt(gravity / layout.size))


def find_largest_rate(layout: Layout) -> float:
    """Return the largest rate at the start; a speed is divided by the scene's size [1/s]."""
    y: Array = layout.y0
    rates = [np.abs(y[int(g["rates"]) : int(g["end"])] * layout.weights[int(g["rates"]) : int(g["end"])])
             for k, g in enumerate(layout.tables["groups"]) if k != layout.energy_group]  # fmt: skip
    return max((float(x.max(initial=0.0)) for x in rates), default=0.0)


TRIAL_SHARE = 0.1  # share of the run that the trial integrates
MAX_TRIAL_SECONDS = 0.5  # seconds for the trial
MAX_STEPS = 2_000


def describe_integration(setup: Setup) -> list[str]:
    """Describe in sentences what is integrated, and what the first part of the run costs."""
    if setup.spec.analysis.type == "rest":
        return ["none: search for the rest position that a heavily damped motion from the start would reach"]
    if setup.method is None:
        return ["none: one instant is solved"]
    if setup.method.is_determined:
        return ["none: motion fully prescribed, solved at each instant on the same assembly branch"]
    layout, tolerance = setup.runner.integrated_scene.layout, setup.spec.analysis.tolerance
    how = f"tolerance {tolerance:.3g} of the model size; repeated at 1/30 of this tolerance as a check"
    if setup.step is not None:
        how = f"in steps of {setup.step:.4g} s; repeated with steps of a quarter as a check"
    row = find_method(setup.method.name)
    kind = f"an {row.kind}" if row is not None and row.kind != "SciPy" else "a"
    sentence = (
        f"{format_count(layout.n_state, 'state variable')}, integrated by {setup.method.name}, {kind} method of order "
        f"{setup.method.order}, {how}"
    )
    return [sentence, *describe_cost(setup, tolerance if setup.step is None else setup.step)]


def find_restart_method(setup: Setup) -> tuple[Method, str] | None:
    """Find the method that the run would be restarted with, and why; None if it would not.

    A run is restarted if its beginning is stiff, or if events end most steps.
    """
    if not setup.is_auto or setup.method is None or setup.method.is_determined:
        return None
    mechanism, last = setup.scene.mechanism, float(setup.spec.analysis.times[-1])
    if not (
        any(depends_on_state(load) for load in mechanism.loads) or not is_smooth(setup.runner.integrated_scene.layout)
    ):
        return None
    with suppress(SolveError, LimitError):
        try:
            run_first_part(setup, setup.spec.analysis.tolerance, last, stops_early=True)
        except StiffRun as stiff:
            return stiff.method, stiff.reason
        except EventfulRun as eventful:
            jumps = find_discontinuities(mechanism, eventful.end_time)
            runs = Runs(setup.runner, np.array([eventful.end_time]), jumps, None, setup.method)
            return (runs.method, eventful.reason) if try_fewer_stages(runs, eventful) else None
    return None


def describe_cost(setup: Setup, tolerance_or_step: float) -> list[str]:
    """Describe what the first part of the run costs; empty if it cannot be solved, because the run itself will say
    why.
    """
    last = TRIAL_SHARE * float(setup.spec.analysis.times[-1])
    whole = round(1.0 / TRIAL_SHARE)
    with suppress(SolveError):
        try:
            run = min((run_first_part(setup, tolerance_or_step, last) for _ in range(2)), key=lambda run: run.seconds)
        except LimitError:
            return [f"the first {last:.4g} s take over {MAX_STEPS:,} steps or {MAX_TRIAL_SECONDS} s: a long run"]
        steps, evaluations = format_count(run.steps, "step"), format_count(run.evaluations, "evaluation")
        check = "1.3 to 1.5" if setup.step is None else "5"
        took = f"the first {last:.4g} s take {steps}, {evaluations}, {1e3 * run.seconds:.2g} ms"
        return [f"{took}; the whole run about {whole} times that, and the check {check} times as much again"]
    return []


def run_first_part(setup: Setup, tolerance_or_step: float, last: float, *, stops_early: bool = False) -> Trajectory:
    """Integrate the run up to `last`."""
    jumps = tuple(find_discontinuities(setup.scene.mechanism, last))
    assert setup.method is not None
    deadline = time.monotonic() + MAX_TRIAL_SECONDS
    request = MotionTask([0.0, last], tolerance_or_step, setup.method, jumps, deadline=deadline, most_steps=MAX_STEPS)
    return setup.runner.run(request, StoppingRules(stiffness=stops_early, events=stops_early))
