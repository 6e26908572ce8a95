"""A solved scene as text, as a part of a page, and as a file: the tables of `heun run`."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from heuncli.base.errors import Problem, UsageError
from heuncli.base.records import replace
from heuncli.output.client_report.as_html import element, escaped
from heuncli.output.snapshots.asked_units import asked_units
from heuncli.output.snapshots.selection import Only, only, selected, told_by_default
from heuncli.output.snapshots.tables import TablesAsked, tables_of
from heuncli.output.tables.heading import heading, write_heading
from heuncli.output.tables.page_width import fit
from heuncli.output.tables.text_table import WIDTH, TextTable, plain
from heuncli.results.results import Array
from heuncli.results.results_schema import BLOWS, EVENTS, REPORT_OF
from heuncli.study.ask.study import Study
from heuncli.study.model.selection import Selection
from heuncli.study.quantities.labels import labels_of
from heuncli.study.quantities.table_units import Units

# no colours: those of the notebook, be it light or dark; all within what begins with this class
STYLE = (
    ".heun-run table{border-collapse:collapse;margin:.3em 0 .6em}"
    ".heun-run td,.heun-run th{padding:.1em .6em;text-align:right;white-space:nowrap;font-weight:normal}"
    ".heun-run th{border-bottom:1px solid currentColor;vertical-align:bottom}"
    ".heun-run .left{text-align:left}.heun-run .wide{overflow-x:auto}"
    ".heun-run h4{margin:.9em 0 .2em}.heun-run h4 small{font-weight:normal}"
    ".heun-run p{margin:.1em 0}.heun-run td.across{text-align:left;padding-top:.5em;font-style:italic}"
)


def text_of(study: Study, at: Array | None, units: str | None, words: str | Sequence[str] | None) -> str:
    """Heading and tables as `heun run` writes them into a file; at (n,): the instants, None for the extremes."""
    asked = None
    if words is not None:
        asked = only(words.split(",") if isinstance(words, str) else words, "only", "study.measure")
    tables = _tables(study, at, asked_units("units", units), asked)
    lines = [plain(part, WIDTH) for table in tables for part in fit(table, WIDTH)]
    return write_heading(study.results) + "".join("\n" + text for text in lines)


def _tables(study: Study, at: Array | None, units: Units, asked: Only | None = None) -> list[TextTable]:
    """Those of the reports that tables tell by default, as far as these were solved for."""
    solved = study.options.asked
    spec = study.spec
    what = selected(asked, spec, told_by_default(spec)) if asked is not None or not solved.entries else solved
    what = replace(what, reports=what.reports & solved.reports or solved.reports)
    named = (asked is not None or spec.report is not None) and "foundation" in what.reports
    own = _narrowed(study, what)
    tables = tables_of(own, replace(labels_of(spec), units=units), TablesAsked(what, at, details=named))
    study.later_warnings.update(own.later_warnings)
    return tables


def _narrowed(study: Study, what: Selection) -> Study:
    """The study with some of its reports alone."""
    results, reports = study.results, what.reports
    left: dict[str, Any] = {block: {} for block, report in REPORT_OF.items() if report not in reports}
    left |= {} if BLOWS in reports else {BLOWS: []}
    left |= {} if EVENTS in reports else {EVENTS: {}}
    left |= {} if "joints" in reports else {"certain_sums": []}
    options = replace(study.options, wanted=reports)
    return replace(study, options=options, results=dataclasses.replace(results, **left))


def fragment_of(study: Study, at: Array | None) -> str:
    """Heading and tables as a part of a page: whatever a spec says is text in it, never markup; no script."""
    _, *lines = heading(study.results)  # the first is version and title
    body = [element("style", STYLE), element("h4", escaped(study.results.title))]
    body += [element("p", escaped(f"{label}: {text}" if label else text)) for label, text in lines]
    body += [_table(table) for table in _tables(study, at, Units())]
    return element("div", "\n".join(body), class_="heun-run")


def _table(table: TextTable) -> str:
    name, _, rest = table.heading.partition("  ")
    caption = element("h4", escaped(name) + (" " + element("small", escaped(rest)) if rest else "")) if name else ""
    grid = ""
    if table.columns:
        kinds = ["left" if column.align == "left" else "" for column in table.columns]
        named = zip(table.columns, kinds, strict=True)
        heads = (element("th", escaped(column.head), class_=kind) for column, kind in named)
        rows = [element("tr", "".join(heads)), *(_row(row, kinds) for row in table.rows)]
        grid = element("div", element("table", "\n".join(rows)), class_="wide")
    return "\n".join([caption, grid, *(element("p", escaped(note)) for note in table.notes)])


def _row(row: tuple[str, ...] | str, kinds: Sequence[str]) -> str:
    if isinstance(row, str):
        return element("tr", element("td", escaped(row), colspan=str(len(kinds)), class_="across"))
    cells = (element("td", escaped(cell), class_=kind) for cell, kind in zip(row, kinds, strict=True))
    return element("tr", "".join(cells))


def write_results(file: str | os.PathLike[str], forms: Mapping[str, Callable[[], str]]) -> None:
    """Write the results in the form that the name's end says. Raises UsageError, OSError."""
    path = Path(file)
    form = forms.get(path.suffix.lower())
    if form is None:
        message = f"save {path.name}: results are written by the name's end: {', '.join(forms)}"
        raise UsageError(Problem("bad-option", message, hint="diagrams are saved by study.plot(...).save(file)"))
    path.write_text(form(), encoding="utf-8", newline="\n")
