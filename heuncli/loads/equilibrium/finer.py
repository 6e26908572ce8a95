"""A rest pose whose search is checked as a motion is: a ten times finer one has to end there, else a finer one still.

Where nothing is indifferent both end in the same pose to its digits, or elsewhere. What nothing holds is where the way
left it: there two are apart by the error of the coarser one, which bounds that of the finer. By accident both may err
alike (in one scene of some thousands): so a third is made there, and a tenth of how far the first two are apart counts,
too. Two searches that go on to different poses pass a ridge between them. Where the finest ones still do, the way
depends on less than they tell.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import SolveError
from heuncli.base.records import record
from heuncli.loads.equilibrium.coordinates import resting
from heuncli.loads.equilibrium.search import FoundPose, RestSearch
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array

ACROSS = 10.0 ** np.arange(-7.0, -1.0)  # rad, or of the size: so far beside a way one looks for another
SEARCHES = 4  # each ten times finer than the one before
FEWEST_OF_THE_LOOSE = 2  # finer ones than the first, where something is indifferent


@record
class CheckedPose:
    """What the finest search found; way (n,): to where the one before ended; elsewhere: another pose to which the start
    may lead as well; steps and evaluations of all."""

    found: FoundPose
    way: Array
    elsewhere: FoundPose | None
    steps: int
    evaluations: int


def checked(scene: PreparedScene, evaluator: Evaluator, t: float) -> CheckedPose:
    """The rest pose that the start leads to. Raises SolveError [no-rest-pose]."""
    all_found: list[FoundPose] = []
    ways: list[Array] = []
    for number in range(SEARCHES):
        off = tolerances.REST_BENT * tolerances.REST_FINER**number
        new = RestSearch(scene, evaluator, t, off).found()
        all_found.append(new)
        if new.steps == 0:
            return told(all_found, np.zeros(new.coordinates.count), None)
        if number == 0:
            continue
        ways.append(new.coordinates.between(new.pose.state, all_found[-2].pose.state))
        held, loose = parts(new, ways[-1])
        same, apart = is_same(new, held, loose), new.coordinates.size(loose)
        enough = number >= FEWEST_OF_THE_LOOSE or not has_loose(new)
        if same and enough and is_certain(new) and apart <= tolerances.REST_WAY:
            break
    other = None if same else all_found[-2]
    if other is None and not is_certain(new):
        other = beyond_the_ridge(scene, evaluator, t, new)
    return told(all_found, error_of(new, ways) if same else np.zeros(len(ways[-1])), other)


def error_of(last: FoundPose, ways: list[Array]) -> Array:
    """How far the last search may be off, (n,): the way to the one before, or a share of the way before that one."""
    shares = [way * tolerances.REST_FINER**back for back, way in enumerate(reversed(ways[-2:]))]
    return max(shares, key=last.coordinates.size)


def left_by_the_way(evaluator: Evaluator, found: FoundPose, way: Array) -> tuple[Array, ...]:
    """The states displaced by a way (n,) to another search's pose, either way, with what is held at rest there."""
    if not way.any():
        return ()
    at, coordinates = found.pose, found.coordinates
    states = coordinates.displaced(np.repeat(at.state[None, :], 2, axis=0), np.array([way, -way]))
    there = resting(evaluator, at.t, states, at.holding)
    back = np.array([found.slopes.newton(a) for a in coordinates.accelerations(there)])
    return tuple(resting(evaluator, at.t, coordinates.displaced(there.states, back), at.holding).states)


def is_certain(found: FoundPose) -> bool:
    """Whether the way has kept away from ridges by more than it is off; what is told unstable stands on one."""
    values, known = found.slopes.eigenvalues, found.slopes.known
    return bool(found.doubt <= tolerances.REST_DOUBT or (values.real > known).any())


def beyond_the_ridge(scene: PreparedScene, evaluator: Evaluator, t: float, found: FoundPose) -> FoundPose | None:
    """Where a way goes on that is beside the one found where that is slowest; None: to the same pose."""
    astray, size = found.turn.astray, found.coordinates.size(found.turn.astray)
    for far in ACROSS if size > 0.0 else ():
        for sign in (1.0, -1.0):
            start = found.coordinates.displaced(found.turn.state[None, :], sign * far / size * astray[None, :])[0]
            try:
                other = RestSearch(scene, evaluator, t, tolerances.REST_BENT, start).found()
            except SolveError:
                continue
            way = found.coordinates.between(found.pose.state, other.pose.state)
            if not is_same(found, *parts(found, way)):
                return other
    return None


def told(all_found: list[FoundPose], way: Array, elsewhere: FoundPose | None) -> CheckedPose:
    """What the last search found, and what all took."""
    steps, evaluations = sum(found.steps for found in all_found), sum(found.evaluations for found in all_found)
    return CheckedPose(all_found[-1], way, elsewhere, steps, evaluations)


def parts(found: FoundPose, way: Array) -> tuple[Array, Array]:
    """Of a displacement (n,) from a rest pose, what leads along all that is held, and along what is indifferent.

    Spins without inertia are neither.
    """
    own = found.slopes
    z, idle = own.inverse @ (own.back @ way), np.isinf(own.known)
    loose, spun = ((own.T @ (own.V @ np.where(which, z, 0.0))).real for which in (~own.decided & ~idle, idle))
    return way - loose - spun, loose


def has_loose(found: FoundPose) -> bool:
    """Whether something is indifferent, spins without inertia aside."""
    return bool((~found.slopes.decided & ~np.isinf(found.slopes.known)).any())


def is_same(found: FoundPose, held: Array, loose: Array) -> bool:
    """Whether two searches ended in one pose, or along what is indifferent beside each other."""
    own, size = found.slopes, found.coordinates.size
    give = np.abs(own.directions.softened(own.noise, own.known))
    soft = size(np.abs(own.T) @ (np.abs(own.V) @ give))
    near = size(loose)
    # poses beside each other along what nothing holds are as far apart along the rest as that bends, or less
    return size(held) <= max(tolerances.REST_SAME, soft, near) and near <= tolerances.REST_BESIDE
