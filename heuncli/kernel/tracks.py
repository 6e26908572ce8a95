"""Points on paths that the tree does not move along: across a path (TRACK), and to one place along it (ALONG).

    TRACK   (r(s) - D) . r' = 0,  N . (D - r) = 0        D from P to Q, s the place of the path nearest to Q; axes of a
            u = r' . Ddot / (|r'|^2 - r'' . (D - r)),  gamma = N . (A - r'' u w),  w = r' . Ddot / |r'|^2
    ALONG   s - length = 0                               s the coordinate of a freedom along the path
            f = r' / |r'|^2,  gamma = f . (A - r'' u^2)

A: the velocity-dependent part of the second derivative of D as seen from a. N is one of two directions across the path:
with h, fixed in a, N = h x r' / |h x r'|, or r'/|r'| x that. The place s is searched from the value counted in the
state, so that the point stays on its branch of a path that crosses itself. Outside an open path there is no place
(NaN).

Below: the change along a direction of the state, line by line.
"""

from __future__ import annotations

from math import fabs

from heuncli.kernel.carried_points import (
    find_relative_motion,
    point_motion,
    point_motion_tangent,
    relative_centripetal,
    world_place,
)
from heuncli.kernel.declarations import *
from heuncli.kernel.libm import NAN
from heuncli.kernel.paths import evaluate_path, offset_path
from heuncli.kernel.tangent_motion import point_tangent, rotation_tangent, vector_tangent

MAX_PLACE_ITERATIONS = 24  # Newton's steps to a place


def measure_track(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Find unit load, gap, rate and gamma of a row of either kind."""
    b: PointKinematics = point_motion(scene, row.b, row.Q)
    a: PointKinematics = point_motion(scene, row.a, row.Q)
    v: Vec3 = sub(b.v, a.v)
    A: Vec3 = relative_centripetal(a, b, v)
    row.m = Vec3(0.0, 0.0, 0.0)
    if row.kind == TRACK:
        measure_across_track(scene, row, v, A)
    else:
        measure_along_track(scene, row, v, A)


def measure_across_track(scene: cython.pointer[Scene], row: cython.pointer[Closure], v: Vec3, A: Vec3) -> cython.void:
    """Measure a row across a path: v, A as seen from a, world axes."""
    track_place: PathPoint = find_world_track_place(scene, row)
    N: Vec3 = find_track_frame(scene, row, track_place).N
    offset: Vec3 = sub(sub(row.Q, world_place(scene, row.a, row.p)), track_place.r)
    speed: cython.double = dot(track_place.slope, v) / dot(track_place.slope, track_place.slope)
    row.f = N
    row.gap = dot(N, offset)
    row.rate = dot(N, v)
    row.gamma = dot(N, A) - dot(N, track_place.bend) * speed * place_speed(track_place, offset, v)


def place_speed(track_place: PathPoint, offset: Vec3, v: Vec3) -> cython.double:
    """Return u of the place of a point that moves with v at an offset from the path."""
    return dot(track_place.slope, v) / (dot(track_place.slope, track_place.slope) - dot(track_place.bend, offset))


def track_speed(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Return u, the rate at which the place of a TRACK moves along its path."""
    track_place: PathPoint = find_world_track_place(scene, row)
    Q: Vec3 = world_place(scene, row.b, row.q)
    offset: Vec3 = sub(sub(Q, world_place(scene, row.a, row.p)), track_place.r)
    return place_speed(track_place, offset, sub(point_motion(scene, row.b, Q).v, point_motion(scene, row.a, Q).v))


def measure_along_track(scene: cython.pointer[Scene], row: cython.pointer[Closure], v: Vec3, A: Vec3) -> cython.void:
    """Measure a row to a place along a path that is a freedom of the tree."""
    freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[row.freedom])
    row.f = scale_vector(1.0 / dot(freedom.s, freedom.s), freedom.s)
    row.gap = freedom.q - row.length
    row.rate = dot(row.f, v)
    row.gamma = dot(row.f, A) - dot(row.f, freedom.curved) * freedom.u * freedom.u


def evaluate_track(scene: cython.pointer[Scene], row: cython.pointer[Closure], s: cython.double) -> PathPoint:
    """Evaluate the path of a TRACK at s; the last pieces of an open path are extended past its ends."""
    first: cython.double = scene.pieces[row.lift].begin
    last: cython.double = scene.pieces[row.lift + row.pieces].begin
    clipped_place: cython.double = s
    if row.period == 0.0:
        clipped_place = first if s < first else last if s > last else s
    track_place: PathPoint = evaluate_path(scene, row.lift, row.pieces, row.period, clipped_place)
    h: cython.double = s - clipped_place
    if h != 0.0:
        r: Vec3 = add_scaled(
            track_place.r,
            h,
            add_scaled(track_place.slope, 0.5 * h, add_scaled(track_place.bend, h / 3.0, track_place.twist)),
        )
        slope: Vec3 = add_scaled(track_place.slope, h, add_scaled(track_place.bend, 0.5 * h, track_place.twist))
        track_place = PathPoint(r, slope, add_scaled(track_place.bend, h, track_place.twist), track_place.twist)
    if row.radius != 0.0:  # a negative radius with reversed h is the same roller
        track_place = offset_path(track_place, row.radius, row.h)
    return track_place


def find_track_place(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Find the place s of the path nearest to the row's point, from the counted one on; NaN outside an open path."""
    k: cython.int
    D: Vec3 = sub(world_place(scene, row.b, row.q), world_place(scene, row.a, row.p))
    if row.a >= 0:
        D = rotate_back(scene.bodies[row.a].R, D)
    first: cython.double = scene.pieces[row.lift].begin
    last: cython.double = scene.pieces[row.lift + row.pieces].begin
    s: cython.double = scene.counters[row.counter].value
    tolerance: cython.double = 1e-9 * (last - first)  # after a step this short the next one, its square, is rounding
    end_tolerance: cython.double = 1e-12 * (last - first)  # rounding by which a place may lie outside the path
    for k in range(MAX_PLACE_ITERATIONS):
        track_place: PathPoint = evaluate_track(scene, row, s)
        offset: Vec3 = sub(track_place.r, D)
        square: cython.double = dot(track_place.slope, track_place.slope)
        curved: cython.double = square + dot(offset, track_place.bend)
        step: cython.double = -dot(offset, track_place.slope) / (curved if curved > 0.0 else square)
        s = s + step
        if fabs(step) <= tolerance:
            break
    if row.period == 0.0 and not (s >= first - end_tolerance and s <= last + end_tolerance):
        return NAN
    return s


def find_world_track_place(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> PathPoint:
    """Return the place of the path nearest to the point of a TRACK, from P on, with its derivatives; world axes."""
    track_place: PathPoint = evaluate_track(scene, row, find_track_place(scene, row))
    return PathPoint(
        world_direction(scene, row.a, track_place.r),
        world_direction(scene, row.a, track_place.slope),
        world_direction(scene, row.a, track_place.bend),
        world_direction(scene, row.a, track_place.twist),
    )


def find_track_frame(scene: cython.pointer[Scene], row: cython.pointer[Closure], track_place: PathPoint) -> TrackFrame:
    """Return the direction N across a path and its change along it, dN/ds, seen from a; world axes."""
    h: Vec3 = world_direction(scene, row.a, row.h)
    m: Vec3 = cross(h, track_place.slope)
    size: cython.double = norm(m)
    N: Vec3 = scale_vector(1.0 / size, m)
    m = cross(h, track_place.bend)
    dN: Vec3 = scale_vector(1.0 / size, add_scaled(m, -dot(N, m), N))
    if row.faced == 0:
        return TrackFrame(N, dN)
    size = norm(track_place.slope)
    t: Vec3 = scale_vector(1.0 / size, track_place.slope)
    dt: Vec3 = scale_vector(1.0 / size, add_scaled(track_place.bend, -dot(t, track_place.bend), t))
    return TrackFrame(cross(t, N), add_cross(cross(dt, N), t, dN))


# Along a direction of the state


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
    relative: RelativeMotion = find_relative_motion(scene, row, Q)
    v: Vec3 = relative.v
    N: Vec3 = add_scaled(vector_tangent(scene, row.a, frame.N), d.s, frame.change)
    square: cython.double = dot(track_place.slope, track_place.slope)
    u: cython.double = dot(track_place.slope, v) / d.square
    w: cython.double = dot(track_place.slope, v) / square
    change: cython.double = dot(d.slope, v) + dot(track_place.slope, relative.dv)
    du: cython.double = (change - u * d.squared) / d.square
    dw: cython.double = (change - 2.0 * w * dot(track_place.slope, d.slope)) / square
    curved: cython.double = dot(frame.N, track_place.bend)
    bent: cython.double = (dot(N, track_place.bend) + dot(frame.N, d.bend)) * u * w + curved * (du * w + u * dw)
    acceleration: cython.double = dot(N, relative.A) + dot(frame.N, relative.dA) - bent
    return RowTangent(Q, N, Vec3(0.0, 0.0, 0.0), dot(N, v) + dot(frame.N, relative.dv), acceleration)


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
