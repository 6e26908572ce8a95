"""How fast points of bodies may be over a stretch of time, by the bounds of the bodies' motions (points.py)."""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import Vec3, norm
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.stepping import Orbits


def bound_acceleration(points: cython.pointer[Orbits], body: cython.int, q: Vec3) -> cython.double:
    """The largest acceleration of a body's point over the part."""
    if body < 0:
        return 0.0
    # the dense outputs of coordinates and of rates agree to the error of a step, far better than to an eighth
    spin: cython.double = points.spin[body]
    return 1.125 * (points.pull[body] + (points.twist[body] + spin * spin) * norm(q))


def bound_speed(points: cython.pointer[Orbits], body: cython.int, q: Vec3) -> cython.double:
    """The largest speed of a body's point over the part."""
    return 1.125 * (points.speed[body] + points.spin[body] * norm(q)) if body >= 0 else 0.0


def bound_reach(points: cython.pointer[Orbits], body: cython.int, q: Vec3) -> cython.double:
    """How far a body's point may be from the origin."""
    return norm(q) + (points.reach[body] if body >= 0 else 0.0)


def bound_spin(points: cython.pointer[Orbits], body: cython.int) -> cython.double:
    """How fast a body may turn."""
    return 1.125 * points.spin[body] if body >= 0 else 0.0


def bound_twist(points: cython.pointer[Orbits], body: cython.int) -> cython.double:
    """How fast that may change."""
    return 1.125 * points.twist[body] if body >= 0 else 0.0
