"""Write client reports: the single route for `heun report` and for `heuncli.report`.

The load cases are solved one after the other and compared with what the spec expects; the report of them is a page,
PDF or Markdown. PDF is printed by the first program found: Chromium or Chrome, WeasyPrint, wkhtmltopdf. Impure: reads
files, runs programs.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from heuncli.app.cli.options import REPORT_FORMATS
from heuncli.app.cli.target import find_ending
from heuncli.base.errors import Finding, HeunError, OutputError, Problem, UsageError
from heuncli.base.files import STDOUT
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.process import result_memory
from heuncli.base.programs import BROWSERS, find_program, list_browser_options, run_program
from heuncli.base.records import replace
from heuncli.base.spelling import suggest
from heuncli.output.client_report.report_data import (
    AS_IT_STANDS,
    CHAPTER_NAMES,
    LOADS,
    Imprint,
    ReportData,
    ReportedRun,
)
from heuncli.output.snapshots.outcomes import Outcome, make_outcome
from heuncli.output.snapshots.take_snapshot import is_searched_between_samples, take_run_snapshot
from heuncli.output.tables.page import make_page
from heuncli.output.tables.summary_document import Summary
from heuncli.scene.file_format.file_contents import read_logo
from heuncli.scene.file_format.models import Logo, ReportSettings, Spec
from heuncli.scene.file_format.named_files import NamedFiles
from heuncli.scene.file_format.reading import STANDARD_INPUT, digest
from heuncli.study.model.memory import MemoryBudget
from heuncli.study.model.options import Options, require_choice
from heuncli.study.model.selection import Selection, select_paths
from heuncli.study.model.setup import attach_locations
from heuncli.study.quantities.labels import make_labels
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.expectations import compare
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve

ENDINGS = {".html": "html", ".htm": "html", ".pdf": "pdf", ".md": "md"}
DRAWING_REPORTS = frozenset({"motion", "joints", "impulses"})  # in the drawing of the machine
IMPULSES_ONLY = frozenset({"impulses"})
NO_REPORTS: frozenset[str] = frozenset()
IMPRINT_KEYS = ("company", "project", "part", "revision", "author")


class DigestedFiles(NamedFiles):
    """The data files of a spec; keeps the digest of each file that is read, by its name."""

    def __init__(self, spec: str) -> None:
        super().__init__(spec)
        self.digests: dict[str, str] = {}

    def read_content(self, name: str) -> bytes | bytearray:
        """Return the bytes of a file. Raises Finding."""
        content = super().read_content(name)
        self.digests[name] = digest(content)
        return content


class ReportedSpec(NamedTuple):
    """A spec that was read: its name, its text, the scene, its load cases, and the digests of its files."""

    name: str
    text: str
    scene: Spec
    cases: Mapping[str, Spec]
    digests: Mapping[str, str]


class ReportOptions(NamedTuple):
    """What a report has, and how its load cases are solved.

    solving: the options of the solver
    given_options: those that change the numbers, as words of the command line
    units: display units of loads
    cases: names of load cases; None: all
    chapters: their names, in their order; none: those of the spec, else the usual ones
    imprint: entries of the title block, by IMPRINT_KEYS and `date`; None or empty: what the spec says
    logo: the file of the logo; None: the spec's
    """

    solving: Options
    given_options: Sequence[str]
    units: Units
    cases: Sequence[str] | None
    chapters: Sequence[str]
    imprint: Mapping[str, str | None]
    logo: str | None


def choose_form(output: str, requested: str | None) -> str:
    """Return the format of the report: the requested one, else that of the file's ending. Raises UsageError."""
    if requested is not None:
        form = require_choice("--format", requested, REPORT_FORMATS)
        if form == "pdf" and output == STDOUT:
            raise UsageError(Problem("bad-option", "-o -: a PDF needs a file", hint="for example -o report.pdf"))
        return form
    ending = find_ending(output)
    if output == STDOUT or ending in ENDINGS:
        return ENDINGS.get(ending, REPORT_FORMATS[0])
    hint = f"accepted: {', '.join(ENDINGS)}; with --format {'|'.join(REPORT_FORMATS)} any name is accepted"
    raise UsageError(Problem("bad-option", f"-o {output}: unknown file extension", hint=hint))


def parse_chapters(words: Sequence[str]) -> tuple[str, ...]:
    """Return the chapters that are named, each once, in their order. Raises UsageError."""
    names = [name.strip() for name in words]
    for name in names:
        if name not in CHAPTER_NAMES:
            hint = suggest(name, CHAPTER_NAMES, "chapters")
            raise UsageError(Problem("bad-option", f"--chapters {name}: there is no such chapter", hint=hint))
    return tuple(dict.fromkeys(names))


def solve_cases(
    source: ReportedSpec,
    options: ReportOptions,
    find_time_limit: Callable[[], float | None],
    report_warnings: Callable[[Study, str], None],
) -> ReportData:
    """Solve the requested cases, and collect the content of the report.

    find_time_limit: returns how long the next case may take [s], or None
    report_warnings: receives each reported study and the name of its case

    Raises what solving raises: if one case cannot be solved there is no report.
    """
    spec, cases = source.scene, source.cases
    imprint = _make_imprint(options, spec.report)
    selected = _select_cases(options.cases, cases) or {"": spec}
    outcomes: list[Outcome] = []
    runs: list[ReportedRun] = []
    if "" not in selected and options.cases is None and spec.expect:  # the expectations of the scene without a case
        study = _solve_case("", spec, options.solving, find_time_limit(), is_reported=False)
        outcomes += _compare_expectations(study, source.name, "")
    for name, scene in selected.items():
        study = _solve_case(name, scene, options.solving, find_time_limit(), is_reported=True)
        outcomes += _compare_expectations(study, source.name, name)
        runs.append(_make_run(name, spec.cases.get(name, ""), study, options.units))
        report_warnings(study, name)
    left_out = [name for name in cases if name not in selected]
    unchecked = [AS_IT_STANDS] if options.cases is not None and spec.expect else []
    unchecked += [name for name in left_out if cases[name].expect]
    return ReportData(
        spec, source.text, source.digests, runs, outcomes, list(options.given_options), left_out, unchecked,
        options.solving.reduce, options.units, imprint, _summarise, options.chapters or spec.report.chapters or (),
    )  # fmt: skip


def render_report(data: ReportData, form: str, paper: str, *, is_landscape: bool, has_decimal_comma: bool) -> str:
    """Render the report as Markdown, or as a page, of which PDF is printed."""
    from heuncli.output.client_report.contents import make_report, make_sheet  # after solving, with the figures
    from heuncli.output.documents.as_html import render_html
    from heuncli.output.documents.document import write_decimal_comma

    report = make_report(data)
    if has_decimal_comma:
        report = write_decimal_comma(report)
    if form == "md":
        from heuncli.output.documents.as_markdown import render_markdown

        return render_markdown(report)
    return render_html(report, make_sheet(data, paper, is_landscape=is_landscape))


def has_met_expectations(data: ReportData) -> bool:
    """Return whether all that the spec expects is met."""
    return all(outcome.has_passed for outcome in data.outcomes)


def _summarise(data: ReportData) -> Summary:
    """Return the summary of all cases."""
    from heuncli.output.client_report.summary_table import summarise_cases  # after solving, with the figures

    return summarise_cases(data)


def _make_imprint(options: ReportOptions, settings: ReportSettings) -> Imprint:
    """Make the entries of the title block: the options, else what the spec says. Raises UsageError."""
    words = {key: options.imprint.get(key) or getattr(settings, key) for key in IMPRINT_KEYS}
    logo = settings.logo
    if options.logo is not None:
        try:
            logo = read_logo(options.logo, NamedFiles(STANDARD_INPUT))
        except Finding as error:
            raise UsageError(Problem("bad-option", f"--logo: {error.message}", hint=error.hint)) from None
    return Imprint(**words, date=options.imprint.get("date") or "", logo="" if logo is None else _embed(logo))


def _embed(logo: Logo) -> str:
    """Return a picture as a data URI."""
    from base64 import b64encode  # where there is a logo

    return f"data:{logo.media_type};base64,{b64encode(logo.content).decode()}"


def _select_cases(names: Sequence[str] | None, cases: Mapping[str, Spec]) -> dict[str, Spec]:
    """Return the cases of these names, or all. Raises UsageError."""
    if names is None:
        return dict(cases)
    for name in names:
        if name not in cases:
            hint = suggest(name, cases, "cases") if cases else "cases: {NAME: {set: {PARAMETER: VALUE}}}"
            raise UsageError(Problem("unknown-case", f"--case {name}: there is no such load case", hint=hint))
    return {name: cases[name] for name in names}


def _solve_case(name: str, spec: Spec, options: Options, time_limit: float | None, *, is_reported: bool) -> Study:
    """Solve a case for what is reported and expected of it. Raises what `solve` does, with the case's name."""
    selection = (
        select_paths([path for item in spec.expect for path in item.paths], spec)
        if spec.expect
        else Selection(NO_REPORTS)
    )
    if is_reported:
        selection = selection.union(Selection(_select_reports(spec) | DRAWING_REPORTS))
    case_options = replace(
        options,
        requested_reports=selection.reports,
        entries=selection.entries,
        time_limit=time_limit,
        memory_budget=MemoryBudget(*result_memory("table")),
    )
    try:
        with attach_locations(spec):
            return solve(spec, case_options)
    except HeunError as error:
        if name:
            error.replace_problems(
                *(each._replace(message=f"in case {name}: {each.message}") for each in error.problems)
            )
        raise


def _select_reports(spec: Spec) -> frozenset[str]:
    """Return the reports to show of a scene; for impulses at time 0 only the impulses."""
    return IMPULSES_ONLY if spec.analysis.type == "impulse" else LOADS


def _compare_expectations(study: Study, spec_name: str, case: str) -> list[Outcome]:
    """Compare a run with what its spec expects."""
    return [make_outcome(compare(study, item), spec_name, case) for item in study.spec.expect]


def _make_run(name: str, title: str, study: Study, units: Units) -> ReportedRun:
    """Make the reported run of a case, with its numbers as they are shown."""
    labels = replace(make_labels(study.spec), units=units)
    page = make_page(study.results, labels, study.magnitudes)
    if study.results.impulses:
        page = page._replace(impact_extremes=study.find_impulse_extremes())
    reports = _select_reports(study.spec)
    snapshot = take_run_snapshot(study, reports, whole_course=False)
    return ReportedRun(name, title, study, snapshot, page, is_searched_between_samples(study, reports))


MAX_PRINT_SECONDS = 90.0  # of a program that prints, unless the time limit leaves less
PRINT_OPTIONS = ("--no-pdf-header-footer", "--print-to-pdf={pdf}", "{page}")  # of a browser
OTHER_PRINTERS = {
    ("weasyprint",): ("{page}", "{pdf}"),
    ("wkhtmltopdf",): ("--quiet", "--disable-javascript", "--enable-local-file-access", "{page}", "{pdf}"),
}
PRINTER_HINT = (
    "install Chromium or Chrome, WeasyPrint (pip install weasyprint) or wkhtmltopdf, and have it on PATH; or write "
    "-o report.html, open it in a browser and print it: it is laid out for paper"
)


class Printer(NamedTuple):
    """A program that prints PDF: its path, and the patterns of its options."""

    path: str
    options: tuple[str, ...]


def find_printer() -> Printer:
    """Find a program that prints PDF. Raises OutputError."""
    for names, options in ((BROWSERS, (*list_browser_options(), *PRINT_OPTIONS)), *OTHER_PRINTERS.items()):
        path = find_program(names)
        if path is not None:
            return Printer(path, options)
    raise OutputError(Problem("no-pdf-printer", "no program that writes PDF was found on PATH", hint=PRINTER_HINT))


def print_pdf(page: str, printer: Printer, seconds: float = MAX_PRINT_SECONDS) -> bytes:
    """Return a page as PDF; seconds: how long the program may take. Raises OutputError."""
    with tempfile.TemporaryDirectory(prefix="heun-", ignore_cleanup_errors=True) as folder:
        source, target = Path(folder, "report.html"), Path(folder, "report.pdf")
        source.write_text(page, encoding="utf-8")
        places = {"folder": folder, "pdf": str(target), "page": source.as_uri()}
        command = [printer.path, *(option.format(**places) for option in printer.options)]
        _, message = run_program(command, folder, seconds)
        content = target.read_bytes() if target.is_file() else b""
    if not content.startswith(b"%PDF"):
        text = f"{printer.path} has written no PDF{f': {message}' if message else ''}"
        raise OutputError(Problem("no-pdf-printer", text, hint=PRINTER_HINT))
    return content
