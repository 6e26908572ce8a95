"""What applied loads change by along a direction of the state: loads.py, differentiated line by line.

Each is put on the bodies (d.M, d.f of BodyTangent) as less of what they ask of their joints. The load itself stands in
the scene as it was found at the state.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import tanh

    from heuncli.kernel.algebra import Vec3, add, add_cross, add_scaled, cross, dot, norm, scaled, sub
    from heuncli.kernel.directions import direction_of
    from heuncli.kernel.jets import slope
    from heuncli.kernel.libm import NAN
    from heuncli.kernel.loads import motion_in, omega_of, sliding_in
    from heuncli.kernel.scene import (
        ACTUATOR,
        BUSHING_SHIFT,
        COUPLE,
        FORCE,
        ROPE,
        SHIFT_DAMPER,
        SHIFT_FRICTION,
        SPRING,
        THREAD_FRICTION,
        THRUST,
        TURN_FRICTION,
        TURN_SPRING,
        Body,
        BodyTangent,
        Closure,
        Load,
        Scene,
    )
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.tangent_bushings import bushing_along
    from heuncli.kernel.tangent_conditions import condition_along
    from heuncli.kernel.tangent_motion import omega_along, point_along, swung
    from heuncli.kernel.tangent_ropes import rope_along, rope_power_along
    from heuncli.kernel.tangent_strains import line_along
    from heuncli.kernel.tree import point_of
    from heuncli.kernel.values import BushingTangent, LineTangent, LoadTangent, PointMotion, RowTangent


def loads_along(scene: cython.pointer[Scene]) -> cython.double:
    """Put what all loads change by on the bodies; what the power of those without potential changes by."""
    i: cython.Py_ssize_t
    power: cython.double = 0.0
    for i in range(scene.load_count):
        load: cython.pointer[Load] = cython.address(scene.loads[i])
        if load.kind == ROPE:
            power += pull_changed(scene, load, given_along(scene, load).x)
            continue
        still: cython.bint = load.a < 0 or not scene.tangents[load.a].moves
        if load.b >= 0 and scene.tangents[load.b].moves:
            still = False
        if still and not scene.sloping:
            continue
        there: PointMotion = point_along(scene, load.b, load.q)
        given: Vec3 = given_along(scene, load)
        if load.kind == FORCE or load.kind == COUPLE:
            power += outer_along(scene, load, given, there)
        elif load.kind == SPRING or load.kind == ACTUATOR:
            power += pair_along(scene, load, given.x, there)
        elif load.kind >= BUSHING_SHIFT:
            power += elastic_along(scene, load, given, there)
        else:
            power += joint_along(scene, load, given.x, there)
    return power


def given_along(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Of the load's given components: expressions in coordinates and rates."""
    if not scene.sloping:
        return Vec3(0.0, 0.0, 0.0)
    return Vec3(
        slope(scene.programs, load.x, scene.slopes) if load.x.count else 0.0,
        slope(scene.programs, load.y, scene.slopes) if load.y.count else 0.0,
        slope(scene.programs, load.z, scene.slopes) if load.z.count else 0.0,
    )


def push_along(scene: cython.pointer[Scene], body: cython.int, at: Vec3, force: Vec3, d: LoadTangent) -> cython.void:
    """Put what a force at a place, and a moment, change by on a body; the ground takes them silently."""
    if body >= 0:
        on: cython.pointer[BodyTangent] = cython.address(scene.tangents[body])
        moment: Vec3 = add_cross(d.moment, sub(at, scene.bodies[body].r), d.force)
        on.M = sub(on.M, add_cross(moment, sub(d.at, on.r), force))
        on.f = sub(on.f, d.force)


def opposite(d: LoadTangent) -> LoadTangent:
    """Of the opposite load at the same place."""
    return LoadTangent(d.at, scaled(-1.0, d.force), scaled(-1.0, d.moment))


def outer_along(
    scene: cython.pointer[Scene], load: cython.pointer[Load], given: Vec3, there: PointMotion
) -> cython.double:
    """A force on a point, or a couple, from outside the system; what its power changes by."""
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    acts: Vec3 = load.force if load.kind == FORCE else load.moment
    change: Vec3 = scaled(load.factor, direction_of(scene, load.b, given) if load.in_body else given)
    if load.in_body:
        change = add(change, swung(scene, load.b, acts))
    if load.kind == FORCE:
        push_along(scene, load.b, load.at, acts, LoadTangent(there.x, change, zero))
        return dot(change, point_of(scene, load.b, load.q).v) + dot(acts, there.v)
    push_along(scene, load.b, load.at, zero, LoadTangent(there.x, zero, change))
    if load.b < 0:
        return 0.0
    return dot(change, scene.bodies[load.b].omega) + dot(acts, scene.tangents[load.b].omega)


def pair_along(
    scene: cython.pointer[Scene], load: cython.pointer[Load], given: cython.double, there: PointMotion
) -> cython.double:
    """A spring or actuator along the line n between two points; what the power of damping or drive changes by.

    dF = -k dl - c d(ldot).
    """
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    power: cython.double = 0.0
    force: Vec3 = zero
    if load.a == load.b:
        return 0.0
    here: PointMotion = point_along(scene, load.a, load.p)
    if load.span > 0.0:
        line: LineTangent = line_along(scene, load)
        F: cython.double = given
        if load.kind == SPRING:
            F = -load.stiffness * line.length - load.coefficient * line.rate
            power = -2.0 * load.coefficient * load.rate * line.rate
        else:
            power = given * load.rate + load.value * line.rate
        force = add_scaled(scaled(F / load.span, sub(load.at, load.from_at)), load.value, line.turned)
    elif load.kind == SPRING and load.length == 0.0:  # as the force begins where the points coincide
        force = scaled(-load.stiffness, sub(there.x, here.x))
    d: LoadTangent = LoadTangent(there.x, force, zero)
    push_along(scene, load.b, load.at, load.force, d)
    d = opposite(LoadTangent(here.x, force, zero))
    push_along(scene, load.a, load.from_at, scaled(-1.0, load.force), d)
    return power


def joint_along(
    scene: cython.pointer[Scene], load: cython.pointer[Load], given: cython.double, there: PointMotion
) -> cython.double:
    """A torque, thrust or spring about or along the joint's axis, a damper or friction; what its power changes by."""
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    axis: Vec3 = direction_of(scene, load.a, load.axis)
    slides: cython.bint = load.kind == THRUST or load.kind == SHIFT_DAMPER or load.kind == SHIFT_FRICTION
    motion: Vec3 = sub(omega_of(scene, load.b), omega_of(scene, load.a))
    change: Vec3 = sub(omega_along(scene, load.b), omega_along(scene, load.a))
    if slides:
        motion = sliding_in(scene, load, point_of(scene, load.b, load.q).v)
        change = sliding_along(scene, load, there)
    power: cython.double
    acts: Vec3
    if load.kind <= TURN_SPRING:
        turned: Vec3 = swung(scene, load.a, axis)
        rate: cython.double = dot(change, axis) + dot(motion, turned)
        F: cython.double = given
        power = given * load.rate + load.value * rate
        if load.kind == TURN_SPRING:
            F = -load.stiffness * angle_along(scene, load) - load.coefficient * rate
            power = -2.0 * load.coefficient * load.rate * rate
        acts = add_scaled(scaled(F, axis), load.value, turned)
    else:
        speed: cython.double = norm(motion)
        faster: cython.double = dot(motion, change) / speed if speed > 0.0 else 0.0
        against: cython.double = resistance(load, speed)
        more: cython.double = resistance_along(load, speed) * faster
        acts = add_scaled(scaled(-against, change), -more, motion)
        power = -more * speed * speed - 2.0 * against * speed * faster
    d: LoadTangent = LoadTangent(there.x, acts, zero) if slides else LoadTangent(there.x, zero, acts)
    if load.kind == THREAD_FRICTION:
        d = LoadTangent(there.x, scaled(load.factor, acts), acts)
        power += dot(d.force, sliding_in(scene, load, point_of(scene, load.b, load.q).v))
        power += dot(load.force, sliding_along(scene, load, there))
    push_along(scene, load.b, load.at, load.force, d)
    push_along(scene, load.a, load.at, scaled(-1.0, load.force), opposite(d))
    return power


def elastic_along(
    scene: cython.pointer[Scene], load: cython.pointer[Load], given: Vec3, there: PointMotion
) -> cython.double:
    """A bushing between two bodies; what the power of what has no potential changes by."""
    if load.a == load.b:
        return 0.0
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    slides: cython.bint = load.kind == BUSHING_SHIFT
    motion: Vec3 = motion_in(scene, load, point_of(scene, load.b, load.q).v, slides)
    change: Vec3 = sub(omega_along(scene, load.b), omega_along(scene, load.a))
    if slides:
        change = sliding_along(scene, load, there)
    found: BushingTangent = bushing_along(scene, load, given, motion, change)
    d: LoadTangent = LoadTangent(there.x, found.acts, zero) if slides else LoadTangent(there.x, zero, found.acts)
    push_along(scene, load.b, load.at, load.force, d)
    push_along(scene, load.a, load.at, scaled(-1.0, load.force), opposite(d))
    return found.power


def pull_changed(scene: cython.pointer[Scene], load: cython.pointer[Load], change: cython.double) -> cython.double:
    """A rope whose `value` changes, and the unit loads of its parts; what the power of what has no potential does."""
    i: cython.Py_ssize_t
    for i in range(load.part, load.part + load.part_count):
        part: cython.pointer[Closure] = cython.address(scene.parts[i])
        d: RowTangent = condition_along(scene, part)
        pull: cython.double = load.value * part.factor
        force: Vec3 = add_scaled(scaled(pull, d.f), change * part.factor, part.f)
        moment: Vec3 = add_scaled(scaled(pull, d.m), change * part.factor, part.m)
        own: LoadTangent = LoadTangent(d.Q, force, moment)
        push_along(scene, part.b, part.Q, scaled(pull, part.f), own)
        push_along(scene, part.a, part.Q, scaled(-pull, part.f), opposite(own))
    return rope_power_along(scene, load, change, rope_along(scene, load))


def sliding_along(scene: cython.pointer[Scene], load: cython.pointer[Load], there: PointMotion) -> Vec3:
    """Of the velocity of b's point as seen from a."""
    if load.a < 0:
        return there.v
    a: cython.pointer[Body] = cython.address(scene.bodies[load.a])
    on: cython.pointer[BodyTangent] = cython.address(scene.tangents[load.a])
    arm: Vec3 = sub(load.at, a.r)
    swept: Vec3 = add_cross(cross(on.omega, arm), a.omega, sub(there.x, on.r))
    return sub(sub(there.v, swept), on.v)


def angle_along(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.double:
    """Of the angle of a turn spring: a coordinate, or of a joint that was cut what the bodies' axes make.

    phi = atan2(y, x) of y = n . (before x now), x = before . now:   (x^2 + y^2) dphi = x dy - y dx.
    """
    if load.freedom >= 0:
        return scene.freedom_tangents[load.freedom].q
    if load.counter < 0:
        return 0.0
    n: Vec3 = direction_of(scene, load.a, load.axis)
    before: Vec3 = direction_of(scene, load.a, load.across)
    now: Vec3 = direction_of(scene, load.b, load.mark)
    d_before: Vec3 = swung(scene, load.a, before)
    d_now: Vec3 = swung(scene, load.b, now)
    x: cython.double = dot(before, now)
    y: cython.double = dot(n, cross(before, now))
    dx: cython.double = dot(d_before, now) + dot(before, d_now)
    across: Vec3 = add_cross(cross(d_before, now), before, d_now)
    dy: cython.double = dot(swung(scene, load.a, n), cross(before, now)) + dot(n, across)
    square: cython.double = x * x + y * y
    return (x * dy - y * dx) / square if square > 0.0 else NAN


def resistance(load: cython.pointer[Load], speed: cython.double) -> cython.double:
    """Of a damper or friction: the load by the speed."""
    if load.kind < TURN_FRICTION:
        return load.coefficient
    size: cython.double = load.coefficient * load.pressed
    if speed > 0.0:
        return size * tanh(speed / load.speed) / speed
    return size / load.speed


def resistance_along(load: cython.pointer[Load], speed: cython.double) -> cython.double:
    """What `resistance` changes by with the speed; of friction (F (1 - tanh^2) / v0 - F tanh / v) / v."""
    if load.kind < TURN_FRICTION or not speed > 0.0:
        return 0.0
    f: cython.double = tanh(speed / load.speed)
    size: cython.double = load.coefficient * load.pressed
    return size * ((1.0 - f * f) / load.speed - f / speed) / speed
