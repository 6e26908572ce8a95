"""Round parts that rotate, in body axes: wheels, balls, gears, pulleys, sheaves, with spokes that show the rotation.

Gears and belts have pitch lines: circles of wheels, lines of racks, and belt strands on the pulleys' carrier.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.mechanism.build import build_joint
from heuncli.multibody.mechanism.gearing import GearMember, find_gears, find_mesh, joint_line
from heuncli.multibody.mechanism.strands import find_strands
from heuncli.output.machine_geometry.poses import Poses
from heuncli.output.machine_geometry.solids import Surface
from heuncli.results.results import Array, Block
from heuncli.scene.file_format.couplings import Belt, Gear, RollingWheel
from heuncli.scene.file_format.models import Shape, Spec, Vec
from heuncli.scene.shapes.rotations import cross_vectors, perpendicular_pair

CIRCLE_CORNERS = 48  # of a circle
HALF_THICKNESS = 0.06  # of the radius
SPOKE_OFFSET = 1.02  # spokes are drawn further out than their face by this factor, to be visible
RIM_RANGE = (0.7, 1.2)  # of the radius: surface corners at these distances from the axis belong to the wheel


class Disc(NamedTuple):
    """A circle about an axis of unit length.

    is_solid: whether a body without shapes is drawn as this disc
    has_spokes: whether it rotates with its body, so that spokes show its angle
    is_pitch_circle: whether it is that of a gear
    """

    centre: Array
    axis: Array
    radius: float
    is_solid: bool = True
    has_spokes: bool = True
    is_pitch_circle: bool = False

    @property
    def rim(self) -> Array:
        """The circle as a closed line, (CIRCLE_CORNERS + 1, 3)."""
        e, f = perpendicular_pair(self.axis)
        turn = np.linspace(0.0, 2.0 * np.pi, CIRCLE_CORNERS + 1)[:, None]
        found: Array = self.centre + self.radius * (np.cos(turn) * e + np.sin(turn) * f)
        return found

    @property
    def shape(self) -> Shape:
        """The disc as a thin cylinder."""
        half = HALF_THICKNESS * self.radius * self.axis
        return Shape("cylinder", from_=to_vec(self.centre - half), to=to_vec(self.centre + half), radius=self.radius)

    def iter_spokes(self, surfaces: tuple[Surface, ...]) -> Iterator[Array]:
        """Yield lines (2, 3) from rim to rim, two on each face that the disc has among its body's surfaces."""
        ends = np.array([-1.0, 1.0])[:, None]
        for height in self.find_face_heights(surfaces):
            for diameter in perpendicular_pair(self.axis):
                yield self.centre + SPOKE_OFFSET * height * self.axis + self.radius * ends * diameter

    def find_face_heights(self, surfaces: tuple[Surface, ...]) -> tuple[float, ...]:
        """Find the positions of its faces along the axis, from the surface corners near its rim; without any, its own
        plane.
        """
        offsets = np.concatenate([np.zeros((0, 3)), *(surface.corners for surface in surfaces)]) - self.centre
        heights = offsets @ self.axis
        distances = np.sqrt(np.maximum(np.sum(offsets * offsets, axis=1) - heights * heights, 0.0))
        rim_heights = heights[(distances >= RIM_RANGE[0] * self.radius) & (distances <= RIM_RANGE[1] * self.radius)]
        return (float(rim_heights.min()), float(rim_heights.max())) if len(rim_heights) else (0.0,)


def to_vec(x: Array) -> Vec:
    """Convert an array of three numbers to a tuple."""
    a, b, c = x.tolist()
    return a, b, c


def to_unit_vector(axis: Vec) -> Array:
    """Scale an axis to length 1."""
    v = np.array(axis)
    return np.asarray(v / np.sqrt(v @ v))


def iter_wheel_discs(spec: Spec) -> Iterator[tuple[str, Disc]]:
    """Yield the discs that roll, each with its body."""
    for wheel in spec.rolling.values():
        if wheel.axis is not None:
            yield wheel.wheel.body, Disc(np.array(wheel.wheel.point), to_unit_vector(wheel.axis), wheel.radius)


def iter_balls(spec: Spec, body: str) -> Iterator[Shape]:
    """Yield the rolling balls as which a body without shapes is drawn."""
    for wheel in spec.rolling.values():
        if wheel.axis is None and wheel.wheel.body == body:
            yield Shape("sphere", center=wheel.wheel.point, radius=wheel.radius)


def find_contact_points(wheel: RollingWheel, poses: Poses) -> tuple[Array, Array]:
    """Find the contact points of a wheel with its plane at all instants (kernel/rolling.py), and the plane's normal,
    (n, 3) each.
    """
    C = poses.trace_point(wheel.wheel.body, np.array(wheel.wheel.point))
    n = poses.trace_direction(wheel.on.body, to_unit_vector(wheel.normal))
    if wheel.axis is None:
        return C - wheel.radius * n, n
    k = poses.trace_direction(wheel.wheel.body, to_unit_vector(wheel.axis))
    t = np.cross(k, n)
    size = np.linalg.norm(t, axis=1, keepdims=True)
    t = np.divide(t, size, out=np.zeros_like(t), where=size > 0.0)  # a rim that lies flat has no lowest point
    return C - wheel.radius * np.cross(t, k), n


class BeltGeometry(NamedTuple):
    """A belt: its strands (2, 2, 3) in running direction, in the axes of the pulleys' carrier; the driving strand
    first.

    pulley_bodies: bodies of the first and the second pulley
    travel_factors: joints, each with the travel of the belt per angle [m]
    """

    name: str
    carrier: str
    strands: Array
    pulley_bodies: tuple[str, str]
    travel_factors: tuple[tuple[str, float], ...]

    def compute_travel(self, coordinates: Block) -> Array:
        """Compute the travel of the belt at the instants of the results, (n,) [m]."""
        parts = [factor * np.asarray(coordinates[name]["angle"]) for name, factor in self.travel_factors]
        return np.asarray(np.sum(parts, axis=0))


class PitchPoint(NamedTuple):
    """The point (3,) at which two gears mesh, in the axes of the body that carries their axes."""

    name: str
    carrier: str
    point: Array


class PitchGeometry(NamedTuple):
    """Discs of bodies and of the ground, pitch lines of racks (2, 3) in body axes, belts, and pitch points."""

    discs: dict[str, list[Disc]]
    racks: dict[str, list[Array]]
    belts: list[BeltGeometry]
    points: list[PitchPoint]


class _GearingModel(NamedTuple):
    """The joints and bodies of a spec in the form that the gearing functions read.

    body_names: by the numbers of the bodies
    joint_numbers: by the names of the joints
    """

    joints: Sequence[Any]
    bodies: Sequence[Any]
    body_names: dict[int, str]
    joint_numbers: dict[str, int]


def make_pitch_geometry(spec: Spec) -> PitchGeometry:
    """Make the geometry of all gears and belts of a spec, except those that are invalid and refused by the solver."""
    index = {name: i for i, name in enumerate(spec.bodies)} | {"ground": -1}
    joints = [build_joint(j, index[j.a], index[j.b], spec.space == "planar") for j in spec.joints.values()]
    bodies: list[Any] = [
        SimpleNamespace(name=name, rotation=None if b.rotation is None else np.array(b.rotation).reshape(3, 3))
        for name, b in spec.bodies.items()
    ]
    model = _GearingModel(joints, bodies, {i: x for x, i in index.items()}, {x: k for k, x in enumerate(spec.joints)})
    geometry = PitchGeometry(defaultdict(list), defaultdict(list), [], [])
    for name, coupling in spec.couplings.items():
        if isinstance(coupling, Gear | Belt):
            try:
                if isinstance(coupling, Gear):
                    _add_gear(geometry, model, name, coupling)
                else:
                    _add_belt(geometry, model, name, coupling)
            except Finding:
                continue
    return geometry


def _add_gear(geometry: PitchGeometry, model: _GearingModel, name: str, gear: Gear) -> None:
    """Add a pair of wheels, or a wheel and its rack. Raises Finding."""
    pair_joints = model.joint_numbers[gear.terms[0].joint], model.joint_numbers[gear.terms[1].joint]
    carrier, *pair = find_gears(model.joints, model.bodies, pair_joints)
    P = find_mesh(gear, carrier, pair[0], pair[1], None if gear.at is None else np.array(gear.at.point)).P
    geometry.points.append(PitchPoint(name, model.body_names[carrier], P))
    radii = [float(np.sqrt(m.arm(P) @ m.arm(P))) if m.turns else 0.0 for m in pair]
    for k, member, r in zip(pair_joints, pair, radii, strict=True):
        body = model.body_names[member.body]
        if member.turns:
            ring = r == max(radii) and is_internal_pair(pair, P)
            geometry.discs[body].append(
                make_pitch_circle(model, k, member, r, float((P - member.point) @ member.axis), not ring)._replace(
                    is_pitch_circle=True
                )
            )
        else:
            geometry.racks[body].append(make_rack_line(model, k, member, P, max(radii)))


def is_internal_pair(pair: Sequence[GearMember], P: Array) -> bool:
    """Return whether one of two wheels lies inside the other: parallel axes on the same side of the pitch point."""
    first, second = pair
    across = cross_vectors(first.axis, second.axis)
    parallel = float(across @ across) <= tolerances.TYPED_AXES**2
    return first.turns and second.turns and parallel and float(first.arm(P) @ second.arm(P)) > 0.0


def _add_belt(geometry: PitchGeometry, model: _GearingModel, name: str, belt: Belt) -> None:
    """Add two pulleys and the strands between them. Raises Finding."""
    pulley_joints = model.joint_numbers[belt.terms[0].joint], model.joint_numbers[belt.terms[1].joint]
    carrier, first, second = find_gears(model.joints, model.bodies, pulley_joints)
    tight, slack = find_strands(belt, first, second)
    offset = float((first.point - second.point) @ second.axis)
    for k, member, r, height in zip(pulley_joints, (first, second), belt.radii, (0.0, offset), strict=True):
        geometry.discs[model.body_names[member.body]].append(make_pitch_circle(model, k, member, r, height))
    pulley_bodies = model.body_names[first.body], model.body_names[second.body]
    # the first pulley pulls the tight strand
    strand_lines = np.array([(tight.end, tight.begin), (slack.begin, slack.end)])
    joints = list(model.joint_numbers)
    travel_factors = tuple((joints[x.joint], belt.radii[0] * x.ratio / first.sign) for x in first.coordinates)
    geometry.belts.append(BeltGeometry(name, model.body_names[carrier], strand_lines, pulley_bodies, travel_factors))


def make_pitch_circle(
    model: _GearingModel, joint_number: int, member: GearMember, r: float, height: float, is_solid: bool = True
) -> Disc:
    """Make the pitch circle of a wheel, in its body's axes."""
    point, axis = joint_line(model.joints[joint_number], model.bodies, member.body)
    return Disc(point + height * axis, axis, r, is_solid, has_spokes=is_solid)


def make_rack_line(model: _GearingModel, joint_number: int, member: GearMember, P: Array, wheel_radius: float) -> Array:
    """Make a rack's pitch line (2, 3) through the pitch point P, in its body's axes, as long as one turn of the
    wheel.
    """
    own_joint, bodies = model.joints[joint_number], model.bodies
    point, axis = joint_line(own_joint, bodies, member.body)
    base = own_joint.a if own_joint.b == member.body else own_joint.b
    rotations = (None if i < 0 else bodies[i].rotation for i in (base, member.body))
    carrier_axes, body_axes = (np.eye(3) if R is None else R for R in rotations)
    center = point + body_axes.T @ carrier_axes @ (P - member.point)
    return np.array([center - np.pi * wheel_radius * axis, center + np.pi * wheel_radius * axis])
