"""The poses of the bodies of a run at given instants, and the positions of their points in the world."""

from __future__ import annotations

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.mechanism.model import Assembly, Mechanism
from heuncli.results.results import Array, Results
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import GROUND
from heuncli.study.queries.study import Study

MOTION = frozenset({"motion"})
Y, Z = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])


class Poses(NamedTuple):
    """The poses of all bodies, by name.

    positions: of the origins, (n, 3)
    orientations: rotation matrices (n, 3, 3), whose columns are the body axes
    quaternions: the same as unit quaternions w, x, y, z, (n, 4); empty for a scene that is only assembled
    """

    times: Array
    positions: dict[str, Array]
    orientations: dict[str, Array]
    quaternions: dict[str, Array]

    @property
    def first(self) -> Poses:
        """The poses at the first instant only."""
        parts = (
            {name: values[:1] for name, values in part.items()}
            for part in (self.positions, self.orientations, self.quaternions)
        )
        return Poses(self.times[:1], *parts)

    def locate_points(self, body: str, points: Array, k: int) -> Array:
        """Compute the positions of points (..., 3) of a body in the world at instant number k."""
        if body == GROUND:
            return np.asarray(points, dtype=np.float64)
        return np.asarray(points @ self.orientations[body][k].T + self.positions[body][k])

    def trace_point(self, body: str, point: Array) -> Array:
        """Compute the positions of a point (3,) of a body in the world at all instants, (n, 3)."""
        if body == GROUND:
            return np.broadcast_to(np.asarray(point, dtype=np.float64), (len(self.times), 3))
        return np.asarray(self.orientations[body] @ point + self.positions[body])

    def trace_direction(self, body: str, axis: Array) -> Array:
        """Turn a direction (3,) from body axes to world axes at all instants, (n, 3)."""
        if body == GROUND:
            return np.broadcast_to(np.asarray(axis, dtype=np.float64), (len(self.times), 3))
        return np.asarray(self.orientations[body] @ axis)


def compute_poses(study: Study, times: Array) -> Poses:
    """Compute the poses at instants of the run, (n,) ascending."""
    return extract_poses(study.results if study.has_one_instant else study.compute_reports(times, MOTION))


def extract_poses(results: Results) -> Poses:
    """Extract the poses from results that include the motion."""
    positions = {name: body["position"] for name, body in results.bodies.items()}
    orientations = {name: body["rotation"] for name, body in results.bodies.items()}
    return Poses(
        results.time, positions, orientations, {name: body["quaternion"] for name, body in results.bodies.items()}
    )


def find_up_direction(spec: Spec, poses: Poses) -> Array:
    """Find the unit vector (3,) that points up: against gravity; without gravity, y if all bodies turn only about z,
    else z.
    """
    gravity = np.array(spec.gravity, dtype=np.float64)
    if gravity.any():
        return np.asarray(-gravity / np.linalg.norm(gravity))
    return Y if all(np.allclose(axes[:, :, 2], Z) for axes in poses.orientations.values()) else Z


def make_start_poses(mechanism: Mechanism, start: Assembly, t: float) -> Poses:
    """Make the poses in which a scene is assembled."""
    names = [body.name for body in mechanism.bodies]
    positions, orientations = (
        dict(zip(names, values[:, None], strict=True)) for values in (start.position, start.rotation)
    )
    return Poses(np.array([t]), positions, orientations, {})


def find_drawn_pose(spec: Spec, body: str) -> tuple[Array, Array]:
    """Find the pose in which a body is drawn: axes (3, 3) and origin (3,); those of the ground if the spec gives
    none.
    """
    if body not in spec.bodies:
        return np.eye(3), np.zeros(3)
    spec_body = spec.bodies[body]
    R = spec_body.near_rotation if spec_body.rotation is None else spec_body.rotation
    r = spec_body.near_position if spec_body.position is None else spec_body.position
    return np.eye(3) if R is None else np.array(R).reshape(3, 3), np.zeros(3) if r is None else np.array(r)
