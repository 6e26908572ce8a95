"""`heun run --case all`: what each load case tells, and the envelope: every extreme with the case that governs it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from heuncli.app.cli.entry import worst
from heuncli.app.cli.output import emit
from heuncli.app.cli.solving import require_cases
from heuncli.app.cli.units import TABLES, say_what_stays
from heuncli.app.commands.run.scene import RunTask, leave, solved
from heuncli.base.foreign_text import shown
from heuncli.output.snapshots.envelopes import Bound, Enveloped, envelope
from heuncli.output.snapshots.keep import keep
from heuncli.output.snapshots.kept import KeptRun
from heuncli.output.tables.export import dump
from heuncli.output.tables.page_width import fit
from heuncli.output.tables.text_table import WIDTH, TextColumn, TextTable, markdown, plain
from heuncli.scene.file_format.models import Spec
from heuncli.study.quantities.table_units import Units

HEADS = ("of", "unit", "least", "at [s]", "case", "greatest", "at [s]", "case")
DIGITS = 6
ALL_ALIKE = "all alike"  # where cases differ by no more than their errors
STRUCK = "without blows: these stand in the tables of each case"


def run_all(task: RunTask, spec: Spec, cases: Mapping[str, Spec]) -> int:
    """Solve every case and tell of them; returns the exit code."""
    require_cases(cases)
    told: dict[str, str] = {}
    runs: dict[str, KeptRun] = {}
    codes = [0]
    for name, one in cases.items():
        study, pieces = solved(task, one)
        told[name] = "".join(pieces)
        if not (task.asked or task.counted):
            runs[name] = keep(study, task.what.reports, whole_course=False)
        codes.append(leave(task, one, study, f"heun: case {name}"))
    emit(_text(task, cases, told, runs), task.request.output)
    say_what_stays(task.request.units, "--measure" if task.asked else task.form, task.request.quiet)
    return worst(codes)


def _text(task: RunTask, cases: Mapping[str, Spec], told: Mapping[str, str], runs: Mapping[str, KeptRun]) -> str:
    """All cases and their envelope in the form that is asked for."""
    if task.form == "json":
        blocks = {name: json.loads(text) for name, text in told.items()}
        return dump({"cases": blocks} | ({"envelope": dict(_blocks(runs))} if runs else {}))
    if task.asked:
        return "".join(f"{name} {line}\n" for name, text in told.items() for line in text.splitlines())
    if task.form == "csv":
        return "".join(_csv(told))
    if task.counted:
        return "\n".join(told.values())
    table = _table(envelope(runs), task.units, _notes(runs))
    if task.form == "markdown":
        return "\n".join([*told.values(), markdown(table)])
    assert task.form in TABLES
    return "\n".join([*told.values(), *(plain(part, WIDTH) for part in fit(table, WIDTH))])


def _csv(told: Mapping[str, str]) -> Iterator[str]:
    """The lines of all cases, each behind the name of its case; the row of names once."""
    for number, (name, text) in enumerate(told.items()):
        head, *lines = text.splitlines(keepends=True)
        yield from [f"case,{head}"] if not number else []
        yield from (f"{name},{line}" for line in lines)


def _blocks(runs: Mapping[str, KeptRun]) -> Iterator[tuple[str, dict[str, Any]]]:
    """The envelope for JSON."""
    beyond = {name: run.horizon for name, run in runs.items() if run.horizon is not None}
    for row in envelope(runs):
        block: dict[str, Any] = {"unit": row.unit}
        block |= {"min": _bound_block(row.least), "max": _bound_block(row.greatest)}
        block |= {"not_in": dict(row.unclear)} if row.unclear else {}
        yield row.path, block | ({"horizon": beyond} if beyond else {})


def _bound_block(bound: Bound | None) -> dict[str, Any] | None:
    """A bound for JSON; alike: of which other cases it is as well, but for the stated errors."""
    if bound is None:
        return None
    block = {"value": bound.value, "at": bound.at, "case": bound.case}
    return block | ({"alike": list(bound.alike)} if bound.alike else {})


def _table(rows: Sequence[Enveloped], units: Units, notes: Sequence[str]) -> TextTable:
    """The envelope as a table; what is 0 in all cases is left out."""
    told = [row for row in rows if row.unclear or not all(map(_is_zero, (row.least, row.greatest)))]
    columns = tuple(TextColumn(head, "left" if head in ("of", "unit", "case") else "point") for head in HEADS)
    unclear = [f"{row.path}: {row.lacks}" for row in told if row.unclear]
    body = tuple(_row(row, units) for row in told if row.least or row.greatest)
    return TextTable("ENVELOPE  of all load cases", columns, body, notes=(*notes, *map(shown, unclear)))


def _is_zero(bound: Bound | None) -> bool:
    """Whether there is no bound, or nothing but rounding in all cases."""
    return bound is None or not bound.value or bound.is_rounding


def _governing(bound: Bound) -> str:
    """The case that governs a bound; nothing where that is rounding, or where all cases are alike."""
    if bound.is_rounding or bound.case is None:
        return "" if bound.is_rounding else ALL_ALIKE
    return ", ".join(bound.governing) if len(bound.alike) <= 1 else f"{bound.case} and {len(bound.alike)} alike"


def _row(row: Enveloped, units: Units) -> tuple[str, ...]:
    unit, size = units.of(row.unit)
    ends: list[str] = []
    for bound in (row.least, row.greatest):
        if bound is None:
            ends += ["", "", ""]
            continue
        at = "" if bound.at is None or bound.is_rounding else f"{bound.at:.6g}"
        text = "0" if bound.is_rounding else f"{bound.value * size:.{DIGITS}g}"
        ends += [text, at, shown(_governing(bound))]
    return (shown(row.path), unit, *ends)


def _notes(runs: Mapping[str, KeptRun]) -> list[str]:
    """Which cases are not known to their end, and what stands in their own tables alone."""
    struck = [STRUCK] if any(run.blows for run in runs.values()) else []
    return struck + [
        f"{name}: nothing is claimed from its horizon on, t = {run.horizon:.6g} s"
        for name, run in runs.items()
        if run.horizon is not None
    ]
