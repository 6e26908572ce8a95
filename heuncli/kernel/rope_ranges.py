"""Bound the first and second rate of a rope's length over an interval of time of length T.

For a strand from a sheave a to a sheave or point b (sheaves.py), seen from a, from bounds of the motions:

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
from heuncli.kernel.libm import INFINITY
from heuncli.kernel.motion_bounds import bound_acceleration, bound_reach, bound_speed, bound_spin, bound_twist


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
