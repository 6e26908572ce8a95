"""Ropes over sheaves: their strands, and the lengths that lie on the sheaves.

    S + sigma chi      a strand between sheave a and sheave or point b, seen from a; sigma = s_a R_a - s_b R_b

n: axis of a; s = 1 if the rope goes round its sheave counter-clockwise about n, as it goes from a to b; p: the vector
from centre to centre across n, h: along n; t: direction of the strand across n, chi: its angle about n, w = t x n:

    p = l t + sigma w        l^2 = p^2 - sigma^2        S^2 = l^2 + h^2

The strand leaves each sheave where it would for h = 0: its length is that of a straight rope between these two places.
Its pull is the gradient g of that, so that no work is lost, and its moment about each axis is the pull times R. The
pull differs from the tension by (h/l)^2/2 at most if the strand is long compared with R, and not at all if h = 0.
"""

from __future__ import annotations

from math import atan2, sqrt

from heuncli.kernel.carried_points import point_motion, world_place
from heuncli.kernel.declarations import *

FULL_TURN = 6.283185307179586
NEARLY_ROUND = 5.497787143782138  # 7/4 pi: a larger angle counts as a negative arc


def find_strand(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> Strand:
    """Find how a strand lies; row.Q: the centre of b. If it cannot be tangent to the sheaves its length is zero."""
    n: Vec3 = world_direction(scene, row.a, row.e)
    D: Vec3 = sub(row.Q, world_place(scene, row.a, row.p))
    h: cython.double = dot(n, D)
    p: Vec3 = add_scaled(D, -h, n)
    sigma: cython.double = row.g.x - row.g.y
    square: cython.double = dot(p, p)
    tangent_square: cython.double = square - sigma * sigma
    if not tangent_square > 0.0:
        tangent_square = 0.0
    l: cython.double = sqrt(tangent_square)
    S: cython.double = sqrt(tangent_square + h * h)
    inverse_square: cython.double = 1.0 / square if square > 0.0 else 0.0
    t: Vec3 = scale_vector(inverse_square, add_scaled(scale_vector(l, p), sigma, cross(n, p)))
    return Strand(n, t, cross(t, n), l, S, h, sigma)


def strand_slope(strand: Strand) -> Vec3:
    """Return g: the change of the strand's length as the centre of b moves."""
    if not strand.S > 0.0 or not strand.l > 0.0:
        return strand.t
    c: cython.double = strand.l / strand.S
    return add_scaled(
        add_scaled(scale_vector(c, strand.t), strand.h / strand.S, strand.n),
        -(1.0 - c) * strand.sigma / strand.l,
        strand.w,
    )


def find_strand_rate(strand: Strand, v: Vec3) -> StrandRate:
    """Return how a strand moves as its end moves with v, seen from a; bend: the effect of v on its second rate."""
    if not strand.S > 0.0 or not strand.l > 0.0:
        return StrandRate(0.0, 0.0, 0.0, 0.0)
    chi: cython.double = -dot(strand.w, v) / strand.l
    along: cython.double = dot(strand.t, v)
    l: cython.double = along - strand.sigma * chi
    S: cython.double = (strand.l * l + strand.h * dot(strand.n, v)) / strand.S
    bend: cython.double = (dot(v, v) - S * S) / strand.S - strand.sigma * chi * (along + l) / strand.l
    return StrandRate(chi, l, S, bend)


def measure_strand(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """g . (v_b - v_a) + s_b R_b n . (omega_b - omega_a), at the centre of b; its gap is its length alone.

    gamma = g . (cen_b - cen_a - 2 omega_a x (v_b - v_a)) + bend + s_b R_b (omega_a x n) . (omega_b - omega_a)
    """
    strand: Strand = find_strand(scene, row)
    b: PointKinematics = point_motion(scene, row.b, row.Q)
    a: PointKinematics = point_motion(scene, row.a, row.Q)
    v: Vec3 = sub(b.v, a.v)
    turn: Vec3 = sub(b.omega, a.omega)
    row.t = scale_vector(row.g.z, strand.t)
    row.f = strand_slope(strand)
    row.m = scale_vector(row.g.y, strand.n)
    row.gap = strand.S
    row.on_a = add_scaled(world_place(scene, row.a, row.p), row.g.x, strand.w)
    row.on_b = add_scaled(row.Q, row.g.y, strand.w)
    row.rate = dot(row.f, v) + dot(row.m, turn)
    row.gamma = dot(row.f, add_scaled(sub(b.centripetal, a.centripetal), -2.0, cross(a.omega, v)))
    row.gamma += find_strand_rate(strand, v).bend + dot(cross(a.omega, row.m), turn)


def clear_row_load(row: cython.pointer[Closure]) -> cython.void:
    """Set load and rates of a rope's length on a sheave to zero: its strands account for them."""
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    row.f = zero
    row.m = zero
    row.rate = 0.0
    row.gamma = 0.0


def measure_arc(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Find the length of rope on a sheave between the strand that arrives and the next one, which leaves.

    R times the angle between the strands, about the axis in the sense in which the rope goes round it.
    """
    n: Vec3 = world_direction(scene, row.a, row.e)
    arriving: Vec3 = scene.parts[row.part].t
    leaving: Vec3 = scene.parts[row.part + 1].t
    sense: cython.double = 1.0 if row.radius > 0.0 else -1.0
    angle: cython.double = atan2(sense * dot(n, cross(arriving, leaving)), dot(arriving, leaving))
    if angle < 0.0:
        angle += FULL_TURN
    if angle > NEARLY_ROUND:
        angle -= FULL_TURN
    row.gap = sense * row.radius * angle
    clear_row_load(row)


def measure_wound(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Find the length of a rope without slip that has been wound on its sheave since the start; seen from the carrier
    c.

    radius times the angle about n from e, both fixed in c, to the strand, plus ratio times the sheave's own coordinate.
    """
    n: Vec3 = world_direction(scene, row.c, row.g)
    e: Vec3 = world_direction(scene, row.c, row.e)
    t: Vec3 = scene.parts[row.part].t
    row.gap = row.radius * atan2(dot(n, cross(e, t)), dot(e, t))
    if row.ratio != 0.0:
        row.gap += row.ratio * scene.freedoms[row.freedom].q
    clear_row_load(row)
