"""Marks in a machine, symbols with a place and a direction: stops, latches, the ground under wheels and ropes' ends.

The limit of an angle stands where the body would come to, as far out as its centre of mass; that of a travel where the
joint's `to` point would come to, of a path on that; that of a length on the line of the rod.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.mechanism.model import GROUND as ON_GROUND
from heuncli.multibody.mechanism.model import Joint, Mechanism
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.rope_ways import pose_of
from heuncli.multibody.tree.starts import joint_start
from heuncli.output.machine_geometry.poses import Poses
from heuncli.output.machine_geometry.ropes import RopeLook, run_of
from heuncli.output.machine_geometry.wheels import touched
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import RollingWheel
from heuncli.scene.file_format.models import Spec, Stop
from heuncli.scene.file_format.names import GROUND
from heuncli.scene.shapes.rotations import about, perpendicular

OUT = 0.6  # of the way to a body's centre of mass: where the stop of its turning stands


class FixedMark(NamedTuple):
    """A symbol of output/drawing/symbols.py on a body: its place and where its x points, body axes.

    told: what it is; name: what stands beside it.
    """

    symbol: str
    told: str
    body: str
    place: Array
    along: Array
    name: str = ""

    def stands(self, poses: Poses) -> tuple[Array, Array]:
        """Place and direction at all instants, (n, 3) each."""
        return poses.ways(self.body, self.place), poses.directions(self.body, self.along)


class LengthMark(NamedTuple):
    """The limit of a length [m] between two points; sign: 1 where it may not grow beyond."""

    symbol: str
    told: str
    ends: tuple[tuple[str, Array], tuple[str, Array]]
    length: float
    sign: float
    name: str = ""

    def stands(self, poses: Poses) -> tuple[Array, Array]:
        """Place and direction at all instants, (n, 3) each."""
        first, last = (poses.ways(*end) for end in self.ends)
        size = np.linalg.norm(last - first, axis=1, keepdims=True)
        way = (last - first) / np.where(size > 0.0, size, 1.0)
        return first + self.length * way, self.sign * way


class RoadMark(NamedTuple):
    """The plane that a wheel touches, at the place of contact."""

    symbol: str
    told: str
    wheel: RollingWheel
    name: str = ""

    def stands(self, poses: Poses) -> tuple[Array, Array]:
        """Place and direction at all instants, (n, 3) each."""
        place, normal = touched(self.wheel, poses)
        return place, -normal


Mark = FixedMark | LengthMark | RoadMark


def marks_of(spec: Spec, scene: PreparedScene, ropes: tuple[RopeLook, ...]) -> Iterator[Mark]:
    """All marks of an assembled scene."""
    for rope in ropes:
        for ends in rope.standing:
            yield LengthMark("foot", f"{rope.name}: on the ground", ends, 0.0, -1.0)
        yield from _sheaves(rope, scene)
    for name, wheel in spec.rolling.items():
        yield RoadMark("road", f"{name}: rolls on {wheel.on.body}", wheel)
    joints = {joint.name: joint for joint in scene.mechanism.joints}
    for stop in spec.stops.values():
        for limit, sign in limits(stop):
            yield mark(scene, joints[stop.joint], stop, "stop", limit, sign)
    for latch in spec.latches.values():
        yield from _latch(spec, scene, joints[latch.joint], latch)


def _sheaves(rope: RopeLook, scene: PreparedScene) -> Iterator[Mark]:
    """What holds sheaves that are the ground's: it stands on the side to which the rope does not pull."""
    index = {body.name: i for i, body in enumerate(scene.mechanism.bodies)} | {GROUND: ON_GROUND}
    for arc in rope.arcs:
        if arc.body == GROUND:
            ends = run_of(rope.strands[arc.before])[0], run_of(rope.strands[arc.before + 1])[1]
            poses = [(pose_of(scene.start, index[body]), point) for body, point in ends]
            ways = [x + R @ point - arc.centre for (x, R), point in poses]
            pull = sum(way / (float(np.linalg.norm(way)) or 1.0) for way in ways)
            yield FixedMark("foot", f"{rope.name}: a sheave on the ground", GROUND, arc.centre, -np.asarray(pull))


def limits(stop: Stop[str]) -> Iterator[tuple[float, float]]:
    """The limits of a coordinate, each with the sense that it stops."""
    for limit, sign in ((stop.low, -1.0), (stop.high, 1.0)):
        if limit is not None:
            yield limit, sign


def _latch(spec: Spec, scene: PreparedScene, joint: Joint, given: Stop[str]) -> Iterator[Mark]:
    """Where a latch holds: a value, the limits of its stop, or, of one that names a joint alone, where this is."""
    own = given.latch
    assert own is not None
    if own.at is not None:
        yield mark(scene, joint, given, "latch", own.at, 1.0)
    elif own.stop is not None:
        for limit, sign in limits(spec.stops[own.stop]):
            if int(sign) in own.sides:
                yield mark(scene, joint, given, "latch", limit, sign)
    else:
        names = {i: body.name for i, body in enumerate(scene.mechanism.bodies)} | {ON_GROUND: GROUND}
        yield FixedMark(
            "latch", f"{given.name}: latch of {joint.name}", names[joint.b], joint.q, joint.to_axis, given.name
        )


def mark(scene: PreparedScene, joint: Joint, stop: Stop[str], symbol: str, limit: float, sign: float) -> Mark:
    """The mark of a limit of a joint's coordinate, in the axes of `from`."""
    names = {i: body.name for i, body in enumerate(scene.mechanism.bodies)} | {ON_GROUND: GROUND}
    told = f"{stop.name}: {symbol} of {joint.name}"
    if stop.quantity == "length":
        return LengthMark(symbol, told, ((names[joint.a], joint.p), (names[joint.b], joint.q)), limit, sign, stop.name)
    if joint.path is not None:
        r, slope, *_ = joint.path.track(limit)
        return FixedMark(symbol, told, names[joint.a], joint.p + r, sign * slope, stop.name)
    (xa, Ra), (xb, Rb) = (pose_of(scene.start, i) for i in (joint.a, joint.b))
    own, n = joint_start(scene.mechanism, scene.start, joint), joint.axis
    to = Ra.T @ (xb + Rb @ joint.q - xa)
    if stop.quantity == "travel":
        return FixedMark(symbol, told, names[joint.a], to + (limit - own.travel) * n, sign * n, stop.name)
    arm = about(n, limit - own.angle) @ Ra.T @ Rb @ _arm(scene.mechanism, joint, Rb.T @ Ra @ n)
    return FixedMark(symbol, told, names[joint.a], to + arm, sign * np.cross(n, arm), stop.name)


def _arm(mechanism: Mechanism, joint: Joint, n: Array) -> Array:
    """From a joint to where its stop meets the body, body axes: towards its centre of mass, beside the axis n."""
    if joint.b == ON_GROUND:
        return np.asarray(perpendicular(n)[0])
    body = mechanism.bodies[joint.b]
    D = np.asarray(body.center) - joint.q
    off = D - (D @ n) * n
    size, spread = float(np.linalg.norm(off)), reach_of(body.mass, np.asarray(body.inertia))
    return OUT * off if size > tolerances.ON_AXIS * spread else OUT * spread * np.asarray(perpendicular(n)[0])


def reach_of(mass: float, inertia: Array) -> float:
    """How far a mass is spread: its radius of gyration about its centre [m]; 1 of what has none."""
    gyration = np.sqrt(max(0.0, float(np.trace(inertia)) / (2.0 * mass))) if mass > 0.0 else 0.0
    return float(gyration) or 1.0
