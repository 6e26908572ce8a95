"""What a strand of a rope changes by along a direction of the state: sheaves.py, differentiated line by line."""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import Vec3, add, add_cross, add_scaled, cross, dot, scaled, sub
    from heuncli.kernel.carried_points import carried
    from heuncli.kernel.loads import omega_of
    from heuncli.kernel.scene import Closure, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.sheaves import strand_of, strand_rate
    from heuncli.kernel.tangent_motion import omega_along, point_along
    from heuncli.kernel.tangent_points import acceleration_at, alpha_along, alpha_at, carried_along
    from heuncli.kernel.values import MotionTangent, RowTangent, Strand, StrandRate


def strand_along(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> RowTangent:
    """g . (A_b - A_a - 2 omega_a x (v_b - v_a)) + bend, and the same of the couple s_b R_b n."""
    of: Strand = strand_of(scene, row)
    dQ: Vec3 = point_along(scene, row.b, row.q).x
    turn: Vec3 = swung_by(scene, row.a)
    omega: Vec3 = omega_of(scene, row.a)
    b: MotionTangent = carried_along(scene, row.b, row.Q, dQ)
    a: MotionTangent = carried_along(scene, row.a, row.Q, dQ)
    v: Vec3 = sub(carried(scene, row.b, row.Q).v, carried(scene, row.a, row.Q).v)
    dv: Vec3 = sub(b.v, a.v)
    way: Vec3 = sub(dQ, carried_by(scene, row.a, row.Q))
    own: Vec3 = sub(dv, cross(turn, v))
    dg: Vec3 = add(cross(turn, row.f), slope_along(of, way))
    A: Vec3 = sub(acceleration_at(scene, row.b, row.Q), acceleration_at(scene, row.a, row.Q))
    A = add_scaled(A, -2.0, cross(omega, v))
    dA: Vec3 = add_scaled(sub(b.a, a.a), -2.0, add_cross(cross(omega_along(scene, row.a), v), omega, dv))
    couple: RowTangent = couple_along(scene, row, dQ, cross(turn, row.m))
    rate: cython.double = dot(dg, v) + dot(row.f, dv) + couple.rate
    found: cython.double = dot(dg, A) + dot(row.f, dA) + bend_along(of, way, v, own)
    return RowTangent(dQ, dg, couple.m, rate, found + couple.acceleration)


def swung_by(scene: cython.pointer[Scene], body: cython.int) -> Vec3:
    """The small turn of a body; none of the ground's."""
    if body < 0:
        return Vec3(0.0, 0.0, 0.0)
    return scene.tangents[body].turn


def carried_by(scene: cython.pointer[Scene], body: cython.int, x: Vec3) -> Vec3:
    """The way of the body's point at the place x."""
    if body < 0:
        return Vec3(0.0, 0.0, 0.0)
    return add_cross(scene.tangents[body].r, scene.tangents[body].turn, sub(x, scene.bodies[body].r))


def slope_along(of: Strand, way: Vec3) -> Vec3:
    """What g changes by as the end of a strand goes a way, seen from a."""
    if not of.S > 0.0 or not of.l > 0.0:
        return Vec3(0.0, 0.0, 0.0)
    d: StrandRate = strand_rate(of, way)
    c: cython.double = of.l / of.S
    k: cython.double = (1.0 - c) * of.sigma / of.l
    dc: cython.double = (d.l - c * d.S) / of.S
    dk: cython.double = -(dc * of.sigma + k * d.l) / of.l
    slant: cython.double = (dot(of.n, way) - of.h / of.S * d.S) / of.S
    found: Vec3 = add_scaled(scaled(dc - k * d.chi, of.t), slant, of.n)
    return add_scaled(found, -c * d.chi - dk, of.w)


def bend_along(of: Strand, way: Vec3, v: Vec3, dv: Vec3) -> cython.double:
    """What the bend changes by as the end goes a way and its velocity v changes by dv, all seen from a."""
    if not of.S > 0.0 or not of.l > 0.0:
        return 0.0
    d: StrandRate = strand_rate(of, way)
    u: StrandRate = strand_rate(of, v)
    along: cython.double = dot(of.t, v)
    dalong: cython.double = dot(of.t, dv) - d.chi * dot(of.w, v)
    dchi: cython.double = -(dot(of.w, dv) + d.chi * along + u.chi * d.l) / of.l
    dl: cython.double = dalong - of.sigma * dchi
    slant: cython.double = d.l * u.l + of.l * dl + dot(of.n, way) * dot(of.n, v) + of.h * dot(of.n, dv)
    dS: cython.double = (slant - u.S * d.S) / of.S
    straight: cython.double = (dot(v, v) - u.S * u.S) / of.S
    found: cython.double = (2.0 * dot(v, dv) - 2.0 * u.S * dS - straight * d.S) / of.S
    both: cython.double = along + u.l
    wound: cython.double = dchi * both + u.chi * (dalong + dl) - u.chi * both * d.l / of.l
    return found - of.sigma * wound / of.l


def couple_along(scene: cython.pointer[Scene], row: cython.pointer[Closure], dQ: Vec3, dm: Vec3) -> RowTangent:
    """m . (alpha_b - alpha_a) + (omega_a x m) . (omega_b - omega_a), m fixed in a."""
    a: Vec3 = omega_of(scene, row.a)
    da: Vec3 = omega_along(scene, row.a)
    turn: Vec3 = sub(omega_of(scene, row.b), a)
    change: Vec3 = sub(omega_along(scene, row.b), da)
    A: Vec3 = sub(alpha_at(scene, row.b), alpha_at(scene, row.a))
    dA: Vec3 = sub(alpha_along(scene, row.b), alpha_along(scene, row.a))
    bent: cython.double = dot(add_cross(cross(da, row.m), a, dm), turn) + dot(cross(a, row.m), change)
    rate: cython.double = dot(dm, turn) + dot(row.m, change)
    return RowTangent(dQ, dm, dm, rate, dot(dm, A) + dot(row.m, dA) + bent)
