"""The reaction of a joint as the loads of the two bearings that it stands for.

Two bearings at a and b along the unit axis n from the reaction's origin carry R1 and R2, across n. From R1 + R2 = F_r
and n x (a R1 + b R2) = M_t, the parts of the force F and the moment M across n:

    R2 = (M x n - a F_r)/(b - a),   R1 = F_r - R2

These are linear: shares by cause, self-stresses and errors take the same way. Axes before that of the instants, such as
that of causes, are kept.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.loads.kinetostatics.reactions import JointLoads
from heuncli.results.results import Array, Block
from heuncli.scene.file_format.models import BearingPair
from heuncli.scene.shapes.rotations import cross_rows


def split_to_bearings(pair: BearingPair, n: Array, force: Array, moment: Array) -> tuple[Array, Array]:
    """Return the loads of two bearings across the axis n (n_t, 3), (..., n_t, 3) each."""
    first, second = pair.at
    across = force - np.sum(force * n, axis=-1)[..., None] * n
    R2 = (cross_rows(moment, np.broadcast_to(n, moment.shape)) - first * across) / (second - first)
    return across - R2, R2


def find_axial_parts(pair: BearingPair, axial: Array) -> tuple[Array, Array]:
    """Return the parts of an axial load (..., n_t) on two bearings; nan where it is not stated which carries it."""
    if pair.axial is None:
        unknown = np.full_like(axial, np.nan)
        return unknown, unknown
    zero = np.zeros_like(axial)
    return (axial, zero) if pair.axial == 0 else (zero, axial)


def make_bearing_loads(load: JointLoads, planar: bool = False) -> Block:
    """Return the loads of a joint's two bearings, by their numbers: across its axis, and along it if the joint carries
    that. Of a scene declared planar no load along the axis exists.
    """
    pair, n = load.joint.bearings, load.axis
    assert pair is not None
    assert n is not None
    axial = np.sum(load.force * n, axis=-1)
    # in a planar scene it is 0 on both, known without a word on which carries it, so it is not open
    axials = (axial, axial) if planar else find_axial_parts(pair, axial)
    across = split_to_bearings(pair, n, load.force, load.moment)
    has_thrust = not load.slides
    return {
        str(i): {"radial_force": across[i]} | ({"axial": axials[i]} if has_thrust else {}) for i in range(len(across))
    }


def make_bearing_blocks(load: JointLoads, planar: bool) -> Block:
    """Make the blocks of a joint's bearings; the axial load is open where it is not stated which carries it."""
    pair = load.joint.bearings
    assert pair is not None
    assert load.axis is not None
    block: Block = {}
    for (key, own), place in zip(make_bearing_loads(load, planar).items(), pair.at, strict=True):
        radial = np.sqrt(np.sum(own["radial_force"] ** 2, axis=-1))
        is_open = "axial" in own and bool(np.isnan(own["axial"]).any())
        names = ["axial"] if is_open else []
        block[key] = {"point": load.point + place * load.axis, "radial": radial, "open": names} | own
    return block


def iter_bearing_terms(joints: Sequence[JointLoads]) -> Iterator[tuple[Array, float, float]]:
    """Yield the load of each bearing across its axis, with the factors by which errors of force and moment enter."""
    for load in joints:
        if load.joint.bearings is not None:
            by_force, by_moment = find_bearing_factors(load.joint.bearings)
            for own in make_bearing_loads(load).values():
                yield own["radial_force"], by_force, by_moment


def find_bearing_factors(pair: BearingPair) -> tuple[float, float]:
    """Return the largest factors by which a force [1] and a moment [1/m] enter the load of a bearing."""
    first, second = pair.at
    distance = abs(second - first)
    return max(abs(first), abs(second), distance) / distance, 1.0 / distance
