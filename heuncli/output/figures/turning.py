"""How a run turns: the angle that it turns in, and its last whole cycle where the motion comes back.

A cycle is one turn or two, as of four-stroke engines. Whether the motion comes back is seen by the cycle before, at the
same angles; a run that does not, or that has no more than one, is seen as a whole.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import GROUND
from heuncli.study.ask.curves import numbers_at
from heuncli.study.ask.study import Study

TURN = 2.0 * math.pi
LEAST = 0.25 * TURN  # what turns less is no crank
CLOSELY = 721  # instants of what is drawn
COMPARED = 128  # angles of a cycle at which it is held against the one before
ALMOST = 1e-6  # of a turn: a run that was to end with it


class TurnedVectors(NamedTuple):
    """What is looked at: at some instants (n,) vectors (n, k, 3), and the errors of these (k,)."""

    at: Callable[[Array], Array]
    errors: Array


class TurningRun(NamedTuple):
    """The instants of a run that are seen, its angle if it turns on in one, and how many turns come back (0: none)."""

    times: Array
    path: str
    angles: Array
    turns: int

    @property
    def way(self) -> float:
        """1 where the angle rises, -1 where it falls."""
        return 1.0 if self.angles[-1] > self.angles[0] else -1.0

    @property
    def counted(self) -> Array:
        """The angles in degrees, of a cycle that comes back counted from its own zero."""
        found = np.degrees(self.angles)
        if self.turns:
            whole = 360.0 * self.turns
            found = found - whole * math.floor(float(min(found[0], found[-1])) / whole + ALMOST)
        return np.asarray(found)

    @property
    def in_words(self) -> str:
        """What of the run is seen."""
        span = f"t = {self.times[0]:.6g} to {self.times[-1]:.6g} s"
        if not self.turns:
            return f"the whole run, {span}"
        return f"the last {'turn' if self.turns == 1 else 'two turns'} of {self.path}, {span}"


def angles_of(spec: Spec) -> list[str]:
    """The angles in which a scene may turn, as paths: driven ones, else those against the ground, else all."""
    turning = {name: joint for name, joint in spec.joints.items() if "angle" in JOINTS[joint.kind].coordinates}
    driven = [drive.joint for drive in spec.drives.values() if drive.joint in turning]
    grounded = [name for name, joint in turning.items() if GROUND in (joint.a, joint.b)]
    return [f"coordinates.{name}.angle" for name in dict.fromkeys(driven or grounded or turning)]


def turning_of(study: Study, times: Array, candidates: Sequence[str], vectors: TurnedVectors) -> TurningRun:
    """How a run turns that is seen at some instants (n,), in that of some angles that turns farthest."""
    whole, farthest = TurningRun(times, "", np.zeros(0), 0), LEAST
    for path in candidates:
        angles = numbers_at(study, path, times)
        if np.isfinite(angles).all() and goes_on(angles) and span(angles) > farthest:
            whole, farthest = TurningRun(times, path, angles, 0), span(angles)
    for turns in (1, 2):
        if whole.path and comes_back(study, whole, turns, vectors):
            return last_of(study, whole, turns)
    return whole


def goes_on(angles: Array) -> bool:
    """Whether angles rise or fall all the time."""
    steps = np.diff(angles)
    return bool((steps >= 0.0).all() or (steps <= 0.0).all())


def span(angles: Array) -> float:
    """From the first to the last."""
    return abs(float(angles[-1] - angles[0])) if len(angles) else 0.0


def comes_back(study: Study, whole: TurningRun, turns: int, vectors: TurnedVectors) -> bool:
    """Whether the last so many turns are as those before them."""
    angle = whole.way * TURN * turns
    if span(whole.angles) < 2.0 * abs(angle) - ALMOST * TURN:
        return False
    near = seen_from(study, whole, float(instants_at(whole, whole.angles[-1:] - 2.0 * angle)[0]))
    back = angle * np.linspace(1.0, 0.0, COMPARED)
    last, before = (vectors.at(instants_at(near, near.angles[-1] - back - k * angle)) for k in (0, 1))
    size, off = (np.nanmax(np.abs(own), axis=(0, 2), initial=0.0) for own in (last, last - before))
    return bool((off <= np.maximum(tolerances.COMES_ROUND * size, 2.0 * vectors.errors)).all())  # each by its own size


def last_of(study: Study, whole: TurningRun, turns: int) -> TurningRun:
    """The last so many turns of a run."""
    angle = whole.way * TURN * turns
    near = seen_from(study, whole, float(instants_at(whole, whole.angles[-1:] - 2.0 * angle)[0]))
    begin = float(instants_at(near, near.angles[-1:] - angle)[0])
    return seen_from(study, whole, begin)._replace(turns=turns)


def seen_from(study: Study, whole: TurningRun, begin: float) -> TurningRun:
    """A run from an instant on, looked at closely."""
    even = np.linspace(begin, whole.times[-1], CLOSELY)
    times = np.unique(np.concatenate([even, whole.times[whole.times > begin]]))
    return TurningRun(times, whole.path, numbers_at(study, whole.path, times), 0)


def instants_at(turning: TurningRun, angles: Array) -> Array:
    """The instants at which a run has some angles, on the line between those at which it was seen, (n,)."""
    order = slice(None, None, int(turning.way))
    return np.asarray(np.interp(angles, turning.angles[order], turning.times[order]))
