"""The tips of vectors over a run, in the plane in which they are drawn, and the largest of them.

The plane is that of a planar scene, else the one normal to an axis at rest. The largest vector is that of the
components in the plane, searched between the samples.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.figures.courses import (
    FigureSource,
    NotDrawable,
    TurningRun,
    VectorSource,
    choose_instants,
    describe_number,
    find_turning_run,
    find_values,
    find_vectors,
    is_varying,
    list_angle_paths,
)
from heuncli.output.machine_geometry.poses import Poses, compute_poses
from heuncli.results.results import Array
from heuncli.results.results_schema import SPACE
from heuncli.scene.file_format.loads import Actuator
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import GROUND
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.labels import make_unit_labels
from heuncli.study.queries.measure_uncertainty import find_search_error, find_unit
from heuncli.study.queries.study import Study
from heuncli.study.search import extremes

AXIS_LETTERS = ("x", "y", "z")
JOINT_BLOCKS = ("joints", "coordinates")
MIN_PEAK_RATIO = 4.0  # of the mean over a cycle: a gas force with a higher peak fires


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


class TipCurve(NamedTuple):
    """The tips of a vector (n, 3) over the instants of a turning run, with their plane, name, caption and pen."""

    name: str
    path: str
    unit: str
    pen: int
    study: Study
    turning: TurningRun
    vectors: Array
    plane: Plane
    caption: str

    @property
    def x(self) -> Array:
        """The components to the right."""
        return self.plane.project(self.vectors)[0]

    @property
    def y(self) -> Array:
        """The components upwards."""
        return self.plane.project(self.vectors)[1]


class LargestVector(NamedTuple):
    """The largest vector: its two components, its magnitude in the plane with the stated error, and its instant.

    is_constant: whether all vectors have this magnitude
    """

    x: float
    y: float
    magnitude: float
    error: float
    time: float
    is_constant: bool


def make_tip_curves(
    sources: Sequence[FigureSource], paths: Sequence[str], axes: str, view: str | None
) -> Iterator[TipCurve]:
    """Yield the curves, each with its pen. Raises NotDrawable."""
    number = 0
    for source in sources:
        study = source.study
        for path in paths:
            _require_vector(study, path)
        turning = _find_turning_run(study, paths)
        for path in paths:
            vectors = find_vectors(study, path, turning.times)
            plane = (
                make_axis_plane(view)
                if view is not None
                else choose_plane(study, path, vectors, turning.times, axes, turning.path)
            )
            name = f"{source.name}: {path}" if source.name else path
            words = describe_number(source, path)
            caption = f"{source.name}: {words}" if source.name else words
            yield TipCurve(name, path, find_unit(path, study.spec), number, study, turning, vectors, plane, caption)
            number += 1


def _require_vector(study: Study, path: str) -> None:
    """Raise NotDrawable if a path is no vector over several instants."""
    numbers = study.find_numbers(path)
    if numbers.axes != (SPACE,) or not numbers.is_timed:
        message = f"polar {path}: a polar diagram needs a vector over time, and this is not one"
        raise NotDrawable(message, "for example polar joints.main, or polar foundation")
    if study.has_one_instant or len(choose_instants(study)) < 2:
        message = f"polar {path}: there is only one instant, so no curve"
        raise NotDrawable(message, "define a motion: analysis.duration")


def _find_turning_run(study: Study, paths: Sequence[str]) -> TurningRun:
    """Find the part of a run that is shown."""
    candidates = [path for path in list_angle_paths(study.spec) if path.split(".")[1] in study.results.coordinates]
    errors = [find_search_error(study, study.find_numbers(path).keys) for path in paths]
    vectors = VectorSource(
        lambda t: np.stack([find_vectors(study, path, t) for path in paths], axis=1), np.nan_to_num(errors, posinf=0.0)
    )
    return find_turning_run(study, choose_instants(study), candidates, vectors)


def list_firing_paths(spec: Spec) -> list[str]:
    """List the paths of the forces that may be those of gas: actuators with an end on the ground."""
    return [
        f"forces.{name}.value"
        for name, force in spec.forces.items()
        if isinstance(force, Actuator) and GROUND in (force.from_.body, force.to.body)
    ]


def find_firings(curve: TipCurve) -> Iterator[tuple[float, str]]:
    """Find the instants of firing in a cycle of a crank: where an actuator on the ground has a sharp peak."""
    turning, spec = curve.turning, curve.study.spec
    if not turning.path:
        return
    for path in list_firing_paths(spec):
        values = np.abs(find_values(curve.study, path, turning.times))
        if np.isfinite(values).all() and values.max() > MIN_PEAK_RATIO * values.mean():
            k = int(values.argmax())
            angle = turning.degrees[k] % (360.0 * turning.turns or math.inf)
            name = describe_object("forces", path.split(".")[1], make_unit_labels(spec))
            yield float(turning.times[k]), f"{name} fires, {angle:.0f}°"


def find_largest(curve: TipCurve) -> LargestVector | None:
    """Find the largest vector in the plane; None if none is known."""
    study, plane = curve.study, curve.plane

    def sample(times: Array) -> Array:
        x, y = plane.project(find_vectors(study, curve.path, times))
        return np.asarray((x * x + y * y)[:, None])

    search_times = study.search_times
    times = curve.turning.times
    times = np.union1d(times, search_times[(search_times >= times[0]) & (search_times <= times[-1])])
    error = find_search_error(study, study.find_numbers(curve.path).keys)
    found = extremes.search_extremes(sample, times, errors=np.array([error]), is_squared=np.array([True]), sides=(1.0,))
    time = float(found.high_at[0])
    if not np.isfinite(found.high[0]):
        return None
    x, y = map(float, plane.project(find_vectors(study, curve.path, np.array([time]))[0]))
    size, error = math.sqrt(float(found.high[0])), 0.0 if math.isnan(error) else error
    smallest = float(np.nanmin(np.hypot(curve.x, curve.y)))
    return LargestVector(x, y, size, error, time, not is_varying(smallest, size, error))
