"""Make the parts of motors: their torque over speed, and their rotors.

A rotor is a body of its own: a thin disc about the axis of the motor's joint, on a pin in the body `from`, coupled to
the joint by a ratio. So its inertia, its gyroscopic moments and the reaction of its gear on the housing follow from the
mechanics of bodies.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from heuncli.base.errors import SourceLocation
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.expressions.composition import add_expressions, multiply_expressions
from heuncli.scene.expressions.programs import OWN, VAR, Expression
from heuncli.scene.file_format import couplings as c
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_elastic as fe
from heuncli.scene.file_format import models as m
from heuncli.scene.file_format.rotations import unit_vector

RATE_EXPRESSION = Expression(source="rate", constant=None, uses=((OWN, "rate"),), code=(VAR, 1))


def make_torque_curve(motor: fe.MotorEntry) -> Expression:
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

    bodies: dict[str, m.Body[m.Vec, m.Matrix]]
    joints: dict[str, m.Joint[str, m.Vec]]
    couplings: dict[str, c.Coupling]
    locations: dict[str, SourceLocation]


def iter_rotor_motors(document: f.Document) -> Iterator[tuple[str, fe.MotorEntry]]:
    """Yield the motors of a document that have a rotor, with their names."""
    for name, load in document.forces.items():
        if isinstance(load, fe.MotorEntry) and load.rotor is not None:
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


def make_disc(name: str, rotor: fe.RotorEntry, axis: m.Vec) -> m.Body[m.Vec, m.Matrix]:
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
