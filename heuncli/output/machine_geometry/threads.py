"""The geometry of screws: the thread as a helix on the spindle, from its bearing to the nut if that is drawn."""

from __future__ import annotations

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.machine_geometry.poses import find_drawn_pose
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import Screw
from heuncli.scene.file_format.models import Joint, Spec, Vec
from heuncli.scene.shapes.rotations import perpendicular_pair

MIN_NUT_DISTANCE = 2.0  # leads: a nut nearer to the bearing does not determine the length of the thread
DEFAULT_TURNS = 3.0  # turns on both sides of the bearing if the nut does not determine the length
MAX_TURNS = 24.0  # turns; a finer thread is drawn coarser
RADIUS_RATIO = 0.025  # radius over length
TURN_CORNERS = 16  # of a turn


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
