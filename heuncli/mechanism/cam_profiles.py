"""The flank of a cam: the outline that its disc needs, and how far it curves.

    v = L' w - e x (C - O)         how the follower's point C passes the disc, by a unit of the disc's angle
    1/rho = -n . v' / |v|^2        of the path of a roller's centre, n outward across v; the flank is a radius R within
    rho = p + d2p/dtheta2          of a flat face at the distance p from the axis, which turns by theta against the disc
A flank that is cut away where it would have to curve more than it can (rho < R, rho < 0) lets no follower follow.
All directions are the carrier's; v' is seen from the disc.
"""

from __future__ import annotations

import numpy as np

from heuncli.mechanism.couplings import CouplingPart
from heuncli.mechanism.model import Joint
from heuncli.records import record
from heuncli.results import Array
from heuncli.shapes.rotations import about, cross_rows


@record
class Flank:
    """A cam over a period of its lift: angles (m,) of the disc, places of contact (m, 3) from the disc's axis on, its
    own axes, and the radius of curvature of the flank there (m,) [m]: not above zero where it is cut away, infinite
    where a roller's flank is straight or hollow.
    """

    angles: Array
    places: Array
    radius: Array


def flank(part: CouplingPart, shaft: Joint, follower: Joint, R_shaft: Array, R_follower: Array) -> Flank:
    """The flank of a cam; R_shaft, R_follower: how disc and follower stand on the carrier at coordinate zero."""
    assert part.cam is not None
    cam, e, g = part.cam, shaft.axis, follower.axis
    phi = cam.lift.looked_at
    lift, slope, bend = (x[:, 0] for x in cam.lift.at(phi))
    arm = R_follower @ (np.asarray(part.q) - follower.q)
    turns = np.array([about(g, x) for x in lift]) if cam.swings else np.broadcast_to(np.eye(3), (len(phi), 3, 3))
    C = follower.p - shaft.p + turns @ arm + (0.0 if cam.swings else lift[:, None] * g)
    w = cross_rows(np.broadcast_to(g, C.shape), turns @ arm) if cam.swings else np.broadcast_to(g, C.shape)
    axis = np.broadcast_to(e, C.shape)
    if cam.face is None:
        places, curved = of_roller(cam.radius, cam.swings * g, axis, C, w, slope, bend)
    else:
        h = turns @ (R_follower @ cam.face)
        places, curved = of_face(h, follower.p - shaft.p, cam.swings * g, axis, C, w, slope, bend)
    back = np.array([R_shaft.T @ about(e, -x) for x in phi])
    if cam.face is None:
        hollow = curved <= 0.0
        curved = np.where(hollow, np.inf, 1.0 / np.where(hollow, 1.0, curved) - cam.radius)
    return Flank(phi, np.einsum("mij,mj->mi", back, places), curved)


def of_roller(R: float, g: Array, e: Array, C: Array, w: Array, slope: Array, bend: Array) -> tuple[Array, Array]:
    """Places of contact, and the curvature of the path of a roller's centre, above zero where it bulges out."""
    v = slope[:, None] * w - cross_rows(e, C)
    change = bend[:, None] * w + (slope**2)[:, None] * cross_rows(np.broadcast_to(g, w.shape), w)
    change = change - slope[:, None] * cross_rows(e, w) - cross_rows(e, v)
    n = cross_rows(e, v)
    n = n / np.sqrt(np.sum(n * n, axis=1))[:, None]
    n = n * np.where(np.sum(n * C, axis=1) < 0.0, -1.0, 1.0)[:, None]
    return C - R * n, -np.sum(change * n, axis=1) / np.sum(v * v, axis=1)


def of_face(
    h: Array, P: Array, g: Array, e: Array, C: Array, w: Array, slope: Array, bend: Array
) -> tuple[Array, Array]:
    """Places of contact of a flat face across h, and the radius of curvature of the flank there."""
    k = cross_rows(e, h)
    turning = np.broadcast_to(g, h.shape)
    passing = slope[:, None] * w - cross_rows(e, C)
    beside = cross_rows(e, k) - slope[:, None] * cross_rows(turning, k)
    s = np.sum(h * passing, axis=1) / np.sum(h * beside, axis=1)
    across = cross_rows(turning, h)
    p = np.sum(h * C, axis=1)
    first = slope * (across @ P)
    second = bend * (across @ P) + slope**2 * (cross_rows(turning, across) @ P)
    turn, faster = slope * (e @ g) - 1.0, bend * (e @ g)
    if not np.any(g):
        along = np.sum(h * w, axis=1)
        first, second = slope * along, bend * along
    radius = p + (second / turn - first * faster / turn**2) / turn
    return C + s[:, None] * k, np.where(p < 0.0, -radius, radius)
