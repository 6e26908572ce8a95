"""Whether a rest pose is stable: the least eigenvalue, and what the slowest or growing small motions are.

    x'' = A x + C x',     x ~ e^(s t)
Stable is what no s leaves with a growing part. Without rates in the loads s^2 = lambda; in a frame that turns, with the
velocity terms of the displaced motion, seen from the frame: a ball's angular acceleration less Omega x omega.
"""

from __future__ import annotations

import numpy as np

from heuncli import tolerances
from heuncli.records import record
from heuncli.rest.coordinates import Coordinates
from heuncli.rest.search import FoundPose
from heuncli.results import Array, Mask
from heuncli.shapes.rotations import hat


@record
class Stability:
    """Growth [1/s] of what grows fastest, 0 where nothing does; what moves in it, and what is indifferent, by name.

    flat: what is indifferent to first order alone, by name: what bends may hold it, or push it off.

    least: the least eigenvalue of stiffness over inertia, -lambda, of what is not indifferent [1/s^2]; slowest: what
    moves in it; frequency: of that motion [Hz], 0 where it does not swing.
    """

    growth: float
    grows: str
    least: float
    slowest: str
    frequency: float
    indifferent: tuple[str, ...]
    flat: tuple[str, ...]


def stability(found: FoundPose, bends: Mask) -> Stability:
    """Of a rest pose; bends (f,): the directions without stiffness that are held, or pushed, by what bends."""
    own, coordinates = found.slopes, found.coordinates
    real = own.decided
    shapes = own.T @ own.V
    s, motions = motions_of(found)
    grown = np.flatnonzero(s.real > tolerances.GROWS * np.abs(s).max(initial=0.0))
    fastest = max(grown.tolist(), key=lambda k: float(s[k].real), default=-1)
    least = min(np.flatnonzero(real).tolist(), key=lambda k: float(-own.eigenvalues[k].real), default=-1)
    free = np.abs(own.inverse @ motions)
    swung = free[real].max(axis=0, initial=0.0) > tolerances.MOVES * free.max(axis=0, initial=0.0)
    swings = [k for k in range(len(s)) if swung[k] and s[k].imag > tolerances.GROWS * np.abs(s).max()]
    near = min(swings, key=lambda k: abs(s[k].imag), default=-1)
    return Stability(
        growth=float(s[fastest].real) if fastest >= 0 else 0.0,
        grows=moves(coordinates, own.T @ motions[:, fastest]) if fastest >= 0 else "",
        least=float(-own.eigenvalues[least].real) if least >= 0 else 0.0,
        slowest=moves(coordinates, shapes[:, least]) if least >= 0 else "",
        frequency=float(abs(s[near].imag)) / (2.0 * np.pi) if near >= 0 else 0.0,
        indifferent=indifferent(found, ~real & ~bends),
        flat=indifferent(found, ~real & bends),
    )


def motions_of(found: FoundPose) -> tuple[Array, Array]:
    """The exponents s of small motions along directions that are not indifferent, and their displacements (f, k)."""
    own, coordinates = found.slopes, found.coordinates
    C = own.law.by_rate.copy()
    omega = found.pose.recovered.bodies["omega"][0]
    for place, first in zip(coordinates.balls.tolist(), coordinates.turns.tolist(), strict=True):
        C[first : first + 3, first : first + 3] -= hat(omega[place])
    f = own.T.shape[1]
    # what is indifferent to the pose is so in V's own directions: there eigenvalues are zero, and not their rounding
    A = own.directions.whole(own.decided)
    whole = np.block([[np.zeros((f, f)), np.eye(f)], [A, own.back @ C @ own.T]])
    s, vectors = np.linalg.eig(whole) if f else (np.zeros(0), np.zeros((0, 0)))
    return s, vectors[:f]


def indifferent(found: FoundPose, loose: Mask) -> tuple[str, ...]:
    """What moves along some directions, by name; not what moves no mass, as spins that nothing determines."""
    own, coordinates = found.slopes, found.coordinates
    if not loose.any():
        return ()
    U, size, _ = np.linalg.svd(np.hstack([own.V.real[:, loose], own.V.imag[:, loose]]), full_matrices=False)
    shapes = own.T @ U[:, size > tolerances.MOVES]
    inertia, axes = np.linalg.eigh(shapes.T @ own.law.mass @ shapes)
    largest = float(np.linalg.norm(own.T.T @ own.law.mass @ own.T))
    shapes = shapes @ axes[:, inertia > tolerances.NO_INERTIA * largest]
    share = np.sqrt(np.sum(shapes**2, axis=1)) * coordinates.weights
    own_share = np.flatnonzero(share > tolerances.MOVES * share.max(initial=0.0))
    return tuple(dict.fromkeys(coordinates.owner(k)[0] for k in own_share.tolist()))


def moves(coordinates: Coordinates, shape: Array) -> str:
    """What moves most in a small motion, by name."""
    return coordinates.owner(int(np.argmax(np.abs(shape) * coordinates.weights)))[0]
