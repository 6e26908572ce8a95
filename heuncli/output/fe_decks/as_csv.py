"""Load cases as CSV: a row a vector, with its case, what it is of, and its unit; no comments: all programs read it."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from io import StringIO

import numpy as np

from heuncli.analyses.load_cases.model import LoadCase, LoadCases, PointAction
from heuncli.output.fe_decks.naming import DeckNames
from heuncli.results.results import Array

HEAD = ("case", "time", "kind", "name", "by", "point", "quantity", "unit", "x", "y", "z")


def written(cases: LoadCases, names: DeckNames) -> Iterator[str]:
    """The lines."""
    yield _line(HEAD)
    for row in rows(cases):
        yield _line(row)


def rows(cases: LoadCases) -> Iterator[tuple[object, ...]]:
    """A row a vector: the body first, then the cases."""
    _, length, mass, _ = cases.units
    body = cases.body
    own = ("", "", "body", body.name, "", "")
    yield (*own, "mass", mass, body.mass, "", "")
    yield (*own, "center", length, *_of(body.center))
    for name, row in zip("xyz", body.inertia, strict=True):
        yield (*own, f"inertia.{name}", f"{mass}*{length}^2", *_of(row))
    for case in cases.cases:
        yield from _case(cases, case)


def _case(cases: LoadCases, case: LoadCase) -> Iterator[tuple[object, ...]]:
    force, length, _, time = cases.units
    pulse = f"*{time}" if case.struck else ""
    lead = (case.name, repr(case.time))
    for one in case.actions:
        yield from _action((*lead, one.kind, one.name, one.by, one.point), one, (f"{force}{pulse}", length))
    f, rate = case.field, "" if case.struck else "^2"
    field = [("acceleration", f"{length}/{time}{rate}", f.origin), ("gravity", f"{length}/{time}{rate}", f.gravity),
             ("angular_velocity", f"rad/{time}", f.angular_velocity),
             ("angular_acceleration", f"rad/{time}{rate}", f.angular_acceleration)]  # fmt: skip
    if case.struck:  # a blow changes velocities, and nothing else matters meanwhile
        field = [("velocity_jump", *field[0][1:]), ("angular_velocity_jump", *field[3][1:])]
    for quantity, unit, value in field:
        yield (*lead, "inertia", cases.body.name, "", "origin", quantity, unit, *_of(value))
    sums = cases.body.sums(case)
    yield (*lead, "sum", "", "", "origin", "force", f"{force}{pulse}", *_of(sums.force))
    yield (*lead, "sum", "", "", "origin", "moment", f"{force}{pulse}*{length}", *_of(sums.moment))


def _action(lead: Sequence[object], one: PointAction, units: tuple[str, str]) -> Iterator[tuple[object, ...]]:
    force, length = units
    yield (*lead, "position", length, *_of(one.at))
    yield (*lead, "force", force, *_of(one.force))
    yield (*lead, "moment", f"{force}*{length}", *_of(one.moment))
    if one.per_length is not None:
        yield (*lead, "force_per_length", f"{force}/{length}", *_of(one.per_length))


def _of(vector: Array) -> list[str]:
    return [repr(x) for x in (np.asarray(vector) + 0.0).tolist()]


def _line(row: Sequence[object]) -> str:
    text = StringIO()
    csv.writer(text, lineterminator="\n").writerow(row)
    return text.getvalue()
