"""The plane that vectors of a run are drawn in: that of a planar scene, else across an axis that stays where it is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.figures.refusals import NotDrawable
from heuncli.output.machine_geometry.poses import Poses, poses_of
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import GROUND
from heuncli.study.ask.study import Study

LETTERS = ("x", "y", "z")
OF_JOINTS = ("joints", "coordinates")


class Plane(NamedTuple):
    """Two directions (3,) in which vectors are drawn, to the right and up, and that across them; their names."""

    right: Array
    up: Array
    across: Array
    names: tuple[str, str]

    @property
    def key(self) -> tuple[float, ...]:
        """By which equal planes are known."""
        return tuple(np.round(np.concatenate([self.right, self.up]), 9).tolist())

    def project(self, vectors: Array) -> tuple[Array, Array]:
        """The parts of vectors (..., 3) to the right and up; what is open across the plane leaves them certain."""
        return component(vectors, self.right), component(vectors, self.up)


def component(vectors: Array, direction: Array) -> Array:
    """The components of vectors (..., 3) along a direction (3,), which hang on no component that it does not have."""
    return np.asarray(np.where(direction != 0.0, vectors * direction, 0.0).sum(axis=-1))


def plane_seen_along(letter: str) -> Plane:
    """The plane across a world axis: of the two others the first to the right."""
    k = LETTERS.index(letter)
    i, j = (m for m in range(3) if m != k)
    e = np.eye(3)
    return Plane(e[i], e[j], e[k], (LETTERS[i], LETTERS[j]))


def plane_across(axis: Array) -> Plane:
    """The plane across a unit direction: of the world's axes if it is one of these, else level and steepest in it."""
    k = int(np.argmax(np.abs(axis)))
    if 1.0 - abs(axis[k]) <= tolerances.PARALLEL:
        return plane_seen_along(LETTERS[k])
    base = plane_seen_along(LETTERS[k])
    right = base.right - (base.right @ axis) * axis
    right /= np.linalg.norm(right)
    across = axis * np.sign(axis[k])
    up = np.cross(across, right)
    up *= np.sign(up @ base.up) or 1.0
    return Plane(right, up, across, ("1", "2"))


def attitudes_for(paths: Sequence[str], spec: Spec) -> list[str]:
    """What of the results tells how the axes of the joints among some paths turn, as paths."""
    words = [path.split(".") for path in paths]
    joints = [spec.joints[word[1]] for word in words if word[0] in OF_JOINTS and word[1] in spec.joints]
    bodies = dict.fromkeys(body for joint in joints for body in (joint.a, joint.b) if body != GROUND)
    return [f"bodies.{body}.rotation" for body in bodies]


def plane_of(study: Study, path: str, vectors: Array, times: Array, axes: str, crank: str) -> Plane:
    """The plane of a path's vectors (n, 3), told in `axes` of its joint; crank: the path of the angle that turns.

    Raises NotDrawable where no plane is known.
    """
    spec = study.spec
    if spec.space == "planar":
        return plane_seen_along("z")
    words = path.split(".")
    joint = words[1] if words[0] == "joints" and words[1] in spec.joints else ""
    axis = _steady_axis(study, joint, axes, times) if joint and _is_turned_about(spec, joint) else None
    if axis is not None:
        return plane_across(axis)
    main = crank.split(".")[1] if crank and (axes == "world" or not joint) else ""
    axis = _steady_axis(study, main, "world", times) if main else None
    if axis is not None and _is_flat(vectors, axis):
        return plane_across(axis)
    flat = next((letter for letter, e in zip(LETTERS, np.eye(3), strict=True) if _is_flat(vectors, e)), None)
    if flat is not None:
        return plane_seen_along(flat)
    if axis is not None:
        return plane_across(axis)
    message = f"polar {path}: no plane holds it, and no axis that stays where it is tells one"
    raise NotDrawable(message, "name the world axis along which it is seen: --view x, y or z")


def _is_turned_about(spec: Spec, name: str) -> bool:
    """Whether a joint turns about an axis, or leads along one."""
    kind = JOINTS[spec.joints[name].kind]
    return "angle" in kind.coordinates or kind.hold.asks == "line"


def _steady_axis(study: Study, name: str, axes: str, times: Array) -> Array | None:
    """The axis of a joint in some axes, (3,); None where it moves in them."""
    joint = study.spec.joints[name]
    axis = np.array(joint.axis, dtype=np.float64)
    axis /= np.linalg.norm(axis)
    if axes == "from" or (joint.a == GROUND and axes != "to"):
        return axis
    poses = poses_of(study, times)
    found = _in_axes(poses, joint.a, joint.b if axes == "to" else GROUND, axis)
    return found[0] if np.abs(found - found[0]).max() <= tolerances.SAME_VALUE else None


def _in_axes(poses: Poses, of: str, seen_from: str, axis: Array) -> Array:
    """A direction of a body in the axes of another, (n, 3)."""
    n = len(poses.times)
    world = np.tile(axis, (n, 1)) if of == GROUND else poses.attitudes[of] @ axis
    return world if seen_from == GROUND else np.einsum("tji,tj->ti", poses.attitudes[seen_from], world)


def _is_flat(vectors: Array, axis: Array) -> bool:
    """Whether vectors (n, 3) have no component along an axis."""
    largest = float(np.nanmax(np.abs(vectors), initial=0.0))
    return bool(np.nanmax(np.abs(component(vectors, axis)), initial=0.0) <= tolerances.IN_ONE_PLANE * largest)
