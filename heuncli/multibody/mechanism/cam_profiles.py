"""Compute the flank of a cam: the outline of its disc, and its curvature.

    v = L' w - e x (C - O)         velocity of the follower's point C past the disc, per unit of the disc's angle
    1/rho = -n . v' / |v|^2        of the path of a roller's centre, n = e x v outward; the flank is a radius R within
    rho = p + d2p/dtheta2          of a flat face at the distance p from the axis, which turns by theta against the disc

A flank that is undercut where it would have to curve more than it can (rho < R, rho < 0) cannot guide a follower. All
directions are in the carrier's axes; v' is relative to the disc. n is outward, for the path goes round the axis once.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.records import record
from heuncli.multibody.mechanism.couplings import CouplingPart
from heuncli.multibody.mechanism.model import Joint
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_rows, rotation_matrix_about


@record
class Flank:
    """The flank of a cam over the range of its lift, for a periodic one over a period.

    angles (m,): of the disc
    centres, places (m, 3): the follower's point and the point of contact, from the disc's axis, in its own axes
    radius (m,): radius of curvature of the flank [m]; not above zero where it is undercut, infinite where a roller's
    flank is straight or hollow
    separation_rates (m,): speed normal to the flank at which the follower leaves the disc, per unit of its coordinate
    lag_rates (m,): rate at which a flat face turns against the disc, per unit of its angle backwards; 1 for a roller
    """

    angles: Array
    centres: Array
    places: Array
    radius: Array
    separation_rates: Array
    lag_rates: Array

    def repeat_around(self, axis: Array, line: Array) -> Array:
        """Repeat a line of points (n, 3) as often as the lift is repeated in a turn of the disc, one after the
        other.
        """
        turns = round(2.0 * np.pi / float(self.angles[-1] - self.angles[0]))
        return np.concatenate([line @ rotation_matrix_about(axis, -k * 2.0 * np.pi / turns).T for k in range(turns)])


def compute_flank(part: CouplingPart, shaft: Joint, follower: Joint, R_shaft: Array, R_follower: Array) -> Flank:
    """Compute the flank of a cam; R_shaft, R_follower: attitudes of disc and follower on the carrier at coordinate
    zero.
    """
    assert part.cam is not None
    cam, e, g = part.cam, shaft.axis, follower.axis
    phi = cam.lift.sample_parameters
    lift, slope, bend = (x[:, 0] for x in cam.lift.evaluate(phi))
    arm = R_follower @ (np.asarray(part.q) - follower.q)
    turns = (
        np.array([rotation_matrix_about(g, x) for x in lift])
        if cam.swings
        else np.broadcast_to(np.eye(3), (len(phi), 3, 3))
    )
    C = follower.p - shaft.p + turns @ arm + (0.0 if cam.swings else lift[:, None] * g)
    w = cross_rows(np.broadcast_to(g, C.shape), turns @ arm) if cam.swings else np.broadcast_to(g, C.shape)
    axis = np.broadcast_to(e, C.shape)
    if cam.face is None:
        contact = roller_contact(cam.radius, cam.swings * g, axis, C, w, slope, bend)
    else:
        h = turns @ (R_follower @ cam.face)
        contact = face_contact(h, follower.p - shaft.p, cam.swings * g, axis, C, w, slope, bend)
    back = np.array([R_shaft.T @ rotation_matrix_about(e, -x) for x in phi])
    return Flank(phi, rotate_each(back, C), rotate_each(back, contact[0]), *contact[1:])


def rotate_each(R: Array, x: Array) -> Array:
    """Rotate vectors (m, 3), each by its own rotation (m, 3, 3)."""
    return np.asarray(np.einsum("mij,mj->mi", R, x))


def roller_contact(
    R: float, g: Array, e: Array, C: Array, w: Array, slope: Array, bend: Array
) -> tuple[Array, Array, Array, Array]:
    """Compute contact points, radius of curvature, separation and lag rates for a roller or a point."""
    v = slope[:, None] * w - cross_rows(e, C)
    change = bend[:, None] * w + (slope**2)[:, None] * cross_rows(np.broadcast_to(g, w.shape), w)
    change = change - slope[:, None] * cross_rows(e, w) - cross_rows(e, v)
    n = cross_rows(e, v)
    size = np.sqrt(np.sum(n * n, axis=1))
    still = size == 0.0
    n = n / np.where(still, 1.0, size)[:, None]
    bulge = -np.sum(change * n, axis=1) / np.where(still, 1.0, size**2)
    hollow = bulge <= 0.0
    radius = np.where(hollow, np.inf, 1.0 / np.where(hollow, 1.0, bulge) - R)
    return C - R * n, np.where(still, -R, radius), np.sum(n * w, axis=1), np.ones(len(C))


def face_contact(
    h: Array, P: Array, g: Array, e: Array, C: Array, w: Array, slope: Array, bend: Array
) -> tuple[Array, Array, Array, Array]:
    """Compute the same for a flat face normal to h. Its side towards the disc is the one that is away from it on
    average.
    """
    h = h * (1.0 if np.sum(h * C) >= 0.0 else -1.0)
    k = cross_rows(e, h)
    turning = np.broadcast_to(g, h.shape)
    passing = slope[:, None] * w - cross_rows(e, C)
    turn, faster = slope * (e @ g) - 1.0, bend * (e @ g)
    behind = np.where(turn == 0.0, 1.0, turn)  # where it is 0 there is no place: the face turns with the disc
    s = np.sum(h * passing, axis=1) / behind
    across = cross_rows(turning, h)
    p = np.sum(h * C, axis=1)
    first = slope * (across @ P)
    second = bend * (across @ P) + slope**2 * (cross_rows(turning, across) @ P)
    if not np.any(g):
        along = np.sum(h * w, axis=1)
        first, second = slope * along, bend * along
    radius = p + (second / behind - first * faster / behind**2) / behind
    leaves = np.sum(h * (w + cross_rows(turning, s[:, None] * k)), axis=1)
    return C + s[:, None] * k, radius, leaves, -turn
