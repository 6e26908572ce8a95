"""The rest pose that a heavily damped motion from the start comes to.

    dq/ds = a(q, rates 0)
is that motion: damped in proportion to its mass a scene goes as slowly as one likes along the accelerations it would
have at rest. A step follows the linear law about its pose exactly (slopes.py), stiff directions to their end and soft
ones as far as s goes; it counts if the accelerations behind it are those of that law, else a shorter one does. Where
all directions are near their end s grows without bound, and the step is Newton's. An unstable direction that nothing
pushes is left alone, as that motion leaves it alone. Contacts close where their gap closes, open where they would pull.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from heuncli import tolerances
from heuncli.errors import Problem, SolveError
from heuncli.integration.evaluator import Evaluator
from heuncli.kinetostatics.bodies import body_states
from heuncli.kinetostatics.coordinates import coordinates as joint_coordinates
from heuncli.linearisation.indifference import indifference
from heuncli.records import record, replace
from heuncli.rest.coordinates import Coordinates, coordinates_of
from heuncli.rest.pose import Pose, bearing, dependent, opening, pose_at
from heuncli.rest.reasons import endless, jumps, run_away, singular
from heuncli.rest.slopes import SAMPLES, Slopes, decided_by, slopes
from heuncli.results import Array
from heuncli.tree.prepare import PreparedScene

MOST_STEPS = 2_000
FASTER, SLOWER = 10.0, 0.2  # by how much s grows or shrinks from step to step at most
SHORTER = 0.5
MOST_TRIES = 60  # of one step
CLOSING = 60  # steps of the search for where a contact closes


@record
class FoundPose:
    """A rest pose, with the linear law about it; what it took."""

    pose: Pose
    slopes: Slopes
    coordinates: Coordinates
    steps: int
    evaluations: int


class RestSearch:
    """A search under way. Changes with every step."""

    def __init__(self, scene: PreparedScene, evaluator: Evaluator, t: float) -> None:
        self.scene, self.evaluator, self.t = scene, evaluator, t
        self.coordinates = coordinates_of(evaluator.layout)
        self.start = evaluator.layout.y0
        self.passed = np.zeros(self.coordinates.count)
        self.steps = self.evaluations = 0
        self.h = self.most = 0.0

    def found(self) -> FoundPose:
        """The rest pose. Raises SolveError [no-rest-pose]."""
        at = self.begun()
        while True:
            own = slopes(self.evaluator, self.coordinates, at)
            self.evaluations += 3 + SAMPLES
            if not own.left.any():
                self.require_held(at, own)
                return FoundPose(*self.polished(at, own), self.coordinates, self.steps, self.evaluations)
            self.check(at, own)
            at = self.advanced(at, own)
            self.steps += 1

    def begun(self) -> Pose:
        """The start, at rest."""
        return bearing(self.evaluator, self.coordinates, self.t, self.start)

    def require_held(self, at: Pose, own: Slopes) -> None:
        """Raise SolveError [no-rest-pose] where what is left is no rounding of what acts: a load jumps just there."""
        terms = own.summed / tolerances.SUM_ROUNDING
        self.most = max(self.most, float(terms.max(initial=0.0)))
        left = np.where(np.abs(own.c) > tolerances.NOT_HELD**2 * self.most, np.abs(own.c), 0.0)
        most = tolerances.NOT_HELD * terms + own.rough
        driven = np.where((left > most) & (own.bent > 0.5 * left), left, 0.0)
        if driven.any():
            shape = (own.T @ own.V[:, int(np.argmax(driven))]).real
            raise SolveError(self.lost_rank(at) or jumps(self.coordinates, at, shape))

    def check(self, at: Pose, own: Slopes) -> None:
        """Raise what ends a search: something runs away, the steps are used up."""
        self.most = max(self.most, float(own.summed.max(initial=0.0)) / tolerances.SUM_ROUNDING)
        far = np.abs(self.passed) * self.coordinates.weights
        limit = np.where(self.coordinates.shifts, tolerances.RUN_AWAY, tolerances.TURNS_ON)
        if (far > limit).any():
            raise SolveError(run_away(self.coordinates, self.passed, far / limit))
        if self.steps >= MOST_STEPS:
            raise SolveError(self.lost_rank(at) or endless(self.coordinates, at, self.steps))

    def advanced(self, at: Pose, own: Slopes) -> Pose:
        """One step further."""
        if self.h == 0.0:
            first = self.coordinates.size(own.T @ (own.V @ own.left).real)
            self.h = tolerances.REST_FIRST / first if first > 0.0 else 1.0
        for _ in range(MOST_TRIES):
            by = own.way(self.h)
            if not np.isfinite(by).all():
                self.h *= SHORTER
                continue
            size = self.coordinates.size(by)
            new = self.moved(at, by)
            off = self.bent(at, own, by, new) if new is not None else np.inf
            far = size > tolerances.REST_FARTHEST
            if off > (tolerances.REST_STRAIGHT if far else tolerances.REST_BENT) * size or new is None:
                shorter = np.sqrt(tolerances.REST_BENT * size / off) if np.isfinite(off) else SHORTER
                self.h *= float(np.clip(0.9 * shorter, SLOWER, 0.9))
                continue
            return self.accepted(at, own, by, new, off / size if size > 0.0 else 0.0)
        raise SolveError(self.lost_rank(at) or endless(self.coordinates, at, self.steps))

    def lost_rank(self, at: Pose) -> Problem | None:
        """The problem of a singular pose, if it is one to which the search came: the start was none."""
        if dependent(at) <= dependent(self.begun()):
            return None
        return singular(self.coordinates, at)

    def moved(self, at: Pose, by: Array) -> Pose | None:
        """The pose displaced, with the same contacts; None where it cannot be closed."""
        state = self.coordinates.displaced(at.state[None, :], by[None, :])[0]
        new = pose_at(self.evaluator, self.coordinates, self.t, state, at.holding)
        self.evaluations += 1
        closed = new.recovered.gap[0] <= tolerances.OPEN_GAP * self.evaluator.size
        return new if new.is_sound and closed else None

    def bent(self, at: Pose, own: Slopes, by: Array, new: Pose) -> float:
        """How far a step is off by what the linear law leaves out of the accelerations behind it."""
        law = at.accelerations + own.T @ (own.A @ (own.back @ by))
        c = own.along(new.accelerations - law)
        # what unstable directions make of it over the whole step is theirs in any case
        return 0.5 * self.coordinates.size(own.way(self.h, c))

    def accepted(self, at: Pose, own: Slopes, by: Array, new: Pose, off: float) -> Pose:
        """The pose behind a step, or that within it at which the first contact closes; s for the next one."""
        closes = self.closes(at, new)
        if closes is not None:
            new, by = self.where_it_closes(at, own, closes)
        else:
            self.h *= float(np.clip(0.9 * np.sqrt(tolerances.REST_BENT / max(off, 1e-9)), SLOWER, FASTER))
        self.passed = self.passed + by
        if not self.evaluator.layout.contacts:
            return self.counted(at, new)
        return self.counted(at, bearing(self.evaluator, self.coordinates, self.t, new.state))

    def closes(self, at: Pose, new: Pose) -> Callable[[Pose], float] | None:
        """How far the contact is open, by the pose, that closes farthest in a step; None where none closes."""
        open_ = [c for c, held in zip(self.evaluator.layout.contacts, at.holding, strict=True) if not held]
        beyond = [(opening(c, new), c) for c in open_ if opening(c, new) < min(0.0, opening(c, at)) - self.near]
        if not beyond:
            return None
        return lambda pose: min(opening(c, pose) for _, c in beyond)

    @property
    def near(self) -> float:
        """A gap as good as none [m or rad]."""
        return tolerances.OPEN_GAP * max(self.evaluator.size, 1.0)

    def where_it_closes(self, at: Pose, own: Slopes, gap: Callable[[Pose], float]) -> tuple[Pose, Array]:
        """The pose within a step, up to s = h, at which a gap closes; bisection."""
        low, high = 0.0, self.h
        new, by = at, np.zeros(self.coordinates.count)
        for _ in range(CLOSING):
            middle = 0.5 * (low + high)
            way = own.way(middle)
            pose = self.moved(at, way)
            if pose is None:
                high = middle
                continue
            low, high = (middle, high) if gap(pose) > 0.0 else (low, middle)
            new, by = pose, way
            if abs(gap(pose)) <= self.near:
                break
        return new, by

    def counted(self, before: Pose, new: Pose) -> Pose:
        """The new pose with the angles of cut pins counted on from where they stood before, over half turns."""
        layout = self.evaluator.layout
        if not layout.counters:
            return new
        state = new.state.copy()
        for place in layout.counters.values():
            state[place] = before.state[place]
        recovered = replace(new.recovered, states=state[None, :])
        told = joint_coordinates(layout, recovered, body_states(layout, recovered))
        for joint, place in layout.counters.items():
            state[place] = told[layout.mechanism.joints[joint].name]["angle"][0]
        return replace(new, state=state, recovered=replace(recovered, states=state[None, :]))

    def polished(self, at: Pose, own: Slopes) -> tuple[Pose, Slopes]:
        """The pose behind Newton's steps along all directions that are not indifferent, as long as they better it."""
        own = self.decided(at, own)
        while own.decided.any():
            by = own.newton(at.accelerations)
            new = self.moved(at, by)
            if new is None or self.push(new) >= 0.5 * self.push(at):
                break
            at = self.counted(at, new)
            own = self.decided(at, slopes(self.evaluator, self.coordinates, at))
            self.evaluations += 3 + SAMPLES
            if self.coordinates.size(by) <= tolerances.PLACE_ROUNDING:
                break  # a force that bends alone leads on through all the numbers below
        return at, own

    def decided(self, at: Pose, own: Slopes) -> Slopes:
        """The slopes at a pose, by what is held there by more than rounding."""
        return decided_by(own, indifference(self.scene, self.t, at.holding, own.law, rests=False))

    def push(self, at: Pose) -> float:
        """The largest acceleration left [rad/s^2, or sizes a s^2]."""
        return self.coordinates.size(at.accelerations)
