"""The change of rows of points on paths along a direction of the state: tracks.py, differentiated line by line."""

from __future__ import annotations

from heuncli.kernel.carried_points import point_motion, world_place
from heuncli.kernel.declarations import *
from heuncli.kernel.loads import body_omega
from heuncli.kernel.tangent_motion import omega_tangent, point_tangent, rotation_tangent, vector_tangent
from heuncli.kernel.tangent_points import point_acceleration, point_motion_tangent
from heuncli.kernel.tracks import find_track_frame, find_world_track_place


def track_row_tangent(scene: cython.pointer[Scene], row: cython.pointer[Closure], Q: Vec3) -> RowTangent:
    """Return the change of a row of either kind: N . (A - r'' u^2); for the coordinate of a freedom s''."""
    if row.kind == TRACK:
        return across_track_tangent(scene, row, Q)
    freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[row.freedom])
    freedom_tangent: cython.pointer[FreedomTangent] = cython.address(scene.freedom_tangents[row.freedom])
    square: cython.double = dot(freedom.s, freedom.s)
    length_change: cython.double = 2.0 * dot(freedom.s, freedom_tangent.s) / square
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    return RowTangent(
        Q,
        scale_vector(1.0 / square, add_scaled(freedom_tangent.s, -length_change, freedom.s)),
        zero,
        freedom_tangent.u,
        0.0,
    )


def across_track_tangent(scene: cython.pointer[Scene], row: cython.pointer[Closure], Q: Vec3) -> RowTangent:
    """Return the change of a row across a path."""
    track_place: PathPoint = find_world_track_place(scene, row)
    d: PlaceTangent = track_place_tangent(scene, row, track_place, Q)
    frame: TrackFrame = find_track_frame(scene, row, track_place)
    omega: Vec3 = body_omega(scene, row.a)
    b: MotionTangent = point_motion_tangent(scene, row.b, row.Q, Q)
    a: MotionTangent = point_motion_tangent(scene, row.a, row.Q, Q)
    v: Vec3 = sub(point_motion(scene, row.b, row.Q).v, point_motion(scene, row.a, row.Q).v)
    dv: Vec3 = sub(b.v, a.v)
    A: Vec3 = sub(point_acceleration(scene, row.b, row.Q), point_acceleration(scene, row.a, row.Q))
    A = add_scaled(A, -2.0, cross(omega, v))
    dA: Vec3 = add_scaled(sub(b.a, a.a), -2.0, add_cross(cross(omega_tangent(scene, row.a), v), omega, dv))
    N: Vec3 = add_scaled(vector_tangent(scene, row.a, frame.N), d.s, frame.change)
    square: cython.double = dot(track_place.slope, track_place.slope)
    u: cython.double = dot(track_place.slope, v) / d.square
    w: cython.double = dot(track_place.slope, v) / square
    change: cython.double = dot(d.slope, v) + dot(track_place.slope, dv)
    du: cython.double = (change - u * d.squared) / d.square
    dw: cython.double = (change - 2.0 * w * dot(track_place.slope, d.slope)) / square
    curved: cython.double = dot(frame.N, track_place.bend)
    bent: cython.double = (dot(N, track_place.bend) + dot(frame.N, d.bend)) * u * w + curved * (du * w + u * dw)
    acceleration: cython.double = dot(N, A) + dot(frame.N, dA) - bent
    return RowTangent(Q, N, Vec3(0.0, 0.0, 0.0), dot(N, v) + dot(frame.N, dv), acceleration)


def track_place_tangent(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], track_place: PathPoint, Q: Vec3
) -> PlaceTangent:
    """Return the change of the place, ds = r' . dD / (|r'|^2 - r'' . (D - r)), of its slope and bend, and that divisor
    with its change.
    """
    arm: Vec3 = sub(world_place(scene, row.b, row.q), world_place(scene, row.a, row.p))
    displacement: Vec3 = sub(Q, point_tangent(scene, row.a, row.p).x)
    displacement = sub(displacement, cross(rotation_tangent(scene, row.a), arm))
    offset: Vec3 = sub(arm, track_place.r)
    square: cython.double = dot(track_place.slope, track_place.slope) - dot(track_place.bend, offset)
    s: cython.double = dot(track_place.slope, displacement) / square
    slope: Vec3 = add_scaled(vector_tangent(scene, row.a, track_place.slope), s, track_place.bend)
    bend: Vec3 = add_scaled(vector_tangent(scene, row.a, track_place.bend), s, track_place.twist)
    squared: cython.double = (
        3.0 * s * dot(track_place.slope, track_place.bend)
        - s * dot(track_place.twist, offset)
        - dot(track_place.bend, displacement)
    )
    return PlaceTangent(s, slope, bend, square, squared)


def track_speed_tangent(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Return the change of the rate u of the place of a TRACK."""
    Q: Vec3 = world_place(scene, row.b, row.q)
    dQ: Vec3 = point_tangent(scene, row.b, row.q).x
    track_place: PathPoint = find_world_track_place(scene, row)
    d: PlaceTangent = track_place_tangent(scene, row, track_place, dQ)
    b: MotionTangent = point_motion_tangent(scene, row.b, Q, dQ)
    a: MotionTangent = point_motion_tangent(scene, row.a, Q, dQ)
    v: Vec3 = sub(point_motion(scene, row.b, Q).v, point_motion(scene, row.a, Q).v)
    change: cython.double = dot(d.slope, v) + dot(track_place.slope, sub(b.v, a.v))
    return (change - dot(track_place.slope, v) / d.square * d.squared) / d.square
