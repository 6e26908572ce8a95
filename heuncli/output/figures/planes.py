"""The plane in which vectors of a run are drawn: that of a planar scene, else the one normal to an axis at rest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.figures.courses import NotDrawable
from heuncli.output.machine_geometry.poses import Poses, compute_poses
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import GROUND
from heuncli.study.queries.study import Study

AXIS_LETTERS = ("x", "y", "z")
JOINT_BLOCKS = ("joints", "coordinates")


class Plane(NamedTuple):
    """A plane: its directions (3,) to the right and upwards, its normal, and the names of the two directions."""

    right: Array
    upward: Array
    normal: Array
    names: tuple[str, str]

    @property
    def key(self) -> tuple[float, ...]:
        """The key by which equal planes are found."""
        return tuple(np.round(np.concatenate([self.right, self.upward]), 9).tolist())

    def project(self, vectors: Array) -> tuple[Array, Array]:
        """Return the components of vectors (..., 3) to the right and upwards; an open normal component leaves them
        known.
        """
        return project_vectors(vectors, self.right), project_vectors(vectors, self.upward)


def project_vectors(vectors: Array, direction: Array) -> Array:
    """Return the components of vectors (..., 3) along a direction (3,), ignoring components in which the direction is
    0.
    """
    return np.asarray(np.where(direction != 0.0, vectors * direction, 0.0).sum(axis=-1))


def make_axis_plane(letter: str) -> Plane:
    """Return the plane normal to a world axis; the first of the two other axes points to the right."""
    k = AXIS_LETTERS.index(letter)
    i, j = (m for m in range(3) if m != k)
    e = np.eye(3)
    return Plane(e[i], e[j], e[k], (AXIS_LETTERS[i], AXIS_LETTERS[j]))


def make_normal_plane(axis: Array) -> Plane:
    """Return the plane normal to a unit direction: with world axes if it is one, else with its level and steepest
    directions.
    """
    k = int(np.argmax(np.abs(axis)))
    if 1.0 - abs(axis[k]) <= tolerances.PARALLEL:
        return make_axis_plane(AXIS_LETTERS[k])
    base = make_axis_plane(AXIS_LETTERS[k])
    right = base.right - (base.right @ axis) * axis
    right /= np.linalg.norm(right)
    normal = axis * np.sign(axis[k])
    upward = np.cross(normal, right)
    upward *= np.sign(upward @ base.upward) or 1.0
    return Plane(right, upward, normal, ("1", "2"))


def list_rotation_paths(paths: Sequence[str], spec: Spec) -> list[str]:
    """Return the paths of the rotations that determine the axes of the joints among some paths."""
    words = [path.split(".") for path in paths]
    joints = [spec.joints[word[1]] for word in words if word[0] in JOINT_BLOCKS and word[1] in spec.joints]
    bodies = dict.fromkeys(body for joint in joints for body in (joint.a, joint.b) if body != GROUND)
    return [f"bodies.{body}.rotation" for body in bodies]


def choose_plane(study: Study, path: str, vectors: Array, times: Array, axes: str, crank: str) -> Plane:
    """Choose the plane of a path's vectors (n, 3), which are in `axes` of its joint.

    crank: the path of the angle that turns

    Raises NotDrawable if no plane is known.
    """
    spec = study.spec
    if spec.space == "planar":
        return make_axis_plane("z")
    words = path.split(".")
    joint = words[1] if words[0] == "joints" and words[1] in spec.joints else ""
    axis = _find_steady_axis(study, joint, axes, times) if joint and _has_axis(spec, joint) else None
    if axis is not None:
        return make_normal_plane(axis)
    crank_joint = crank.split(".")[1] if crank and (axes == "world" or not joint) else ""
    axis = _find_steady_axis(study, crank_joint, "world", times) if crank_joint else None
    if axis is not None and _is_flat(vectors, axis):
        return make_normal_plane(axis)
    flat_letter = next(
        (letter for letter, e in zip(AXIS_LETTERS, np.eye(3), strict=True) if _is_flat(vectors, e)), None
    )
    if flat_letter is not None:
        return make_axis_plane(flat_letter)
    if axis is not None:
        return make_normal_plane(axis)
    message = f"polar {path}: it does not stay in a plane, and no fixed axis defines one"
    raise NotDrawable(message, "set the viewing axis: --view x, y or z")


def _has_axis(spec: Spec, name: str) -> bool:
    """Return whether a joint turns about an axis, or guides along one."""
    kind = JOINTS[spec.joints[name].kind]
    return "angle" in kind.coordinates or kind.hold.gap_type == "line"


def _find_steady_axis(study: Study, name: str, axes: str, times: Array) -> Array | None:
    """Return the axis of a joint in some axes, (3,); None if it moves in them."""
    joint = study.spec.joints[name]
    axis = np.array(joint.axis, dtype=np.float64)
    axis /= np.linalg.norm(axis)
    if axes == "from" or (joint.a == GROUND and axes != "to"):
        return axis
    poses = compute_poses(study, times)
    directions = _transform_axis(poses, joint.a, joint.b if axes == "to" else GROUND, axis)
    return directions[0] if np.abs(directions - directions[0]).max() <= tolerances.SAME_VALUE else None


def _transform_axis(poses: Poses, body: str, seen_from: str, axis: Array) -> Array:
    """Return a direction of a body in the axes of another one, (n, 3)."""
    n = len(poses.times)
    world = np.tile(axis, (n, 1)) if body == GROUND else poses.orientations[body] @ axis
    return world if seen_from == GROUND else np.einsum("tji,tj->ti", poses.orientations[seen_from], world)


def _is_flat(vectors: Array, axis: Array) -> bool:
    """Return whether vectors (n, 3) have no component along an axis."""
    largest = float(np.nanmax(np.abs(vectors), initial=0.0))
    return bool(np.nanmax(np.abs(project_vectors(vectors, axis)), initial=0.0) <= tolerances.IN_ONE_PLANE * largest)
