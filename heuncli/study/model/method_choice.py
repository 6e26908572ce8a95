"""Choose the method that `auto` begins with, and say why.

Driven motions that leave no freedom are followed and not integrated (motion/integration/integrated_scene.py). A motion
that turns out to be stiff, or cut by events at nearly every step, is restarted (motion/integration/run/supervision.py).
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.base import tolerances
from heuncli.base.method_rows import DEFAULT
from heuncli.base.spelling import list_some
from heuncli.motion.integration.integrated_scene import find_discontinuities
from heuncli.motion.integration.methods.method import GLOBAL, QUATERNION, RECENTRED, Method, load_method_by_name
from heuncli.motion.integration.run.kernel_loop import depends_on_state
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec

FINE_METHOD = "Verner98"  # for smooth motions at tolerances up to tolerances.VERNER98
LONG_MOTION = 100.0  # turns or swings from which on a conservative motion is called long
MAY_BE_STIFF = (
    "monitored for stiffness due to {}: if explicit steps stay short, the run is restarted with an implicit "
    "method where that is faster"
)
NOTHING_STIFF = "not expected to be stiff: no spring, damper, friction or force law in coordinates"
COUNTED_FROM = {GLOBAL: "relative to the world axes: none can pass 180 deg", RECENTRED: "restarted in each step"}


def choose_first_method(layout: Layout, spec: Spec) -> Method:
    """Choose the method for a motion that is not known to be stiff.

    layout: of the scene that is integrated
    """
    is_fine = spec.analysis.tolerance <= tolerances.VERNER98 and is_smooth(layout)
    return load_method_by_name(
        FINE_METHOD if is_fine and not find_discontinuities(layout.mechanism, find_end_time(spec)) else DEFAULT
    )


def find_end_time(spec: Spec) -> float:
    """Return the end of a motion [s]."""
    return float(spec.analysis.times[-1])


def is_smooth(layout: Layout) -> bool:
    """Return whether only jumps in time can end a step early, apart from the step's own error."""
    return not (layout.pack.branch_count or layout.contacts or layout.mechanism.impulses)


def explain_choice(method: Method, layout: Layout, spec: Spec, *, is_auto: bool) -> list[str]:
    """Explain how a method represents attitudes and, if `auto` chose it, why."""
    reasons = [*describe_attitudes(method, layout)]
    return [*reasons, *explain_method(method, layout, spec)] if is_auto and not method.is_determined else reasons


def explain_method(method: Method, layout: Layout, spec: Spec) -> list[str]:
    """Explain in sentences why a motion begins with that method."""
    sentence = f"{method.name}, explicit, order {method.order}: "
    if method.name == FINE_METHOD:
        sentence += "fewest evaluations for smooth motions at so small a tolerance"
    else:
        sentence += "fewest evaluations for smooth motions, at six or more digits"
    return [*describe_length(layout, find_end_time(spec)), sentence, describe_stiffness(layout.mechanism)]


def explain_restart(reason: str, method: Method) -> str:
    """Explain why a run was restarted, and by which method."""
    return f"{reason}; restarted with {method.name}"


def describe_attitudes(method: Method, layout: Layout) -> list[str]:
    """Say in a sentence how a method represents attitudes within a step, if not as quaternions."""
    if method.attitude == QUATERNION:
        return []
    if not layout.bodies["ball"].any():
        return [f"{method.name}: no integrated body is free or on a ball joint, so this equals DOP853"]
    return [f"{method.name}: orientations by Rodrigues parameters, {COUNTED_FROM[method.attitude]}"]


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
