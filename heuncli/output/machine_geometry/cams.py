"""The geometry of cams and paths as lines in body axes: the outline of a cam disc, and the path of a point.

The outline is that of the cam and follower whose axes coincide at coordinate zero, the usual case.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.multibody.mechanism.build import build_joint
from heuncli.multibody.mechanism.build_couplings import cam_rows
from heuncli.multibody.mechanism.couplings import CouplingPart
from heuncli.multibody.tree.cam_flanks import Flank, compute_flank
from heuncli.output.machine_geometry.discs import Disc
from heuncli.output.machine_geometry.poses import find_drawn_pose
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import Cam
from heuncli.scene.file_format.models import Spec
from heuncli.scene.shapes.rotations import perpendicular_pair

MAX_POINTS = 400  # of a line
ROLLER_POINTS = 36  # of a roller
FACE_EXTENSION = 1.5  # length of a drawn flat face, relative to what the contact needs


def iter_cam_outlines(spec: Spec, body: str) -> Iterator[Array]:
    """Yield the outlines (n, 3) of the cam discs, rollers and flat faces that belong to a body."""
    for coupling in spec.couplings.values():
        if isinstance(coupling, Cam) and coupling.radius and spec.joints[coupling.follower].b == body:
            axis = np.array(spec.joints[coupling.shaft].axis)
            arm = coupling.radius * np.array(perpendicular_pair(axis / np.sqrt(axis @ axis)))
            phi = np.linspace(0.0, 2.0 * np.pi, ROLLER_POINTS + 1)[:, None]
            yield np.array(coupling.at) + np.cos(phi) * arm[0] + np.sin(phi) * arm[1]
        if not isinstance(coupling, Cam) or body not in (
            spec.joints[coupling.shaft].b,
            spec.joints[coupling.follower].b,
        ):
            continue
        joints = [build_joint(spec.joints[name], 0, 1, False) for name in (coupling.shaft, coupling.follower)]
        (row,) = cam_rows(coupling, 0, joints[0], 1, joints[1])
        cam_flank = compute_flank(row.parts[0], joints[0], joints[1], np.eye(3), np.eye(3))
        if spec.joints[coupling.shaft].b == body:
            yield make_cam_outline(cam_flank, row.parts[0], joints[0].axis) + joints[0].q
        elif coupling.normal is not None:
            yield make_follower_face(cam_flank, coupling.at, np.cross(joints[0].axis, coupling.normal))


def make_follower_face(cam_flank: Flank, center: tuple[float, float, float], direction: Array) -> Array:
    """Make the line (2, 3) of a flat follower face, symmetric about its center and a little longer than the contact
    needs.
    """
    offsets = cam_flank.places - cam_flank.centres
    reach = FACE_EXTENSION * float(np.sqrt(np.max(np.sum(offsets * offsets, axis=1)) / (direction @ direction)))
    return np.asarray(np.array(center) + np.outer([-reach, reach], direction))


def make_cam_outline(cam_flank: Flank, part: CouplingPart, axis: Array) -> Array:
    """Make a closed line (n, 3) of a cam's flank about its axis; for a profile over less than one turn, the outline of
    a sector.
    """
    assert part.cam is not None
    line = cam_flank.places[
        :: max(1, round(2.0 * np.pi / np.ptp(cam_flank.angles)) * len(cam_flank.places) // MAX_POINTS)
    ]
    if part.cam.lift.period:
        return np.concatenate([cam_flank.repeat_around(axis, line), cam_flank.places[:1]])
    hub = axis * (cam_flank.places[0] @ axis)
    return np.array([hub, *line, cam_flank.places[-1], hub])


def iter_path_rollers(spec: Spec) -> Iterator[tuple[str, Disc]]:
    """Yield the rollers that run on paths, each with its body, in the pose in which the spec is drawn."""
    for path_joint in spec.joints.values():
        if path_joint.path is not None and path_joint.path.radius:
            n = (
                find_drawn_pose(spec, path_joint.b)[0].T
                @ find_drawn_pose(spec, path_joint.a)[0]
                @ np.asarray(path_joint.path.normal)
            )
            yield path_joint.b, Disc(np.array(path_joint.q), n, path_joint.path.radius)


def iter_paths(spec: Spec, body: str) -> Iterator[Array]:
    """Yield the paths (n, 3) of points that are fixed in a body, or in the ground."""
    for path_joint in spec.joints.values():
        if path_joint.path is not None and path_joint.a == body:
            s = path_joint.path.sample_parameters
            yield np.array(path_joint.p) + path_joint.path.evaluate_track(s[:: max(1, len(s) // MAX_POINTS)])[0]
