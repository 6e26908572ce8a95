"""What motors are made of: their torque over their speed, and their rotors.

A rotor is a body of its own: a thin disc about the axis of the motor's joint, on a pin in the body `from`, and a ratio
that ties it to the joint. So its inertia, its gyroscopic moments, and what its gear does to the housing are those of
bodies.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from heuncli.base.errors import SourceLocation
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.expressions.composed import product, total
from heuncli.scene.expressions.programs import OWN, VAR, Expression
from heuncli.scene.file_format import couplings as c
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_elastic as fe
from heuncli.scene.file_format import models as m
from heuncli.scene.file_format.turns import unit

RATE = Expression(source="rate", constant=None, uses=((OWN, "rate"),), code=(VAR, 1))


def curve_of(motor: fe.MotorEntry) -> Expression:
    """Its torque over its own speed: the curve, or the line from standstill to where it idles."""
    if motor.curve is not None:
        return motor.curve
    assert motor.stall is not None
    assert motor.idle is not None
    return total(Expression.of(motor.stall), product(Expression.of(-motor.stall / motor.idle), RATE))


def rotor_of(motor: str) -> str:
    """The name of a motor's rotor, of its pin and of its gear."""
    return f"{motor}_rotor"


class Rotors(NamedTuple):
    """The bodies, joints and couplings that the rotors of a scene are, by their names, and where these are written."""

    bodies: dict[str, m.Body[m.Vec, m.Matrix]]
    joints: dict[str, m.Joint[str, m.Vec]]
    couplings: dict[str, c.Coupling]
    locations: dict[str, SourceLocation]


def with_rotors(document: f.Document) -> Iterator[tuple[str, fe.MotorEntry]]:
    """The motors of a document that have a rotor, by their names."""
    for name, load in document.forces.items():
        if isinstance(load, fe.MotorEntry) and load.rotor is not None:
            yield name, load


def rotors(
    document: f.Document, joints: Mapping[str, m.Joint[str, m.Vec]], locations: Mapping[str, SourceLocation]
) -> Rotors:
    """What the rotors of a scene are; joints: all others."""
    found = Rotors({}, {}, {}, {})
    for motor, load in with_rotors(document):
        name, joint = rotor_of(motor), joints[load.joint]
        assert load.rotor is not None
        found.bodies[name] = disc(name, load.rotor, joint.axis)
        found.joints[name] = pin(name, joint)
        terms = c.Term(name, "angle", 1.0), c.Term(load.joint, "angle", -load.ratio)
        found.couplings[name] = c.Ratio(terms)
        if (location := locations.get(f"forces.{motor}")) is not None:
            found.locations.update((f"{block}.{name}", location) for block in ("bodies", "joints", "couplings"))
    return found


def disc(name: str, rotor: fe.RotorEntry, axis: m.Vec) -> m.Body[m.Vec, m.Matrix]:
    """A thin disc about an axis, half of its inertia across."""
    n = unit(axis)
    rows: Any = tuple(tuple(0.5 * rotor.inertia * ((i == k) + n[i] * n[k]) for k in range(3)) for i in range(3))
    nothing: dict[str, Any] = dict.fromkeys(
        ("position", "rotation", "velocity", "angular_velocity", "near_position", "near_rotation")
    )
    return m.Body(name=name, mass=rotor.mass, center=m.ZERO, inertia=rows, points={}, **nothing)


def pin(name: str, of: m.Joint[str, m.Vec]) -> m.Joint[str, m.Vec]:
    """A pin in the body `from` of a joint, in line with it."""
    nothing: dict[str, Any] = dict.fromkeys(("angle", "rate", "travel", "speed", "length", "stiffness", "drive"))
    return m.Joint(
        name=name, kind="pin", a=of.a, p=of.p, b=name, q=m.ZERO, axis=of.axis, to_axis=of.axis, to_axis_given=False,
        tension_only=False, p_name=of.p_name, **nothing,
    )  # fmt: skip
