"""The flanks of a scene's cams: find those that cannot be made, or do not move their followers.

The flank is the outline of the disc, with its curvature:

    v = L' w - e x (C - O)         velocity of the follower's point C past the disc, per unit of the disc's angle
    1/rho = -n . v' / |v|^2        of the path of a roller's centre, n = e x v outward; the flank is a radius R within
    rho = p + d2p/dtheta2          of a flat face at the distance p from the axis, which turns by theta against the disc

A flank that is undercut where it would have to curve more than it can (rho < R, rho < 0) cannot guide a follower. All
directions are in the carrier's axes; v' is relative to the disc. n is outward, for the path goes round the axis once.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record
from heuncli.multibody.mechanism.couplings import CamShape, Coupling, CouplingPart
from heuncli.multibody.mechanism.model import Joint
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Mask
from heuncli.scene.shapes.rotations import cross_rows, rotation_matrix_about

# Cam profiles


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


# Cam flanks

MAX_SAMPLES = 720  # places of a flank at which rollers at other angles are looked for, at most


def make_flank(layout: Layout, cam: Coupling) -> Flank:
    """Compute the flank of a cam of the scene."""
    part = cam.rows[0].parts[0]
    k, n = (x.joint for x in part.coordinates)
    joints = layout.mechanism.joints
    return compute_flank(part, joints[k], joints[n], layout.starts[k].R_ref, layout.starts[n].R_ref)


def require_flanks(layout: Layout) -> None:
    """Raise SolveError for cams whose followers no disc can move as prescribed."""
    cams = [coupling for coupling in layout.mechanism.couplings if coupling.entry.type == "cam"]
    problems = [problem for cam in cams if (problem := find_fault(layout, cam)) is not None]
    if problems:
        raise SolveError(*problems)


def find_fault(layout: Layout, cam: Coupling) -> Problem | None:
    """Return the first problem of a cam, or None if it can be made."""
    entry_path = f"couplings.{cam.name}"
    if is_tilted(layout, cam):
        message = f"the face of cam {cam.name} is not parallel to the axis of its disc: its normal is inclined to it"
        hint = "give a normal perpendicular to the disc's axis, in the follower's axes"
        return Problem("cam-contact", message, hint=hint, entry_path=entry_path)
    cam_flank = make_flank(layout, cam)
    if (cam_flank.lag_rates <= 0.0).any():
        where = format_angles(cam_flank, cam_flank.lag_rates <= 0.0)
        message = f"the face of cam {cam.name} rotates as fast as its disc, or faster, at disc angles {where}"
        hint = "use a lift that rises by less than 1 rad per rad of disc rotation, or a roller"
        return Problem("cam-undercut", message, hint=hint, entry_path=entry_path)
    if (cam_flank.separation_rates <= 0.0).any() and (cam_flank.separation_rates >= 0.0).any():
        where = format_angles(cam_flank, cam_flank.separation_rates <= 0.0)
        message = f"the flank of cam {cam.name} pushes its follower toward smaller coordinates at disc angles "
        message += f"{where}, elsewhere toward larger ones: in between it cannot move the follower"
        hint = "guide the follower so that it never moves along the flank, as it does next to the disc's axis"
        return Problem("cam-sense", message, hint=hint, entry_path=entry_path)
    if cam.rows[0].tension_only and (cam_flank.separation_rates < 0.0).all():
        message = f"the lift of cam {cam.name} is positive toward its disc, but a cam can only push its follower away"
        hint = "reverse the axis of the follower's joint, and with it the lift; for a grooved cam: two_sided: true"
        return Problem("cam-sense", message, hint=hint, entry_path=entry_path)
    return find_undercut(cam_flank, cam, layout.mechanism.joints[cam.rows[0].parts[0].coordinates[0].joint].axis)


def is_tilted(layout: Layout, cam: Coupling) -> bool:
    """Return whether a flat face is not parallel to its disc's axis."""
    part = cam.rows[0].parts[0]
    assert part.cam is not None
    if part.cam.face is None:
        return False
    k, n = (x.joint for x in part.coordinates)
    leans = float(layout.mechanism.joints[k].axis @ (layout.starts[n].R_ref @ part.cam.face))
    return abs(leans) > tolerances.TYPED_AXES


def find_undercut(cam_flank: Flank, cam: Coupling, axis: Array) -> Problem | None:
    """Return the problem of a cam that would have to curve more than it can, or whose flank another part of it cuts
    away.
    """
    shape, entry_path = cam.rows[0].parts[0].cam, f"couplings.{cam.name}"
    assert shape is not None
    is_undercut = cam_flank.radius <= 0.0
    if not is_undercut.any():
        crossing = find_crossing(cam_flank, shape, np.asarray(axis)) if shape.radius else None
        if crossing is None:
            return None
        message = f"the flank of cam {cam.name} is undercut at disc angle {crossing:.4g} deg: there the roller "
        message += "would penetrate the disc, which it touches at another angle"
        hint = "use a smaller roller, or a larger disc (roller further out)"
        return Problem("cam-undercut", message, hint=hint, entry_path=entry_path)
    if shape.face is None:
        curve = cam_flank.radius[is_undercut].min() + shape.radius
        what = f"the roller's path has a radius of curvature of {curve:.4g} m, the roller {shape.radius:.4g} m"
        hint = "use a smaller roller, a larger disc (roller further out), or a lift with less curvature"
    else:
        what = f"its radius would be {cam_flank.radius.min():.4g} m: the face cannot touch it"
        hint = (
            "use a larger disc (face further out), or a lift with less curvature: keep base + lift + lift'' above zero"
        )
    message = f"the flank of cam {cam.name} is undercut at disc angles {format_angles(cam_flank, is_undercut)}: {what}"
    return Problem("cam-undercut", message, hint=hint, entry_path=entry_path)


def find_crossing(cam_flank: Flank, shape: CamShape, axis: Array) -> float | None:
    """Return the disc angle [deg] at which the roller at another angle would intersect the flank; None if there is
    none.
    """
    stride = -(-len(cam_flank.places) // MAX_SAMPLES)
    places = cam_flank.places[::stride]
    centres = cam_flank.centres[::stride]
    if shape.lift.period:
        centres = cam_flank.repeat_around(axis, centres)
    square = np.sum(places * places, axis=1)[:, None] + np.sum(centres * centres, axis=1) - 2.0 * places @ centres.T
    least = square.min(axis=1)
    i = int(np.argmin(least))
    clearance = shape.radius * shape.radius * (1.0 - tolerances.SAME_VALUE)
    return float(np.degrees(cam_flank.angles[::stride][i])) if least[i] < clearance else None


def format_angles(cam_flank: Flank, which: Mask) -> str:
    """Format the marked angles of the disc."""
    return " and ".join(f"{a:.4g} to {b:.4g} deg" for a, b in find_runs(np.degrees(cam_flank.angles), which)[:3])


def find_runs(angles: Array, which: Mask) -> list[tuple[float, float]]:
    """Return the first and the last angle of each run of neighbouring marked angles."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], which, [False]]).astype(int)))
    return [(float(angles[a]), float(angles[b - 1])) for a, b in zip(edges[::2], edges[1::2], strict=True)]
