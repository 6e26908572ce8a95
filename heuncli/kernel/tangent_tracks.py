"""What rows of points on paths change by along a direction of the state: tracks.py, differentiated line by line."""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import Vec3, add_cross, add_scaled, cross, dot, scaled, sub
    from heuncli.kernel.carried_points import carried, place_of
    from heuncli.kernel.loads import omega_of
    from heuncli.kernel.scene import TRACK, Closure, Freedom, FreedomTangent, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.tangent_motion import omega_along, point_along, swung, turn_along_of
    from heuncli.kernel.tangent_points import acceleration_at, carried_along
    from heuncli.kernel.tracks import across, place_in_world
    from heuncli.kernel.values import MotionTangent, PathPoint, PlaceTangent, RowTangent, TrackFrame


def track_along(scene: cython.pointer[Scene], row: cython.pointer[Closure], Q: Vec3) -> RowTangent:
    """What a row of either kind changes by: N . (A - r'' u^2); of the coordinate of a freedom s''."""
    if row.kind == TRACK:
        return across_along(scene, row, Q)
    freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[row.freedom])
    own: cython.pointer[FreedomTangent] = cython.address(scene.freedom_tangents[row.freedom])
    square: cython.double = dot(freedom.s, freedom.s)
    turned: cython.double = 2.0 * dot(freedom.s, own.s) / square
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    return RowTangent(Q, scaled(1.0 / square, add_scaled(own.s, -turned, freedom.s)), zero, own.u, 0.0)


def across_along(scene: cython.pointer[Scene], row: cython.pointer[Closure], Q: Vec3) -> RowTangent:
    """Of a row across a path."""
    here: PathPoint = place_in_world(scene, row)
    d: PlaceTangent = place_along(scene, row, here, Q)
    frame: TrackFrame = across(scene, row, here)
    omega: Vec3 = omega_of(scene, row.a)
    b: MotionTangent = carried_along(scene, row.b, row.Q, Q)
    a: MotionTangent = carried_along(scene, row.a, row.Q, Q)
    v: Vec3 = sub(carried(scene, row.b, row.Q).v, carried(scene, row.a, row.Q).v)
    dv: Vec3 = sub(b.v, a.v)
    A: Vec3 = sub(acceleration_at(scene, row.b, row.Q), acceleration_at(scene, row.a, row.Q))
    A = add_scaled(A, -2.0, cross(omega, v))
    dA: Vec3 = add_scaled(sub(b.a, a.a), -2.0, add_cross(cross(omega_along(scene, row.a), v), omega, dv))
    N: Vec3 = add_scaled(swung(scene, row.a, frame.N), d.s, frame.change)
    square: cython.double = dot(here.slope, here.slope)
    u: cython.double = dot(here.slope, v) / d.square
    w: cython.double = dot(here.slope, v) / square
    change: cython.double = dot(d.slope, v) + dot(here.slope, dv)
    du: cython.double = (change - u * d.squared) / d.square
    dw: cython.double = (change - 2.0 * w * dot(here.slope, d.slope)) / square
    curved: cython.double = dot(frame.N, here.bend)
    bent: cython.double = (dot(N, here.bend) + dot(frame.N, d.bend)) * u * w + curved * (du * w + u * dw)
    acceleration: cython.double = dot(N, A) + dot(frame.N, dA) - bent
    return RowTangent(Q, N, Vec3(0.0, 0.0, 0.0), dot(N, v) + dot(frame.N, dv), acceleration)


def place_along(scene: cython.pointer[Scene], row: cython.pointer[Closure], here: PathPoint, Q: Vec3) -> PlaceTangent:
    """What the place changes by, ds = r' . dD / (|r'|^2 - r'' . (D - r)), its slope and bend, and that divisor."""
    arm: Vec3 = sub(place_of(scene, row.b, row.q), place_of(scene, row.a, row.p))
    moved: Vec3 = sub(Q, point_along(scene, row.a, row.p).x)
    moved = sub(moved, cross(turn_along_of(scene, row.a), arm))
    off: Vec3 = sub(arm, here.r)
    square: cython.double = dot(here.slope, here.slope) - dot(here.bend, off)
    s: cython.double = dot(here.slope, moved) / square
    slope: Vec3 = add_scaled(swung(scene, row.a, here.slope), s, here.bend)
    bend: Vec3 = add_scaled(swung(scene, row.a, here.bend), s, here.twist)
    squared: cython.double = 3.0 * s * dot(here.slope, here.bend) - s * dot(here.twist, off) - dot(here.bend, moved)
    return PlaceTangent(s, slope, bend, square, squared)


def pace_of_along(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """What the rate u of the place of a TRACK changes by."""
    Q: Vec3 = place_of(scene, row.b, row.q)
    dQ: Vec3 = point_along(scene, row.b, row.q).x
    here: PathPoint = place_in_world(scene, row)
    d: PlaceTangent = place_along(scene, row, here, dQ)
    b: MotionTangent = carried_along(scene, row.b, Q, dQ)
    a: MotionTangent = carried_along(scene, row.a, Q, dQ)
    v: Vec3 = sub(carried(scene, row.b, Q).v, carried(scene, row.a, Q).v)
    change: cython.double = dot(d.slope, v) + dot(here.slope, sub(b.v, a.v))
    return (change - dot(here.slope, v) / d.square * d.squared) / d.square
