"""Points on paths that the tree does not carry along: across a path (TRACK), and to one place along it (ALONG).

    TRACK   (r(s) - D) . r' = 0,  N . (D - r) = 0        D from P to Q, s the place of the path beside Q; axes of a
            u = r' . Ddot / (|r'|^2 - r'' . (D - r)),  gamma = N . (A - r'' u w),  w = r' . Ddot / |r'|^2
    ALONG   s - length = 0                               s the coordinate of a freedom along the path
            f = r' / |r'|^2,  gamma = f . (A - r'' u^2)
A: what of the second derivative of D as a sees it velocities make. N is one of two directions across the path: with h,
fixed in a, N = h x r' / |h x r'|, or r'/|r'| x that. The place s is sought from where the state counts it, so that the
branch of a path that crosses itself stays the same one. Beyond an open end there is none (NaN).
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import fabs

    from heuncli.kernel.algebra import Vec3, add_cross, add_scaled, cross, dot, norm, rotate_back, scaled, sub
    from heuncli.kernel.carried_points import carried, place_of
    from heuncli.kernel.directions import direction_of
    from heuncli.kernel.libm import NAN
    from heuncli.kernel.paths import beside, path_point
    from heuncli.kernel.scene import TRACK, Closure, Freedom, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.values import Carried, PathPoint, TrackFrame

    NEARING = 24  # Newton's steps to a place


def track_row(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """A row of either kind."""
    b: Carried = carried(scene, row.b, row.Q)
    a: Carried = carried(scene, row.a, row.Q)
    v: Vec3 = sub(b.v, a.v)
    A: Vec3 = add_scaled(sub(b.centripetal, a.centripetal), -2.0, cross(a.omega, v))
    row.m = Vec3(0.0, 0.0, 0.0)
    if row.kind == TRACK:
        across_row(scene, row, v, A)
    else:
        along_row_of(scene, row, v, A)


def across_row(scene: cython.pointer[Scene], row: cython.pointer[Closure], v: Vec3, A: Vec3) -> cython.void:
    """Across a path: v, A as a sees them, world axes."""
    here: PathPoint = place_in_world(scene, row)
    N: Vec3 = across(scene, row, here).N
    off: Vec3 = sub(sub(row.Q, place_of(scene, row.a, row.p)), here.r)
    way: cython.double = dot(here.slope, v) / dot(here.slope, here.slope)
    row.f = N
    row.gap = dot(N, off)
    row.rate = dot(N, v)
    row.gamma = dot(N, A) - dot(N, here.bend) * way * pace_along(here, off, v)


def pace_along(here: PathPoint, off: Vec3, v: Vec3) -> cython.double:
    """u of what moves with v a way beside its place on a path."""
    return dot(here.slope, v) / (dot(here.slope, here.slope) - dot(here.bend, off))


def pace_of(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """u, at which the place of a TRACK moves along its path."""
    here: PathPoint = place_in_world(scene, row)
    Q: Vec3 = place_of(scene, row.b, row.q)
    off: Vec3 = sub(sub(Q, place_of(scene, row.a, row.p)), here.r)
    return pace_along(here, off, sub(carried(scene, row.b, Q).v, carried(scene, row.a, Q).v))


def along_row_of(scene: cython.pointer[Scene], row: cython.pointer[Closure], v: Vec3, A: Vec3) -> cython.void:
    """To a place along a path that is a freedom of the tree."""
    freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[row.freedom])
    row.f = scaled(1.0 / dot(freedom.s, freedom.s), freedom.s)
    row.gap = freedom.q - row.length
    row.rate = dot(row.f, v)
    row.gamma = dot(row.f, A) - dot(row.f, freedom.curved) * freedom.u * freedom.u


def track_point(scene: cython.pointer[Scene], row: cython.pointer[Closure], s: cython.double) -> PathPoint:
    """What runs along the path of a TRACK at s; the last pieces of an open path go on beyond its ends."""
    first: cython.double = scene.pieces[row.lift].begin
    last: cython.double = scene.pieces[row.lift + row.pieces].begin
    inner: cython.double = s
    if row.period == 0.0:
        inner = first if s < first else last if s > last else s
    here: PathPoint = path_point(scene, row.lift, row.pieces, row.period, inner)
    h: cython.double = s - inner
    if h != 0.0:
        r: Vec3 = add_scaled(here.r, h, add_scaled(here.slope, 0.5 * h, add_scaled(here.bend, h / 3.0, here.twist)))
        slope: Vec3 = add_scaled(here.slope, h, add_scaled(here.bend, 0.5 * h, here.twist))
        here = PathPoint(r, slope, add_scaled(here.bend, h, here.twist), here.twist)
    if row.radius != 0.0:  # below 0 with h turned over, which is the same roller
        here = beside(here, row.radius, row.h)
    return here


def place_beside(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """The place s of the path beside the row's point, from one near it on; beyond an open end there is none (NaN)."""
    k: cython.int
    D: Vec3 = sub(place_of(scene, row.b, row.q), place_of(scene, row.a, row.p))
    if row.a >= 0:
        D = rotate_back(scene.bodies[row.a].R, D)
    first: cython.double = scene.pieces[row.lift].begin
    last: cython.double = scene.pieces[row.lift + row.pieces].begin
    s: cython.double = scene.counters[row.counter].counted
    near: cython.double = 1e-9 * (last - first)  # after so short a step the next one is rounding, as its square
    end: cython.double = 1e-12 * (last - first)  # rounding, by which a place may lie beyond an end
    for k in range(NEARING):
        here: PathPoint = track_point(scene, row, s)
        off: Vec3 = sub(here.r, D)
        square: cython.double = dot(here.slope, here.slope)
        curved: cython.double = square + dot(off, here.bend)
        step: cython.double = -dot(off, here.slope) / (curved if curved > 0.0 else square)
        s = s + step
        if fabs(step) <= near:
            break
    if row.period == 0.0 and not (s >= first - end and s <= last + end):
        return NAN
    return s


def place_in_world(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> PathPoint:
    """The place of the path beside the point of a TRACK, from P on, with its derivatives; world axes."""
    here: PathPoint = track_point(scene, row, place_beside(scene, row))
    return PathPoint(
        direction_of(scene, row.a, here.r),
        direction_of(scene, row.a, here.slope),
        direction_of(scene, row.a, here.bend),
        direction_of(scene, row.a, here.twist),
    )


def across(scene: cython.pointer[Scene], row: cython.pointer[Closure], here: PathPoint) -> TrackFrame:
    """The direction N across a path, and what it changes by along it, dN/ds, seen from a; world axes."""
    h: Vec3 = direction_of(scene, row.a, row.h)
    m: Vec3 = cross(h, here.slope)
    size: cython.double = norm(m)
    N: Vec3 = scaled(1.0 / size, m)
    m = cross(h, here.bend)
    dN: Vec3 = scaled(1.0 / size, add_scaled(m, -dot(N, m), N))
    if row.faced == 0:
        return TrackFrame(N, dN)
    size = norm(here.slope)
    t: Vec3 = scaled(1.0 / size, here.slope)
    dt: Vec3 = scaled(1.0 / size, add_scaled(here.bend, -dot(t, here.bend), t))
    return TrackFrame(cross(t, N), add_cross(cross(dt, N), t, dN))
