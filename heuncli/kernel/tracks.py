"""Points on paths that the tree does not move along: across a path (TRACK), and to one place along it (ALONG).

    TRACK   (r(s) - D) . r' = 0,  N . (D - r) = 0        D from P to Q, s the place of the path nearest to Q; axes of a
            u = r' . Ddot / (|r'|^2 - r'' . (D - r)),  gamma = N . (A - r'' u w),  w = r' . Ddot / |r'|^2
    ALONG   s - length = 0                               s the coordinate of a freedom along the path
            f = r' / |r'|^2,  gamma = f . (A - r'' u^2)

A: the velocity-dependent part of the second derivative of D as seen from a. N is one of two directions across the path:
with h, fixed in a, N = h x r' / |h x r'|, or r'/|r'| x that. The place s is searched from the value counted in the
state, so that the point stays on its branch of a path that crosses itself. Outside an open path there is no place
(NaN).
"""

from __future__ import annotations

from math import fabs

from heuncli.kernel.carried_points import point_motion, world_place
from heuncli.kernel.declarations import *
from heuncli.kernel.libm import NAN
from heuncli.kernel.paths import evaluate_path, offset_path

MAX_PLACE_ITERATIONS = 24  # Newton's steps to a place


def measure_track(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Find unit load, gap, rate and gamma of a row of either kind."""
    b: PointKinematics = point_motion(scene, row.b, row.Q)
    a: PointKinematics = point_motion(scene, row.a, row.Q)
    v: Vec3 = sub(b.v, a.v)
    A: Vec3 = add_scaled(sub(b.centripetal, a.centripetal), -2.0, cross(a.omega, v))
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
    s: cython.double = scene.counters[row.counter].counted
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
