"""Symbols in a machine with a position and a direction: loads in joints, stops, latches, roads, rope ends, sensors.

The symbol of a load stands in the row of its kind. The limit of an angle is drawn where the body would be, on the side
of its centre of mass; the limit of a travel where the joint's `to` point would be, for a path on the path; the limit
of a length on the line of the rod.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS, TYPES, JointKind
from heuncli.base.load_kinds import LOAD_KINDS
from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.mechanism.loads import GROUND as ON_GROUND
from heuncli.multibody.mechanism.model import Joint, Mechanism
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.rope_routes import body_pose
from heuncli.multibody.tree.starts import compute_joint_start
from heuncli.output.machine_geometry.discs import find_contact_points
from heuncli.output.machine_geometry.poses import Poses
from heuncli.output.machine_geometry.ropes import RopeGeometry, order_span_ends
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import RollingWheel
from heuncli.scene.file_format.models import JointForce, PairForce, Spec, Stop
from heuncli.scene.file_format.names import GROUND
from heuncli.scene.shapes.rotations import perpendicular_pair, rotation_matrix_about

DRIVE = "drive"  # drawn as the torque that it is
AXIS_KINDS = ("pin", "line", "cylinder")  # of bearings: the kinds whose axis is that of the shaft
BEARING_KINDS = (*AXIS_KINDS, "ball")
ON_AXIS = 1e-6  # share of the distance of bearings: those farther from the axis are not on it
OBLIQUE = np.array([1.0, -0.35, -0.6])  # of a round symbol: no usual view looks along it
STOP_RADIUS = 0.6  # of the distance to the body's centre of mass: radius at which the stop of an angle is drawn


class JointSymbol(NamedTuple):
    """The symbol of a joint's drive, or of a load in a joint.

    load_kind: DRIVE, or a kind of load
    symbols: seen with the joint's axis towards the eye, and away from it
    slides: whether the symbol acts along the joint's axis and not about it
    """

    name: str
    load_kind: str
    joint: str
    symbols: tuple[str, str]
    slides: bool


def find_scene_joint_kind(spec: Spec, type_: str) -> JointKind:
    """Find the kind of a joint of a given type; in a scene declared planar, its planar kind."""
    kind = TYPES[type_]
    return JOINTS[kind.planar] if spec.space == "planar" and kind.planar is not None else kind


def iter_joint_symbols(spec: Spec) -> Iterator[JointSymbol]:
    """Yield the symbols of all drives and loads in joints. A load along a rod or rope is drawn with that rod or
    rope.
    """
    joint_loads = [(drive.joint, drive.name, DRIVE) for drive in spec.drives.values()]
    for name, force in spec.forces.items():
        if isinstance(force, JointForce):
            joint_loads.append((force.joint, name, force.type))
    for joint, name, load_kind in joint_loads:
        kind = find_scene_joint_kind(spec, spec.joints[joint].kind)
        if not kind.keeps_distance:
            slides = kind.follows_path or (bool(kind.shifts) and kind.turn.condition == "all")
            to_eye, away_from_eye, sliding = LOAD_KINDS["torque" if load_kind == DRIVE else load_kind].symbols
            yield JointSymbol(name, load_kind, joint, (sliding, sliding) if slides else (to_eye, away_from_eye), slides)


def find_guided_actuators(spec: Spec) -> frozenset[str]:
    """Find the actuators between two bodies that slide on each other, such as the gas on a piston.

    They have no rod and barrel of their own: what acts is drawn on both bodies.
    """
    slides = {frozenset((j.a, j.b)) for j in spec.joints.values() if find_scene_joint_kind(spec, j.kind).shifts}
    return frozenset(
        name
        for name, force in spec.forces.items()
        if isinstance(force, PairForce)
        and force.type == "actuator"
        and frozenset((force.from_.body, force.to.body)) in slides
    )


def find_shaft_bearings(spec: Spec) -> dict[str, bool]:
    """Find the bearings of shafts: joints on the ground with a body that has two or more of them on one axis.

    Returns their names, each with whether it holds the shaft along the axis (a fixed bearing).
    """
    bearings: dict[str, bool] = {}
    for body in spec.bodies:
        supports = [(n, j) for n, j in spec.joints.items() if {j.a, j.b} == {GROUND, body} and j.kind in BEARING_KINDS]
        axes = [j for _, j in supports if j.kind in AXIS_KINDS]
        if not axes:
            continue
        axis = np.array(axes[0].axis) / np.linalg.norm(axes[0].axis)
        places = {n: np.array(j.p if j.a == GROUND else j.q) for n, j in supports}
        offsets = {n: place - places[supports[0][0]] for n, place in places.items()}
        extent = max(float(np.linalg.norm(offset)) for offset in offsets.values())
        on_axis = [n for n, offset in offsets.items() if np.linalg.norm(np.cross(offset, axis)) <= ON_AXIS * extent]
        if extent > 0.0 and len(on_axis) > 1:
            bearings |= {n: not TYPES[spec.joints[n].kind].shifts for n in on_axis}
    return bearings


class FixedMark(NamedTuple):
    """A symbol of output/drawing/symbols.py on a body: its position, and the direction of its x axis, both in body
    axes.

    description: what it is
    name: the text next to it
    """

    symbol: str
    description: str
    body: str
    place: Array
    direction: Array
    name: str = ""

    def locate(self, poses: Poses) -> tuple[Array, Array]:
        """Compute position and direction at all instants, (n, 3) each."""
        return poses.trace_point(self.body, self.place), poses.trace_direction(self.body, self.direction)


class LengthMark(NamedTuple):
    """The limit of a length [m] between two points.

    sign: 1 for an upper limit, -1 for a lower one
    """

    symbol: str
    description: str
    ends: tuple[tuple[str, Array], tuple[str, Array]]
    length: float
    sign: float
    name: str = ""

    def locate(self, poses: Poses) -> tuple[Array, Array]:
        """Compute position and direction at all instants, (n, 3) each."""
        first, last = (poses.trace_point(*end) for end in self.ends)
        size = np.linalg.norm(last - first, axis=1, keepdims=True)
        direction = (last - first) / np.where(size > 0.0, size, 1.0)
        return first + self.length * direction, self.sign * direction


class RoadMark(NamedTuple):
    """The plane that a wheel rolls on, drawn at the contact point."""

    symbol: str
    description: str
    wheel: RollingWheel
    name: str = ""

    def locate(self, poses: Poses) -> tuple[Array, Array]:
        """Compute position and direction at all instants, (n, 3) each."""
        place, normal = find_contact_points(self.wheel, poses)
        return place, -normal


Mark = FixedMark | LengthMark | RoadMark


def iter_marks(spec: Spec, scene: PreparedScene, ropes: tuple[RopeGeometry, ...]) -> Iterator[Mark]:
    """Yield all marks of an assembled scene."""
    for rope in ropes:
        for ends in rope.ground_ends:
            yield LengthMark("foot", f"{rope.name}: on the ground", ends, 0.0, -1.0)
        yield from _iter_sheave_marks(rope, scene)
    for name, wheel in spec.rolling.items():
        yield RoadMark("road", f"{name}: rolls on {wheel.on.body}", wheel)
    yield from _iter_reaction_marks(spec, scene)
    joints = {joint.name: joint for joint in scene.mechanism.joints}
    for stop in spec.stops.values():
        for limit, sign in iter_limits(stop):
            yield make_mark(scene, joints[stop.joint], stop, "stop", limit, sign)
    for latch in spec.latches.values():
        yield from _iter_latch_marks(spec, scene, joints[latch.joint], latch)


def _iter_reaction_marks(spec: Spec, scene: PreparedScene) -> Iterator[Mark]:
    """Yield the two bearings of joints that have them, and the points of sensors."""
    for joint in scene.mechanism.joints:
        if joint.bearings is not None:
            for number, place in enumerate(joint.bearings.at):
                symbol = "fixed bearing" if joint.bearings.axial == number else "floating bearing"
                body, at = spec.joints[joint.name].b, joint.q + place * joint.to_axis
                yield FixedMark(symbol, f"{joint.name}: bearing {number}", body, at, joint.to_axis)
    for name, sensor in spec.sensors.items():
        if sensor.point is not None:
            body, point = sensor.point.body, sensor.point.point
        elif sensor.joint is not None:
            body, point = spec.joints[sensor.joint].b, spec.joints[sensor.joint].q
        else:
            section = spec.sections[sensor.section or ""]
            body, point = section.body, section.at or section.from_ or (0.0, 0.0, 0.0)
        yield FixedMark("sensor", f"{name}: sensor", body, np.array(point), OBLIQUE, name)


def _iter_sheave_marks(rope: RopeGeometry, scene: PreparedScene) -> Iterator[Mark]:
    """Yield the supports of sheaves on the ground, each on the side opposite to the pull of the rope."""
    index = {body.name: i for i, body in enumerate(scene.mechanism.bodies)} | {GROUND: ON_GROUND}
    for arc in rope.arcs:
        if arc.body == GROUND:
            ends = order_span_ends(rope.spans[arc.span])[0], order_span_ends(rope.spans[arc.span + 1])[1]
            poses = [(body_pose(scene.start, index[body]), point) for body, point in ends]
            span_vectors = [x + R @ point - arc.centre for (x, R), point in poses]
            pull = sum(vector / (float(np.linalg.norm(vector)) or 1.0) for vector in span_vectors)
            yield FixedMark("foot", f"{rope.name}: a sheave on the ground", GROUND, arc.centre, -np.asarray(pull))


def iter_limits(stop: Stop[str]) -> Iterator[tuple[float, float]]:
    """Yield the limits of a stop, each with its sign: -1 for the lower, 1 for the upper."""
    for limit, sign in ((stop.low, -1.0), (stop.high, 1.0)):
        if limit is not None:
            yield limit, sign


def _iter_latch_marks(spec: Spec, scene: PreparedScene, joint: Joint, stop: Stop[str]) -> Iterator[Mark]:
    """Yield the marks of a latch: at its value, at the limits of its stop, or, if it names only a joint, at the
    joint.
    """
    latch = stop.latch
    assert latch is not None
    if latch.position is not None:
        yield make_mark(scene, joint, stop, "latch", latch.position, 1.0)
    elif latch.stop is not None:
        for limit, sign in iter_limits(spec.stops[latch.stop]):
            if int(sign) in latch.sides:
                yield make_mark(scene, joint, stop, "latch", limit, sign)
    else:
        names = {i: body.name for i, body in enumerate(scene.mechanism.bodies)} | {ON_GROUND: GROUND}
        yield FixedMark(
            "latch", f"{stop.name}: latch of {joint.name}", names[joint.b], joint.q, joint.to_axis, stop.name
        )


def make_mark(scene: PreparedScene, joint: Joint, stop: Stop[str], symbol: str, limit: float, sign: float) -> Mark:
    """Make the mark of a limit of a joint coordinate, in the axes of the `from` body."""
    names = {i: body.name for i, body in enumerate(scene.mechanism.bodies)} | {ON_GROUND: GROUND}
    description = f"{stop.name}: {symbol} of {joint.name}"
    if stop.quantity == "length":
        return LengthMark(
            symbol, description, ((names[joint.a], joint.p), (names[joint.b], joint.q)), limit, sign, stop.name
        )
    if joint.path is not None:
        r, slope, *_ = joint.path.evaluate_track(limit)
        return FixedMark(symbol, description, names[joint.a], joint.p + r, sign * slope, stop.name)
    (xa, Ra), (xb, Rb) = (body_pose(scene.start, i) for i in (joint.a, joint.b))
    start_coordinates, n = compute_joint_start(scene.mechanism, scene.start, joint), joint.axis
    joint_offset = Ra.T @ (xb + Rb @ joint.q - xa)
    if stop.quantity == "travel":
        return FixedMark(
            symbol,
            description,
            names[joint.a],
            joint_offset + (limit - start_coordinates.travel) * n,
            sign * n,
            stop.name,
        )
    arm = (
        rotation_matrix_about(n, limit - start_coordinates.angle)
        @ Ra.T
        @ Rb
        @ _find_stop_arm(scene.mechanism, joint, Rb.T @ Ra @ n)
    )
    return FixedMark(symbol, description, names[joint.a], joint_offset + arm, sign * np.cross(n, arm), stop.name)


def _find_stop_arm(mechanism: Mechanism, joint: Joint, n: Array) -> Array:
    """Find the vector from a joint to its stop on the body, body axes: towards the centre of mass, perpendicular to
    axis n.
    """
    if joint.b == ON_GROUND:
        return np.asarray(perpendicular_pair(n)[0])
    body = mechanism.bodies[joint.b]
    D = np.asarray(body.center) - joint.q
    offset = D - (D @ n) * n
    size, gyration = float(np.linalg.norm(offset)), compute_gyration_radius(body.mass, np.asarray(body.inertia))
    return (
        STOP_RADIUS * offset
        if size > tolerances.ON_AXIS * gyration
        else STOP_RADIUS * gyration * np.asarray(perpendicular_pair(n)[0])
    )


def compute_gyration_radius(mass: float, inertia: Array) -> float:
    """Compute the radius of gyration of a mass about its centre [m]; 1 if mass or inertia is zero."""
    gyration = np.sqrt(max(0.0, float(np.trace(inertia)) / (2.0 * mass))) if mass > 0.0 else 0.0
    return float(gyration) or 1.0
