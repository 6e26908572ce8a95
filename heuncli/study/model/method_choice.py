"""Which method `auto` begins with, and why, by what can be seen of the scene and of the tolerance beforehand.

Driven motions that leave no freedom are followed and not integrated (motion/integration/determined_motion.py). What
turns out to be stiff on the way, or cut by events at nearly every step, is begun anew
(motion/integration/run/stiffness.py, motion/integration/run/event_frequency.py).
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.base import tolerances
from heuncli.base.method_rows import DEFAULT
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.methods.registry import method_of
from heuncli.motion.integration.run.kernel_loop import depends
from heuncli.motion.integration.segments import discontinuities_of
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.counts_and_lists import some

FINE = "Verner98"
LONG = 100.0  # turns or swings from which on a conservative motion is called long
WATCHED = (
    "watched on the way: should {} prove stiff and keep explicit steps short, the motion is begun anew by an implicit "
    "method, if that takes less"
)
NOTHING_STIFF = "not stiff, as far as can be seen beforehand: no spring, damper, friction or law in coordinates"


def first_choice(layout: Layout, spec: Spec) -> Method:
    """The method a motion is begun with that is not known to be stiff; layout: of what is integrated."""
    fine = spec.analysis.tolerance <= tolerances.VERNER98 and is_smooth(layout)
    return method_of(FINE if fine and not discontinuities_of(layout.mechanism, last_of(spec)) else DEFAULT)


def last_of(spec: Spec) -> float:
    """The end of a motion [s]."""
    return float(spec.analysis.times[-1])


def is_smooth(layout: Layout) -> bool:
    """Whether nothing but jumps in time may end a step beside the step's own error."""
    return not (layout.pack.held or layout.contacts or layout.mechanism.blows)


def why(method: Method, layout: Layout, spec: Spec) -> list[str]:
    """Why a motion is begun with that method, in sentences."""
    found = f"by {method.name}, explicit, of order {method.order}: "
    if method.name == FINE:
        found += "to so small a tolerance the fewest evaluations for what is smooth"
    else:
        found += "the fewest evaluations for what is smooth, to six digits and more"
    return [*kind_of_motion(layout, last_of(spec)), found, stiffness(layout.mechanism)]


def anew(why: str, method: Method) -> str:
    """Why a run was begun anew, and by which method."""
    return f"{why}; begun anew by {method.name}"


def stiffness(mechanism: Mechanism) -> str:
    """What may turn out to be stiff, in a sentence."""
    names = list(dict.fromkeys(load.name for load in mechanism.loads if depends(load)))
    return WATCHED.format(some([f"`{name}`" for name in names])) if names else NOTHING_STIFF


def kind_of_motion(layout: Layout, last: float) -> list[str]:
    """Long and conservative, or short, in a sentence; nothing of what is neither."""
    swings = last * pace(layout) / (2.0 * math.pi)
    if swings < 1.0:
        return ["short: less than a turn, or a swing, of the whole"]
    if swings >= LONG and is_conservative(layout):
        about = float(f"{swings:.2g}")
        return [
            f"long and conservative, some {about:,.0f} turns or swings: what the check run tells of the error holds to "
            "their end; a symmetric method, Gauss6 with a given step, pays only beyond some 100,000"
        ]
    return []


def is_conservative(layout: Layout) -> bool:
    """Whether nothing takes energy or gives it: weight and springs alone, no drive, no blow, nothing that is struck."""
    mechanism = layout.mechanism
    moved = bool(mechanism.laws)
    return not (moved or layout.contacts or mechanism.blows) and all(load.is_conservative for load in mechanism.loads)


def pace(layout: Layout) -> float:
    """How fast the scene turns, or would swing as a pendulum of its size does [rad/s]."""
    gravity = float(np.sqrt(np.sum(np.square(layout.mechanism.gravity))))
    return max(fastest(layout), math.sqrt(gravity / layout.size))


def fastest(layout: Layout) -> float:
    """The largest rate at the start, of the scene's size where it is a speed [1/s]."""
    y: Array = layout.y0
    rates = [np.abs(y[int(g["rates"]) : int(g["end"])] * layout.weights[int(g["rates"]) : int(g["end"])])
             for k, g in enumerate(layout.tables["groups"]) if k != layout.energy_group]  # fmt: skip
    return max((float(x.max(initial=0.0)) for x in rates), default=0.0)
