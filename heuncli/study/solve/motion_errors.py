"""The results of a motion other than positions and velocities: momenta, the system vector, attitudes; and their errors.

They have no error in common with positions. A small body in a large scene may turn by far more than its position errors
suggest; orbital and spin moments of momentum may have opposite errors.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import reduce

import numpy as np

from heuncli.base import tolerances
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.energy import system_vector
from heuncli.loads.kinetostatics.foundation import find_momenta
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array
from heuncli.study.solve.error_extents import norms

MOTION_KINDS = ("motion", "attitudes", "rodrigues")  # kinds of errors of a motion


def iter_momentum_quantities(
    mechanism: Mechanism, states: BodyStates, moment_point: Array
) -> Iterator[tuple[str, Array, Array]]:
    """Yield by unit the values of the bodies and the sums over them (n_t, m, 3), and the rounding (n_t,)."""
    body_momenta, vector = find_momenta(mechanism, states, moment_point), system_vector(mechanism, states)
    body_vectors = [np.stack([*own.values()], axis=1) for own in vector.values() if isinstance(own, dict)]
    for unit, parts, totals in (
        ("N·s", (body_momenta.linear,), ()),
        ("N·m·s", (body_momenta.orbital, body_momenta.spin), (body_momenta.orbital + body_momenta.spin,)),
        ("N·m/s", body_vectors, ()),
    ):
        sums = [part.sum(axis=1, keepdims=True) for part in parts]
        rounding = tolerances.SUM_ROUNDING * sum(norms(part).sum(axis=1) for part in parts)
        yield unit, np.concatenate([*(totals or parts), *sums], axis=1), np.asarray(rounding)


def compare_attitudes(R: Array, count: int) -> tuple[Array, Array]:
    """Return how far the attitudes of `count` runs, instant by instant, lie from the first's, and their Rodrigues'
    vectors, (n,).

    Columns of two attitudes an angle d apart differ by at most 2 sin(d/2), 1/√2 of the root of squares of all elements.
    For rho = tan(half the turn) that makes (1 + rho^2) d/2, where 1 + rho^2 = 4 / (1 + tr R); near half a turn no
    vector is compared.
    """
    first_run = R[0::count]
    others = [np.sqrt(0.5 * np.square(first_run - R[k::count]).sum(axis=(2, 3))) for k in range(1, count)]
    distances = reduce(np.maximum, others)
    trace = 1.0 + np.trace(first_run, axis1=2, axis2=3)
    is_defined = trace > 4.0 * tolerances.HALF_TURN**2
    vectors = 2.0 * distances / np.where(is_defined, trace, 1.0) * is_defined
    return distances.max(axis=1), vectors.max(axis=1)
