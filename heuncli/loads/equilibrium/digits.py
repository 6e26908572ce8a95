"""How well a rest pose is known: poses beside it that rounding does not tell from it.

Each is found as the pose itself is, by Newton's step from a pose moved by rounding; or as far off as rounding of the
sums pushes a soft direction; or as far across the closures as these are left open, which near a dead centre is far; and
where a direction is held by no stiffness but by what bends (a quartic potential), as far out along it as the
accelerations are still rounding.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.loads.equilibrium.coordinates import resting, rounding_of
from heuncli.loads.equilibrium.search import FoundPose
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.linearisation.indifference import SCENES, Indifference
from heuncli.motion.linearisation.rounded_scenes import rounded_scene
from heuncli.results.results import Array, Mask

BESIDE = 2  # poses moved by rounding
REACHES = 10.0 ** np.arange(-8.0, -2.0)  # rad, or of the size: how far out directions without stiffness are tried
THRICE = 3.0  # of Newton's steps: so far away is the rest of what is held by a cubic force alone
LEVERS = 10.0  # how far a motion turns on a way, at most, of what the way is
BACK = 6  # of Newton's steps by the slopes of the pose itself: beside it each errs by as much as that is away


def beside(evaluator: Evaluator, found: FoundPose, what: Indifference) -> tuple[list[Array], Mask]:
    """States (n_state,) of such poses; which motions (g,) without stiffness are held, or pushed, by what bends."""
    at, own, coordinates = found.pose, found.slopes, found.coordinates
    by = np.array([rounding_of(coordinates, at.state, k) for k in range(BESIDE)])
    states = coordinates.displaced(np.repeat(at.state[None, :], BESIDE, axis=0), by)
    there = resting(evaluator, at.t, states, at.holding)
    back = np.array([own.newton(a) for a in coordinates.accelerations(there)])
    again = resting(evaluator, at.t, coordinates.displaced(there.states, back), at.holding)
    sums = coordinates.displaced(at.state[None, :], rounding_of_sums(found)[None, :])
    far, bends = bent(evaluator, found, what)
    open_ = coordinates.displaced(at.state[None, :], left_open(evaluator, found)[None, :])
    return [*again.states, *resting(evaluator, at.t, sums, at.holding).states, *open_, *far], bends


def left_open(evaluator: Evaluator, found: FoundPose) -> Array:
    """A displacement (n,) across the closures, each open by what closing leaves, so that it is largest somewhere."""
    across = found.slopes.law.across
    if not across.size:
        return np.zeros(len(across))
    size = found.coordinates.weights * np.abs(across).sum(axis=1)
    return np.asarray(tolerances.CLOSED * evaluator.size * (across @ np.sign(across[int(np.argmax(size))])))


def rounding_of_sums(found: FoundPose) -> Array:
    """How far each direction gives way to what rounding leaves of its accelerations' sums, all together, (n,)."""
    own = found.slopes
    push = THRICE * tolerances.PLACE_ROUNDING / tolerances.SUM_ROUNDING * own.summed
    give = np.abs(own.directions.softened(push, own.known))
    way = np.asarray((own.T @ (own.V @ give)).real)
    return way / max(1.0, found.coordinates.size(way))  # a radian, or the size: nothing is known beyond that


def bent(evaluator: Evaluator, found: FoundPose, what: Indifference) -> tuple[list[Array], Mask]:
    """The farthest poses along motions without stiffness at which nothing pushes, where it does farther out.

    And in which motions (g,) it does: by more than in scenes that rounding does not tell from this one.
    """
    states, shapes = [], what.free
    bends = np.zeros(shapes.shape[1], dtype=bool)
    others = [Runner(rounded_scene(evaluator.layout, number)) for number in range(SCENES)] if len(bends) else []
    for k, shape in enumerate(shapes.T):
        size = found.coordinates.size(shape)
        for sign in (1.0, -1.0) if size > 0.0 else ():
            out, a = beyond(evaluator, found, sign * REACHES[:, None] * shape / size)
            pushes = [along(found, shapes, b) for b in (a, *(accelerations(other, found, out) for other in others))]
            unsure = tolerances.HELD * np.abs(np.array(pushes[1:]) - pushes[0]).max(axis=0)
            # a push along what is held shows in them by as much as the motion has turned there
            turned = LEVERS * REACHES[:, None] * (np.abs(a) @ np.abs(found.slopes.law.mass) @ np.abs(shapes))
            seen = np.flatnonzero((np.abs(pushes[0]) > unsure + turned).any(axis=1))
            if len(seen):
                states.append(out[max(seen[0] - 1, 0)])
                bends[k] = True
    return states, bends


def along(found: FoundPose, shapes: Array, accelerations: Array) -> Array:
    """What accelerations (k, n) push along motions (n, g), (k, g)."""
    return np.asarray(accelerations @ found.slopes.law.mass @ shapes)


def accelerations(evaluator: Evaluator, found: FoundPose, states: Array) -> Array:
    """Those of states at rest, (k, n)."""
    return found.coordinates.accelerations(resting(evaluator, found.pose.t, states, found.pose.holding))


def beyond(evaluator: Evaluator, found: FoundPose, way: Array) -> tuple[Array, Array]:
    """States displaced by ways (k, n) at which all that is held rests, and the accelerations there, (k, n)."""
    at, own, coordinates = found.pose, found.slopes, found.coordinates
    states = coordinates.displaced(np.repeat(at.state[None, :], len(way), axis=0), way)
    for _ in range(BACK):
        there = resting(evaluator, at.t, states, at.holding)
        states = coordinates.displaced(
            there.states, np.array([own.newton(a) for a in coordinates.accelerations(there)])
        )
    there = resting(evaluator, at.t, states, at.holding)
    return there.states, coordinates.accelerations(there)
