"""Solve one scene, and render its results in the requested format."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from heuncli.app.api import solve_spec
from heuncli.app.cli.documents import is_rich, render_document, render_rich_document
from heuncli.app.cli.output import print_stderr
from heuncli.app.cli.solving import format_timings, parse_instants, print_warnings
from heuncli.app.cli.target import TABLES, note_si_format
from heuncli.app.commands.run.request import RunRequest
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.base.text_safety import escape
from heuncli.output.tables.page import TablesQuery
from heuncli.output.tables.run_description import make_heading
from heuncli.output.tables.summary_document import RunParts, Summary, make_run_parts
from heuncli.results.results import Results
from heuncli.results.stored_arrays import StoredArray, iter_chunks
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.options import Options
from heuncli.study.model.selection import Selection
from heuncli.study.model.setup import attach_locations
from heuncli.study.quantities.labels import Labels, make_labels
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.study import Study

if TYPE_CHECKING:
    from heuncli.app.commands.run.collective import CollectiveTask
    from heuncli.study.queries.measure import MeasureRequest


class RunTask(NamedTuple):
    """The options of a run.

    selection: the results to show
    measures: measures of --measure
    collective: load collectives of --collective
    units: display units of tables
    """

    request: RunRequest
    form: str
    options: Options
    selection: Selection
    measures: Sequence[MeasureRequest]
    units: Units
    collective: CollectiveTask | None = None


class RenderedRun(NamedTuple):
    """A solved scene, and the text of its results in pieces that are made on demand.

    summary: of a load case, which the summary of all cases needs
    """

    study: Study
    pieces: Iterable[str]
    summary: Summary | None = None


def solve_and_render(task: RunTask, spec: Spec, case: str = "") -> RenderedRun:
    """Solve a scene and render its results; case: name of its load case, if it is one of all."""
    request = task.request
    study = solve_spec(spec, task.options)
    with attach_locations(spec):
        if task.measures:
            return RenderedRun(study, [_render_measures(task, study)])
        if task.collective is not None:
            from heuncli.app.commands.run.collective import make_collectives_document

            document = make_collectives_document(task.collective, study, task.units)
            facts = make_heading(study.results, request.verbose, brief=not request.full)
            return RenderedRun(study, [*render_document(document._replace(facts=facts), task.form, request.output)])
        labels = replace(make_labels(spec), units=task.units)
        if task.form not in TABLES:
            return RenderedRun(study, _export(request, task.form, study, labels))
        parts = make_run_parts(
            study, labels, make_query(task, study, spec), case,
            has_summary=request.only is None, show_reductions=request.verbose,
        )  # fmt: skip
        shown = parts._replace(summary=None) if case else parts
        return RenderedRun(study, render_parts(task, shown), parts.summary)


def make_query(task: RunTask, study: Study, spec: Spec) -> TablesQuery:
    """Make the query of the tables: which results, at which instants, how much of them."""
    request, selection = task.request, task.selection
    is_explicit = (request.only is not None or spec.report.results is not None) and "foundation" in selection.reports
    times = parse_instants(request.at, study) if request.at is not None else None
    return TablesQuery(selection, times, request.all, is_explicit, full=request.full or request.verbose)


def render_parts(task: RunTask, parts: RunParts) -> list[str]:
    """Render heading, summary and tables."""
    request = task.request
    document = parts.make_document(full=request.full)
    if parts.summary is None or parts.summary.is_empty or not is_rich(task.form, request.output):
        return [*render_document(document, task.form, request.output)]
    return render_rich_document(document)


def _render_measures(task: RunTask, study: Study) -> str:
    """Render the measured numbers, in the units of --units where these apply."""
    from heuncli.output.tables import measure

    shown = measure.choose_units(task.measures, study, task.units, task.request.units)
    return measure.format_measures(task.measures, study, task.form, [size for _, size in shown])


def note_measure_units(task: RunTask, study: Study) -> None:
    """Print the units of the measured numbers to standard error, or that JSON stays in SI."""
    from heuncli.output.tables import measure

    if task.form == "json" or task.request.quiet:
        note_si_format(task.request.units, task.form, task.request.quiet)
        return
    shown = measure.choose_units(task.measures, study, task.units, task.request.units)
    for line in measure.describe_units(task.measures, shown):
        print_stderr(escape(line))


def finish(task: RunTask, spec: Spec, study: Study, place: str = "heun") -> int:
    """Print warnings and times; returns the exit code."""
    later = list(study.later_warnings)
    if task.measures:
        from heuncli.output.tables import measure

        later += measure.find_warnings(task.measures, study)
    warnings = print_warnings(spec, study.results, task.request.quiet, place, later)
    if task.request.verbose:
        print_stderr(f"{place}: {format_timings(study.results.work)}")
    return _check_strict(study.results, warnings) if task.request.strict else 0


def _export(request: RunRequest, form: str, study: Study, labels: Labels) -> Iterator[str]:
    """Yield the results as JSON or CSV, at the instants of --at if these are given."""
    from heuncli.output.tables.export import iter_csv_pieces, iter_json_pieces  # not needed for tables

    times = parse_instants(request.at, study) if request.at is not None else None
    results = study.results if times is None else study.resample(times)
    return iter_json_pieces(results) if form == "json" else iter_csv_pieces(results, labels)


def _check_strict(results: Results, warnings: list[str]) -> int:
    """Return 1 if there are warnings or indeterminate reactions, and print why."""
    loads = [results.joints, results.sensors, results.sections, results.foundation.get("supports", {})]
    for impulse in results.impulses:
        supports = impulse.get("foundation", {}).get("supports", {})
        loads += [*(impulse.get(block, {}) for block in ("joints", "sensors", "sections")), supports]
    for joint, block in results.joints.items():
        loads.append({f"{joint}.bearings.{number}": own for number, own in block.get("bearings", {}).items()})
    indeterminate = [name for block in loads for name, part in block.items() if part.get("open") or _has_open(part)]
    if warnings:
        print_stderr(f"heun: --strict: {len(warnings)} warning{'s' * (len(warnings) > 1)}")
    if indeterminate:
        print_stderr(f"heun: --strict: indeterminate reactions in {', '.join(dict.fromkeys(indeterminate))}")
    return int(bool(warnings or indeterminate))


def _has_open(part: dict[str, Any]) -> bool:
    """Return whether a load of an entry is indeterminate at any instant."""
    arrays = (part[key] for key in ("force", "moment", "N") if isinstance(part.get(key), np.ndarray | StoredArray))
    return any(np.isnan(rows).any() for values in arrays for rows in iter_chunks(values))
