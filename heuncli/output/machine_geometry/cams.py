"""What cams and paths look like: the outline of a disc, and the way of a point, as lines in their body's axes.

The outline is that of disc and follower whose axes agree at coordinate zero, as they mostly do.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.multibody.mechanism.build import joint
from heuncli.multibody.mechanism.build_couplings import cam_rows
from heuncli.multibody.mechanism.cam_profiles import Flank, flank
from heuncli.multibody.mechanism.couplings import CouplingPart
from heuncli.output.machine_geometry.discs import Disc
from heuncli.output.machine_geometry.threads import pose
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import Cam
from heuncli.scene.file_format.models import Spec
from heuncli.scene.shapes.rotations import perpendicular

MOST = 400  # places of a line
ROUND = 36  # of a roller
OVER = 1.5  # of what the flank comes to: how far a flat face is drawn


def cam_outlines(spec: Spec, body: str) -> Iterator[Array]:
    """The outlines (n, 3) of the discs that a body is, and of the rollers and faces that it has."""
    for given in spec.couplings.values():
        if isinstance(given, Cam) and given.radius and spec.joints[given.follower].b == body:
            axis = np.array(spec.joints[given.shaft].axis)
            arm = given.radius * np.array(perpendicular(axis / np.sqrt(axis @ axis)))
            phi = np.linspace(0.0, 2.0 * np.pi, ROUND + 1)[:, None]
            yield np.array(given.at) + np.cos(phi) * arm[0] + np.sin(phi) * arm[1]
        if not isinstance(given, Cam) or body not in (spec.joints[given.shaft].b, spec.joints[given.follower].b):
            continue
        joints = [joint(spec.joints[name], 0, 1, False) for name in (given.shaft, given.follower)]
        (row,) = cam_rows(given, 0, joints[0], 1, joints[1])
        own = flank(row.parts[0], joints[0], joints[1], np.eye(3), np.eye(3))
        if spec.joints[given.shaft].b == body:
            yield outline(own, row.parts[0], joints[0].axis) + joints[0].q
        elif given.normal is not None:
            yield face(own, given.at, np.cross(joints[0].axis, given.normal))


def face(own: Flank, at: tuple[float, float, float], along: Array) -> Array:
    """A flat face, (2, 3), somewhat longer than what the flank comes to, the same to both sides; along: of it."""
    off = own.places - own.centres
    reach = OVER * float(np.sqrt(np.max(np.sum(off * off, axis=1)) / (along @ along)))
    return np.asarray(np.array(at) + np.outer([-reach, reach], along))


def outline(own: Flank, part: CouplingPart, axis: Array) -> Array:
    """The flank of a disc as a closed line (n, 3) about its axis; of a part of a turn the sector."""
    assert part.cam is not None
    line = own.places[:: max(1, round(2.0 * np.pi / np.ptp(own.angles)) * len(own.places) // MOST)]
    if part.cam.lift.period:
        return np.concatenate([own.around(axis, line), own.places[:1]])
    hub = axis * (own.places[0] @ axis)
    return np.array([hub, *line, own.places[-1], hub])


def rollers_of(spec: Spec) -> Iterator[tuple[str, Disc]]:
    """The rollers that run beside paths, each with its body, in a scene as it is drawn."""
    for own in spec.joints.values():
        if own.path is not None and own.path.radius:
            n = pose(spec, own.b)[0].T @ pose(spec, own.a)[0] @ np.asarray(own.path.normal)
            yield own.b, Disc(np.array(own.q), n, own.path.radius)


def paths_of(spec: Spec, body: str) -> Iterator[Array]:
    """The lines (n, 3) along which points run that are fixed in a body, or in the ground."""
    for own in spec.joints.values():
        if own.path is not None and own.a == body:
            s = own.path.looked_at
            yield np.array(own.p) + own.path.track(s[:: max(1, len(s) // MOST)])[0]
