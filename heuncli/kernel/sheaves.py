"""Ropes over sheaves: their strands, and the lengths that lie on the sheaves.

    S + sigma chi      a strand between sheave a and sheave or point b, seen from a; sigma = s_a R_a - s_b R_b

n: axis of a; s = 1 if the rope goes round its sheave counter-clockwise about n, as it goes from a to b; p: the vector
from centre to centre across n, h: along n; t: direction of the strand across n, chi: its angle about n, w = t x n:

    p = l t + sigma w        l^2 = p^2 - sigma^2        S^2 = l^2 + h^2

The strand leaves each sheave where it would for h = 0: its length is that of a straight rope between these two places.
Its pull is the gradient g of that, so that no work is lost, and its moment about each axis is the pull times R. The
pull differs from the tension by (h/l)^2/2 at most if the strand is long compared with R, and not at all if h = 0.

Below: the change of a strand along a direction of the state, line by line.
"""

from __future__ import annotations

from math import atan2, sqrt

from heuncli.kernel.carried_points import (
    alpha_tangent,
    body_alpha,
    body_omega,
    find_relative_motion,
    point_motion,
    relative_centripetal,
    world_place,
)
from heuncli.kernel.declarations import *
from heuncli.kernel.tangent_motion import omega_tangent, point_tangent

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
    row.gamma = dot(row.f, relative_centripetal(a, b, v))
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


# Along a direction of the state


def strand_tangent(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> RowTangent:
    """g . (A_b - A_a - 2 omega_a x (v_b - v_a)) + bend, and the same of the couple s_b R_b n."""
    strand: Strand = find_strand(scene, row)
    dQ: Vec3 = point_tangent(scene, row.b, row.q).x
    turn: Vec3 = body_rotation(scene, row.a)
    d: RelativeMotion = find_relative_motion(scene, row, dQ)
    displacement: Vec3 = sub(dQ, point_displacement(scene, row.a, row.Q))
    velocity_change: Vec3 = sub(d.dv, cross(turn, d.v))
    dg: Vec3 = add(cross(turn, row.f), strand_slope_tangent(strand, displacement))
    couple: RowTangent = strand_couple_tangent(scene, row, dQ, cross(turn, row.m))
    rate: cython.double = dot(dg, d.v) + dot(row.f, d.dv) + couple.rate
    acceleration: cython.double = (
        dot(dg, d.A) + dot(row.f, d.dA) + strand_bend_tangent(strand, displacement, d.v, velocity_change)
    )
    return RowTangent(dQ, dg, couple.m, rate, acceleration + couple.acceleration)


def body_rotation(scene: cython.pointer[Scene], body: cython.int) -> Vec3:
    """Return the small rotation of a body; zero for the ground."""
    if body < 0:
        return Vec3(0.0, 0.0, 0.0)
    return scene.tangents[body].turn


def point_displacement(scene: cython.pointer[Scene], body: cython.int, x: Vec3) -> Vec3:
    """Return the displacement of the body's point at the place x."""
    if body < 0:
        return Vec3(0.0, 0.0, 0.0)
    return add_cross(scene.tangents[body].r, scene.tangents[body].turn, sub(x, scene.bodies[body].r))


def strand_slope_tangent(strand: Strand, displacement: Vec3) -> Vec3:
    """Return the change of g for a displacement of the strand's end, seen from a."""
    if not strand.S > 0.0 or not strand.l > 0.0:
        return Vec3(0.0, 0.0, 0.0)
    d: StrandRate = find_strand_rate(strand, displacement)
    c: cython.double = strand.l / strand.S
    k: cython.double = (1.0 - c) * strand.sigma / strand.l
    dc: cython.double = (d.l - c * d.S) / strand.S
    dk: cython.double = -(dc * strand.sigma + k * d.l) / strand.l
    slant: cython.double = (dot(strand.n, displacement) - strand.h / strand.S * d.S) / strand.S
    total: Vec3 = add_scaled(scale_vector(dc - k * d.chi, strand.t), slant, strand.n)
    return add_scaled(total, -c * d.chi - dk, strand.w)


def strand_bend_tangent(strand: Strand, displacement: Vec3, v: Vec3, dv: Vec3) -> cython.double:
    """Return the change of the bend for a displacement of the end and a change dv of its velocity v, seen from a."""
    if not strand.S > 0.0 or not strand.l > 0.0:
        return 0.0
    d: StrandRate = find_strand_rate(strand, displacement)
    u: StrandRate = find_strand_rate(strand, v)
    along: cython.double = dot(strand.t, v)
    dalong: cython.double = dot(strand.t, dv) - d.chi * dot(strand.w, v)
    dchi: cython.double = -(dot(strand.w, dv) + d.chi * along + u.chi * d.l) / strand.l
    dl: cython.double = dalong - strand.sigma * dchi
    slant: cython.double = (
        d.l * u.l + strand.l * dl + dot(strand.n, displacement) * dot(strand.n, v) + strand.h * dot(strand.n, dv)
    )
    dS: cython.double = (slant - u.S * d.S) / strand.S
    straight: cython.double = (dot(v, v) - u.S * u.S) / strand.S
    total: cython.double = (2.0 * dot(v, dv) - 2.0 * u.S * dS - straight * d.S) / strand.S
    both: cython.double = along + u.l
    wound: cython.double = dchi * both + u.chi * (dalong + dl) - u.chi * both * d.l / strand.l
    return total - strand.sigma * wound / strand.l


def strand_couple_tangent(scene: cython.pointer[Scene], row: cython.pointer[Closure], dQ: Vec3, dm: Vec3) -> RowTangent:
    """m . (alpha_b - alpha_a) + (omega_a x m) . (omega_b - omega_a), m fixed in a."""
    a: Vec3 = body_omega(scene, row.a)
    da: Vec3 = omega_tangent(scene, row.a)
    turn: Vec3 = sub(body_omega(scene, row.b), a)
    change: Vec3 = sub(omega_tangent(scene, row.b), da)
    A: Vec3 = sub(body_alpha(scene, row.b), body_alpha(scene, row.a))
    dA: Vec3 = sub(alpha_tangent(scene, row.b), alpha_tangent(scene, row.a))
    bent: cython.double = dot(add_cross(cross(da, row.m), a, dm), turn) + dot(cross(a, row.m), change)
    rate: cython.double = dot(dm, turn) + dot(row.m, change)
    return RowTangent(dQ, dm, dm, rate, dot(dm, A) + dot(row.m, dA) + bent)
