"""Bound speeds and accelerations of bodies' points over an interval of time, from the bodies' bounds (points.py)."""

from __future__ import annotations

from heuncli.kernel.declarations import *


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
