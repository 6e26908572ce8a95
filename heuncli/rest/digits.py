"""How well a rest pose is known: poses beside it that rounding does not tell from it.

Each is found as the pose itself is, by Newton's step from a pose moved by rounding; or as far off as rounding of the
sums pushes a soft direction; and where a direction is held by no stiffness but by what bends (a quartic potential), as
far out along it as the accelerations are still rounding.
"""

from __future__ import annotations

import numpy as np

from heuncli import tolerances
from heuncli.integration.evaluator import Evaluator
from heuncli.rest.coordinates import resting, rounding_of
from heuncli.rest.search import Found
from heuncli.results import Array

BESIDE = 2  # poses moved by rounding
REACHES = 10.0 ** np.arange(-8.0, -2.0)  # rad, or of the size: how far out directions without stiffness are tried
THRICE = 3.0  # of Newton's steps: so far away is the rest of what is held by a cubic force alone
BACK = 6  # of Newton's steps by the slopes of the pose itself: beside it each errs by as much as that is away


def beside(evaluator: Evaluator, found: Found) -> list[Array]:
    """States (n_state,) of such poses."""
    at, own, coordinates = found.pose, found.slopes, found.coordinates
    by = np.array([rounding_of(coordinates, at.state, k) for k in range(BESIDE)])
    states = coordinates.displaced(np.repeat(at.state[None, :], BESIDE, axis=0), by)
    there = resting(evaluator, at.t, states, at.holding)
    back = np.array([own.newton(a) for a in coordinates.accelerations(there)])
    again = resting(evaluator, at.t, coordinates.displaced(there.states, back), at.holding)
    sums = coordinates.displaced(at.state[None, :], rounding_of_sums(found)[None, :])
    return [*again.states, *resting(evaluator, at.t, sums, at.holding).states, *bent(evaluator, found)]


def rounding_of_sums(found: Found) -> Array:
    """How far each direction gives way to what rounding leaves of its accelerations' sums, all together, (n,)."""
    own = found.slopes
    push = THRICE * tolerances.PLACE_ROUNDING / tolerances.SUM_ROUNDING * own.summed
    give = np.abs(own.directions.softened(push, own.known))
    way = np.asarray((own.T @ (own.V @ give)).real)
    return way / max(1.0, found.coordinates.size(way))  # a radian, or the size: nothing is known beyond that


def bent(evaluator: Evaluator, found: Found) -> list[Array]:
    """The farthest poses along directions without stiffness at which accelerations are rounding, but are none farther.

    Nothing of a direction in which they are so as far as one looks: that is indifferent.
    """
    own, coordinates, states = found.slopes, found.coordinates, []
    for k in np.flatnonzero(~own.decided).tolist():
        shape = own.T @ own.V[:, k].real
        size = coordinates.size(shape)
        for sign in (1.0, -1.0) if size > 0.0 else ():
            out, push = beyond(evaluator, found, sign * REACHES[:, None] * shape / size)
            held = np.flatnonzero(np.abs(push[:, k]) > own.noise[k])
            if len(held):
                states.append(out[max(held[0] - 1, 0)])
    return states


def beyond(evaluator: Evaluator, found: Found, way: Array) -> tuple[Array, Array]:
    """States displaced by ways (k, n) at which all directions but those without stiffness rest, and c there, (k, f)."""
    at, own, coordinates = found.pose, found.slopes, found.coordinates
    states = coordinates.displaced(np.repeat(at.state[None, :], len(way), axis=0), way)
    for _ in range(BACK):
        there = resting(evaluator, at.t, states, at.holding)
        states = coordinates.displaced(
            there.states, np.array([own.newton(a) for a in coordinates.accelerations(there)])
        )
    there = resting(evaluator, at.t, states, at.holding)
    return there.states, np.array([own.along(a) for a in coordinates.accelerations(there)])
