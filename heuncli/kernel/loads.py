"""Applied loads: forces and couples from outside, between two points, and between the two bodies of a joint.

Each is applied to the bodies as force and moment; its value, rate and power are stored for the results.
"""

from __future__ import annotations

from math import atan2, tanh

from heuncli.kernel.bushings import apply_bushing_load, bushing_energy
from heuncli.kernel.carried_points import body_omega
from heuncli.kernel.closures import apply_condition_load
from heuncli.kernel.declarations import *
from heuncli.kernel.evaluator import evaluate_program
from heuncli.kernel.kinematics import add_load_to_body, locate_point
from heuncli.kernel.libm import NAN
from heuncli.kernel.strains import find_span_vector, measure_rope, rope_energy, rope_power


def apply_loads(scene: cython.pointer[Scene]) -> cython.double:
    """Apply all loads to the bodies. Returns the power of those that have no potential [W]."""
    i: cython.Py_ssize_t
    power: cython.double = 0.0
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for i in range(scene.load_count):
        load: cython.pointer[Load] = cython.address(scene.loads[i])
        point: PointMotion = locate_point(scene, load.b, load.q)
        vector: Vec3 = evaluate_load_vector(scene, load)
        load.place = point.x
        load.force = zero
        load.moment = zero
        if load.kind == FORCE or load.kind == COUPLE:
            apply_outer_load(scene, load, vector, point.v)
            power += load.power
        elif load.kind == SPRING or load.kind == ACTUATOR:
            power += apply_pair_load(scene, load, vector, point.v)
        elif load.kind == ROPE:
            power += apply_rope_load(scene, load, vector)
        elif is_bushing(load):
            power += apply_bushing_load(scene, load, vector, bushing_rates(scene, load, point.v))
        else:
            power += apply_joint_load(scene, load, vector, point.v)
    return power


def evaluate_load_vector(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return the load's components: numbers, or expressions at this instant."""
    return Vec3(
        evaluate_program(scene.programs, load.x) if load.x.count else load.vector.x,
        evaluate_program(scene.programs, load.y) if load.y.count else load.vector.y,
        evaluate_program(scene.programs, load.z) if load.z.count else load.vector.z,
    )


def apply_outer_load(scene: cython.pointer[Scene], load: cython.pointer[Load], vector: Vec3, v: Vec3) -> cython.void:
    """Apply a force on a point that moves with v, or a couple, from outside the system."""
    world_vector: Vec3 = scale_vector(load.factor, world_direction(scene, load.b, vector) if load.in_body else vector)
    load.value = norm(world_vector)
    if load.kind == FORCE:
        load.force = world_vector
        load.power = dot(world_vector, v)
    else:
        load.moment = world_vector
        load.power = dot(world_vector, body_omega(scene, load.b))
    add_load_to_body(scene, load.b, load.place, load.force, load.moment)


def apply_pair_load(scene: cython.pointer[Scene], load: cython.pointer[Load], vector: Vec3, v: Vec3) -> cython.double:
    """Apply a spring F = -k (l - l0) - c ldot, or an actuator, along the line between two points; positive pushes them
    apart.

    Within one body its length is constant and its forces cancel: it moves nothing, but sections between its points feel
    it. Returns the power of what has no potential: the actuator's, or the spring's damping.
    """
    inside: cython.bint = load.a == load.b
    start_point: PointMotion = locate_point(scene, load.a, load.p)
    span: Vec3 = sub(load.place, start_point.x)
    load.place_on_a = start_point.x
    load.span = norm(span)
    load.rate = dot(span, sub(v, start_point.v))
    if load.span > 0.0:
        load.rate = load.rate / load.span
    if inside:
        load.rate = 0.0
    lost: cython.double
    if load.kind == SPRING:
        load.value = -load.stiffness * (load.span - load.length) - load.coefficient * load.rate
        lost = -load.coefficient * load.rate * load.rate
    else:
        load.value = vector.x
        lost = load.value * load.rate
    load.power = load.value * load.rate
    if load.span > 0.0:
        F: cython.double = load.value
        load.force = Vec3(F * span.x / load.span, F * span.y / load.span, F * span.z / load.span)
    # no direction and no force; the formula gives the force to first order
    elif load.kind == SPRING and load.length == 0.0:
        load.force = Vec3(0.0 - load.stiffness * span.x, 0.0 - load.stiffness * span.y, 0.0 - load.stiffness * span.z)
    if not inside:
        add_load_to_body(scene, load.b, load.place, load.force, load.moment)
        add_load_to_body(scene, load.a, load.place_on_a, scale_vector(-1.0, load.force), load.moment)
    return lost


def apply_joint_load(scene: cython.pointer[Scene], load: cython.pointer[Load], vector: Vec3, v: Vec3) -> cython.double:
    """Apply a torque, thrust or spring about or along the joint's axis, or a damper or friction against its motion.

    A spring's torque is -k (angle - free angle) - c rate. Friction is Coulomb's: as it is, F against its slip, or
    smoothed, F tanh(rate / speed) against the direction of the motion; in a thread the force that goes with its moment
    is added. Returns the power of what has no potential, without joint friction that depends on the joint's own load:
    that is found here for 1 N, and not applied to any body (joint_friction.py).
    """
    axis: Vec3 = world_direction(scene, load.a, load.axis)
    slides: cython.bint = slides_in_joint(load)
    motion: Vec3 = relative_motion(scene, load, v, slides)
    load_on_b: Vec3
    load.rate = dot(motion, axis)
    if acts_about_axis(load):
        load.value = vector.x
        if load.kind == TURN_SPRING:
            load.span = turn_spring_angle(scene, load)
            load.value = -load.stiffness * (load.span - load.length) - load.coefficient * load.rate
        load.power = load.value * load.rate
        load_on_b = scale_vector(load.value, axis)
    elif load.breakaway > 0.0:  # what sticks is a closure's load, which is found with the accelerations
        if not load.normal_force_kind:
            load.normal_force = vector.x
        load.value = -load.slip * load.coefficient * vector.x
        load.power = load.value * load.rate
        load_on_b = scale_vector(load.value, axis)
    else:
        speed: cython.double = norm(motion)
        if not load.in_body:
            load.rate = speed  # a motion without a single axis is measured by its speed
        resistance_factor: cython.double = load.coefficient
        if is_friction(load):
            if not load.normal_force_kind:
                load.normal_force = vector.x
            resistance_factor = load.coefficient * vector.x / load.speed  # what it comes to at rest, as a slope
            if speed > 0.0:
                resistance_factor = load.coefficient * vector.x * tanh(speed / load.speed) / speed
        load.value = -resistance_factor * load.rate
        load.power = -resistance_factor * speed * speed
        load_on_b = scale_vector(-resistance_factor, motion)
    if slides:
        load.force = load_on_b
    else:
        load.moment = load_on_b
    if load.kind == THREAD_FRICTION:
        load.force = scale_vector(load.factor, load_on_b)
        load.power += dot(load.force, sliding_velocity(scene, load, v))
    load.place_on_a = load.place
    if load.normal_force_kind:  # for a normal force of 1 N; the normal force is found with the accelerations
        load.unit = load_on_b
        return 0.0
    add_load_to_body(scene, load.b, load.place, load.force, load.moment)
    add_load_to_body(scene, load.a, load.place, scale_vector(-1.0, load.force), scale_vector(-1.0, load.moment))
    return -load.coefficient * load.rate * load.rate if load.kind == TURN_SPRING else load.power


def apply_rope_load(scene: cython.pointer[Scene], load: cython.pointer[Load], vector: Vec3) -> cython.double:
    """Apply an elastic rope with a given pull, signed like a closure's multiplier; return the power of what has no
    potential.
    """
    motion: RopeMotion = measure_rope(scene, load)
    load.place_on_a = load.place
    load.value = NAN if has_wound_up(scene, load) else vector.x
    load.span = motion.S
    load.rate = motion.rate
    load.power = load.value * load.rate
    apply_rope_pull(scene, load)
    return rope_power(scene, load)


def has_wound_up(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.bint:
    """Return whether a strand of a rope has no length left, because its end is on the rim of its sheave or inside."""
    i: cython.Py_ssize_t
    for i in range(load.part, load.part + load.part_count):
        part: cython.pointer[Closure] = cython.address(scene.parts[i])
        if part.kind == STRAND and not part.gap > 0.0:
            return True
    return False


def apply_rope_pull(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.void:
    """Apply a rope's pull to all bodies that it passes."""
    i: cython.Py_ssize_t
    for i in range(load.part, load.part + load.part_count):
        part: cython.pointer[Closure] = cython.address(scene.parts[i])
        apply_condition_load(scene, part, load.value * part.factor)


def is_bushing(load: cython.pointer[Load]) -> cython.bint:
    """Whether a load is the shift or the turn of a bushing."""
    return load.kind == BUSHING_SHIFT or load.kind == BUSHING_TURN


def acts_about_axis(load: cython.pointer[Load]) -> cython.bint:
    """Whether a load in a joint acts about or along its axis, and not against its motion."""
    return load.kind == TORQUE or load.kind == THRUST or load.kind == TURN_SPRING


def is_friction(load: cython.pointer[Load]) -> cython.bint:
    """Whether a load has the size of friction, not a coefficient of its rate."""
    return load.kind == TURN_FRICTION or load.kind == SHIFT_FRICTION or load.kind == THREAD_FRICTION


def slides_in_joint(load: cython.pointer[Load]) -> cython.bint:
    """Whether a load in a joint is a force on its sliding, not a moment on its turning."""
    return load.kind == THRUST or load.kind == SHIFT_DAMPER or load.kind == SHIFT_FRICTION


def load_potential(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.double:
    """Return the potential energy of a spring, rope or bushing at the present pose, 0 if relaxed; 0 for other loads
    [J].
    """
    stretch: cython.double = 0.0
    if load.kind == ROPE:
        return rope_energy(scene, load)
    elif is_bushing(load):
        return bushing_energy(scene, load)
    elif load.kind == SPRING:
        stretch = norm(find_span_vector(scene, load)) - load.length
    elif load.kind == TURN_SPRING:
        stretch = turn_spring_angle(scene, load) - load.length
    return 0.5 * load.stiffness * stretch * stretch


def turn_spring_angle(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.double:
    """Return the angle of a turn spring, turns counted: a coordinate, or for a cut joint the angle between the bodies'
    axes.

    The latter is taken in the revolution nearest to the counted angle. A joint that cannot turn keeps its angle.
    """
    if load.freedom >= 0:
        return scene.freedoms[load.freedom].q + load.offset
    if load.counter < 0:
        return load.offset
    counter: cython.pointer[Counter] = cython.address(scene.counters[load.counter])
    n: Vec3 = world_direction(scene, load.a, load.axis)
    reference: Vec3 = world_direction(scene, load.a, load.mark_a)
    marker: Vec3 = world_direction(scene, load.b, load.mark_b)
    angle: cython.double = atan2(dot(n, cross(reference, marker)), dot(reference, marker))
    half: cython.double = 3.141592653589793
    while counter.value - angle > half:
        angle += 2.0 * half
    while angle - counter.value > half:
        angle -= 2.0 * half
    return angle


def relative_motion(scene: cython.pointer[Scene], load: cython.pointer[Load], v: Vec3, slides: cython.bint) -> Vec3:
    """Return the velocity of b's point, which moves with v, or the angular velocity of b, as seen from a."""
    return sliding_velocity(scene, load, v) if slides else sub(body_omega(scene, load.b), body_omega(scene, load.a))


def bushing_rates(scene: cython.pointer[Scene], load: cython.pointer[Load], v: Vec3) -> BushingRates:
    """Return the rates of a bushing whose point of b moves with v; the other is 0 where it has no effect."""
    shifts: cython.bint = load.kind == BUSHING_SHIFT
    other: Vec3 = Vec3(0.0, 0.0, 0.0)
    if load.is_coupled:
        other = relative_motion(scene, load, v, not shifts)
    return BushingRates(relative_motion(scene, load, v, shifts), other)


def sliding_velocity(scene: cython.pointer[Scene], load: cython.pointer[Load], v: Vec3) -> Vec3:
    """Return the velocity of b's point, which moves with v, as seen from a."""
    if load.a < 0:
        return v
    a: cython.pointer[Body] = cython.address(scene.bodies[load.a])
    return sub(sub(v, cross(a.omega, sub(load.place, a.r))), a.v)
