"""Rules about joints along a path: it is a smooth curve, and a prescribed start lies on it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from heuncli.base import tolerances
from heuncli.scene.expressions.programs import TableFunction
from heuncli.scene.file_format import format_joints as fj
from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule

if TYPE_CHECKING:
    from heuncli.scene.expressions.paths import Path
    from heuncli.scene.file_format.fields import Direction

AXES = ("x", "y", "z")
PERIODIC = 2  # a table's kind (scene/expressions/programs.py)


@rule("path-form")
def check_path_form(draft: DraftDocument) -> Iterator[Violation]:
    """A path has a table at least; its tables share a range or a period; it has a direction everywhere; a start is on
    it.
    """
    for name, joint in draft.document.joints.items():
        if isinstance(joint, fj.CurveJoint):
            yield from check_path(name, joint, draft.document.head.space == "planar")


def check_path(name: str, joint: fj.CurveJoint, planar: bool) -> Iterator[Violation]:
    """Yield what prevents a joint's tables from forming a path."""
    path = ("joints", name)
    tables = {axis: table for axis in AXES if isinstance(table := getattr(joint, axis), TableFunction)}
    if not tables:
        hint = "give x, y and z, each as a table over the travel along the path or as a number"
        yield Violation(path, "a path needs at least one table", hint, key=True)
        return
    if planar and "z" in tables:
        yield Violation((*path, "z"), "a planar model has no path along z", "give z as a number")
        return
    if (violation := find_range_error(name, tables)) is not None:
        yield violation
        return
    from heuncli.scene.expressions.paths import find_cusp, make_path  # with NumPy, which few specs need

    curve = make_path((joint.x, joint.y, joint.z))
    cusp_travel = find_cusp(curve)
    if cusp_travel is not None:
        hint = "round a corner, or end the path before this point"
        yield Violation(path, f"the path has no direction at travel {cusp_travel:.6g} (cusp)", hint, key=True)
        return
    if joint.radius is not None or joint.normal is not None or joint.one_sided:
        yield from check_path_side(name, joint, planar, curve)
    start_travel = joint.initial.travel if joint.initial is not None else None
    if start_travel is not None and not curve.period and not curve.first <= start_travel <= curve.last:
        message = f"travel {start_travel:g} is outside the path, which covers {curve.first:.6g} to {curve.last:.6g} m"
        yield Violation((*path, "initial", "travel"), message, "start it on the path, or leave it out")


def check_path_side(name: str, joint: fj.CurveJoint, planar: bool, path: Path) -> Iterator[Violation]:
    """Yield what prevents a path from having a left and a right side, for a roller or a one-sided path: it must be
    plane.
    """
    joint_path, key = ("joints", name), "radius" if joint.radius is not None else "one_sided"
    if joint.radius is None and not joint.one_sided:
        hint = "normal sets the side of a roller, or the pushing side of a one_sided path"
        yield Violation((*joint_path, "normal"), "'normal' without 'radius'", hint, key=True)
        return
    normal = joint.normal or ((0.0, 0.0, 1.0) if planar else None)
    if normal is None:
        hint = (
            "normal of the path's plane, as normal: [0, 0, 1]; with it pointing towards you, the roller is on the left"
        )
        subject = "a roller on a path" if joint.radius is not None else "a path that pushes to one side"
        yield Violation((*joint_path, key), f"{subject} needs its 'normal'", hint, key=True)
        return
    if normal == (0.0, 0.0, 0.0) or (planar and normal[:2] != (0.0, 0.0)):  # reported by another rule
        return
    from heuncli.scene.expressions.roller_path import leaves_plane

    if leaves_plane(path, normal):
        normal_path = (*joint_path, "normal" if joint.normal is not None else key)
        hint = "only a plane path has a left side: z: a number, and normal: [0, 0, 1]"
        yield Violation(normal_path, "the path does not lie in a plane perpendicular to its normal", hint)
    elif joint.radius is not None and joint.radius > 0.0:  # else reported by another rule
        yield from check_roller(joint_path, joint, path, normal)


def check_roller(joint_path: Path_, joint: fj.CurveJoint, path: Path, normal: Direction) -> Iterator[Violation]:
    """Yield what prevents a roller from following a path: too high a curvature, or another part of the path too
    close.
    """
    from heuncli.scene.expressions.paths import make_roller_path
    from heuncli.scene.expressions.roller_path import find_interference, find_max_curvature

    assert joint.radius is not None
    roller = make_roller_path(path, joint.radius, normal)
    tightest_travel, share = find_max_curvature(roller)
    if share > 1.0 - tolerances.NO_PATH_DIRECTION:
        tightest_travel = (
            tightest_travel if abs(tightest_travel) > tolerances.SAME_VALUE * (path.last - path.first) else 0.0
        )  # a smaller value is rounding error
        path_radius = joint.radius / share
        curved = f"the path has a radius of {path_radius:.4g} m at travel {tightest_travel:.6g}, but the roller has "
        hint = "use a smaller roller, a path with less curvature, or the other side (the opposite normal)"
        yield Violation((*joint_path, "radius"), f"{curved}{joint.radius:.4g} m: it cannot follow the path", hint)
    elif (meeting := find_interference(roller)) is not None:
        message = f"at travel {meeting[0]:.6g} the roller would also touch the path at travel {meeting[1]:.6g}"
        hint = "use a shorter path, a smaller roller or the other side; for the path of the centre give no radius"
        yield Violation((*joint_path, "radius"), message, hint)


def check_path_restitution(draft: DraftDocument) -> Iterator[Violation]:
    """Restitution is for a one-sided path, from 0 to 1, without loads in the joint that would act while the point is
    free.
    """
    for name, joint in draft.document.joints.items():
        if not isinstance(joint, fj.CurveJoint) or joint.restitution is None:
            continue
        path = ("joints", name, "restitution")
        if not joint.one_sided:
            message = "restitution given, but this path guides on both sides: it has no impacts"
            yield Violation(path, message, "add one_sided: true", key=True)
        if not 0.0 <= joint.restitution <= 1.0:
            hint = "0: no rebound, 1: full rebound"
            yield Violation(path, f"restitution {joint.restitution:g} is not between 0 and 1", hint)
        for load, entry in draft.document.forces.items():
            if entry.type in ("damper", "friction") and entry.joint == name:
                message = f"the {entry.type} {load} would still act while the point is off its path"
                hint = "remove it; or without restitution the run ends where the point lifts off"
                yield Violation(("forces", load, "joint"), message, hint)


def find_range_error(name: str, tables: dict[str, TableFunction]) -> Violation | None:
    """Return what is wrong with the ranges of tables that form a path together."""
    path = ("joints", name)
    ends = {axis: (table.x[0], table.x[-1]) for axis, table in tables.items() if table.kind != PERIODIC}
    if ends:
        if max(low for low, _ in ends.values()) < min(high for _, high in ends.values()):
            return None
        message = "its tables have no travel in common: " + ", ".join(
            f"{axis} from {low:.6g} to {high:.6g}" for axis, (low, high) in ends.items()
        )
        return Violation(path, message, "all tables must cover the same travel along the path", key=True)
    periods = {axis: table.numbers[0] for axis, table in tables.items()}
    first = next(iter(periods.values()))
    if all(abs(period - first) <= tolerances.TABLE_ENDS * first for period in periods.values()):
        return None
    message = "its tables have different periods: " + ", ".join(f"{a} {p:.6g}" for a, p in periods.items())
    return Violation(path, message, "a closed path has one period: its length", key=True)
