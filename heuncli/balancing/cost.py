"""What counterweights cost: the scene really solved at the cycle's rate, with its loads, before and after.

Of force and moment on the foundation, of the drive, and of every joint (across its axis, if it has one) the root of the
mean square over the cycle and the largest. What redundant joints leave open is told as open (None). All are told by
their squares, which are smooth where a magnitude is none.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli import tolerances
from heuncli.balancing.choice import CyclePlan
from heuncli.balancing.loaded import LoadedScene, loaded
from heuncli.balancing.over_cycle import of_squares
from heuncli.balancing.results import OverCycle
from heuncli.kinetostatics.foundation import inertia_loads
from heuncli.mechanism.model import Mechanism
from heuncli.results import Array
from heuncli.shapes.rotations import cross_rows
from heuncli.spec.models import Spec
from heuncli.study.compose.blocks import blocks
from heuncli.study.compose.recovery import Recovery
from heuncli.tree.prepare import PreparedScene

MOMENTS = ("moment", "drive")
FAINT = 1e-12  # of the largest square: a magnitude of a millionth, whose rounding is of no digit that is told


def loads_of(scene: LoadedScene, plan: CyclePlan, about: Array) -> tuple[dict[str, OverCycle], tuple[str, ...]]:
    """Force, moment, drive and joints by their names, over the cycle; with what is to be told beside them."""
    first = scene.at_first()
    names = [*squares(first, plan, about)]
    opened: set[str] = set()

    def columns(recovery: Recovery) -> Array:
        own = squares(recovery, plan, about)
        opened.update(name for name, values in own.items() if np.isnan(values).any())
        return np.nan_to_num(np.stack([own[name] for name in names], axis=1))

    found = scene.numbers(columns, [1] * len(names), faint(columns(first), names, scene.setup.scene.layout.size))
    tops = of_squares({name: found.values[:, k] for k, name in enumerate(names)}, found.nodes)
    over = {
        name: OverCycle(None, None) if name in opened else OverCycle(own.rms, own.peak, own.error)
        for name, own in tops.items()
    }
    return over, found.notes


def squares(recovery: Recovery, plan: CyclePlan, about: Array) -> dict[str, Array]:
    """The squares of force, moment, drive and joints by their names, (n,) each; nan is open."""
    mechanism, states = recovery.setup.scene.mechanism, recovery.states
    ma, spin = inertia_loads(mechanism, states)
    moment = -(cross_rows(states.centre - about, ma) + spin).sum(axis=1)
    if mechanism.planar:
        moment = moment * np.array([0.0, 0.0, 1.0])
    found = {"force": np.sum(ma.sum(axis=1) ** 2, axis=1), "moment": np.sum(moment**2, axis=1)}
    joints: Mapping[str, Mapping[str, Array]] = blocks(recovery, frozenset({"joints"}))["joints"]
    found["drive"] = joints[plan.joint]["drive"] ** 2
    for name, own in joints.items():
        found[f"joints.{name}"] = own["radial"] ** 2 if "radial" in own else np.sum(own["force"] ** 2, axis=1)
    return found


def faint(values: Array, names: Sequence[str], size: float) -> list[float]:
    """What of squares (n, m) is none: of magnitudes a millionth of the largest force, or of that by the size [m]."""
    force = max(float(values[:, k].max()) for k, name in enumerate(names) if name not in MOMENTS)
    moment = max(force * size**2, *(float(values[:, k].max()) for k, name in enumerate(names) if name in MOMENTS))
    return [tolerances.ORDERS_SETTLED * FAINT * (moment if name in MOMENTS else force) for name in names]


def cost(
    spec: Spec, scene: PreparedScene, heavier: Mechanism, plan: CyclePlan, about: Array
) -> tuple[dict[str, OverCycle], dict[str, OverCycle], tuple[str, ...]]:
    """The loads before and after, and what is to be told beside them; heavier: with the weights."""
    rate = plan.rate or 1.0
    two: Sequence[Mechanism] = (scene.mechanism, heavier)
    (before, notes), (after, more) = (loads_of(loaded(spec, scene, own, plan, rate), plan, about) for own in two)
    return before, after, (*notes, *more)
