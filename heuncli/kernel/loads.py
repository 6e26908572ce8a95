"""Applied loads: forces and couples from outside, between two points, and between the two bodies of a joint.

Each is put on the bodies as force and moment; what it does there (value, rate, power) is kept for the results.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import atan2, tanh

    from heuncli.kernel.algebra import Vec3, cross, dot, norm, scaled, sub
    from heuncli.kernel.bushings import bushing_energy, bushing_load
    from heuncli.kernel.closures import push_condition
    from heuncli.kernel.directions import direction_of
    from heuncli.kernel.evaluator import value
    from heuncli.kernel.ropes import motion_of_rope, rope_energy, rope_power
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
        Closure,
        Counter,
        Load,
        Scene,
    )
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.strains import find_span_vector
    from heuncli.kernel.tree import point_of, push
    from heuncli.kernel.values import PointMotion, RopeMotion


def apply_loads(scene: cython.pointer[Scene]) -> cython.double:
    """Put all applied loads on the bodies; power of those that have no potential [W]."""
    i: cython.Py_ssize_t
    power: cython.double = 0.0
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for i in range(scene.load_count):
        load: cython.pointer[Load] = cython.address(scene.loads[i])
        there: PointMotion = point_of(scene, load.b, load.q)
        given: Vec3 = given_vector(scene, load)
        load.at = there.x
        load.force = zero
        load.moment = zero
        if load.kind == FORCE or load.kind == COUPLE:
            outer_load(scene, load, given, there.v)
            power += load.power
        elif load.kind == SPRING or load.kind == ACTUATOR:
            power += pair_load(scene, load, given, there.v)
        elif load.kind == ROPE:
            power += rope_load(scene, load, given)
        elif load.kind >= BUSHING_SHIFT:
            shifts: cython.bint = load.kind == BUSHING_SHIFT
            power += bushing_load(scene, load, given, motion_in(scene, load, there.v, shifts))
        else:
            power += joint_load(scene, load, given, there.v)
    return power


def given_vector(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """The load's given components: numbers, or expressions at this instant."""
    return Vec3(
        value(scene.programs, load.x) if load.x.count else load.vector.x,
        value(scene.programs, load.y) if load.y.count else load.vector.y,
        value(scene.programs, load.z) if load.z.count else load.vector.z,
    )


def outer_load(scene: cython.pointer[Scene], load: cython.pointer[Load], given: Vec3, v: Vec3) -> cython.void:
    """A force on a point that moves with v, or a couple, from outside the system."""
    turned: Vec3 = scaled(load.factor, direction_of(scene, load.b, given) if load.in_body else given)
    load.value = norm(turned)
    if load.kind == FORCE:
        load.force = turned
        load.power = dot(turned, v)
    else:
        load.moment = turned
        load.power = dot(turned, omega_of(scene, load.b))
    push(scene, load.b, load.at, load.force, load.moment)


def pair_load(scene: cython.pointer[Scene], load: cython.pointer[Load], given: Vec3, v: Vec3) -> cython.double:
    """A spring F = -k (l - l0) - c ldot, or an actuator, along the line between two points; positive pushes apart.

    Within one body its length stays and its ends cancel: it moves nothing, but cuts between its points feel it. Gives
    the power of what has no potential: the actuator's, or the spring's damping.
    """
    inside: cython.bint = load.a == load.b
    here: PointMotion = point_of(scene, load.a, load.p)
    span: Vec3 = sub(load.at, here.x)
    load.from_at = here.x
    load.span = norm(span)
    load.rate = dot(span, sub(v, here.v))
    if load.span > 0.0:
        load.rate = load.rate / load.span
    if inside:
        load.rate = 0.0
    lost: cython.double
    if load.kind == SPRING:
        load.value = -load.stiffness * (load.span - load.length) - load.coefficient * load.rate
        lost = -load.coefficient * load.rate * load.rate
    else:
        load.value = given.x
        lost = load.value * load.rate
    load.power = load.value * load.rate
    if load.span > 0.0:
        F: cython.double = load.value
        load.force = Vec3(F * span.x / load.span, F * span.y / load.span, F * span.z / load.span)
    elif load.kind == SPRING and load.length == 0.0:  # no direction, nor force; but this is how the force begins
        load.force = Vec3(0.0 - load.stiffness * span.x, 0.0 - load.stiffness * span.y, 0.0 - load.stiffness * span.z)
    if not inside:
        push(scene, load.b, load.at, load.force, load.moment)
        push(scene, load.a, load.from_at, scaled(-1.0, load.force), load.moment)
    return lost


def joint_load(scene: cython.pointer[Scene], load: cython.pointer[Load], given: Vec3, v: Vec3) -> cython.double:
    """A torque, thrust or spring about or along the joint's axis, a damper or friction against its turning or sliding.

    A spring's torque is -k (angle - free angle) - c rate. Friction is Coulomb's, smoothed: F tanh(rate / speed),
    against the direction of the motion; in a thread the force that goes with its moment is added. Gives the power of
    what has no potential, less that of friction by what presses: that is found here as it is if 1 N does, and put on no
    body (pressing.py).
    """
    axis: Vec3 = direction_of(scene, load.a, load.axis)
    slides: cython.bint = load.kind == THRUST or load.kind == SHIFT_DAMPER or load.kind == SHIFT_FRICTION
    motion: Vec3 = motion_in(scene, load, v, slides)
    acts: Vec3
    load.rate = dot(motion, axis)
    if load.kind <= TURN_SPRING:
        load.value = given.x
        if load.kind == TURN_SPRING:
            load.span = turned_by(scene, load)
            load.value = -load.stiffness * (load.span - load.length) - load.coefficient * load.rate
        load.power = load.value * load.rate
        acts = scaled(load.value, axis)
    else:
        speed: cython.double = norm(motion)
        if not load.in_body:
            load.rate = speed  # of motions about or along no one axis: how fast
        against: cython.double = load.coefficient
        if load.kind >= TURN_FRICTION:
            if not load.presses:
                load.pressed = given.x
            against = load.coefficient * given.x / load.speed  # what it comes to at rest, as a slope
            if speed > 0.0:
                against = load.coefficient * given.x * tanh(speed / load.speed) / speed
        load.value = -against * load.rate
        load.power = -against * speed * speed
        acts = scaled(-against, motion)
    if slides:
        load.force = acts
    else:
        load.moment = acts
    if load.kind == THREAD_FRICTION:
        load.force = scaled(load.factor, acts)
        load.power += dot(load.force, sliding_in(scene, load, v))
    load.from_at = load.at
    if load.presses:  # by a unit of it; what presses is found with the accelerations
        load.unit = acts
        return 0.0
    push(scene, load.b, load.at, load.force, load.moment)
    push(scene, load.a, load.at, scaled(-1.0, load.force), scaled(-1.0, load.moment))
    return -load.coefficient * load.rate * load.rate if load.kind == TURN_SPRING else load.power


def rope_load(scene: cython.pointer[Scene], load: cython.pointer[Load], given: Vec3) -> cython.double:
    """A rope that stretches, given its pull with the sign of a closure's multiplier; power of what has no potential."""
    motion: RopeMotion = motion_of_rope(scene, load)
    load.from_at = load.at
    load.value = given.x
    load.span = motion.S
    load.rate = motion.rate
    load.power = load.value * load.rate
    pull_along(scene, load)
    return rope_power(scene, load)


def pull_along(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.void:
    """Put what a rope pulls with on all bodies that it passes."""
    i: cython.Py_ssize_t
    for i in range(load.part, load.part + load.part_count):
        part: cython.pointer[Closure] = cython.address(scene.parts[i])
        push_condition(scene, part, load.value * part.factor)


def potential_of(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.double:
    """Of springs, ropes and bushings as the bodies stand, 0 where they are relaxed; none of other loads [J]."""
    stretch: cython.double = 0.0
    if load.kind == ROPE:
        return rope_energy(scene, load)
    elif load.kind >= BUSHING_SHIFT:
        return bushing_energy(scene, load)
    elif load.kind == SPRING:
        stretch = norm(find_span_vector(scene, load)) - load.length
    elif load.kind == TURN_SPRING:
        stretch = turned_by(scene, load) - load.length
    return 0.5 * load.stiffness * stretch * stretch


def turned_by(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.double:
    """The angle of a turn spring, turns counted: a coordinate, or of a joint that was cut what the bodies' axes make.

    The latter in the revolution nearest to the angle that is counted along. What turns neither way keeps its angle.
    """
    if load.freedom >= 0:
        return scene.freedoms[load.freedom].q + load.offset
    if load.counter < 0:
        return load.offset
    counter: cython.pointer[Counter] = cython.address(scene.counters[load.counter])
    n: Vec3 = direction_of(scene, load.a, load.axis)
    before: Vec3 = direction_of(scene, load.a, load.across)
    now: Vec3 = direction_of(scene, load.b, load.mark)
    angle: cython.double = atan2(dot(n, cross(before, now)), dot(before, now))
    half: cython.double = 3.141592653589793
    while counter.counted - angle > half:
        angle += 2.0 * half
    while angle - counter.counted > half:
        angle -= 2.0 * half
    return angle


def motion_in(scene: cython.pointer[Scene], load: cython.pointer[Load], v: Vec3, slides: cython.bint) -> Vec3:
    """Velocity of b's point, which moves with v, or angular velocity of b, as seen from a."""
    return sliding_in(scene, load, v) if slides else sub(omega_of(scene, load.b), omega_of(scene, load.a))


def sliding_in(scene: cython.pointer[Scene], load: cython.pointer[Load], v: Vec3) -> Vec3:
    """Velocity of b's point, which moves with v, as seen from a."""
    if load.a < 0:
        return v
    a: cython.pointer[Body] = cython.address(scene.bodies[load.a])
    return sub(sub(v, cross(a.omega, sub(load.at, a.r))), a.v)


def omega_of(scene: cython.pointer[Scene], body: cython.int) -> Vec3:
    """Angular velocity of a body; none of the ground's."""
    if body < 0:
        return Vec3(0.0, 0.0, 0.0)
    return scene.bodies[body].omega
