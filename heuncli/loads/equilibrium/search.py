"""The rest pose that a heavily damped motion from the start comes to.

    dq/ds = a(q, rates 0)
is that motion: damped in proportion to its mass a scene goes as slowly as one likes along the accelerations it would
have at rest. A step follows the linear law about its pose exactly (slopes.py), stiff directions to their end and soft
ones as far as s goes, with what that law leaves out to third order (way.py); it counts if that is little of it, else a
shorter one does. Where all directions are near their end s grows without bound, and the step is Newton's. An unstable
direction that nothing pushes is left alone, as that motion leaves it alone. Contacts close where their gap closes, open
where they would pull. How far a search can be trusted a finer one tells (finer.py).
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record, replace
from heuncli.loads.equilibrium.coordinates import Coordinates, coordinates_of
from heuncli.loads.equilibrium.geared import tied
from heuncli.loads.equilibrium.pose import Pose, bearing, carried, dependent, opening, pose_at
from heuncli.loads.equilibrium.reasons import endless, jumps, run_away, singular
from heuncli.loads.equilibrium.slopes import SAMPLES, Slopes, decided_by, slopes
from heuncli.loads.equilibrium.way import Way, straight
from heuncli.loads.kinetostatics.bodies import body_states
from heuncli.loads.kinetostatics.coordinates import coordinates as joint_coordinates
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.linearisation.indifference import indifference
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array

MOST_STEPS = 2_000
FASTER, SLOWER = 10.0, 0.2  # by how much s grows or shrinks from step to step at most
SHORTER = 0.5
MOST_TRIES = 60  # of one step
CLOSINGS = 8  # of a displaced pose: each misses by a tenth of the one before, or the step is too long
HALVINGS = 60  # of a step, to find where in it a contact closes or opens
LOOKED_AT = (0.25, 0.5, 0.75, 1.0)  # where in a step contacts are looked at


@record
class FoundPose:
    """A rest pose, with the linear law about it, and what it took.

    doubt: how far the way may have gone astray [rad, or of the size]; turn: where on it that began to grow.
    """

    pose: Pose
    slopes: Slopes
    coordinates: Coordinates
    steps: int
    evaluations: int
    doubt: float
    turn: Slowest


@record
class Slowest:
    """Where a way is slowest before it may go astray: its state (n_state,), and how far off that may be, (n,)."""

    state: Array
    astray: Array
    push: float


class RestSearch:
    """A search under way. Changes with every step."""

    def __init__(
        self, scene: PreparedScene, evaluator: Evaluator, t: float, off: float, start: Array | None = None
    ) -> None:
        """off: of a step, what the linear law may leave out; start (n_state,): in place of the layout's."""
        self.scene, self.evaluator, self.t, self.off = scene, evaluator, t, off
        self.coordinates = coordinates_of(evaluator.layout)
        self.tied = tied(evaluator.layout, self.coordinates.freedoms, self.coordinates.numbers)
        self.start = evaluator.layout.y0 if start is None else start
        self.astray = np.zeros(self.coordinates.count)
        self.turn = Slowest(self.start, self.astray, np.inf)
        self.doubt = self.late = 0.0
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
                pose, own = self.polished(at, own)
                taken = self.steps, self.evaluations
                return FoundPose(pose, own, self.coordinates, *taken, self.doubt, self.turn)
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
        beyond = self.tied.least(far / limit)
        if (beyond > 1.0).any():
            raise SolveError(run_away(self.coordinates, self.passed, beyond))
        if self.steps >= MOST_STEPS * np.sqrt(tolerances.REST_BENT / self.off):
            raise SolveError(self.lost_rank(at) or endless(self.coordinates, at, self.steps))

    def advanced(self, at: Pose, own: Slopes) -> Pose:
        """One step further."""
        if self.h == 0.0:
            first = self.coordinates.size(own.T @ (own.V @ own.left).real)
            self.h = tolerances.REST_FIRST / first if first > 0.0 else 1.0
        for _ in range(MOST_TRIES):
            way = straight(own, self.h)
            by = way.by(self.h)
            if not np.isfinite(by).all():
                self.h *= SHORTER
                continue
            size = self.coordinates.size(by)
            way, new = self.corrected(at, way, by)
            off = self.coordinates.size(way.correction(self.h)) if new is not None else np.inf
            most = tolerances.REST_STRAIGHT if size > tolerances.REST_FARTHEST else self.off
            if off > most * size or new is None:
                shorter = np.sqrt(self.off * size / off) if np.isfinite(off) else SHORTER
                self.h *= float(np.clip(0.9 * shorter, SLOWER, 0.9))
                continue
            return self.accepted(at, way, new, off / size if size > 0.0 else 0.0)
        raise SolveError(self.lost_rank(at) or endless(self.coordinates, at, self.steps))

    def corrected(self, at: Pose, way: Way, by: Array) -> tuple[Way, Pose | None]:
        """The way with what the law leaves out at its end, and the pose there; none where it cannot be closed."""
        straight_on = self.closed(at, way, by)
        if straight_on is None:
            return way, None
        went = self.coordinates.between(at.state, straight_on.state)
        way = way.bent(self.coordinates.followed(went, straight_on.accelerations), went, at.accelerations)
        more = way.correction(self.h)
        if not np.isfinite(more).all():
            return way, None
        return way, self.closed(at, way, by + more) if more.any() else straight_on

    def closed(self, at: Pose, way: Way, by: Array) -> Pose | None:
        """The pose displaced, along what closures admit by just that; none where they close on another branch.

        Closing leads across the tangent T, and a bit along it: that is taken back.
        """
        own, trial, size = way.own, by, self.coordinates.size(by)
        rounding = tolerances.PUSHED_BY_ROUNDING * tolerances.START_ROUNDING
        for _ in range(CLOSINGS):
            new = self.moved(at, trial)
            if new is None:
                return None
            went = self.coordinates.between(at.state, new.state)
            if self.coordinates.size(went - by) > np.sqrt(self.off) * size + rounding:
                return None
            missed = own.T @ (own.back @ (by - went))
            if self.coordinates.size(missed) <= tolerances.REST_MISSED * self.off * size + rounding:
                return new
            trial = trial + missed
        return None

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

    def accepted(self, at: Pose, way: Way, new: Pose, off: float) -> Pose:
        """The pose behind a step, or that within it at which the first contact closes or opens; s for the next one."""
        self.go_astray(at, way, off)
        event = self.where_contacts_change(at, way) if self.evaluator.layout.contacts else None
        if event is None:
            self.h *= float(np.clip(0.9 * np.sqrt(self.off / max(off, 1e-9)), SLOWER, FASTER))
        else:
            new = event
        self.passed = self.passed + self.coordinates.between(at.state, new.state)
        if not self.evaluator.layout.contacts:
            return self.counted(at, new)
        return self.counted(at, bearing(self.evaluator, self.coordinates, self.t, new.state))

    def go_astray(self, at: Pose, way: Way, off: float) -> None:
        """Follow how far the way is off: by what each step adds, and by what the linear law makes of it from then on.

        A step is off by about sqrt(off) of its correction, the next order. What is off along the way itself comes to
        the same pose, sooner or later; but a way that leaves a ridge may have left it for the other side.
        """
        own, push = way.own, self.push(at)
        if self.doubt <= tolerances.REST_DOUBT and push <= self.turn.push:
            self.turn = Slowest(at.state, self.astray, push)
        grown = own.directions.led(way.h, own.inverse @ (own.A @ (own.back @ self.astray)))
        astray = self.astray + own.by_directions(grown) + np.sqrt(off) * way.correction(way.h)
        if not np.isfinite(astray).all():
            self.doubt = float(np.fmax(self.doubt, self.coordinates.size(astray)))
            return
        weights = self.coordinates.weights
        along, grows = at.accelerations * weights, own.T @ (own.A @ (own.back @ at.accelerations)) * weights
        later = float((astray * weights) @ along / (along @ along))
        # what is off along a way that grows as e^(m s) is so by m * later of how far it came from a pose of rest
        self.late += abs(later) * max(0.0, float(grows @ along / (along @ along)))
        self.astray = astray - later * at.accelerations
        self.doubt = float(np.fmax(self.doubt, max(self.late, self.coordinates.size(self.astray))))

    def where_contacts_change(self, at: Pose, way: Way) -> Pose | None:
        """The pose at which the first contact closes or opens on a way; None where none does. Halving."""
        low = high = 0.0
        for share in LOOKED_AT:
            pose = self.closed(at, way, way.by(share * way.h))
            if pose is None or self.is_broken(at, pose):
                high = share * way.h
                break
            low = share * way.h
        if high == 0.0:
            return None
        new = None
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            pose = self.closed(at, way, way.by(middle))
            if pose is None or self.is_broken(at, pose):
                high, new = middle, pose or new
            else:
                low = middle
        return new

    def is_broken(self, at: Pose, pose: Pose) -> bool:
        """Whether on the way from one pose to another a contact was passed, or would have to pull."""
        for contact, held in zip(self.evaluator.layout.contacts, at.holding, strict=False):  # latches' places behind
            if held > 0.0 and carried(contact, pose) < min(0.0, carried(contact, at)):
                return True
            if not held > 0.0 and opening(contact, pose) < min(0.0, opening(contact, at)) - self.near:
                return True
        return False

    @property
    def near(self) -> float:
        """A gap as good as none [m or rad]."""
        return tolerances.OPEN_GAP * max(self.evaluator.size, 1.0)

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
            state[place] = told[(own := layout.mechanism.joints[joint]).name][
                "angle" if own.path is None else "travel"
            ][0]
        return replace(new, state=state, recovered=replace(recovered, states=state[None, :]))

    def polished(self, at: Pose, own: Slopes) -> tuple[Pose, Slopes]:
        """The pose behind Newton's steps along all directions that are not indifferent, as long as they better it."""
        own = self.decided(at, own)
        while own.decided.any():
            by = own.newton(at.accelerations)
            new = self.moved(at, by)
            if new is None or self.coordinates.size(own.newton(new.accelerations)) >= 0.5 * self.coordinates.size(by):
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
