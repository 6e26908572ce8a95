"""Joints along a path: that it is one, smooth all along, and that what is held at the start lies on it."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli import tolerances
from heuncli.expressions.programs import TableFunction
from heuncli.spec import format as f
from heuncli.spec.rules.registry import DraftDocument, Violation, rule

AXES = ("x", "y", "z")
PERIODIC = 2  # a table's kind (expressions/programs.py)


@rule("path-form")
def path_form(draft: DraftDocument) -> Iterator[Violation]:
    """A path is a table at least, its tables share a range, or a period; it never stands still; a start is on it."""
    for name, joint in draft.document.joints.items():
        if isinstance(joint, f.CurveJoint):
            yield from faults(name, joint, draft.document.head.space == "planar")


def faults(name: str, joint: f.CurveJoint, planar: bool) -> Iterator[Violation]:
    """What keeps a joint's tables from being a path."""
    path = ("joints", name)
    tables = {axis: table for axis in AXES if isinstance(table := getattr(joint, axis), TableFunction)}
    if not tables:
        hint = "x, y and z are each a table over the travel along the path, or a number"
        yield Violation(path, "a path without a table is a point", hint, key=True)
        return
    if planar and "z" in tables:
        yield Violation((*path, "z"), "a planar scene has no path along z", "z: a number")
        return
    if (violation := ranges(name, tables)) is not None:
        yield violation
        return
    from heuncli.expressions.paths import cusp, path_of  # with NumPy, which few specs need

    found = path_of((joint.x, joint.y, joint.z))
    still = cusp(found)
    if still is not None:
        hint = "a path goes on everywhere: a corner is rounded, an end is cut off before it"
        yield Violation(path, f"the path stands still at travel {still:.6g}: it has no direction there", hint, key=True)
    held = joint.initial.travel if joint.initial is not None else None
    if held is not None and not found.period and not found.first <= held <= found.last:
        message = f"travel {held:g} is off the path, which covers {found.first:.6g} to {found.last:.6g} m"
        yield Violation((*path, "initial", "travel"), message, "hold it on the path, or leave it out")


def ranges(name: str, tables: dict[str, TableFunction]) -> Violation | None:
    """What is wrong with the ranges of tables that make a path together."""
    path = ("joints", name)
    ends = {axis: (table.x[0], table.x[-1]) for axis, table in tables.items() if table.kind != PERIODIC}
    if ends:
        if max(low for low, _ in ends.values()) < min(high for _, high in ends.values()):
            return None
        message = "its tables have no travel in common: " + ", ".join(
            f"{axis} from {low:.6g} to {high:.6g}" for axis, (low, high) in ends.items()
        )
        return Violation(path, message, "all are over one travel along the path", key=True)
    periods = {axis: table.numbers[0] for axis, table in tables.items()}
    first = next(iter(periods.values()))
    if all(abs(period - first) <= tolerances.TABLE_ENDS * first for period in periods.values()):
        return None
    message = "its tables close after different ways: " + ", ".join(f"{a} after {p:.6g}" for a, p in periods.items())
    return Violation(path, message, "a closed path has one period, its length", key=True)
