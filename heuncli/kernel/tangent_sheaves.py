"""The change of a strand of a rope along a direction of the state: sheaves.py, differentiated line by line."""

from __future__ import annotations

from heuncli.kernel.carried_points import point_motion
from heuncli.kernel.declarations import *
from heuncli.kernel.loads import body_omega
from heuncli.kernel.sheaves import find_strand, find_strand_rate
from heuncli.kernel.tangent_motion import omega_tangent, point_tangent
from heuncli.kernel.tangent_points import alpha_tangent, body_alpha, point_acceleration, point_motion_tangent


def strand_tangent(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> RowTangent:
    """g . (A_b - A_a - 2 omega_a x (v_b - v_a)) + bend, and the same of the couple s_b R_b n."""
    strand: Strand = find_strand(scene, row)
    dQ: Vec3 = point_tangent(scene, row.b, row.q).x
    turn: Vec3 = body_rotation(scene, row.a)
    omega: Vec3 = body_omega(scene, row.a)
    b: MotionTangent = point_motion_tangent(scene, row.b, row.Q, dQ)
    a: MotionTangent = point_motion_tangent(scene, row.a, row.Q, dQ)
    v: Vec3 = sub(point_motion(scene, row.b, row.Q).v, point_motion(scene, row.a, row.Q).v)
    dv: Vec3 = sub(b.v, a.v)
    displacement: Vec3 = sub(dQ, point_displacement(scene, row.a, row.Q))
    velocity_change: Vec3 = sub(dv, cross(turn, v))
    dg: Vec3 = add(cross(turn, row.f), strand_slope_tangent(strand, displacement))
    A: Vec3 = sub(point_acceleration(scene, row.b, row.Q), point_acceleration(scene, row.a, row.Q))
    A = add_scaled(A, -2.0, cross(omega, v))
    dA: Vec3 = add_scaled(sub(b.a, a.a), -2.0, add_cross(cross(omega_tangent(scene, row.a), v), omega, dv))
    couple: RowTangent = strand_couple_tangent(scene, row, dQ, cross(turn, row.m))
    rate: cython.double = dot(dg, v) + dot(row.f, dv) + couple.rate
    acceleration: cython.double = (
        dot(dg, A) + dot(row.f, dA) + strand_bend_tangent(strand, displacement, v, velocity_change)
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
