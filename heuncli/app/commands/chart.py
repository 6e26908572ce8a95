"""`heun chart`: compare speed and accuracy of the integration methods on the user's scene."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import Annotated, Any

from heuncli.analyses.work_precision.plan import ChartOptions
from heuncli.analyses.work_precision.results import (
    COMPLETED,
    FAILED,
    KINDS,
    ChartResults,
    ChartRun,
    format_setting,
    make_remark,
    remove_instant,
)
from heuncli.analyses.work_precision.study import chart
from heuncli.app.cli import timeout
from heuncli.app.cli.documents import emit_document
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.figure_output import require_save_form
from heuncli.app.cli.options import CASE, FORMAT, FORMATS, OUTPUT, QUIET, SET, SPEC, Option
from heuncli.app.cli.output import save
from heuncli.app.cli.progress import show_progress
from heuncli.app.cli.solving import load_spec, print_warnings
from heuncli.app.cli.target import choose_format, require_other_file
from heuncli.base.errors import Problem
from heuncli.base.method_rows import AUTO, METHODS, find_method
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.output.documents.as_data import FORMAT as FORMAT_NUMBER
from heuncli.output.documents.as_data import make_columns
from heuncli.output.documents.document import (
    Cell,
    NumberCell,
    OutputColumn,
    OutputDocument,
    OutputTable,
    Part,
    make_panels,
)
from heuncli.output.drawing.drawing_files import encode_drawing
from heuncli.scene.file_format.methods import method_hint
from heuncli.version import VERSION


class ChartRequest(NamedTuple):
    """The options and arguments of `heun chart`."""

    spec: Annotated[str, SPEC]
    format: Annotated[str | None, FORMAT] = None
    output: Annotated[str | None, OUTPUT] = None
    save: Annotated[
        str | None,
        Option(("--save",), "Also draw the chart in this file: chart.svg, .png or .pdf.", "FILE"),
    ] = None
    methods: Annotated[
        str | None, Option(("--methods",), "Run only these methods; heun methods lists them.", "NAME,...")
    ] = None
    tolerances: Annotated[
        str | None, Option(("--tolerances",), "Local tolerances of adaptive methods.", "NUMBER,...")
    ] = None
    steps: Annotated[str | None, Option(("--steps",), "Step sizes of fixed-step methods [s].", "NUMBER,...")] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    time_limit: Annotated[
        float | None, Option(("--time-limit",), "Start no run after this time; runs left out are listed.", "SECONDS")
    ] = None
    quiet: Annotated[bool, QUIET] = False


def main(request: ChartRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = choose_format(request.format, request.output, FORMATS)
    figure_form = require_save_form(request.save, request.output)
    options = ChartOptions(
        parse_methods(request.methods),
        parse_numbers("--tolerances", request.tolerances, 1.0),
        parse_numbers("--steps", request.steps, math.inf),
    )
    spec = load_spec(request)
    require_other_file(request.output, [request.spec])
    if request.save is not None:
        require_other_file(request.save, [request.spec], "--save")
    with show_progress(request.quiet) as report:
        results = chart(spec, replace(options, time_limit=timeout.remaining_time()), report)
    if figure_form is not None and request.save is not None:
        from heuncli.output.drawing.layout import lay_out
        from heuncli.output.figures.work_precision import make_work_precision_figure

        save(encode_drawing(lay_out(make_work_precision_figure(results)), figure_form), request.save)
    emit_document(make_document(results), form, request.output, late=True)
    print_warnings(spec, None, request.quiet)
    return 0


def parse_methods(words: str | None) -> tuple[str, ...] | None:
    """Parse the names of `--methods` as the registry writes them."""
    if words is None:
        return None
    method_names = []
    for word in words.split(","):
        row = find_method(word.strip())
        if row is None:
            names = [each.name for each in METHODS]
            hint = method_hint(word.strip())
            if word.strip().lower() == AUTO:
                hint = f"auto is not a single method; accepted: {', '.join(names)}"
            raise UsageError(Problem("bad-option", f"--methods {word.strip()}: unknown method", hint=hint))
        method_names.append(row.name)
    return tuple(dict.fromkeys(method_names))


def parse_numbers(option: str, words: str | None, upper_bound: float) -> tuple[float, ...] | None:
    """Parse positive numbers separated by commas, all below a bound."""
    if words is None:
        return None
    try:
        values = [float(word) for word in words.split(",")]
    except ValueError:
        hint = f"for example {option} 1e-4,1e-6"
        raise UsageError(Problem("bad-option", f"{option} {words}: expected numbers", hint=hint)) from None
    for value in values:
        if not (0.0 < value < upper_bound and math.isfinite(value)):
            limit = "" if upper_bound == math.inf else f" below {upper_bound:g}"
            raise UsageError(
                Problem(
                    "bad-option",
                    f"{option} {value:g}: expected positive numbers{limit}",
                    hint=f"for example {option} 1e-4,1e-6",
                )
            )
    return tuple(values)


HEADING = "RUNS  median processor time of the integration only; errors at the compared instants; * Pareto front"
ERROR_WORDS = {
    "motion": "motion: largest error of any point, relative to the model size",
    "reactions": "reactions: of joints, relative to the largest",
    "sections": "sections: relative to the largest",
}
AT_MOST = "≤"
COLUMNS = (
    "method", "chart", "tolerance", "step", "seconds", "repeats", "steps", "evaluations",
    *(f"error_{kind}" for kind in KINDS), "at_most", "status", "at", "code", "reason", "front",
)  # fmt: skip


def make_document(chart: ChartResults) -> OutputDocument:
    """Make the document: the runs, and their errors over their times."""
    return OutputDocument(
        chart.title,
        list_facts(chart),
        iter_parts(chart),
        lambda: to_block(chart),
        lambda: OutputTable("", make_columns(" ".join(COLUMNS)), list(map(make_record, chart.runs))),
    )


def list_facts(chart: ChartResults) -> list[tuple[str, str]]:
    """Return label and text of the lines above the table."""
    reference = chart.reference
    instants = f"{reference.instants} instants" if reference.instants != 1 else "1 instant"
    return [
        ("chart", f"speed versus accuracy, compared at {instants} up to t = {reference.last_time:.6g} s"),
        ("reference", reference.description),
        *(("", note) for note in (*reference.notes, *chart.notes)),
    ]


def iter_parts(chart: ChartResults) -> Iterator[Part]:
    """Yield the table and the panel."""
    from heuncli.output.figures.work_precision import make_work_precision_figure  # where it is drawn

    yield make_table(chart)
    yield from make_panels(make_work_precision_figure(chart))


def make_table(chart: ChartResults) -> OutputTable:
    """Make the table of the runs, one row each, under the name of their method."""
    kinds = chart.kinds
    columns = [
        OutputColumn("", "text"),
        OutputColumn("tolerance or step", "text"),
        OutputColumn("time [ms]"),
        OutputColumn("steps"),
    ]
    columns += [OutputColumn("evaluations"), *(OutputColumn(kind, "text") for kind in kinds)]
    remarks = any(run.status != COMPLETED for run in chart.runs)
    columns += [OutputColumn("", "text")] * remarks
    rows: list[tuple[Cell, ...] | str] = []
    for name, runs in chart.runs_by_method.items():
        rows.append(format_title(name))
        rows += [
            (*make_cells(run, kinds, same[-1]), *([make_short_remark(run)] * remarks))
            for same in group_runs(runs)
            for run in same[:1]
        ]
    notes = ["; ".join(ERROR_WORDS[kind] for kind in kinds)]
    if any(run.upper_bounds for run in chart.runs):
        notes.append(f"{AT_MOST}: the run differs from the reference by no more than the error of the reference")
    notes += list_reasons(chart)
    return OutputTable(HEADING, tuple(columns), tuple(rows), tuple(notes))


def group_runs(runs: Sequence[ChartRun]) -> Iterator[list[ChartRun]]:
    """Group the runs of a method: neighbours with the same remark (failed, not run) share a row, the others have their
    own.
    """
    for remarks, group in groupby(runs, key=make_short_remark):
        if remarks:
            yield list(group)
        else:
            yield from ([run] for run in group)


def format_title(name: str) -> str:
    """Format a method's name with its description."""
    row = find_method(name)
    return name if row is None else f"{row.name}  order {row.order}, {row.kind}, {row.steps}: {row.purpose}"


def make_cells(run: ChartRun, kinds: Sequence[str], last: ChartRun) -> Iterator[Cell]:
    """Yield the cells of a run, without the remark.

    last: the last of the runs that share the row
    """
    is_complete = run.status == COMPLETED
    yield "*" if run.front else ""
    yield format_setting(run.row) if last is run else f"{format_setting(run.row)} to {format_setting(last.row)}"
    yield NumberCell(run.seconds, write=format_milliseconds) if is_complete and run.seconds is not None else None
    yield run.steps if is_complete else None
    yield run.evaluations if is_complete else None
    for kind in kinds:
        yield format_error(run, kind)


def format_milliseconds(seconds: float) -> str:
    """Format seconds as milliseconds, with three digits and without a power of ten."""
    value = float(f"{1e3 * seconds:.3g}")
    return f"{value:.0f}" if value >= 100.0 else f"{value:.3g}"


def format_error(run: ChartRun, kind: str) -> str:
    """Format an error to two digits, or its bound."""
    value = run.error[kind]
    if value is None:
        return ""
    return f"{AT_MOST if kind in run.upper_bounds else ' '}{value:.1e}"


def make_short_remark(run: ChartRun) -> str:
    """Return in a few words why a run did not end; the reason of a failure stands below the table."""
    if run.status == FAILED:
        instant_text = f" at t = {run.failure_time:.6g} s" if run.failure_time is not None else ""
        return f"fails{instant_text} [{run.code}]"
    return make_remark(run)


def list_reasons(chart: ChartResults) -> list[str]:
    """List why runs failed, once for each method and code."""
    reasons_by_run: dict[tuple[str, str], str] = {}
    for run in chart.runs:
        if run.status == FAILED:
            reasons_by_run.setdefault((run.row.method, run.code), remove_instant(run))
    return [f"[{code}] {method}: {reason}" for (method, code), reason in reasons_by_run.items()]


def to_block(chart: ChartResults) -> dict[str, Any]:
    """Return the chart as the JSON has it."""
    reference = chart.reference
    return {
        "heun": FORMAT_NUMBER,
        "title": chart.title,
        "spec": dict(chart.spec),
        "version": VERSION,
        "reference": reference.description,
        "reference_error": dict(reference.error),
        "judged": {"until": reference.last_time, "instants": reference.instants},
        "horizon": reference.horizon,
        "notes": [*reference.notes, *chart.notes],
        "runs": [make_run_block(run) for run in chart.runs],
    }


def make_run_block(run: ChartRun) -> dict[str, Any]:
    """Return a run as the JSON has it; `at_most` lists the kinds whose error is an upper bound."""
    row, is_complete = run.row, run.status == COMPLETED
    return {
        "method": row.method,
        "chart": row.attitude,
        "step" if row.has_fixed_step else "tolerance": row.local if row.local else None,
        "seconds": run.seconds if is_complete else None,
        "repeats": run.repeats,
        "steps": run.steps,
        "evaluations": run.evaluations,
        "error": dict(run.error),
        "at_most": sorted(run.upper_bounds),
        "status": run.status,
        "at": run.failure_time,
        "code": run.code or None,
        "reason": run.reason or None,
        "front": run.front,
    }


def make_record(run: ChartRun) -> list[Cell]:
    """Make the row of a run in the CSV; unknown values are empty."""
    block = make_run_block(run)
    block |= {f"error_{kind}": value for kind, value in run.error.items()}
    block |= {"at_most": " ".join(block["at_most"]), "front": "true" if run.front else "false"}
    return [block.get(name) for name in COLUMNS]
