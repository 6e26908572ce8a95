"""How well a rest pose is known: poses beside it that rounding does not tell from it.

Each is found as the pose itself is, by Newton's step from a pose moved by rounding; or as far off as rounding of the
sums pushes a soft direction; and where a direction is held by no stiffness but by what bends (a quartic potential), as
far out along it as the accelerations are still rounding.
"""

from __future__ import annotations

import numpy as np

from heuncli import tolerances
from heuncli.integration.evaluator import Evaluator
from heuncli.linearisation.linearise import linearised
from heuncli.records import replace
from heuncli.rest.coordinates import Coordinates, resting, rounding_of
from heuncli.rest.search import FoundPose
from heuncli.rest.slopes import Slopes
from heuncli.results import Array, Mask

TWICE = 2.0  # the change of an eigenvalue between two poses that rounding does not tell apart
BESIDE = 2  # poses moved by rounding
REACHES = 10.0 ** np.arange(-8.0, -2.0)  # rad, or of the size: how far out directions without stiffness are tried
THRICE = 3.0  # of Newton's steps: so far away is the rest of what is held by a cubic force alone
BACK = 6  # of Newton's steps by the slopes of the pose itself: beside it each errs by as much as that is away


def beside(evaluator: Evaluator, found: FoundPose) -> tuple[list[Array], Mask]:
    """States (n_state,) of such poses; which directions (f,) without stiffness are held, or pushed, by what bends."""
    at, own, coordinates = found.pose, found.slopes, found.coordinates
    by = np.array([rounding_of(coordinates, at.state, k) for k in range(BESIDE)])
    states = coordinates.displaced(np.repeat(at.state[None, :], BESIDE, axis=0), by)
    there = resting(evaluator, at.t, states, at.holding)
    back = np.array([own.newton(a) for a in coordinates.accelerations(there)])
    again = resting(evaluator, at.t, coordinates.displaced(there.states, back), at.holding)
    sums = coordinates.displaced(at.state[None, :], rounding_of_sums(found)[None, :])
    far, bends = bent(evaluator, found)
    return [*again.states, *resting(evaluator, at.t, sums, at.holding).states, *far], bends


def rounding_of_sums(found: FoundPose) -> Array:
    """How far each direction gives way to what rounding leaves of its accelerations' sums, all together, (n,)."""
    own = found.slopes
    push = THRICE * tolerances.PLACE_ROUNDING / tolerances.SUM_ROUNDING * own.summed
    give = np.abs(own.directions.softened(push, own.known))
    way = np.asarray((own.T @ (own.V @ give)).real)
    return way / max(1.0, found.coordinates.size(way))  # a radian, or the size: nothing is known beyond that


def bent(evaluator: Evaluator, found: FoundPose) -> tuple[list[Array], Mask]:
    """The farthest poses along directions without stiffness at which accelerations are rounding, but are none farther.

    And which directions (f,) these are; none in which accelerations are rounding as far as one looks: indifferent ones.
    """
    own, coordinates, states = found.slopes, found.coordinates, []
    bends = np.zeros(len(own.known), dtype=bool)
    for k in np.flatnonzero(~own.decided).tolist():
        shape = own.T @ own.V[:, k].real
        size = coordinates.size(shape)
        for sign in (1.0, -1.0) if size > 0.0 else ():
            out, push = beyond(evaluator, found, sign * REACHES[:, None] * shape / size)
            held = np.flatnonzero(np.abs(push[:, k]) > own.noise[k])
            if len(held):
                states.append(out[max(held[0] - 1, 0)])
                bends[k] = True
    return states, bends


def softened(found: FoundPose, states: list[Array]) -> Slopes:
    """The slopes at a pose, with eigenvalues known no better than they stay as far off as rounding leaves the pose."""
    at, own, coordinates = found.pose, found.slopes, found.coordinates
    if not own.decided.any():
        return own
    farthest = max(states, key=lambda state: off(coordinates, at.state, state))
    there = linearised(coordinates.layout, at.t, farthest, at.holding)
    change = own.inverse @ (own.back @ there.by_place @ own.T - own.A) @ own.V
    return replace(own, known=own.known + TWICE * np.abs(np.diag(change)))


def beyond(evaluator: Evaluator, found: FoundPose, way: Array) -> tuple[Array, Array]:
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


def off(coordinates: Coordinates, state: Array, other: Array) -> float:
    """How far a state is off another one: the largest of turns, and of shifts by the scene's size."""
    change = np.abs(other - state)
    balls = [change[a : a + 4].max() for a in coordinates.layout.bodies["attitude_at"][coordinates.balls].tolist()]
    shifts = change[coordinates.layout.tables["freedoms"]["q_at"][coordinates.freedoms]]
    return float(np.max([*balls, *(shifts * coordinates.weights[coordinates.numbers])], initial=0.0))
