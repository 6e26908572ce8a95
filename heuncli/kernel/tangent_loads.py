"""The change of applied loads and of closure rows along a direction of the state: loads.py and closures.py,
differentiated line by line.

Each load is applied to the bodies by reducing the loads that they need from their joints (d.M, d.f of BodyTangent). The
load itself is in the scene as found at the state.

    d(J Vdot + gamma)      at the present accelerations: the demand on the response to the direction
    d(J' lambda)           at the present multipliers: applied to the bodies as loads are
"""

from __future__ import annotations

from math import tanh

from heuncli.kernel.bushings import bushing_tangent
from heuncli.kernel.carried_points import body_omega
from heuncli.kernel.conditions import condition, condition_count, condition_tangent
from heuncli.kernel.declarations import *
from heuncli.kernel.jets import slope
from heuncli.kernel.kinematics import locate_point
from heuncli.kernel.libm import NAN
from heuncli.kernel.loads import (
    acts_about_axis,
    bushing_rates,
    evaluate_load_vector,
    is_bushing,
    is_friction,
    slides_in_joint,
    sliding_velocity,
)
from heuncli.kernel.strains import line_tangent, rope_power_tangent, rope_tangent
from heuncli.kernel.tangent_motion import omega_tangent, point_tangent, vector_tangent


def add_load_tangents(scene: cython.pointer[Scene]) -> cython.double:
    """Apply the changes of all loads to the bodies. Returns the change of the power of those without potential."""
    i: cython.Py_ssize_t
    power: cython.double = 0.0
    for i in range(scene.load_count):
        load: cython.pointer[Load] = cython.address(scene.loads[i])
        if load.kind == ROPE:
            power += add_rope_tangent(scene, load, load_vector_tangent(scene, load).x)
            continue
        is_still_load: cython.bint = load.a < 0 or not scene.tangents[load.a].moves
        if load.b >= 0 and scene.tangents[load.b].moves:
            is_still_load = False
        if is_still_load and not scene.has_slopes:
            continue
        point: PointMotion = point_tangent(scene, load.b, load.q)
        vector: Vec3 = load_vector_tangent(scene, load)
        if load.kind == FORCE or load.kind == COUPLE:
            power += add_outer_load_tangent(scene, load, vector, point)
        elif load.kind == SPRING or load.kind == ACTUATOR:
            power += add_pair_load_tangent(scene, load, vector.x, point)
        elif is_bushing(load):
            power += add_bushing_tangent(scene, load, vector, point)
        else:
            power += add_joint_load_tangent(scene, load, vector.x, point)
    return power


def load_vector_tangent(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return the change of the load's components, which are expressions in coordinates and rates."""
    if not scene.has_slopes:
        return Vec3(0.0, 0.0, 0.0)
    return Vec3(
        slope(scene.programs, load.x, scene.slopes) if load.x.count else 0.0,
        slope(scene.programs, load.y, scene.slopes) if load.y.count else 0.0,
        slope(scene.programs, load.z, scene.slopes) if load.z.count else 0.0,
    )


def push_load_tangent(
    scene: cython.pointer[Scene], body: cython.int, place: Vec3, force: Vec3, d: LoadTangent
) -> cython.void:
    """Apply the change of a force at a place, and of a moment, to a body; the ground ignores it."""
    if body >= 0:
        target: cython.pointer[BodyTangent] = cython.address(scene.tangents[body])
        moment: Vec3 = add_cross(d.moment, sub(place, scene.bodies[body].r), d.force)
        target.M = sub(target.M, add_cross(moment, sub(d.place, target.r), force))
        target.f = sub(target.f, d.force)


def opposite_load(d: LoadTangent) -> LoadTangent:
    """Return the change of the opposite load at the same place."""
    return LoadTangent(d.place, scale_vector(-1.0, d.force), scale_vector(-1.0, d.moment))


def add_outer_load_tangent(
    scene: cython.pointer[Scene], load: cython.pointer[Load], vector_change: Vec3, point: PointMotion
) -> cython.double:
    """Apply the change of a force on a point, or a couple, from outside the system. Returns the change of its power."""
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    load_on_b: Vec3 = load.force if load.kind == FORCE else load.moment
    change: Vec3 = scale_vector(
        load.factor, world_direction(scene, load.b, vector_change) if load.in_body else vector_change
    )
    if load.in_body:
        change = add(change, vector_tangent(scene, load.b, load_on_b))
    if load.kind == FORCE:
        push_load_tangent(scene, load.b, load.place, load_on_b, LoadTangent(point.x, change, zero))
        return dot(change, locate_point(scene, load.b, load.q).v) + dot(load_on_b, point.v)
    push_load_tangent(scene, load.b, load.place, zero, LoadTangent(point.x, zero, change))
    if load.b < 0:
        return 0.0
    return dot(change, scene.bodies[load.b].omega) + dot(load_on_b, scene.tangents[load.b].omega)


def add_pair_load_tangent(
    scene: cython.pointer[Scene], load: cython.pointer[Load], value_change: cython.double, point: PointMotion
) -> cython.double:
    """Apply the change of a spring or actuator along the line n between two points. Returns the change of the power of
    damping or drive.

    dF = -k dl - c d(ldot).
    """
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    power: cython.double = 0.0
    force: Vec3 = zero
    if load.a == load.b:
        return 0.0
    start_point: PointMotion = point_tangent(scene, load.a, load.p)
    if load.span > 0.0:
        line: LineTangent = line_tangent(scene, load)
        F: cython.double = value_change
        if load.kind == SPRING:
            F = -load.stiffness * line.length - load.coefficient * line.rate
            power = -2.0 * load.coefficient * load.rate * line.rate
        else:
            power = value_change * load.rate + load.value * line.rate
        force = add_scaled(scale_vector(F / load.span, sub(load.place, load.place_on_a)), load.value, line.turned)
    elif load.kind == SPRING and load.length == 0.0:  # the force to first order where the points coincide
        force = scale_vector(-load.stiffness, sub(point.x, start_point.x))
    d: LoadTangent = LoadTangent(point.x, force, zero)
    push_load_tangent(scene, load.b, load.place, load.force, d)
    d = opposite_load(LoadTangent(start_point.x, force, zero))
    push_load_tangent(scene, load.a, load.place_on_a, scale_vector(-1.0, load.force), d)
    return power


def add_joint_load_tangent(
    scene: cython.pointer[Scene], load: cython.pointer[Load], value_change: cython.double, point: PointMotion
) -> cython.double:
    """Apply the change of a torque, thrust or spring about or along the joint's axis, or of a damper or friction.
    Returns the change of its power.
    """
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    axis: Vec3 = world_direction(scene, load.a, load.axis)
    slides: cython.bint = slides_in_joint(load)
    motion: Vec3 = sub(body_omega(scene, load.b), body_omega(scene, load.a))
    change: Vec3 = sub(omega_tangent(scene, load.b), omega_tangent(scene, load.a))
    if slides:
        motion = sliding_velocity(scene, load, locate_point(scene, load.b, load.q).v)
        change = sliding_velocity_tangent(scene, load, point)
    power: cython.double
    load_on_b: Vec3
    if acts_about_axis(load):
        axis_change: Vec3 = vector_tangent(scene, load.a, axis)
        rate: cython.double = dot(change, axis) + dot(motion, axis_change)
        F: cython.double = value_change
        power = value_change * load.rate + load.value * rate
        if load.kind == TURN_SPRING:
            F = -load.stiffness * turn_spring_angle_tangent(scene, load) - load.coefficient * rate
            power = -2.0 * load.coefficient * load.rate * rate
        load_on_b = add_scaled(scale_vector(F, axis), load.value, axis_change)
    elif load.breakaway > 0.0:  # of a given size and sign, or a closure's load
        axis_turn: Vec3 = vector_tangent(scene, load.a, axis)
        load_on_b = scale_vector(load.value, axis_turn)
        power = load.value * (dot(change, axis) + dot(motion, axis_turn))
    else:
        speed: cython.double = norm(motion)
        speed_change: cython.double = dot(motion, change) / speed if speed > 0.0 else 0.0
        resistance_factor: cython.double = resistance_per_speed(load, speed)
        factor_change: cython.double = resistance_slope(load, speed) * speed_change
        load_on_b = add_scaled(scale_vector(-resistance_factor, change), -factor_change, motion)
        power = -factor_change * speed * speed - 2.0 * resistance_factor * speed * speed_change
    d: LoadTangent = LoadTangent(point.x, load_on_b, zero) if slides else LoadTangent(point.x, zero, load_on_b)
    if load.kind == THREAD_FRICTION:
        d = LoadTangent(point.x, scale_vector(load.factor, load_on_b), load_on_b)
        power += dot(d.force, sliding_velocity(scene, load, locate_point(scene, load.b, load.q).v))
        power += dot(load.force, sliding_velocity_tangent(scene, load, point))
    push_load_tangent(scene, load.b, load.place, load.force, d)
    push_load_tangent(scene, load.a, load.place, scale_vector(-1.0, load.force), opposite_load(d))
    return power


def add_bushing_tangent(
    scene: cython.pointer[Scene], load: cython.pointer[Load], preload_change: Vec3, point: PointMotion
) -> cython.double:
    """Apply the change of a bushing between two bodies. Returns the change of the power of what has no potential."""
    if load.a == load.b:
        return 0.0
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    slides: cython.bint = load.kind == BUSHING_SHIFT
    rates: BushingRates = bushing_rates(scene, load, locate_point(scene, load.b, load.q).v)
    turning_change: Vec3 = sub(omega_tangent(scene, load.b), omega_tangent(scene, load.a))
    changes: BushingRates = BushingRates(turning_change, zero)
    if slides or load.is_coupled:
        sliding_change: Vec3 = sliding_velocity_tangent(scene, load, point)
        changes = (
            BushingRates(sliding_change, turning_change) if slides else BushingRates(turning_change, sliding_change)
        )
    tangent_of_load: BushingTangent = bushing_tangent(
        scene, load, evaluate_load_vector(scene, load), preload_change, rates, changes
    )
    d: LoadTangent = (
        LoadTangent(point.x, tangent_of_load.acts, zero) if slides else LoadTangent(point.x, zero, tangent_of_load.acts)
    )
    push_load_tangent(scene, load.b, load.place, load.force, d)
    push_load_tangent(scene, load.a, load.place, scale_vector(-1.0, load.force), opposite_load(d))
    return tangent_of_load.power


def add_rope_tangent(scene: cython.pointer[Scene], load: cython.pointer[Load], change: cython.double) -> cython.double:
    """Apply the change of a rope's `value`, and of the unit loads of its parts. Returns the change of the power of what
    has no potential.
    """
    i: cython.Py_ssize_t
    for i in range(load.part, load.part + load.part_count):
        part: cython.pointer[Closure] = cython.address(scene.parts[i])
        d: RowTangent = condition_tangent(scene, part)
        pull: cython.double = load.value * part.factor
        force: Vec3 = add_scaled(scale_vector(pull, d.f), change * part.factor, part.f)
        moment: Vec3 = add_scaled(scale_vector(pull, d.m), change * part.factor, part.m)
        part_change: LoadTangent = LoadTangent(d.Q, force, moment)
        push_load_tangent(scene, part.b, part.Q, scale_vector(pull, part.f), part_change)
        push_load_tangent(scene, part.a, part.Q, scale_vector(-pull, part.f), opposite_load(part_change))
    return rope_power_tangent(scene, load, change, rope_tangent(scene, load))


def sliding_velocity_tangent(scene: cython.pointer[Scene], load: cython.pointer[Load], point: PointMotion) -> Vec3:
    """Return the change of the velocity of b's point as seen from a."""
    if load.a < 0:
        return point.v
    a: cython.pointer[Body] = cython.address(scene.bodies[load.a])
    carrier_tangent: cython.pointer[BodyTangent] = cython.address(scene.tangents[load.a])
    arm: Vec3 = sub(load.place, a.r)
    swept: Vec3 = add_cross(cross(carrier_tangent.omega, arm), a.omega, sub(point.x, carrier_tangent.r))
    return sub(sub(point.v, swept), carrier_tangent.v)


def turn_spring_angle_tangent(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.double:
    """Return the change of the angle of a turn spring: a coordinate, or for a cut joint the angle between the bodies'
    axes.

    phi = atan2(y, x) of y = n . (reference x marker), x = reference . marker:   (x^2 + y^2) dphi = x dy - y dx.
    """
    if load.freedom >= 0:
        return scene.freedom_tangents[load.freedom].q
    if load.counter < 0:
        return 0.0
    n: Vec3 = world_direction(scene, load.a, load.axis)
    reference: Vec3 = world_direction(scene, load.a, load.mark_a)
    marker: Vec3 = world_direction(scene, load.b, load.mark_b)
    reference_change: Vec3 = vector_tangent(scene, load.a, reference)
    marker_change: Vec3 = vector_tangent(scene, load.b, marker)
    x: cython.double = dot(reference, marker)
    y: cython.double = dot(n, cross(reference, marker))
    dx: cython.double = dot(reference_change, marker) + dot(reference, marker_change)
    across: Vec3 = add_cross(cross(reference_change, marker), reference, marker_change)
    dy: cython.double = dot(vector_tangent(scene, load.a, n), cross(reference, marker)) + dot(n, across)
    square: cython.double = x * x + y * y
    return (x * dy - y * dx) / square if square > 0.0 else NAN


def resistance_per_speed(load: cython.pointer[Load], speed: cython.double) -> cython.double:
    """Return the load of a damper or friction, divided by the speed."""
    if not is_friction(load):
        return load.coefficient
    size: cython.double = load.coefficient * load.normal_force
    if speed > 0.0:
        return size * tanh(speed / load.speed) / speed
    return size / load.speed


def resistance_slope(load: cython.pointer[Load], speed: cython.double) -> cython.double:
    """Return the derivative of `resistance_per_speed` by the speed; for friction (F (1 - tanh^2) / v0 - F tanh / v) /
    v.
    """
    if not is_friction(load) or not speed > 0.0:
        return 0.0
    f: cython.double = tanh(speed / load.speed)
    size: cython.double = load.coefficient * load.normal_force
    return size * ((1.0 - f * f) / load.speed - f / speed) / speed


def add_closure_tangents(scene: cython.pointer[Scene]) -> cython.void:
    """Set the demands of the independent rows; apply the changes of their multipliers' loads to the bodies."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    for i in range(scene.selected_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.selected[i]])
        force: cython.double = scene.multipliers[scene.selected[i]]
        row.demand = 0.0
        for k in range(condition_count(row)):
            part: cython.pointer[Closure] = condition(scene, row, k)
            row.demand += part.factor * add_condition_tangent(scene, part, force * part.factor)


def add_condition_tangent(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], force: cython.double
) -> cython.double:
    """Return the demand of a condition between two bodies; apply the change of its load to them."""
    if (
        is_motion_unchanged(scene, row.a)
        and is_motion_unchanged(scene, row.b)
        and is_motion_unchanged(scene, row.c if row.kind == MESH or row.kind == CAM else -1)
    ):
        return 0.0
    d: RowTangent = condition_tangent(scene, row)
    load: LoadTangent = LoadTangent(d.Q, scale_vector(force, d.f), scale_vector(force, d.m))
    push_load_tangent(scene, row.b, row.Q, scale_vector(force, row.f), load)
    push_load_tangent(scene, row.a, row.Q, scale_vector(-force, row.f), opposite_load(load))
    return d.acceleration


def is_motion_unchanged(scene: cython.pointer[Scene], body: cython.int) -> cython.bint:
    """Return whether nothing of a body's motion changes."""
    return body < 0 or not scene.tangents[body].moves


def row_tangent(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> RowTangent:
    """Return the change of one row: its place and unit load, its rate and its acceleration J Vdot + gamma."""
    k: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    total: RowTangent = RowTangent(zero, zero, zero, 0.0, 0.0)
    for k in range(condition_count(row)):
        part: cython.pointer[Closure] = condition(scene, row, k)
        d: RowTangent = condition_tangent(scene, part)
        f: Vec3 = add_scaled(total.f, part.factor, d.f)
        m: Vec3 = add_scaled(total.m, part.factor, d.m)
        rate: cython.double = total.rate + part.factor * d.rate
        total = RowTangent(d.Q, f, m, rate, total.acceleration + part.factor * d.acceleration)
    return total
