"""Solve the load cases of a report one after the other, and compare them with what the spec expects."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from heuncli.app.cli import timeout
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.solving import (
    apply_captions,
    apply_captions_to_cases,
    make_solver_options,
    parse_overrides,
    print_warnings,
)
from heuncli.app.cli.target import parse_units
from heuncli.app.commands.report.request import ReportRequest
from heuncli.base.errors import Finding, HeunError, Problem
from heuncli.base.process import result_memory
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
from heuncli.output.summary.summary_document import Summary
from heuncli.output.tables.page import make_page
from heuncli.scene.file_format.file_contents import read_logo
from heuncli.scene.file_format.load import load_with_cases
from heuncli.scene.file_format.models import Logo, ReportSettings, Spec
from heuncli.scene.file_format.named_files import NamedFiles
from heuncli.scene.file_format.reading import STANDARD_INPUT, digest
from heuncli.scene.file_format.source import read_text
from heuncli.study.model.options import MemoryBudget, Options
from heuncli.study.model.selection import Selection, select_paths
from heuncli.study.model.setup import attach_locations
from heuncli.study.quantities.labels import make_labels
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.expectations import compare
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve

DRAWING_REPORTS = frozenset({"motion", "joints", "impulses"})  # in the drawing of the machine
IMPULSES_ONLY = frozenset({"impulses"})
NO_REPORTS: frozenset[str] = frozenset()
IMPRINT_KEYS = ("company", "project", "part", "revision", "author")
OPTIONS, SWITCHES = ("method", "step", "tolerance"), ("no_reduce", "least_norm")


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


def solve_report_cases(request: ReportRequest) -> ReportData:
    """Solve the requested cases, and collect the content of the report.

    Raises what solving raises: if one case cannot be solved there is no report.
    """
    units_shown, options = parse_units(request.units), make_solver_options(request)
    settings, chapters = parse_overrides(request.set), parse_chapters(request.chapters)
    text = read_text(request.spec)
    files = DigestedFiles(request.spec)
    spec, cases = load_with_cases(request.spec, settings, not settings, text, files)
    spec, cases = apply_captions(spec, request), apply_captions_to_cases(cases, request)
    imprint = make_imprint(request, spec.report)
    chosen = _select_cases(request, cases)
    selected = chosen or {"": spec}
    outcomes: list[Outcome] = []
    runs: list[ReportedRun] = []
    if "" not in selected and request.case is None and spec.expect:  # the expectations of the scene without a case
        outcomes += _compare_expectations(_solve_case("", spec, options, is_reported=False), request, "")
    for name, scene in selected.items():
        study = _solve_case(name, scene, options, is_reported=True)
        outcomes += _compare_expectations(study, request, name)
        runs.append(_make_run(name, spec.cases.get(name, ""), study, units_shown))
        print_warnings(
            scene, study.results, request.quiet, f"heun: case {name}" if name else "heun", study.later_warnings
        )
    left_out = [name for name in cases if name not in selected]
    unchecked = [AS_IT_STANDS] if request.case is not None and spec.expect else []
    unchecked += [name for name in left_out if cases[name].expect]
    return ReportData(
        spec, text, files.digests, runs, outcomes, list(_iter_numeric_options(request)), left_out, unchecked,
        not request.no_reduce, units_shown, imprint, _summarise, chapters or spec.report.chapters or (),
    )  # fmt: skip


def _summarise(data: ReportData) -> Summary:
    from heuncli.output.client_report.summary_table import summarise_cases  # after solving, with the figures

    return summarise_cases(data)


def parse_chapters(words: str | None) -> tuple[str, ...]:
    """Return the chapters of `--chapters`, in their order; none without it. Raises UsageError."""
    names = [name.strip() for name in words.split(",")] if words is not None else []
    for name in names:
        if name not in CHAPTER_NAMES:
            hint = suggest(name, CHAPTER_NAMES, "chapters")
            raise UsageError(Problem("bad-option", f"--chapters {name}: there is no such chapter", hint=hint))
    return tuple(dict.fromkeys(names))


def make_imprint(request: ReportRequest, settings: ReportSettings) -> Imprint:
    """Make the entries of the title block: the options, else what the spec says. Raises UsageError."""
    words = {key: getattr(request, key) or getattr(settings, key) for key in IMPRINT_KEYS}
    logo = settings.logo
    if request.logo is not None:
        try:
            logo = read_logo(request.logo, NamedFiles(STANDARD_INPUT))
        except Finding as error:
            raise UsageError(Problem("bad-option", f"--logo: {error.message}", hint=error.hint)) from None
    return Imprint(**words, date=request.date or "", logo="" if logo is None else _embed(logo))


def _embed(logo: Logo) -> str:
    """Return a picture as a data URI."""
    from base64 import b64encode  # where there is a logo

    return f"data:{logo.media_type};base64,{b64encode(logo.content).decode()}"


def _select_cases(request: ReportRequest, cases: Mapping[str, Spec]) -> dict[str, Spec]:
    """Return the cases of `--case`, or all without it. Raises UsageError."""
    if request.case is None:
        return dict(cases)
    names = [name.strip() for name in request.case.split(",")]
    for name in names:
        if name not in cases:
            hint = suggest(name, cases, "cases") if cases else "cases: {NAME: {set: {PARAMETER: VALUE}}}"
            raise UsageError(Problem("unknown-case", f"--case {name}: there is no such load case", hint=hint))
    return {name: cases[name] for name in names}


def _solve_case(name: str, spec: Spec, options: Options, *, is_reported: bool) -> Study:
    """Solve a case for what is reported and expected of it. Raises what `solve` does, with the case's name."""
    selection = (
        select_paths([path for item in spec.expect for path in item.paths], spec)
        if spec.expect
        else Selection(NO_REPORTS)
    )
    if is_reported:
        selection = selection.union(Selection(select_reports(spec) | DRAWING_REPORTS))
    case_options = replace(
        options,
        requested_reports=selection.reports,
        entries=selection.entries,
        time_limit=timeout.remaining_time(),
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


def select_reports(spec: Spec) -> frozenset[str]:
    """Return the reports to show of a scene; for impulses at time 0 only the impulses."""
    return IMPULSES_ONLY if spec.analysis.type == "impulse" else LOADS


def _compare_expectations(study: Study, request: ReportRequest, name: str) -> list[Outcome]:
    return [make_outcome(compare(study, item), request.spec, name) for item in study.spec.expect]


def _make_run(name: str, title: str, study: Study, units: Units) -> ReportedRun:
    """Make the reported run of a case, with its numbers as they are shown."""
    labels = replace(make_labels(study.spec), units=units)
    page = make_page(study.results, labels, study.magnitudes)
    if study.results.impulses:
        page = page._replace(impact_extremes=study.find_impulse_extremes())
    reports = select_reports(study.spec)
    snapshot, searched = (
        take_run_snapshot(study, reports, whole_course=False),
        is_searched_between_samples(study, reports),
    )
    return ReportedRun(name, title, study, snapshot, page, searched)


def _iter_numeric_options(request: ReportRequest) -> Iterator[str]:
    """Yield the options of the command line that change the numbers, as they were given."""
    yield from (f"--set {word}" for word in request.set)
    for name in OPTIONS:
        if (value := getattr(request, name)) is not None:
            yield f"--{name} {value}"
    yield from (f"--{name.replace('_', '-')}" for name in SWITCHES if getattr(request, name))
