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
    from heuncli.kernel.algebra import Vec3, norm
    from heuncli.kernel.intervals import anything
    from heuncli.kernel.libm import INFINITY
    from heuncli.kernel.programs import Bounds, Span
    from heuncli.kernel.scene import ALONG_LINE, BUSHING_SHIFT, Load, Scene, Variable
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.stepping import Orbits
    from heuncli.kernel.strains import component_of, rate_of_length, span_of, strain_of

QUARTER_TURN = 1.5707963267948966
STEEPEST = 1.93  # K


def load_at_end(
    scene: cython.pointer[Scene], i: cython.Py_ssize_t, places: cython.p_double, rates: cython.p_double
) -> cython.void:
    """A variable that is of a load as the bodies stand: length and its rate; a strain, and how long the span is."""
    variable: cython.pointer[Variable] = cython.address(scene.variables[i])
    load: cython.pointer[Load] = cython.address(scene.loads[variable.load])
    if variable.part == ALONG_LINE:
        places[i] = norm(span_of(scene, load))
        rates[i] = rate_of_length(scene, load)
    else:
        places[i] = component_of(strain_of(scene, load), variable.part)
        rates[i] = norm(span_of(scene, load))


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
    V: cython.double = speed_of(points, load.a, load.p) + speed_of(points, load.b, load.q)
    A: cython.double = acceleration_of(points, load.a, load.p) + acceleration_of(points, load.b, load.q)
    far: cython.double = reach_of(points, load.a, load.p) + reach_of(points, load.b, load.q)
    open_by: cython.double = scene.limits.rounding * far
    fastest: cython.double = V
    bend: cython.double = 0.5 * V * T
    second: Bounds = anything()
    if load.a == load.b:
        fastest = 0.0
        bend = 0.0
        second = Bounds(0.0, 0.0)
    elif variable.part == ALONG_LINE:
        least: cython.double = points.first_place[i]
        if points.last_place[i] < least:
            least = points.last_place[i]
        least = least - 0.5 * V * T - open_by
        if least > 0.0:
            A = A + V * V / least
            bend = 0.125 * A * T * T
            second = Bounds(-A, A)
    elif load.kind == BUSHING_SHIFT:
        L: cython.double = points.last_rate[i] + V * T
        spin: cython.double = spin_of(points, load.a)
        A = A + (twist_of(points, load.a) + spin * spin) * L + 2.0 * spin * V
        fastest = V + spin * L
        bend = 0.125 * A * T * T
        second = Bounds(-A, A)
    else:
        spin_a: cython.double = spin_of(points, load.a)
        spin_b: cython.double = spin_of(points, load.b)
        fastest = QUARTER_TURN * (spin_a + spin_b)
        A = QUARTER_TURN * (twist_of(points, load.a) + twist_of(points, load.b) + spin_a * spin_b)
        A = A + STEEPEST * fastest * (spin_a + spin_b)
        bend = 0.125 * A * T * T
        open_by = 8.0 * scene.limits.rounding
        second = Bounds(-A, A)
    rate: Bounds = Bounds(-fastest, fastest)
    if rates and variable.is_rate:
        return Span(value, second, anything())
    if rates:
        return Span(value, rate, second)
    if variable.is_rate:
        if second.high < INFINITY:
            open_by = scene.limits.rounding * V
            rate = between(points.first_rate[i], points.last_rate[i], 0.5 * second.high * T + open_by)
        return Span(rate, anything(), anything())
    return Span(between(points.first_place[i], points.last_place[i], bend + open_by), anything(), anything())


def between(a: cython.double, b: cython.double, beyond: cython.double) -> Bounds:
    """What lies between two numbers, or so far beyond them."""
    return Bounds(a - beyond, b + beyond) if a < b else Bounds(b - beyond, a + beyond)


def acceleration_of(points: cython.pointer[Orbits], body: cython.int, q: Vec3) -> cython.double:
    """The largest acceleration of a body's point over the part."""
    if body < 0:
        return 0.0
    # the dense outputs of coordinates and of rates agree to the error of a step, far better than to an eighth
    spin: cython.double = points.spin[body]
    return 1.125 * (points.pull[body] + (points.twist[body] + spin * spin) * norm(q))


def speed_of(points: cython.pointer[Orbits], body: cython.int, q: Vec3) -> cython.double:
    """The largest speed of a body's point over the part."""
    return 1.125 * (points.speed[body] + points.spin[body] * norm(q)) if body >= 0 else 0.0


def reach_of(points: cython.pointer[Orbits], body: cython.int, q: Vec3) -> cython.double:
    """How far a body's point may be from the origin."""
    return norm(q) + (points.reach[body] if body >= 0 else 0.0)


def spin_of(points: cython.pointer[Orbits], body: cython.int) -> cython.double:
    """How fast a body may turn."""
    return 1.125 * points.spin[body] if body >= 0 else 0.0


def twist_of(points: cython.pointer[Orbits], body: cython.int) -> cython.double:
    """How fast that may change."""
    return 1.125 * points.twist[body] if body >= 0 else 0.0
