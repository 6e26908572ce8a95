"""The flanks of a scene's cams, and which of them cannot be made."""

from __future__ import annotations

import numpy as np

from heuncli.errors import Problem, SolveError
from heuncli.mechanism.cam_profiles import Flank, flank
from heuncli.mechanism.couplings import Coupling
from heuncli.results import Array, Mask
from heuncli.tree.layout import Layout


def flank_of(layout: Layout, cam: Coupling) -> Flank:
    """The flank of a cam of the scene."""
    part = cam.rows[0].parts[0]
    k, n = (x.joint for x in part.coordinates)
    joints = layout.mechanism.joints
    return flank(part, joints[k], joints[n], layout.starts[k].R_ref, layout.starts[n].R_ref)


def require_flanks(layout: Layout) -> None:
    """Raise SolveError for cams whose flanks would be cut away: no disc moves the follower so."""
    cams = [coupling for coupling in layout.mechanism.couplings if coupling.given.type == "cam"]
    problems = [problem for cam in cams if (problem := cut_away(layout, cam)) is not None]
    if problems:
        raise SolveError(*problems)


def cut_away(layout: Layout, cam: Coupling) -> Problem | None:
    """The problem of a cam that has to curve more than it can, with the angles of its disc; None where it has none."""
    own = flank_of(layout, cam)
    least = own.radius <= 0.0
    if not least.any():
        return None
    shape = cam.rows[0].parts[0].cam
    assert shape is not None
    angles = " and ".join(f"{a:.4g} to {b:.4g} deg" for a, b in runs(np.degrees(own.angles), least)[:3])
    if shape.face is None:
        curve = own.radius[least].min() + shape.radius
        what = f"curves with {curve:.4g} m where the roller's centre runs, the roller has {shape.radius:.4g} m"
        hint = "a smaller roller, a larger disc (a roller further out), or a lift that bends less"
    else:
        what = f"would have a radius of {own.radius.min():.4g} m: the face does not reach it"
        hint = "a larger disc (a face further out), or a lift that bends less: base + lift + lift'' stays above zero"
    message = f"the flank of cam {cam.name} is cut away at angles {angles} of its disc: there it {what}"
    return Problem("cam-undercut", message, hint=hint, about=f"couplings.{cam.name}")


def runs(angles: Array, which: Mask) -> list[tuple[float, float]]:
    """The first and the last of neighbouring angles that are marked, each run of them."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], which, [False]]).astype(int)))
    return [(float(angles[a]), float(angles[b - 1])) for a, b in zip(edges[::2], edges[1::2], strict=True)]
