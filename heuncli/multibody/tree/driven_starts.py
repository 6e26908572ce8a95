"""Drives by a rate, or counted from the assembled start: after assembly their coordinates are known in time."""

from __future__ import annotations

from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import replace
from heuncli.multibody.mechanism.model import Assembly, Joint, Mechanism
from heuncli.multibody.tree.starts import compute_joint_start, point_distance
from heuncli.scene.expressions.discontinuities import find_first_not_positive
from heuncli.scene.expressions.integrals import add_start_value


def prescribe_coordinates(mechanism: Mechanism, start: Assembly) -> Mechanism:
    """Make all drives prescribe their coordinates; start: assembled at t = 0."""
    return replace(
        mechanism, joints=tuple(_prescribe_coordinate(mechanism, start, joint) for joint in mechanism.joints)
    )


def require_lengths(mechanism: Mechanism, last: float) -> None:
    """Raise SolveError [drive-length] where the length of a driven rod becomes zero within a run up to `last`."""
    problems = []
    for joint in mechanism.joints:
        drive = joint.drive
        end_time = (
            find_first_not_positive(drive.value, last) if drive is not None and drive.quantity == "length" else None
        )
        if drive is not None and end_time is not None:
            message = f"drive {drive.name}: the length of rod {joint.name} reaches 0 at t = {end_time:.4g} s"
            hint = "end the run earlier, or keep the length above 0"
            problems.append(Problem("drive-length", message, drive.value.location, hint))
    if problems:
        raise SolveError(*problems)


def _prescribe_coordinate(mechanism: Mechanism, start: Assembly, joint: Joint) -> Joint:
    drive = joint.drive
    if drive is None or not drive.adds_to_start:
        return joint
    zero = drive.zero_assembled and drive.quantity == "angle"  # a travel counts from where the points are level
    value = add_start_value(drive.value, _start_coordinate(mechanism, start, joint))
    begun_joint: Joint = replace(joint, drive=replace(drive, value=value, from_start=False, zero_assembled=zero))
    return begun_joint


def _start_coordinate(mechanism: Mechanism, start: Assembly, joint: Joint) -> float:
    """Return the driven coordinate at the start: an angle [rad], a travel or a length [m]; the held value where there
    is one.
    """
    assert joint.drive is not None
    if joint.drive.quantity == "length":
        return joint.length if joint.length is not None else point_distance(start, joint)
    start_values = compute_joint_start(mechanism, start, joint)
    held, found = (
        (joint.angle, start_values.angle) if joint.drive.quantity == "angle" else (joint.travel, start_values.travel)
    )
    # a held value is measured from the assembled start, too
    is_relative = joint.to_axis_given or joint.drive.zero_assembled
    return held if held is not None and not is_relative else found
