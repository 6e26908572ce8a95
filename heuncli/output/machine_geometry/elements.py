"""Machine elements on the bodies that carry them, in body axes: cams, paths and screws as lines, round parts as discs.

The outline of a cam is that of the cam and follower whose axes coincide at coordinate zero, the usual case. The thread
of a screw is a helix on the spindle, from its bearing to the nut if that is drawn.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.mechanism.build import build_joint
from heuncli.multibody.mechanism.build_couplings import cam_rows
from heuncli.multibody.mechanism.couplings import CouplingPart
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.cam_flanks import Flank, compute_flank
from heuncli.output.machine_geometry.discs import BeltGeometry, Disc, PitchPoint, make_pitch_geometry
from heuncli.output.machine_geometry.poses import find_drawn_pose
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import Cam, Screw
from heuncli.scene.file_format.models import Joint, Spec, Vec
from heuncli.scene.file_format.names import GROUND
from heuncli.scene.shapes.rotations import perpendicular_pair

MAX_POINTS = 400  # of a line
ROLLER_POINTS = 36  # of a roller
FACE_EXTENSION = 1.5  # length of a drawn flat face, relative to what the contact needs
MIN_NUT_DISTANCE = 2.0  # leads: a nut nearer to the bearing does not determine the length of the thread
DEFAULT_TURNS = 3.0  # turns on both sides of the bearing if the nut does not determine the length
MAX_TURNS = 24.0  # turns; a finer thread is drawn coarser
RADIUS_RATIO = 0.025  # radius over length
TURN_CORNERS = 16  # of a turn
SAME_DISC = 1e-9  # of the radius: discs whose centres, radii and axes differ by less are one


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


class ScrewMember(NamedTuple):
    """The spindle or the nut of a screw: its body, its joint to the carrier, and the joint's sign for its motion."""

    body: str
    joint: Joint[str, Vec]
    sign: float


def make_threads(spec: Spec) -> dict[str, tuple[Array, ...]]:
    """Make the threads (n, 3) of all screws, in body axes, by the spindle's body."""
    threads: dict[str, tuple[Array, ...]] = {}
    for coupling in spec.couplings.values():
        if isinstance(coupling, Screw):
            spindle, nut = find_members(spec, coupling)
            if spindle.body in spec.bodies:
                line = make_thread(spec, coupling.lead, spindle, nut)
                threads[spindle.body] = (*threads.get(spindle.body, ()), line)
    return threads


def find_members(spec: Spec, screw: Screw) -> tuple[ScrewMember, ScrewMember]:
    """Find the spindle and the nut of a screw; in a cylinder joint the `to` body is the spindle and `from` the nut."""
    joints = {term.quantity: spec.joints[term.joint] for term in screw.terms}
    turns, slides = joints["angle"], joints["travel"]
    if turns is slides:
        return ScrewMember(turns.b, turns, 1.0), ScrewMember(turns.a, turns, -1.0)
    carrier = {turns.a, turns.b} & {slides.a, slides.b}
    spindle, nut = (ScrewMember(j.b, j, 1.0) if j.a in carrier else ScrewMember(j.a, j, -1.0) for j in (turns, slides))
    return spindle, nut


def make_thread(spec: Spec, lead: float, spindle: ScrewMember, nut: ScrewMember) -> Array:
    """Make a helix (n, 3) about the spindle's axis, from its bearing, in the spindle's axes.

    Its hand is the one that moves the nut as the lead states: a right-hand thread on a spindle that turns in its
    bearing draws the nut back.
    """
    R, _ = find_drawn_pose(spec, spindle.body)
    start, axis = (
        R.T @ (find_joint_point(spec, spindle) - find_drawn_pose(spec, spindle.body)[1]),
        R.T @ find_axis(spec, spindle),
    )
    height = float((find_joint_point(spec, nut) - find_joint_point(spec, spindle)) @ find_axis(spec, spindle))
    relative_sign = spindle.sign * nut.sign * float(np.sign(find_axis(spec, spindle) @ find_axis(spec, nut)))
    pitch = -lead * (relative_sign or 1.0)
    begin, end = (
        (0.0, height)
        if abs(height) > MIN_NUT_DISTANCE * abs(lead)
        else (-DEFAULT_TURNS * abs(lead), DEFAULT_TURNS * abs(lead))
    )
    count = float(np.clip((end - begin) / pitch, -MAX_TURNS, MAX_TURNS))
    angle = np.linspace(0.0, 2.0 * np.pi * count, int(TURN_CORNERS * abs(count)) + 2)[:, None]
    e, f = perpendicular_pair(axis)
    rise = np.linspace(begin, end, len(angle))[:, None] * axis
    line: Array = start + rise + RADIUS_RATIO * abs(end - begin) * (np.cos(angle) * e + np.sin(angle) * f)
    return line


def find_axis(spec: Spec, member: ScrewMember) -> Array:
    """Find a joint's axis in the pose that is drawn, world axes."""
    axis = find_drawn_pose(spec, member.joint.a)[0] @ np.array(member.joint.axis)
    return np.asarray(axis / np.sqrt(axis @ axis))


def find_joint_point(spec: Spec, member: ScrewMember) -> Array:
    """Find a joint's point on a body in the pose that is drawn, world axes."""
    joint = member.joint
    R, r = find_drawn_pose(spec, member.body)
    return np.asarray(r + R @ np.array(joint.p if member.body == joint.a else joint.q))


class ElementGeometry(NamedTuple):
    """Discs and lines of each body, in its axes; belts, and the points at which gears mesh."""

    discs: dict[str, list[Disc]]
    lines: dict[str, list[Array]]
    belts: tuple[BeltGeometry, ...] = ()
    pitch_points: tuple[PitchPoint, ...] = ()


NO_ELEMENTS = ElementGeometry({}, {})


def collect_elements(spec: Spec, mechanism: Mechanism | None) -> ElementGeometry:
    """Collect the geometry of all machine elements of a spec.

    mechanism: as assembled, for the sheaves of its ropes, which a spec alone does not determine
    """
    kinds = {own.type for own in spec.couplings.values()} | {"wheel" for _ in spec.rolling}
    kinds |= {"curve" for own in spec.joints.values() if own.path is not None}
    if not kinds:
        return NO_ELEMENTS
    lines = defaultdict[str, list[Array]](list)
    pitch = make_pitch_geometry(spec)
    for body, racks in pitch.racks.items():
        lines[body] += racks
    if kinds & {"cam", "curve"}:
        for body in (*spec.bodies, GROUND):
            lines[body] += (*iter_cam_outlines(spec, body), *iter_paths(spec, body))
    if "screw" in kinds:
        for body, threads in make_threads(spec).items():
            lines[body] += threads
    discs = defaultdict[str, list[Disc]](list)
    for body, own in _iter_discs(spec, mechanism, pitch.discs):
        if not any(are_same_disc(own, other) for other in discs[body]):
            discs[body].append(own)
    return ElementGeometry(discs, lines, tuple(pitch.belts), tuple(pitch.points))


def _iter_discs(spec: Spec, mechanism: Mechanism | None, gears: dict[str, list[Disc]]) -> Iterator[tuple[str, Disc]]:
    """Yield all discs, each with its body."""
    from heuncli.output.machine_geometry.discs import iter_wheel_discs

    yield from iter_wheel_discs(spec)
    yield from ((body, disc) for body, own in gears.items() for disc in own)
    yield from iter_path_rollers(spec)
    if mechanism is not None and any(own.type == "rope" for own in spec.couplings.values()):
        from heuncli.output.machine_geometry.ropes import iter_sheaves

        yield from iter_sheaves(mechanism)


def are_same_disc(first: Disc, second: Disc) -> bool:
    """Return whether two discs coincide, as when a planet meshes with the sun and with the ring."""
    difference = np.concatenate([first.centre - second.centre, [first.radius - second.radius]])
    across = np.cross(first.axis, second.axis)
    return float(difference @ difference) <= (SAME_DISC * first.radius) ** 2 and float(across @ across) <= SAME_DISC**2
