"""One scene solved, and told in the form that is asked for."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from heuncli.app.api import solve_spec
from heuncli.app.cli.output import say
from heuncli.app.cli.solving import instants, timings, warn
from heuncli.app.cli.units import TABLES
from heuncli.app.commands.run.request import RunRequest
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.output.snapshots.tables import TablesAsked, tables_of
from heuncli.output.tables.heading import write_heading, write_heading_markdown
from heuncli.output.tables.page_width import fit
from heuncli.output.tables.text_table import WIDTH, TextTable, markdown, plain
from heuncli.results.results import Results
from heuncli.results.stored_arrays import StoredArray, in_parts
from heuncli.scene.file_format.models import Spec
from heuncli.study.ask.study import Study
from heuncli.study.model.error_places import placed
from heuncli.study.model.options import Options
from heuncli.study.model.selection import Selection
from heuncli.study.quantities.labels import Labels, labels_of
from heuncli.study.quantities.table_units import Units

if TYPE_CHECKING:
    from heuncli.app.commands.run.collective import CollectiveTask
    from heuncli.study.ask.measure import MeasureRequest


class RunTask(NamedTuple):
    """What is to be told of a scene: the options, what is asked for, and in which units tables show it."""

    request: RunRequest
    form: str
    options: Options
    what: Selection
    asked: Sequence[MeasureRequest]
    units: Units
    counted: CollectiveTask | None = None


def solved(task: RunTask, spec: Spec) -> tuple[Study, Iterable[str]]:
    """A scene solved, and what is told of it as text, in pieces that are made as they are asked for."""
    request, what = task.request, task.what
    study = solve_spec(spec, task.options)
    with placed(spec):
        if task.asked:
            from heuncli.output.snapshots import measure

            return study, [measure.write(task.asked, study, task.form)]
        if task.counted is not None:
            from heuncli.app.commands.run.collective import told

            return study, [_counted(task, study, told(task.counted, study, task.form, task.units))]
        named = (request.only is not None or spec.report is not None) and "foundation" in what.reports
        labels = replace(labels_of(spec), units=task.units)
        if task.form not in TABLES:
            return study, _export(request, task.form, study, labels)
        return study, [_report(request, task.form, study, labels, what, details=named)]


def leave(task: RunTask, spec: Spec, study: Study, place: str = "heun") -> int:
    """Tell warnings and times; returns the exit code."""
    later = list(study.later_warnings)
    if task.asked:
        from heuncli.output.snapshots import measure

        later += measure.warnings(task.asked, study)
    warnings = warn(spec, study.results, task.request.quiet, place, later)
    if task.request.verbose:
        say(f"{place}: {timings(study.results.work)}")
    return _strict(study.results, warnings) if task.request.strict else 0


def _export(request: RunRequest, form: str, study: Study, labels: Labels) -> Iterator[str]:
    from heuncli.output.tables.export import csv_pieces, json_pieces  # tables do without

    at = instants(request.at, study) if request.at is not None else None
    shown = study.results if at is None else study.resample(at)
    return json_pieces(shown) if form == "json" else csv_pieces(shown, labels)


def _report(request: RunRequest, form: str, study: Study, labels: Labels, what: Selection, *, details: bool) -> str:
    at = instants(request.at, study) if request.at is not None else None
    tables = tables_of(study, labels, TablesAsked(what, at, request.all, details))
    return _headed(request, form, study, tables)


def _counted(task: RunTask, study: Study, told: str | list[TextTable]) -> str:
    """Collectives as text."""
    return told if isinstance(told, str) else _headed(task.request, task.form, study, told)


def _headed(request: RunRequest, form: str, study: Study, tables: list[TextTable]) -> str:
    """Tables below what was solved, and how well."""
    if form == "markdown":
        return write_heading_markdown(study.results, request.verbose) + "\n".join(map(markdown, tables))
    return write_heading(study.results, request.verbose) + "".join("\n" + text for text in _writer(request)(tables))


def _writer(request: RunRequest) -> Callable[[list[TextTable]], list[str]]:
    """How tables become text: fitted to a terminal where one is written to, else to a page."""
    if request.output is None:
        from heuncli.app.cli import terminal  # a file needs nothing of it

        if terminal.present():
            return terminal.write
    return lambda tables: [plain(part, WIDTH) for table in tables for part in fit(table, WIDTH)]


def _strict(results: Results, warnings: list[str]) -> int:
    """1 if there are warnings or open reactions, and why."""
    loads = [results.joints, results.sections, results.foundation.get("supports", {})]
    for struck in results.impulses:
        supports = struck.get("foundation", {}).get("supports", {})
        loads += [struck.get("joints", {}), struck.get("sections", {}), supports]
    unsure = [name for block in loads for name, part in block.items() if part.get("open") or _has_open(part)]
    if warnings:
        say(f"heun: --strict: {len(warnings)} warning{'s' * (len(warnings) > 1)}")
    if unsure:
        say(f"heun: --strict: open reactions in {', '.join(dict.fromkeys(unsure))}")
    return int(bool(warnings or unsure))


def _has_open(part: dict[str, Any]) -> bool:
    told = (part[key] for key in ("force", "moment", "N") if isinstance(part.get(key), np.ndarray | StoredArray))
    return any(np.isnan(rows).any() for values in told for rows in in_parts(values))
