"""The flanks of a scene's cams, and which of them cannot be made, or do not move their followers."""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.multibody.mechanism.cam_profiles import Flank, flank
from heuncli.multibody.mechanism.couplings import CamShape, Coupling
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Mask

LOOKED_AT = 720  # places of a flank at which rollers at other angles are looked for, at most


def flank_of(layout: Layout, cam: Coupling) -> Flank:
    """The flank of a cam of the scene."""
    part = cam.rows[0].parts[0]
    k, n = (x.joint for x in part.coordinates)
    joints = layout.mechanism.joints
    return flank(part, joints[k], joints[n], layout.starts[k].R_ref, layout.starts[n].R_ref)


def require_flanks(layout: Layout) -> None:
    """Raise SolveError for cams that no disc can be: their followers are not moved so, whatever its flank."""
    cams = [coupling for coupling in layout.mechanism.couplings if coupling.given.type == "cam"]
    problems = [problem for cam in cams if (problem := fault(layout, cam)) is not None]
    if problems:
        raise SolveError(*problems)


def fault(layout: Layout, cam: Coupling) -> Problem | None:
    """What is wrong with a cam, the first of what there may be; None of one that can be made."""
    about = f"couplings.{cam.name}"
    if is_tilted(layout, cam):
        message = f"the face of cam {cam.name} is not along the axis of its disc: its normal leans that way"
        hint = "normal: across the disc's axis, in the follower's axes"
        return Problem("cam-contact", message, hint=hint, about=about)
    own = flank_of(layout, cam)
    if (own.falls_behind <= 0.0).any():
        where = angles(own, own.falls_behind <= 0.0)
        message = f"the face of cam {cam.name} turns as fast as its disc, or faster, at angles {where} of the disc"
        hint = "a face touches a flank that turns past it: a lift that grows by less than 1 rad for each, or a roller"
        return Problem("cam-undercut", message, hint=hint, about=about)
    if (own.leaves <= 0.0).any() and (own.leaves >= 0.0).any():
        where = angles(own, own.leaves <= 0.0)
        message = f"the flank of cam {cam.name} pushes its follower toward smaller coordinates at angles {where} of "
        message += "its disc, elsewhere toward greater ones: between them it stands across and moves nothing"
        hint = "guide the follower so that it never passes beside the disc's axis, where it moves along the flank"
        return Problem("cam-sense", message, hint=hint, about=about)
    if cam.rows[0].tension_only and (own.leaves < 0.0).all():
        message = f"the lift of cam {cam.name} grows toward its disc: a cam that presses moves its follower away"
        hint = "turn the axis of the follower's joint round, and with it the lift; or in a groove: two_sided: true"
        return Problem("cam-sense", message, hint=hint, about=about)
    return cut_away(own, cam, layout.mechanism.joints[cam.rows[0].parts[0].coordinates[0].joint].axis)


def is_tilted(layout: Layout, cam: Coupling) -> bool:
    """Whether a face is not parallel to its disc's axis."""
    part = cam.rows[0].parts[0]
    assert part.cam is not None
    if part.cam.face is None:
        return False
    k, n = (x.joint for x in part.coordinates)
    leans = float(layout.mechanism.joints[k].axis @ (layout.starts[n].R_ref @ part.cam.face))
    return abs(leans) > tolerances.TYPED_AXES


def cut_away(own: Flank, cam: Coupling, axis: Array) -> Problem | None:
    """The problem of a cam that has to curve more than it can, or that another part of its own flank cuts away."""
    shape, about = cam.rows[0].parts[0].cam, f"couplings.{cam.name}"
    assert shape is not None
    least = own.radius <= 0.0
    if not least.any():
        missed = crossed(own, shape, np.asarray(axis)) if shape.radius else None
        if missed is None:
            return None
        message = f"the flank of cam {cam.name} is cut away at an angle {missed:.4g} deg of its disc: there the roller "
        message += "would be in the disc, which it touches at another angle"
        hint = "a smaller roller, or a larger disc (a roller further out)"
        return Problem("cam-undercut", message, hint=hint, about=about)
    if shape.face is None:
        curve = own.radius[least].min() + shape.radius
        what = f"curves with {curve:.4g} m where the roller's centre runs, the roller has {shape.radius:.4g} m"
        hint = "a smaller roller, a larger disc (a roller further out), or a lift that bends less"
    else:
        what = f"would have a radius of {own.radius.min():.4g} m: the face does not reach it"
        hint = "a larger disc (a face further out), or a lift that bends less: base + lift + lift'' stays above zero"
    message = f"the flank of cam {cam.name} is cut away at angles {angles(own, least)} of its disc: there it {what}"
    return Problem("cam-undercut", message, hint=hint, about=about)


def crossed(own: Flank, shape: CamShape, axis: Array) -> float | None:
    """The angle [deg] of the disc at which a roller at another angle is in what it touches there; None: none is."""
    apart = -(-len(own.places) // LOOKED_AT)
    places = own.places[::apart]
    centres = own.centres[::apart]
    if shape.lift.period:
        centres = own.around(axis, centres)
    square = np.sum(places * places, axis=1)[:, None] + np.sum(centres * centres, axis=1) - 2.0 * places @ centres.T
    least = square.min(axis=1)
    i = int(np.argmin(least))
    room = shape.radius * shape.radius * (1.0 - tolerances.SAME_VALUE)
    return float(np.degrees(own.angles[::apart][i])) if least[i] < room else None


def angles(own: Flank, which: Mask) -> str:
    """The angles of the disc that are marked, in words."""
    return " and ".join(f"{a:.4g} to {b:.4g} deg" for a, b in runs(np.degrees(own.angles), which)[:3])


def runs(angles: Array, which: Mask) -> list[tuple[float, float]]:
    """The first and the last of neighbouring angles that are marked, each run of them."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], which, [False]]).astype(int)))
    return [(float(angles[a]), float(angles[b - 1])) for a, b in zip(edges[::2], edges[1::2], strict=True)]
