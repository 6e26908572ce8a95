"""`heun report`: solve every load case of a spec, and write a report for a client, as a page, PDF or Markdown."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.app import reports
from heuncli.app.cli import timeout
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.options import PAPERS
from heuncli.app.cli.output import emit
from heuncli.app.cli.solving import (
    apply_captions,
    apply_captions_to_cases,
    make_solver_options,
    parse_overrides,
    print_warnings,
    require_choice,
)
from heuncli.app.cli.target import parse_units, require_other_file, require_writable
from heuncli.app.commands.report.request import ReportRequest
from heuncli.base import files
from heuncli.base.errors import Problem
from heuncli.base.files import STDOUT
from heuncli.output.client_report.report_data import ReportData
from heuncli.scene.file_format.load import load_with_cases
from heuncli.scene.file_format.source import read_text
from heuncli.study.queries.study import Study

FAILED = 1
SOLVER_OPTIONS, SWITCHES = ("method", "step", "tolerance"), ("no_reduce", "least_norm")


def main(request: ReportRequest) -> int:
    """Run the command; returns the exit code: 1 if an expectation of the spec is not met."""
    output, form = _choose_output(request)
    paper = require_choice("--paper", request.paper or PAPERS[0], PAPERS)
    require_other_file(output, [request.spec])
    printer = reports.find_printer() if form == "pdf" else None
    data = solve_report_cases(request)
    require_other_file(output, [request.spec])
    text = reports.render_report(
        data, form, paper, is_landscape=request.landscape, has_decimal_comma=request.decimal_comma
    )
    if printer is None:
        emit(text, output)
    else:
        content = reports.print_pdf(text, printer, timeout.limit_seconds(reports.MAX_PRINT_SECONDS))
        timeout.disarm()
        files.write([content], output)
    return 0 if reports.has_met_expectations(data) else FAILED


def _choose_output(request: ReportRequest) -> tuple[str, str]:
    """Return the file of the report and its format, before any work. Raises UsageError, OutputError."""
    output = request.output
    if output is None:
        hint = "for example -o report.pdf, -o report.html, or -o - for standard output"
        raise UsageError(Problem("bad-option", "report: no output file is given", hint=hint))
    if output != STDOUT:
        require_writable(output)
    return output, reports.choose_form(output, request.format)


def solve_report_cases(request: ReportRequest) -> ReportData:
    """Read the spec, solve the requested cases, and print their warnings. Raises what solving raises."""
    units_shown, options = parse_units(request.units), make_solver_options(request.solver)
    settings = parse_overrides(request.set)
    report_options = reports.ReportOptions(
        options,
        list(_iter_given_options(request)),
        units_shown,
        None if request.case is None else [name.strip() for name in request.case.split(",")],
        reports.parse_chapters(request.chapters.split(",") if request.chapters is not None else ()),
        {key: getattr(request, key) for key in (*reports.IMPRINT_KEYS, "date")},
        request.logo,
    )
    text = read_text(request.spec)
    spec_files = reports.DigestedFiles(request.spec)
    spec, cases = load_with_cases(request.spec, settings, not settings, text, spec_files)
    spec, cases = apply_captions(spec, request.captions), apply_captions_to_cases(cases, request.captions)

    def report_warnings(study: Study, case: str) -> None:
        """Print the warnings of one case."""
        place = f"heun: case {case}" if case else "heun"
        print_warnings(study.spec, study.results, request.quiet, place, study.later_warnings)

    source = reports.ReportedSpec(request.spec, text, spec, cases, spec_files.digests)
    return reports.solve_cases(source, report_options, timeout.remaining_time, report_warnings)


def _iter_given_options(request: ReportRequest) -> Iterator[str]:
    """Yield the options of the command line that change the numbers, as they were given."""
    yield from (f"--set {word}" for word in request.set)
    for name in SOLVER_OPTIONS:
        if (value := getattr(request.solver, name)) is not None:
            yield f"--{name} {value}"
    yield from (f"--{name.replace('_', '-')}" for name in SWITCHES if getattr(request.solver, name))
