"""Drives by a rate, or counted from the assembled start: from there on their coordinates are known in time."""

from __future__ import annotations

from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import replace
from heuncli.multibody.mechanism.model import Assembly, Joint, Mechanism
from heuncli.multibody.tree.starts import distance, joint_start
from heuncli.scene.expressions.discontinuities import first_not_positive
from heuncli.scene.expressions.integrals import begun_at


def begun(mechanism: Mechanism, start: Assembly) -> Mechanism:
    """The mechanism with drives that prescribe their coordinates; start: assembled at t = 0."""
    return replace(mechanism, joints=tuple(_begun(mechanism, start, joint) for joint in mechanism.joints))


def require_lengths(mechanism: Mechanism, last: float) -> None:
    """Raise SolveError [drive-length] where a driven rod has no length left within a run up to `last`."""
    problems = []
    for joint in mechanism.joints:
        drive = joint.drive
        gone = first_not_positive(drive.value, last) if drive is not None and drive.quantity == "length" else None
        if drive is not None and gone is not None:
            message = f"drive {drive.name}: the rod {joint.name} has no length left at t = {gone:.4g} s"
            hint = "let the run end before, or the length stay above 0"
            problems.append(Problem("drive-length", message, drive.value.location, hint))
    if problems:
        raise SolveError(*problems)


def _begun(mechanism: Mechanism, start: Assembly, joint: Joint) -> Joint:
    drive = joint.drive
    if drive is None or not drive.adds_to_start:
        return joint
    zero = drive.zero_assembled and drive.quantity == "angle"  # a travel is told from where the points are level
    value = begun_at(drive.value, _coordinate(mechanism, start, joint))
    begun_joint: Joint = replace(joint, drive=replace(drive, value=value, from_start=False, zero_assembled=zero))
    return begun_joint


def _coordinate(mechanism: Mechanism, start: Assembly, joint: Joint) -> float:
    """What a drive prescribes, at the start: an angle [rad], a travel or a length [m], as it is held where it is."""
    assert joint.drive is not None
    if joint.drive.quantity == "length":
        return joint.length if joint.length is not None else distance(start, joint)
    at = joint_start(mechanism, start, joint)
    held, found = (joint.angle, at.angle) if joint.drive.quantity == "angle" else (joint.travel, at.travel)
    from_there = joint.to_axis_given or joint.drive.zero_assembled  # what is held is told from where it stands, too
    return held if held is not None and not from_there else found
