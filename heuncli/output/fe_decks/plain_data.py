"""Write load cases as CSV, one row for each vector, and as JSON. Neither has comments, so any program can read it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from heuncli.analyses.load_cases.model import LoadCase, LoadCases, PointAction
from heuncli.output.documents.as_data import dump_json, format_line
from heuncli.output.documents.document import Cell
from heuncli.output.fe_decks.decks import DeckNames
from heuncli.results.results import Array

HEADER = ("case", "time", "kind", "name", "by", "point", "quantity", "unit", "x", "y", "z")


def write_csv(cases: LoadCases, names: DeckNames) -> Iterator[str]:
    """Yield the lines of the CSV, with all digits."""
    yield format_line(HEADER)
    for row in iter_vector_rows(cases):
        yield format_line(row)


def iter_vector_rows(cases: LoadCases) -> Iterator[tuple[Cell, ...]]:
    """Yield one row for each vector: first the body, then the cases."""
    _, length, mass, _ = cases.units
    body = cases.body
    body_columns = ("", "", "body", body.name, "", "")
    yield (*body_columns, "mass", mass, body.mass, "", "")
    yield (*body_columns, "center", length, *_format_vector(body.center))
    for name, row in zip("xyz", body.inertia, strict=True):
        yield (*body_columns, f"inertia.{name}", f"{mass}*{length}^2", *_format_vector(row))
    for case in cases.cases:
        yield from _iter_case_rows(cases, case)


def _iter_case_rows(cases: LoadCases, case: LoadCase) -> Iterator[tuple[Cell, ...]]:
    force, length, _, time = cases.units
    pulse = f"*{time}" if case.is_impulse else ""
    case_columns = (case.name, repr(case.time))
    for action in case.actions:
        yield from _iter_action_rows(
            (*case_columns, action.kind, action.name, action.source, action.point), action, (f"{force}{pulse}", length)
        )
    f, rate = case.field, "" if case.is_impulse else "^2"
    field = [("acceleration", f"{length}/{time}{rate}", f.origin), ("gravity", f"{length}/{time}{rate}", f.gravity),
             ("angular_velocity", f"rad/{time}", f.angular_velocity),
             ("angular_acceleration", f"rad/{time}{rate}", f.angular_acceleration)]  # fmt: skip
    if case.is_impulse:  # an impulse changes only velocities
        field = [("velocity_jump", *field[0][1:]), ("angular_velocity_jump", *field[3][1:])]
    for quantity, unit, value in field:
        yield (*case_columns, "inertia", cases.body.name, "", "origin", quantity, unit, *_format_vector(value))
    sums = cases.body.compute_sums(case)
    yield (*case_columns, "sum", "", "", "origin", "force", f"{force}{pulse}", *_format_vector(sums.force))
    yield (*case_columns, "sum", "", "", "origin", "moment", f"{force}{pulse}*{length}", *_format_vector(sums.moment))


def _iter_action_rows(
    first_columns: Sequence[Cell], action: PointAction, units: tuple[str, str]
) -> Iterator[tuple[Cell, ...]]:
    force, length = units
    yield (*first_columns, "position", length, *_format_vector(action.at))
    yield (*first_columns, "force", force, *_format_vector(action.force))
    yield (*first_columns, "moment", f"{force}*{length}", *_format_vector(action.moment))
    if action.per_length is not None:
        yield (*first_columns, "force_per_length", f"{force}/{length}", *_format_vector(action.per_length))


def _format_vector(vector: Array) -> list[str]:
    return [repr(x) for x in (np.asarray(vector) + 0.0).tolist()]


def write_json(cases: LoadCases, names: DeckNames) -> Iterator[str]:
    """Yield one JSON object."""
    body = cases.body
    yield dump_json({
        "heun": 1,
        "title": cases.title,
        "spec": {"path": cases.spec, "sha256": cases.digest},
        "version": cases.version,
        "units": dict(zip(("force", "length", "mass", "time"), cases.units, strict=True)),
        "axes": "body",
        "body": {"name": body.name, "mass": body.mass, "center": body.center, "inertia": body.inertia},
        "estimate": {"reactions": cases.estimate},
        **({"split": cases.split} if cases.split else {}),
        "cases": [_make_case_block(cases, case) for case in cases.cases],
    })  # fmt: skip


def _make_case_block(cases: LoadCases, case: LoadCase) -> dict[str, Any]:
    sums, f = cases.body.compute_sums(case), case.field
    field: dict[str, Any] = {
        "acceleration": f.origin, "gravity": f.gravity, "angular_velocity": f.angular_velocity,
        "angular_acceleration": f.angular_acceleration,
    }  # fmt: skip
    if case.is_impulse:
        field = {"velocity_jump": f.origin, "angular_velocity_jump": f.angular_acceleration}
    return {
        "name": case.name,
        "time": case.time,
        "blow": case.is_impulse,
        **({"blow_over": case.averaging_time} if case.averaging_time is not None else {}),
        "loads": [
            {"kind": one.kind, "name": one.name, "by": one.source, "point": one.point or None, "position": one.at,
             "force": one.force, "moment": one.moment,
             **({"force_per_length": one.per_length} if one.per_length is not None else {})}
            for one in case.actions
        ],
        "origin": field,
        "sums": {"force": sums.force, "moment": sums.moment, "relative": cases.body.balance(case).relative},
    }  # fmt: skip
