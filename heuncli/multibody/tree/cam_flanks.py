"""The flanks of a scene's cams: find those that cannot be made, or do not move their followers."""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.multibody.mechanism.cam_profiles import Flank, compute_flank
from heuncli.multibody.mechanism.couplings import CamShape, Coupling
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Mask

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
    """Whether a flat face is not parallel to its disc's axis."""
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
