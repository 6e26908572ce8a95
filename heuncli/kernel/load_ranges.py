"""How far the variables that are of loads may go over a stretch of time of length T, by bounds of the motions.

V, A: of the speeds and accelerations of a load's two points together; Omega, Alpha: of a's turning; L: of the span.

    |l - chord| <= (A + V^2 / l) T^2 / 8,  |l'| <= V
    |d - chord| <= (A + (Alpha + Omega^2) L + 2 Omega V) T^2 / 8,  |d'| <= V + Omega L
    |phi - chord| <= (pi/2 (Alpha_a + Alpha_b + Omega_a Omega_b) + K pi/2 (Omega_a + Omega_b)^2) T^2 / 8
    |phi'| <= pi/2 (Omega_a + Omega_b)
phi: a rotation vector of less than half a turn, phi' = J^-1 omega, omega = R_a' (omega_b - omega_a). There
|J^-1| = (theta/2) / sin (theta/2) <= pi/2. Of J^-1 = 1 - [phi]/2 + f (n n' - 1), f = 1 - (theta/2) cot (theta/2), the
change along a unit step of phi is not above 1/2 + f' + 2 f / theta, which is 1/2 + pi/4 + 2/pi < K at half a turn.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import norm
    from heuncli.kernel.enclosure import enclose
    from heuncli.kernel.intervals import anything
    from heuncli.kernel.libm import INFINITY
    from heuncli.kernel.motion_bounds import bound_acceleration, bound_reach, bound_speed, bound_spin, bound_twist
    from heuncli.kernel.programs import Bounds, Span
    from heuncli.kernel.rope_ranges import bounds_of_rope
    from heuncli.kernel.ropes import motion_of_rope
    from heuncli.kernel.scene import ALONG_LINE, BUSHING_SHIFT, DRAWN, ROPE, Load, Scene, Variable
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.stepping import Orbits
    from heuncli.kernel.strains import component_of, find_span_vector, rate_of_length, strain_of
    from heuncli.kernel.values import LengthBounds, RopeMotion

QUARTER_TURN = 1.5707963267948966
STEEPEST = 1.93  # K


def load_at_end(
    scene: cython.pointer[Scene], i: cython.Py_ssize_t, places: cython.p_double, rates: cython.p_double
) -> cython.void:
    """A variable that is of a load as the bodies stand: length and its rate; a strain, and how long the span is."""
    variable: cython.pointer[Variable] = cython.address(scene.variables[i])
    load: cython.pointer[Load] = cython.address(scene.loads[variable.load])
    if load.kind == ROPE:
        rope: RopeMotion = motion_of_rope(scene, load)
        places[i] = rope.S
        rates[i] = rope.rate
    elif variable.part == ALONG_LINE:
        places[i] = norm(find_span_vector(scene, load))
        rates[i] = rate_of_length(scene, load)
    else:
        places[i] = component_of(strain_of(scene, load), variable.part)
        rates[i] = norm(find_span_vector(scene, load))


def range_of_load(
    scene: cython.pointer[Scene],
    points: cython.pointer[Orbits],
    i: cython.Py_ssize_t,
    T: cython.double,
    value: Bounds,
    rates: cython.bint,
) -> Span:
    """The range of such a variable; or of its rate, and of the rate of that, beside its value."""
    variable: cython.pointer[Variable] = cython.address(scene.variables[i])
    load: cython.pointer[Load] = cython.address(scene.loads[variable.load])
    if variable.part == DRAWN:
        drawn: Span = enclose(scene.programs, load.y)  # in time alone
        return Span(value, drawn.second, anything()) if rates else Span(drawn.rate, anything(), anything())
    of: LengthBounds = bounds_of_load(scene, points, load, i, T)
    second: Bounds = anything()
    if of.second < INFINITY:
        second = Bounds(-of.second, of.second)
    rate: Bounds = Bounds(-of.rate, of.rate)
    if rates and variable.is_rate:
        return Span(value, second, anything())
    if rates:
        return Span(value, rate, second)
    if variable.is_rate:
        if of.second < INFINITY:
            rate = between(points.first_rate[i], points.last_rate[i], 0.5 * of.second * T + of.rounding * of.rate)
        return Span(rate, anything(), anything())
    beyond: cython.double = of.bend + of.rounding * of.far
    return Span(between(points.first_place[i], points.last_place[i], beyond), anything(), anything())


def bounds_of_load(
    scene: cython.pointer[Scene],
    points: cython.pointer[Orbits],
    load: cython.pointer[Load],
    i: cython.Py_ssize_t,
    T: cython.double,
) -> LengthBounds:
    """What the motions allow of a variable that is of a load; where two points of one body are, nothing."""
    rounding: cython.double = scene.limits.rounding
    if load.kind == ROPE:
        return bounds_of_rope(scene, points, load, T)
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
    A = A + STEEPEST * turning * (spin_a + spin_b)
    return LengthBounds(turning, A, 0.125 * A * T * T, 8.0, rounding)


def between(a: cython.double, b: cython.double, beyond: cython.double) -> Bounds:
    """What lies between two numbers, or so far beyond them."""
    return Bounds(a - beyond, b + beyond) if a < b else Bounds(b - beyond, a + beyond)
