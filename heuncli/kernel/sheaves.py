"""Ropes over sheaves: their strands, and what of them lies on the sheaves.

    S + sigma chi      a strand between sheave a and sheave or point b, seen from a; sigma = s_a R_a - s_b R_b
n: axis of a; s = 1 where the rope runs round its sheave counter-clockwise about n, as it runs from a to b; p: the way
from centre to centre across n, h: along n; t: direction of the strand across n, chi: its angle about n, w = t x n:

    p = l t + sigma w        l^2 = p^2 - sigma^2        S^2 = l^2 + h^2
The strand leaves each sheave where it would without h: its length is that of a straight rope between these two places.
Its pull is the slope g of that, so that no work is lost, and its moment about each axis is the pull times R; the pull
is off the tension by (h/l)^2/2 at most where the strand is long against R, and by nothing where h = 0.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import atan2, sqrt

    from heuncli.kernel.algebra import Vec3, add_scaled, cross, dot, scaled, sub
    from heuncli.kernel.carried_points import carried, place_of
    from heuncli.kernel.directions import direction_of
    from heuncli.kernel.scene import Closure, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.values import Carried, Strand, StrandRate

WHOLE_TURN = 6.283185307179586
NEARLY_ROUND = 5.497787143782138  # 7/4 pi: of an arc more than that is less than none


def strand_of(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> Strand:
    """How a strand lies; row.Q: the centre of b. Where it could touch the sheave nowhere its length is none."""
    n: Vec3 = direction_of(scene, row.a, row.e)
    D: Vec3 = sub(row.Q, place_of(scene, row.a, row.p))
    h: cython.double = dot(n, D)
    p: Vec3 = add_scaled(D, -h, n)
    sigma: cython.double = row.g.x - row.g.y
    square: cython.double = dot(p, p)
    free: cython.double = square - sigma * sigma
    if not free > 0.0:
        free = 0.0
    l: cython.double = sqrt(free)
    S: cython.double = sqrt(free + h * h)
    by: cython.double = 1.0 / square if square > 0.0 else 0.0
    t: Vec3 = scaled(by, add_scaled(scaled(l, p), sigma, cross(n, p)))
    return Strand(n, t, cross(t, n), l, S, h, sigma)


def slope_of(of: Strand) -> Vec3:
    """g: what the strand's length grows by as the centre of b moves."""
    if not of.S > 0.0 or not of.l > 0.0:
        return of.t
    c: cython.double = of.l / of.S
    return add_scaled(add_scaled(scaled(c, of.t), of.h / of.S, of.n), -(1.0 - c) * of.sigma / of.l, of.w)


def strand_rate(of: Strand, v: Vec3) -> StrandRate:
    """How a strand moves as its end does with v, seen from a; bend: what v alone makes of its second derivative."""
    if not of.S > 0.0 or not of.l > 0.0:
        return StrandRate(0.0, 0.0, 0.0, 0.0)
    chi: cython.double = -dot(of.w, v) / of.l
    along: cython.double = dot(of.t, v)
    l: cython.double = along - of.sigma * chi
    S: cython.double = (of.l * l + of.h * dot(of.n, v)) / of.S
    bend: cython.double = (dot(v, v) - S * S) / of.S - of.sigma * chi * (along + l) / of.l
    return StrandRate(chi, l, S, bend)


def strand_part(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """g . (v_b - v_a) + s_b R_b n . (omega_b - omega_a), at the centre of b; its gap is its length alone.

    gamma = g . (cen_b - cen_a - 2 omega_a x (v_b - v_a)) + bend + s_b R_b (omega_a x n) . (omega_b - omega_a)
    """
    of: Strand = strand_of(scene, row)
    b: Carried = carried(scene, row.b, row.Q)
    a: Carried = carried(scene, row.a, row.Q)
    v: Vec3 = sub(b.v, a.v)
    turn: Vec3 = sub(b.omega, a.omega)
    row.t = scaled(row.g.z, of.t)
    row.f = slope_of(of)
    row.m = scaled(row.g.y, of.n)
    row.gap = of.S
    row.on_a = add_scaled(place_of(scene, row.a, row.p), row.g.x, of.w)
    row.on_b = add_scaled(row.Q, row.g.y, of.w)
    row.rate = dot(row.f, v) + dot(row.m, turn)
    row.gamma = dot(row.f, add_scaled(sub(b.centripetal, a.centripetal), -2.0, cross(a.omega, v)))
    row.gamma += strand_rate(of, v).bend + dot(cross(a.omega, row.m), turn)


def lie_free(row: cython.pointer[Closure]) -> cython.void:
    """What only lies on a sheave loads nothing, and its strands tell how it grows."""
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    row.f = zero
    row.m = zero
    row.rate = 0.0
    row.gamma = 0.0


def arc_part(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """What of a rope lies on a sheave between the strand that arrives and the next one, which leaves.

    R times the angle between the strands, about the axis in the sense in which the rope runs round it.
    """
    n: Vec3 = direction_of(scene, row.a, row.e)
    before: Vec3 = scene.parts[row.part].t
    behind: Vec3 = scene.parts[row.part + 1].t
    sense: cython.double = 1.0 if row.radius > 0.0 else -1.0
    angle: cython.double = atan2(sense * dot(n, cross(before, behind)), dot(before, behind))
    if angle < 0.0:
        angle += WHOLE_TURN
    if angle > NEARLY_ROUND:
        angle -= WHOLE_TURN
    row.gap = sense * row.radius * angle
    lie_free(row)


def wound_part(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """What of a rope that does not slip is wound on its sheave, more than at first; seen from the carrier c.

    radius times the angle about n from e, both fixed in c, to the strand, and ratio times the sheave's own coordinate.
    """
    n: Vec3 = direction_of(scene, row.c, row.g)
    e: Vec3 = direction_of(scene, row.c, row.e)
    t: Vec3 = scene.parts[row.part].t
    row.gap = row.radius * atan2(dot(n, cross(e, t)), dot(e, t))
    if row.ratio != 0.0:
        row.gap += row.ratio * scene.freedoms[row.freedom].q
    lie_free(row)
