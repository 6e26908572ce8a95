"""Resolve the loads of a document: what each kind of entry means, in SI.

A kind whose value is known where it acts needs no meaning of its own: between two points it is an Actuator, in a joint
a Torque, under its own name; its law may name the length and rate of its line, or the coordinates of its joint.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from heuncli.scene.expressions.composition import (
    add_expressions,
    limit_magnitude,
    multiply_expressions,
    rename_coordinates,
    scale_coordinate,
)
from heuncli.scene.expressions.programs import LOADS, OWN, Expression
from heuncli.scene.file_format import format_loads as fl
from heuncli.scene.file_format import loads
from heuncli.scene.file_format import models as m
from heuncli.scene.file_format.resolve_couplings import ReferenceResolver
from heuncli.scene.file_format.rotations import IDENTITY
from heuncli.scene.file_format.semantics import find_point, make_torque_curve, orientation_matrix


def resolve_load(resolver: ReferenceResolver, name: str, load: fl.LoadEntry) -> m.Force:
    """Resolve an entry of `forces`; `name` gives the locations of its expressions."""
    resolved: m.Force = MEANINGS[load.type](resolver, name, load)
    return resolved


def resolve_force(resolver: ReferenceResolver, name: str, load: fl.ForceEntry) -> loads.PointForce:
    """Resolve a force at a point."""
    return loads.PointForce(resolver.end(load.on), resolver.attach_locations(load.vector, f"forces.{name}"), load.frame)


def resolve_couple(resolver: ReferenceResolver, name: str, load: fl.CoupleEntry) -> loads.Couple:
    """Resolve a couple on a body."""
    on = resolver.end(load.on) if load.on.at is not None else None
    return loads.Couple(load.on.body, on, resolver.attach_locations(load.vector, f"forces.{name}"), load.frame)


def resolve_torque(resolver: ReferenceResolver, name: str, load: fl.TorqueEntry) -> loads.Torque:
    """Resolve a torque about a pin's axis or a thrust along a slide's."""
    return loads.Torque(load.joint, resolver.attach_location(load.value, f"forces.{name}.value"))


def resolve_actuator(resolver: ReferenceResolver, name: str, load: fl.ActuatorEntry) -> loads.Actuator:
    """Resolve a given force between two points."""
    value = resolver.attach_location(load.value, f"forces.{name}.value")
    return loads.Actuator(resolver.end(load.from_), resolver.end(load.to), value)


def resolve_spring(resolver: ReferenceResolver, name: str, load: fl.SpringEntry) -> loads.Spring:
    """Resolve a spring between two points, by its numbers or by its law."""
    law = bind_law(resolver, load.force, f"forces.{name}.force", f"{LOADS}.{name}")
    numbers = load.stiffness or 0.0, load.length or 0.0, load.damping or 0.0
    return loads.Spring(resolver.end(load.from_), resolver.end(load.to), *numbers, law)


def resolve_turn_spring(resolver: ReferenceResolver, name: str, load: fl.TurnSpringEntry) -> loads.TurnSpring:
    """Resolve a spring in a joint, by its numbers or by its law."""
    law = bind_law(resolver, load.torque, f"forces.{name}.torque", load.joint)
    return loads.TurnSpring(load.joint, load.stiffness or 0.0, load.angle or 0.0, load.damping or 0.0, law)


def resolve_damper(resolver: ReferenceResolver, name: str, load: fl.DamperEntry) -> loads.Damper:
    """Resolve a damper in a joint, by its coefficients or by its law."""
    coefficient = constant_value(load.coefficient) if load.coefficient is not None else 0.0
    torque, force = (
        bind_law(resolver, getattr(load, k), f"forces.{name}.{k}", load.joint) for k in ("torque", "force")
    )
    return loads.Damper(load.joint, coefficient, load.sliding, torque or force)


def resolve_friction(resolver: ReferenceResolver, name: str, load: fl.FrictionEntry) -> loads.Friction:
    """Resolve friction in a joint."""
    torque, force = (
        resolver.attach_location(value, f"forces.{name}.{k}") if (value := getattr(load, k)) is not None else None
        for k in ("torque", "force")
    )
    speed, static = (None if value is None else constant_value(value) for value in (load.speed, load.static))
    return loads.Friction(load.joint, torque, force, speed, load.coefficient, static, load.radius, load.length)


def resolve_motor(resolver: ReferenceResolver, name: str, load: fl.MotorEntry) -> loads.Torque:
    """Resolve a motor: ratio * value * curve(ratio * rate), within the limit of the motor itself."""
    path = f"forces.{name}"
    curve = resolver.attach_location(make_torque_curve(load), f"{path}.curve")
    law = scale_coordinate(curve, (OWN, "rate"), load.ratio)
    law = limit_magnitude(law, load.limit) if load.limit is not None else law
    if load.value is not None:
        law = multiply_expressions(resolver.attach_location(load.value, f"{path}.value"), law)
    bound = bind_law(
        resolver, multiply_expressions(Expression.from_number(load.ratio), law), f"{path}.curve", load.joint
    )
    assert bound is not None
    return loads.Torque(load.joint, bound, load.type)


def resolve_distributed(resolver: ReferenceResolver, name: str, load: fl.DistributedEntry) -> loads.Distributed:
    """Resolve a load along a line on a body."""
    body, path = resolver.document.bodies[load.on], f"forces.{name}"
    start, end = find_point(body, load.from_), find_point(body, load.to)
    assert start is not None
    assert end is not None
    vector = resolver.attach_locations(load.vector, path)
    to_vector = vector if load.to_vector is None else resolver.attach_locations(load.to_vector, path, "to_vector")
    return loads.Distributed(load.on, start, end, vector, to_vector, load.frame)


def resolve_bushing(resolver: ReferenceResolver, name: str, load: fl.BushingEntry) -> loads.Bushing:
    """Resolve a bushing between two bodies."""
    rotation = orientation_matrix(load.orientation) if load.orientation is not None else IDENTITY
    to_rotation = orientation_matrix(load.to_orientation) if load.to_orientation is not None else rotation
    shift = make_elastic(resolver, name, "shift", load.stiffness, load.damping, load.preload)
    turn = make_elastic(resolver, name, "turn", load.turning, load.turning_damping, load.turning_preload)
    return loads.Bushing(
        resolver.end(load.from_), resolver.end(load.to), shift, turn, rotation, to_rotation,
        load.coupling or loads.ZERO_MATRIX, load.coupling_damping or loads.ZERO_MATRIX,
    )  # fmt: skip


MEANINGS: dict[str, Callable[..., m.Force]] = {
    "force": resolve_force,
    "couple": resolve_couple,
    "torque": resolve_torque,
    "actuator": resolve_actuator,
    "spring": resolve_spring,
    "turn_spring": resolve_turn_spring,
    "distributed": resolve_distributed,
    "damper": resolve_damper,
    "friction": resolve_friction,
    "motor": resolve_motor,
    "bushing": resolve_bushing,
}


def bind_law(resolver: ReferenceResolver, law: Expression | None, path: str, owner: str) -> Expression | None:
    """Bind a load's law to its own variables: the length of its line, or the coordinate of its joint."""
    if law is None:
        return None
    own = {use: (owner, use[1]) for use in law.uses if use[0] == OWN}
    return rename_coordinates(resolver.attach_location(law, path), own)


def make_elastic(
    resolver: ReferenceResolver, name: str, motion: str, stiffness: Any, damping: Any, preload: m.Vec | None
) -> loads.Elastic[m.Vec, loads.Matrix]:
    """Make the springs of a bushing's translation or rotation.

    motion: "shift" or "turn". An axis without a constant stiffness has a table; a matrix has none.
    """
    laws = [] if is_matrix(stiffness) else add_table_areas(expand_to_axes(stiffness))
    preload = preload or m.ZERO
    extra_load = [Expression.from_number(x) for x in preload]
    numbers = stiffness if is_matrix(stiffness) else tuple(0.0 if isinstance(x, Expression) else x for x in laws)
    path = f"forces.{name}.{'stiffness' if motion == 'shift' else 'turning'}"
    for i, law in enumerate(laws):
        if isinstance(law, Expression):
            law_of_axis = rename_coordinates(
                resolver.attach_location(law, path), {law.uses[0]: (f"{LOADS}.{name}", f"{motion}_{'xyz'[i]}")}
            )
            extra_load[i] = add_expressions(extra_load[i], law_of_axis)
    return loads.Elastic(
        make_symmetric_matrix(numbers),
        make_symmetric_matrix(damping),
        preload,
        (extra_load[0], extra_load[1], extra_load[2]),
    )


def add_table_areas(laws: tuple[Any, Any, Any]) -> list[Any]:
    """Return the stiffness laws, tables extended by their areas; a table used for several axes is extended once."""
    if not any(isinstance(law, Expression) for law in laws):
        return list(laws)
    from heuncli.scene.expressions.curves import append_areas  # needs NumPy, which a table has loaded already

    tables_with_areas = {id(law): append_areas(law) for law in laws if isinstance(law, Expression)}
    return [tables_with_areas.get(id(law), law) for law in laws]


def expand_to_axes(value: Any) -> tuple[Any, Any, Any]:
    """Expand a value to three axes: one value for all, a list, or values by axis name; None is zero."""
    if value is None:
        return m.ZERO
    if isinstance(value, fl.ShiftLaws | fl.TurnLaws):
        return value.x, value.y, value.z
    return value if isinstance(value, tuple) else (value, value, value)


def is_matrix(value: Any) -> bool:
    """Whether a value of a bushing is given in rows."""
    return isinstance(value, tuple) and isinstance(value[0], tuple)


def make_symmetric_matrix(value: Any) -> loads.Matrix:
    """Make the matrix of a stiffness or damping without tables: the symmetric part of one, or a diagonal one."""
    if is_matrix(value):
        rows = tuple(tuple(0.5 * (value[i][j] + value[j][i]) for j in range(3)) for i in range(3))
        return rows[0], rows[1], rows[2]
    x, y, z = expand_to_axes(value)
    return (x, 0.0, 0.0), (0.0, y, 0.0), (0.0, 0.0, z)


def constant_value(value: Expression) -> float:
    """Return the number of an expression that depends on nothing."""
    assert value.constant is not None
    return value.constant
