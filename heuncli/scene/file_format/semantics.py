"""The meaning of single entries, for the rules and for `resolve`: orientations, inertia, drives, instants, points.

All functions except orientation_matrix accept any document that could be read, even one with errors.

A motor has a torque over speed and a rotor. A rotor is a body of its own: a thin disc about the axis of the motor's
joint, on a pin in the body `from`, coupled to the joint by a ratio. So its inertia, its gyroscopic moments and the
reaction of its gear on the housing follow from the mechanics of bodies.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from decimal import Decimal
from typing import Any, Literal

from heuncli.base.errors import Finding, SourceLocation
from heuncli.base.joint_kinds import RATES, TYPES, JointKind
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.expressions.composition import add_expressions, multiply_expressions
from heuncli.scene.expressions.programs import OWN, VAR, Expression
from heuncli.scene.file_format import couplings as c
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_loads as fl
from heuncli.scene.file_format import format_shapes as fs
from heuncli.scene.file_format import loads, rotations
from heuncli.scene.file_format import models as m
from heuncli.scene.file_format.fields import EndEntry
from heuncli.scene.file_format.rotations import unit_vector
from heuncli.scene.file_format.segments import QUANTITY_DIMENSIONS, SegmentMotion, read_segments

# Semantics

DEFAULT_SAMPLES = 201
# what a drive may prescribe: a coordinate, or its rate of change
DRIVEN_RATES = RATES | {"length": "speed"}
DRIVE_KEYS = tuple(dict.fromkeys((*DRIVEN_RATES, *DRIVEN_RATES.values())))
DRIVE_FORMS = (*DRIVE_KEYS, "segments")
Limits = tuple[float | None, float | None]
ORIENTATIONS: dict[str, tuple[str, ...]] = {
    "axis": ("axis", "angle"),
    "quaternion": ("quaternion",),
    "rodrigues": ("rodrigues",),
    "euler": ("euler", "sequence"),
    "matrix": ("matrix",),
}


def orientation_matrix(value: fs.Orientation) -> loads.Matrix:
    """Return the rotation matrix of an orientation. Raises Finding."""
    given_keys = {key for keys in ORIENTATIONS.values() for key in keys if getattr(value, key) is not None}
    forms = [name for name, keys in ORIENTATIONS.items() if given_keys & set(keys)]
    known = "{axis, angle}, {quaternion}, {rodrigues}, {euler, sequence} or {matrix}"
    if len(forms) != 1:
        description = f"the orientation is given by {' and '.join(forms)}" if forms else "the orientation is empty"
        raise Finding("orientation", description, f"give one of {known}")
    missing = [key for key in ORIENTATIONS[forms[0]] if key not in given_keys]
    if missing:
        hint = (
            "sequence: zyx rotates about z, then the new y, then the new x"
            if missing == ["sequence"]
            else f"give one of {known}"
        )
        raise Finding("orientation", f"the orientation has no {missing[0]}", hint)
    if value.axis is not None and value.angle is not None:
        if not any(value.axis):
            raise Finding("orientation", "the axis is [0, 0, 0], which has no direction", "[0, 0, 1] is the z axis")
        return rotations.rotation_about(value.axis, value.angle)
    if value.quaternion is not None:
        return rotations.rotation_from_unit_quaternion(value.quaternion)
    if value.rodrigues is not None:
        return rotations.rotation_from_rodrigues(value.rodrigues)
    if value.euler is not None:
        return rotations.rotation_from_euler(value.euler, value.sequence or "")
    assert value.matrix is not None
    return rotations.rotation_from_matrix(value.matrix)


def inertia_tensor(owner: f.BodyEntry | f.PieceEntry) -> loads.Matrix:
    """Return the inertia tensor about the centre of mass: moments on the diagonal, negated deviation moments off it."""
    inertia = owner.inertia
    if isinstance(inertia, float):  # planar: a flat body with this moment about z
        return ((0.5 * inertia, 0.0, 0.0), (0.0, 0.5 * inertia, 0.0), (0.0, 0.0, inertia))
    rows: Any = inertia
    if isinstance(rows[0], tuple):
        a, b, c = rows
        off = (0.5 * (a[1] + b[0]), 0.5 * (a[2] + c[0]), 0.5 * (b[2] + c[1]))
        return ((a[0], off[0], off[1]), (off[0], b[1], off[2]), (off[1], off[2], c[2]))
    x, y, z = rows
    a, b, c = (-d if d != 0.0 else 0.0 for d in owner.deviation or (0.0, 0.0, 0.0))
    return ((x, c, b), (c, y, a), (b, a, z))


class DrivenCoordinate(NamedTuple):
    """What a drive prescribes: the key (the coordinate or its rate), its value in time, and the coordinate."""

    key: Literal["angle", "travel", "length", "rate", "speed", "segments"]
    value: Expression
    quantity: Literal["angle", "travel", "length"]

    @property
    def by_rate(self) -> bool:
        """Whether the value is the coordinate's rate of change."""
        return self.key in DRIVEN_RATES.values()


def list_drive_keys(kind: JointKind) -> tuple[str, ...]:
    """List the keys by which a joint of this kind may be driven."""
    return (*kind.drives, *(DRIVEN_RATES[quantity] for quantity in kind.drives))


def find_driven_coordinate(drive: f.DriveEntry, joint_type: str | None) -> DrivenCoordinate | None:
    """Return what a drive prescribes, if it is exactly one quantity.

    joint_type: type of its joint, or None if unknown
    """
    given_keys = [key for key in DRIVE_FORMS if getattr(drive, key) is not None]
    if len(given_keys) != 1:
        return None
    key = given_keys[0]
    value = getattr(drive, key)
    if key == "segments":
        motion = read_drive_segments(drive, joint_type)
        if motion is None or motion.problems:
            return None
        return DrivenCoordinate("segments", motion.make_expression(drive.repeat), TYPES[joint_type or ""].drives[0])
    if key not in DRIVEN_RATES.values():
        return DrivenCoordinate(key, value, key)  # type: ignore[arg-type]
    kind = TYPES.get(joint_type or "")
    quantities = [quantity for quantity in (kind.drives if kind is not None else ()) if DRIVEN_RATES[quantity] == key]
    return DrivenCoordinate(key, value, quantities[0]) if quantities else None  # type: ignore[arg-type]


def read_drive_segments(drive: f.DriveEntry, joint_type: str | None) -> SegmentMotion | None:
    """Read the segments of a drive; None if its joint cannot be driven."""
    kind = TYPES.get(joint_type or "")
    if kind is None or not kind.drives:
        return None
    return read_segments(drive.segments or (), drive.base, QUANTITY_DIMENSIONS[kind.drives[0]])


def find_limits(stop: f.StopEntry) -> tuple[Literal["angle", "travel", "length"], Limits] | None:
    """Return quantity and limits of a stop that limits exactly one coordinate."""
    limits_by_quantity: list[tuple[Literal["angle", "travel", "length"], Limits | None]] = [
        ("angle", stop.angle), ("travel", stop.travel), ("length", stop.length)
    ]  # fmt: skip
    found = [(quantity, limits) for quantity, limits in limits_by_quantity if limits is not None]
    return found[0] if len(found) == 1 else None


class HeldCoordinate(NamedTuple):
    """What a latch holds: a joint's coordinate at a position, at limits of its stop (-1 lower, 1 upper), or
    anywhere.
    """

    joint: str
    quantity: Literal["angle", "travel", "length"]
    position: float | None
    sides: tuple[int, ...]


def find_held_coordinate(latch: f.LatchEntry, document: f.Document) -> HeldCoordinate | None:
    """Return what a latch holds, or None if its entry is not valid."""
    stop = document.stops.get(latch.stop or "")
    if stop is not None:
        found = find_limits(stop)
        sides = {"lower": (-1,), "upper": (1,), None: (-1, 1)}[latch.limit]
        return (
            HeldCoordinate(stop.joint, found[0], None, tuple(s for s in sides if found[1][s > 0] is not None))
            if found
            else None
        )
    joint = document.joints.get(latch.joint or "")
    kind = TYPES.get(joint.type) if joint is not None else None
    if latch.joint is None or kind is None or len(coordinates := limitable_coordinates(kind)) != 1:
        return None
    return HeldCoordinate(latch.joint, coordinates[0], getattr(latch, coordinates[0], None), ())


def limitable_coordinates(kind: JointKind) -> tuple[Literal["angle", "travel", "length"], ...]:
    """Return the coordinates of a kind of joint that can be limited or held."""
    return ("length",) if kind.keeps_distance else kind.coordinates


def find_analysis_type(document: f.Document) -> Literal["motion", "impulse", "state", "rest"]:
    """Return the type of the analysis: as given, else as the rest of the spec implies."""
    analysis = document.analysis
    if analysis.type is not None:
        return analysis.type
    if analysis.duration is not None or analysis.times is not None:
        return "motion"
    return "impulse" if document.impulses else "state"


MAX_SAMPLES = 3_000_000  # 100 MB while a spec is read; 200 million result numbers even for the smallest scene


def list_instants(document: f.Document) -> tuple[float, ...]:
    """List the output instants [s]; empty if they are not valid."""
    analysis = document.analysis
    if find_analysis_type(document) != "motion":
        return (0.0,)
    if analysis.times is not None:
        return tuple(analysis.times)
    count = analysis.samples if analysis.samples is not None else DEFAULT_SAMPLES
    if analysis.duration is None or not math.isfinite(analysis.duration) or not 2 <= count <= MAX_SAMPLES:
        return ()
    return (*iter_even_instants(analysis.duration, count), analysis.duration)


def iter_even_instants(duration: float, count: int) -> Iterator[float]:
    """Yield `count` evenly spaced instants without the last, with the duration taken as the decimal number written.

    Each is the double nearest to its exact fraction. So the second of 0, 0.1, 0.2, 0.3 equals an impulse time of 0.1,
    whereas 0.3 * 1 / 3 in floating point is the next smaller double.
    """
    numerator, denominator = Decimal(repr(duration)).as_integer_ratio()
    return (numerator * i / (denominator * (count - 1)) for i in range(count - 1))


def run_duration(analysis: f.AnalysisEntry) -> float:
    """Return the duration of the run [s]; 0 if there is none."""
    if analysis.times:
        return max(analysis.times)
    return analysis.duration or 0.0


def find_reduction_end(reduce_to: str | EndEntry) -> EndEntry | None:
    """Return the point about which a section's moments are taken; None for a word such as `centroid`."""
    if isinstance(reduce_to, EndEntry):
        return reduce_to
    body, dot, point = reduce_to.partition(".")
    return EndEntry.model_construct(body=body, at=point) if dot else None


def find_point(body: f.BodyEntry, point: object) -> m.Vec | None:
    """Return a point given by coordinates or by name, in body axes."""
    return body.points.get(point) if isinstance(point, str) else point  # type: ignore[return-value]


# Motors

RATE_EXPRESSION = Expression(source="rate", constant=None, uses=((OWN, "rate"),), code=(VAR, 1))


def make_torque_curve(motor: fl.MotorEntry) -> Expression:
    """Return the motor's torque over its own speed: the given curve, or the line from stall to no-load speed."""
    if motor.curve is not None:
        return motor.curve
    assert motor.stall is not None
    assert motor.idle is not None
    return add_expressions(
        Expression.from_number(motor.stall),
        multiply_expressions(Expression.from_number(-motor.stall / motor.idle), RATE_EXPRESSION),
    )


def rotor_name(motor: str) -> str:
    """Return the name of a motor's rotor, of its pin and of its gear."""
    return f"{motor}_rotor"


class Rotors(NamedTuple):
    """The bodies, joints and couplings that represent the rotors of a scene, by name, and their locations."""

    bodies: dict[str, m.Body[m.Vec, loads.Matrix]]
    joints: dict[str, m.Joint[str, m.Vec]]
    couplings: dict[str, c.Coupling]
    locations: dict[str, SourceLocation]


def iter_rotor_motors(document: f.Document) -> Iterator[tuple[str, fl.MotorEntry]]:
    """Yield the motors of a document that have a rotor, with their names."""
    for name, load in document.forces.items():
        if isinstance(load, fl.MotorEntry) and load.rotor is not None:
            yield name, load


def make_rotors(
    document: f.Document, joints: Mapping[str, m.Joint[str, m.Vec]], locations: Mapping[str, SourceLocation]
) -> Rotors:
    """Make the parts that represent the rotors of a scene.

    joints: all other joints
    """
    found = Rotors({}, {}, {}, {})
    for motor, load in iter_rotor_motors(document):
        name, joint = rotor_name(motor), joints[load.joint]
        assert load.rotor is not None
        found.bodies[name] = make_disc(name, load.rotor, joint.axis)
        found.joints[name] = make_pin(name, joint)
        terms = c.Term(name, "angle", 1.0), c.Term(load.joint, "angle", -load.ratio)
        found.couplings[name] = c.Ratio(terms)
        if (location := locations.get(f"forces.{motor}")) is not None:
            found.locations.update((f"{block}.{name}", location) for block in ("bodies", "joints", "couplings"))
    return found


def make_disc(name: str, rotor: fl.RotorEntry, axis: m.Vec) -> m.Body[m.Vec, loads.Matrix]:
    """Make a thin disc about an axis; its inertia about a diameter is half of that about the axis."""
    n = unit_vector(axis)
    rows: Any = tuple(tuple(0.5 * rotor.inertia * ((i == k) + n[i] * n[k]) for k in range(3)) for i in range(3))
    unset: dict[str, Any] = dict.fromkeys(
        ("position", "rotation", "velocity", "angular_velocity", "near_position", "near_rotation")
    )
    return m.Body(name=name, mass=rotor.mass, center=m.ZERO, inertia=rows, points={}, **unset)


def make_pin(name: str, joint: m.Joint[str, m.Vec]) -> m.Joint[str, m.Vec]:
    """Make a pin in the body `from` of a joint, coaxial with the joint."""
    unset: dict[str, Any] = dict.fromkeys(("angle", "rate", "travel", "speed", "length", "stiffness", "drive"))
    return m.Joint(
        name=name,
        kind="pin",
        a=joint.a,
        p=joint.p,
        b=name,
        q=m.ZERO,
        axis=joint.axis,
        to_axis=joint.axis,
        to_axis_given=False,
        tension_only=False,
        p_name=joint.p_name,
        **unset,
    )
