"""What screws look like: the thread as a helix on what turns, from its bearing to the nut where that is drawn."""

from __future__ import annotations

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import Screw
from heuncli.scene.file_format.models import Joint, Spec, Vec
from heuncli.scene.shapes.rotations import perpendicular

SHORT = 2.0  # leads: a nut nearer to the bearing than that stands beside it, or is not drawn apart from it
TURNS = 3.0  # to both sides of the bearing, where the nut does not tell how long the spindle is
MOST = 24.0  # turns that an eye tells apart: a finer thread is drawn as coarse
SLENDER = 0.025  # radius over length
CORNERS = 16  # of a turn


class ScrewMember(NamedTuple):
    """What turns, or slides, on the carrier: the body, its joint, and the joint's sign for its motion."""

    body: str
    joint: Joint[str, Vec]
    sign: float


def threads_of(spec: Spec) -> dict[str, tuple[Array, ...]]:
    """The threads (n, 3) on each body that turns in one, in its axes."""
    found: dict[str, tuple[Array, ...]] = {}
    for own in spec.couplings.values():
        if isinstance(own, Screw):
            spindle, nut = members(spec, own)
            if spindle.body in spec.bodies:
                line = thread(spec, own.lead, spindle, nut)
                found[spindle.body] = (*found.get(spindle.body, ()), line)
    return found


def members(spec: Spec, own: Screw) -> tuple[ScrewMember, ScrewMember]:
    """The spindle and its nut; of a cylinder `to` is the spindle, and `from` the nut."""
    of = {term.quantity: spec.joints[term.joint] for term in own.terms}
    turns, slides = of["angle"], of["travel"]
    if turns is slides:
        return ScrewMember(turns.b, turns, 1.0), ScrewMember(turns.a, turns, -1.0)
    carrier = {turns.a, turns.b} & {slides.a, slides.b}
    spindle, nut = (ScrewMember(j.b, j, 1.0) if j.a in carrier else ScrewMember(j.a, j, -1.0) for j in (turns, slides))
    return spindle, nut


def thread(spec: Spec, lead: float, spindle: ScrewMember, nut: ScrewMember) -> Array:
    """A helix about the spindle's axis, from its bearing, in the spindle's axes, (n, 3).

    Its hand is that which moves the nut as the lead says: along a spindle that turns in its bearing a thread of the
    right hand draws the nut back.
    """
    R, _ = pose(spec, spindle.body)
    start, axis = R.T @ (place(spec, spindle) - pose(spec, spindle.body)[1]), R.T @ along(spec, spindle)
    height = float((place(spec, nut) - place(spec, spindle)) @ along(spec, spindle))
    alike = spindle.sign * nut.sign * float(np.sign(along(spec, spindle) @ along(spec, nut)))
    pitch = -lead * (alike or 1.0)
    low, high = (0.0, height) if abs(height) > SHORT * abs(lead) else (-TURNS * abs(lead), TURNS * abs(lead))
    count = float(np.clip((high - low) / pitch, -MOST, MOST))
    angle = np.linspace(0.0, 2.0 * np.pi * count, int(CORNERS * abs(count)) + 2)[:, None]
    e, f = perpendicular(axis)
    up = np.linspace(low, high, len(angle))[:, None] * axis
    line: Array = start + up + SLENDER * abs(high - low) * (np.cos(angle) * e + np.sin(angle) * f)
    return line


def along(spec: Spec, member: ScrewMember) -> Array:
    """A joint's axis as it is drawn, world axes."""
    axis = pose(spec, member.joint.a)[0] @ np.array(member.joint.axis)
    return np.asarray(axis / np.sqrt(axis @ axis))


def place(spec: Spec, member: ScrewMember) -> Array:
    """A joint's point on a body as it is drawn, world axes."""
    joint = member.joint
    R, r = pose(spec, member.body)
    return np.asarray(r + R @ np.array(joint.p if member.body == joint.a else joint.q))


def pose(spec: Spec, body: str) -> tuple[Array, Array]:
    """How a body is drawn: its axes (3, 3) and origin (3,); as the ground where that is left out."""
    if body not in spec.bodies:
        return np.eye(3), np.zeros(3)
    own = spec.bodies[body]
    R = own.near_rotation if own.rotation is None else own.rotation
    r = own.near_position if own.position is None else own.position
    return np.eye(3) if R is None else np.array(R).reshape(3, 3), np.zeros(3) if r is None else np.array(r)
