"""Bound the variables that belong to loads over an interval of time of length T, from bounds of the motions.

V, A: of the speeds and accelerations of a load's two points together; Omega, Alpha: of a's rotation; L: of the span.

    |l - chord| <= (A + V^2 / l) T^2 / 8,  |l'| <= V
    |d - chord| <= (A + (Alpha + Omega^2) L + 2 Omega V) T^2 / 8,  |d'| <= V + Omega L
    |phi - chord| <= (pi/2 (Alpha_a + Alpha_b + Omega_a Omega_b) + K pi/2 (Omega_a + Omega_b)^2) T^2 / 8
    |phi'| <= pi/2 (Omega_a + Omega_b)

phi: a rotation vector of less than half a turn, phi' = J^-1 omega, omega = R_a' (omega_b - omega_a). There |J^-1| =
(theta/2) / sin (theta/2) <= pi/2. Of J^-1 = 1 - [phi]/2 + f (n n' - 1), f = 1 - (theta/2) cot (theta/2), the change
along a unit step of phi is at most 1/2 + f' + 2 f / theta, which is 1/2 + pi/4 + 2/pi < K at half a turn.

The first and second rate of a rope's length, for a strand from a sheave a to a sheave or point b (sheaves.py), seen
from a:

    V = speed_a + speed_b + spin_a |D|                     of the centre of b
    |g| <= G = 1 + (1 - l/S) |sigma| / l                   1 - l/S <= h^2 / (2 l^2)
    |S'|  <= G V + R_b (spin_a + spin_b)
    |S''| <= G (A_a + A_b + (twist_a + spin_a^2) |D| + 2 spin_a V) + V^2 / l + |sigma| V^2 (2 + |sigma| / l) / l^2
             + R_b (twist_a + twist_b + spin_a (spin_a + spin_b))

with the smallest l and the largest |D| and h that are possible within T of the strand's position at its end. The length
on a sheave changes with its strands.
"""

from __future__ import annotations

from math import fabs, sqrt

from heuncli.kernel.declarations import *
from heuncli.kernel.enclosure import enclose
from heuncli.kernel.intervals import all_numbers
from heuncli.kernel.libm import INFINITY
from heuncli.kernel.strains import bushing_strain, find_span_vector, line_rate, measure_rope, vector_component


def bound_acceleration(points: cython.pointer[PointCourse], body: cython.int, q: Vec3) -> cython.double:
    """Return the largest acceleration of a body's point over the part."""
    if body < 0:
        return 0.0
    # 9/8: the dense outputs of coordinates and of rates agree to the error of a step, far better than to an
    # eighth
    spin: cython.double = points.angular_velocity[body]
    return 1.125 * (points.acceleration[body] + (points.angular_acceleration[body] + spin * spin) * norm(q))


def bound_speed(points: cython.pointer[PointCourse], body: cython.int, q: Vec3) -> cython.double:
    """Return the largest speed of a body's point over the part."""
    return 1.125 * (points.speed[body] + points.angular_velocity[body] * norm(q)) if body >= 0 else 0.0


def bound_reach(points: cython.pointer[PointCourse], body: cython.int, q: Vec3) -> cython.double:
    """Return how far a body's point may be from the origin."""
    return norm(q) + (points.reach[body] if body >= 0 else 0.0)


def bound_spin(points: cython.pointer[PointCourse], body: cython.int) -> cython.double:
    """Return the largest angular velocity of a body."""
    return 1.125 * points.angular_velocity[body] if body >= 0 else 0.0


def bound_twist(points: cython.pointer[PointCourse], body: cython.int) -> cython.double:
    """Return the largest angular acceleration of a body."""
    return 1.125 * points.angular_acceleration[body] if body >= 0 else 0.0


def bound_rope(
    scene: cython.pointer[Scene], points: cython.pointer[PointCourse], load: cython.pointer[Load], T: cython.double
) -> LengthBounds:
    """Bound all parts of a rope together, from their positions at the end of the interval."""
    i: cython.Py_ssize_t
    rate: cython.double = 0.0
    second: cython.double = 0.0
    far: cython.double = 0.0
    for i in range(load.part, load.part + load.part_count):
        part: cython.pointer[Closure] = cython.address(scene.parts[i])
        if part.kind == ROD or part.kind == STRAND:
            strand: Jet = bound_strand(points, part, T)
            rate += fabs(part.factor) * strand.rate
            second += fabs(part.factor) * strand.second
            far += fabs(part.factor) * strand.value
    bend: cython.double = 0.125 * second * T * T if second < INFINITY else 0.5 * rate * T
    return LengthBounds(rate, second, bend, far, scene.limits.rounding)


def bound_strand(points: cython.pointer[PointCourse], part: cython.pointer[Closure], T: cython.double) -> Jet:
    """Bound one strand: its distance from the origin, and its rates; between two points the bodies' rotation has no
    effect.
    """
    turns: cython.double = 1.0 if part.kind == STRAND else 0.0
    sigma: cython.double = turns * fabs(part.g.x - part.g.y)
    radius: cython.double = turns * fabs(part.g.y)
    spin: cython.double = turns * bound_spin(points, part.a)
    both: cython.double = spin + turns * bound_spin(points, part.b)
    speed: cython.double = bound_speed(points, part.a, part.p) + bound_speed(points, part.b, part.q)
    span_vector: Vec3 = sub(part.on_b, part.on_a)
    span: cython.double = sqrt(dot(span_vector, span_vector) + sigma * sigma) + speed * T
    V: cython.double = speed + spin * span
    across: cython.double = fabs(dot(part.t, span_vector)) if part.kind == STRAND else norm(span_vector)
    slant: cython.double = sqrt(fabs(dot(span_vector, span_vector) - across * across)) + V * T
    nearest: cython.double = sqrt(across * across + sigma * sigma) - V * T
    far: cython.double = bound_reach(points, part.a, part.p) + bound_reach(points, part.b, part.q) + sigma + radius
    free: cython.double = nearest * nearest - sigma * sigma
    if not nearest > 0.0 or not free > 0.0:
        return Jet(far, INFINITY if sigma > 0.0 else V + radius * both, INFINITY)
    l: cython.double = sqrt(free)
    G: cython.double = 1.0 + turns * 0.5 * slant * slant * sigma / (free * l)
    A: cython.double = bound_acceleration(points, part.a, part.p) + bound_acceleration(points, part.b, part.q)
    twist: cython.double = turns * bound_twist(points, part.a)
    A = G * (A + (twist + spin * spin) * span + 2.0 * spin * V)
    A += V * V / l + sigma * V * V * (2.0 + sigma / l) / free
    A += radius * (twist + turns * bound_twist(points, part.b) + spin * both)
    return Jet(far, G * V + radius * both, A)


QUARTER_TURN = 1.5707963267948966
MAX_MAP_SLOPE = 1.93  # K


def evaluate_load_end(
    scene: cython.pointer[Scene], i: cython.Py_ssize_t, places: cython.p_double, rates: cython.p_double
) -> cython.void:
    """Evaluate a load's variable at the present pose: a length and its rate; or a strain, and the span's length."""
    variable: cython.pointer[Variable] = cython.address(scene.variables[i])
    load: cython.pointer[Load] = cython.address(scene.loads[variable.load])
    if load.kind == ROPE:
        rope: RopeMotion = measure_rope(scene, load)
        places[i] = rope.S
        rates[i] = rope.rate
    elif variable.part == ALONG_LINE:
        places[i] = norm(find_span_vector(scene, load))
        rates[i] = line_rate(scene, load)
    else:
        places[i] = vector_component(bushing_strain(scene, load), variable.part)
        rates[i] = norm(find_span_vector(scene, load))


def bound_load_variable(
    scene: cython.pointer[Scene],
    points: cython.pointer[PointCourse],
    i: cython.Py_ssize_t,
    T: cython.double,
    value: Bounds,
    rates: cython.bint,
) -> Span:
    """Bound such a variable; or, with `rates`, its rate and the rate of that, next to its value."""
    variable: cython.pointer[Variable] = cython.address(scene.variables[i])
    load: cython.pointer[Load] = cython.address(scene.loads[variable.load])
    if variable.part == DRAWN:
        drawn_length: Span = enclose(scene.programs, load.y)  # in time alone
        return (
            Span(value, drawn_length.second, all_numbers())
            if rates
            else Span(drawn_length.rate, all_numbers(), all_numbers())
        )
    motion: LengthBounds = bound_load_motion(scene, points, load, i, T)
    second: Bounds = all_numbers()
    if motion.second < INFINITY:
        second = Bounds(-motion.second, motion.second)
    rate: Bounds = Bounds(-motion.rate, motion.rate)
    if rates and variable.is_rate:
        return Span(value, second, all_numbers())
    if rates:
        return Span(value, rate, second)
    if variable.is_rate:
        if motion.second < INFINITY:
            rate = bounds_between(
                points.first_rate[i], points.last_rate[i], 0.5 * motion.second * T + motion.rounding * motion.rate
            )
        return Span(rate, all_numbers(), all_numbers())
    margin: cython.double = motion.bend + motion.rounding * motion.far
    return Span(bounds_between(points.first_place[i], points.last_place[i], margin), all_numbers(), all_numbers())


def bound_load_motion(
    scene: cython.pointer[Scene],
    points: cython.pointer[PointCourse],
    load: cython.pointer[Load],
    i: cython.Py_ssize_t,
    T: cython.double,
) -> LengthBounds:
    """Bound a load's variable by the motions; between two points of the same body its rates are zero."""
    rounding: cython.double = scene.limits.rounding
    if load.kind == ROPE:
        return bound_rope(scene, points, load, T)
    far: cython.double = bound_reach(points, load.a, load.p) + bound_reach(points, load.b, load.q)
    if load.a == load.b:
        return LengthBounds(0.0, 0.0, 0.0, far, rounding)
    V: cython.double = bound_speed(points, load.a, load.p) + bound_speed(points, load.b, load.q)
    A: cython.double = bound_acceleration(points, load.a, load.p) + bound_acceleration(points, load.b, load.q)
    if scene.variables[i].part == ALONG_LINE:
        least: cython.double = points.first_place[i]
        if points.last_place[i] < least:
            least = points.last_place[i]
        least = least - 0.5 * V * T - rounding * far
        if least > 0.0:
            A = A + V * V / least
            return LengthBounds(V, A, 0.125 * A * T * T, far, rounding)
        return LengthBounds(V, INFINITY, 0.5 * V * T, far, rounding)
    if load.kind == BUSHING_SHIFT:
        L: cython.double = points.last_rate[i] + V * T
        spin: cython.double = bound_spin(points, load.a)
        A = A + (bound_twist(points, load.a) + spin * spin) * L + 2.0 * spin * V
        return LengthBounds(V + spin * L, A, 0.125 * A * T * T, far, rounding)
    spin_a: cython.double = bound_spin(points, load.a)
    spin_b: cython.double = bound_spin(points, load.b)
    turning: cython.double = QUARTER_TURN * (spin_a + spin_b)
    A = QUARTER_TURN * (bound_twist(points, load.a) + bound_twist(points, load.b) + spin_a * spin_b)
    A = A + MAX_MAP_SLOPE * turning * (spin_a + spin_b)
    return LengthBounds(turning, A, 0.125 * A * T * T, 8.0, rounding)


def bounds_between(a: cython.double, b: cython.double, margin: cython.double) -> Bounds:
    """Return the bounds between two numbers, extended by a margin."""
    return Bounds(a - margin, b + margin) if a < b else Bounds(b - margin, a + margin)
