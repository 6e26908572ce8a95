"""What is told of a motion beside places and velocities: momenta, the system vector, attitudes; and how they err.

They have no error in common with places. A small body in a large scene may turn by far more than a part of the scene's
size as small as the error of its places; momenta and their moments, orbital and spin, may err against each other.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import reduce

import numpy as np

from heuncli.base import tolerances
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.energy import system_vector
from heuncli.loads.kinetostatics.momentum import momenta
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array
from heuncli.study.solve.error_extents import norms

TOLD = ("motion", "attitudes", "rodrigues")  # kinds of errors of a motion


def moved_quantities(mechanism: Mechanism, states: BodyStates, about: Array) -> Iterator[tuple[str, Array, Array]]:
    """By unit: what the bodies have and the sums over them (n_t, m, 3), and its rounding (n_t,)."""
    moved, vector = momenta(mechanism, states, about), system_vector(mechanism, states)
    of_bodies = [np.stack([*own.values()], axis=1) for own in vector.values() if isinstance(own, dict)]
    for unit, parts, told in (
        ("N·s", (moved.linear,), ()),
        ("N·m·s", (moved.orbital, moved.spin), (moved.orbital + moved.spin,)),
        ("N·m/s", of_bodies, ()),
    ):
        sums = [part.sum(axis=1, keepdims=True) for part in parts]
        rounding = tolerances.SUM_ROUNDING * sum(norms(part).sum(axis=1) for part in parts)
        yield unit, np.concatenate([*(told or parts), *sums], axis=1), np.asarray(rounding)


def turned_apart(R: Array, count: int) -> tuple[Array, Array]:
    """How far attitudes of so many runs, instant by instant, lie from the first's, and their Rodrigues' vectors, (n,).

    Columns of two attitudes an angle d apart differ by 2 sin(d/2) at most, 1/√2 of all elements' root of squares. Of
    rho = tan(half the turn) that makes (1 + rho^2) d/2, where 1 + rho^2 = 4 / (1 + tr R); at half a turn none is told.
    """
    own = R[0::count]
    others = [np.sqrt(0.5 * np.square(own - R[k::count]).sum(axis=(2, 3))) for k in range(1, count)]
    turned = reduce(np.maximum, others)
    trace = 1.0 + np.trace(own, axis1=2, axis2=3)
    told = trace > 4.0 * tolerances.HALF_TURN**2
    vectors = 2.0 * turned / np.where(told, trace, 1.0) * told
    return turned.max(axis=1), vectors.max(axis=1)
