"""Where the bodies of a run stand at some instants, and where their points come to be."""

from __future__ import annotations

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.mechanism.model import Assembly, Mechanism
from heuncli.results.results import Array, Results
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import GROUND
from heuncli.study.ask.study import Study

MOTION = frozenset({"motion"})
Y, Z = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])


class Poses(NamedTuple):
    """Of each body the places of its origin (n, 3) and its attitudes (n, 3, 3), whose columns are its axes.

    turns: the attitudes as unit quaternions w, x, y, z, (n, 4); none of what is only assembled.
    """

    times: Array
    places: dict[str, Array]
    attitudes: dict[str, Array]
    turns: dict[str, Array]

    @property
    def first(self) -> Poses:
        """Those of the first instant alone."""
        kept = ({name: own[:1] for name, own in part.items()} for part in (self.places, self.attitudes, self.turns))
        return Poses(self.times[:1], *kept)

    def at(self, body: str, points: Array, k: int) -> Array:
        """Where points (..., 3) of a body stand in the world at the instant of a number."""
        if body == GROUND:
            return np.asarray(points, dtype=np.float64)
        return np.asarray(points @ self.attitudes[body][k].T + self.places[body][k])

    def ways(self, body: str, point: Array) -> Array:
        """Where a point (3,) of a body stands in the world at all instants, (n, 3)."""
        if body == GROUND:
            return np.broadcast_to(np.asarray(point, dtype=np.float64), (len(self.times), 3))
        return np.asarray(self.attitudes[body] @ point + self.places[body])

    def directions(self, body: str, axis: Array) -> Array:
        """A direction (3,) in a body's axes in the world at all instants, (n, 3)."""
        if body == GROUND:
            return np.broadcast_to(np.asarray(axis, dtype=np.float64), (len(self.times), 3))
        return np.asarray(self.attitudes[body] @ axis)


def poses_of(study: Study, times: Array) -> Poses:
    """The poses at instants of the run, (n,) ascending."""
    return poses_in(study.results if study.of_one_instant else study.reports_at(times, MOTION))


def poses_in(found: Results) -> Poses:
    """The poses that results with motions have."""
    places = {name: body["position"] for name, body in found.bodies.items()}
    attitudes = {name: body["rotation"] for name, body in found.bodies.items()}
    return Poses(found.time, places, attitudes, {name: body["quaternion"] for name, body in found.bodies.items()})


def up_of(spec: Spec, poses: Poses) -> Array:
    """The unit direction (3,) that is up: against gravity; without it y of what turns about z alone, else z."""
    gravity = np.array(spec.gravity, dtype=np.float64)
    if gravity.any():
        return np.asarray(-gravity / np.linalg.norm(gravity))
    return Y if all(np.allclose(axes[:, :, 2], Z) for axes in poses.attitudes.values()) else Z


def poses_at_start(mechanism: Mechanism, start: Assembly, t: float) -> Poses:
    """The poses in which a scene is assembled."""
    names = [body.name for body in mechanism.bodies]
    places, attitudes = (dict(zip(names, own[:, None], strict=True)) for own in (start.position, start.rotation))
    return Poses(np.array([t]), places, attitudes, {})
