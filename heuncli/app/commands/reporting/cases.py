"""The load cases of a report: read, solved one after the other, held against what the spec expects."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from heuncli.app.cli import alarm, memory
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.solving import overrides, solver_options, warn
from heuncli.app.cli.units import units
from heuncli.app.commands.reporting.request import ReportRequest
from heuncli.base.errors import HeunError, Problem
from heuncli.base.nearest import did_you_mean
from heuncli.base.records import replace
from heuncli.output.client_report.reported import AS_IT_STANDS, LOADS, Imprint, Reported, ReportedRun
from heuncli.output.snapshots.keep import keep, looks_between
from heuncli.output.snapshots.outcomes import Outcome, outcome_of
from heuncli.output.tables.cut_runs import LOADS as RESULTANTS
from heuncli.output.tables.page import page_of
from heuncli.scene.file_format.digest import digest
from heuncli.scene.file_format.load import load_with_cases
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.named_files import NamedFiles
from heuncli.scene.file_format.source import text_in
from heuncli.study.ask.expectations import compare
from heuncli.study.ask.study import Study
from heuncli.study.model.error_places import placed
from heuncli.study.model.memory_estimate import Room
from heuncli.study.model.options import Options
from heuncli.study.model.selection import Selection, asked_by
from heuncli.study.quantities.labels import labels_of
from heuncli.study.quantities.table_units import Units
from heuncli.study.workflow import solve

DRAWN = frozenset({"motion", "joints", "impulses"})  # in the drawing of the machine
BLOWS_ALONE = frozenset({"impulses"})
EMPTY: frozenset[str] = frozenset()
OPTIONS, SWITCHES = ("method", "step", "tolerance"), ("no_reduce", "least_norm")


class DigestedFiles(NamedFiles):
    """The files beside a spec; of each that is read its digest is kept, by its name."""

    def __init__(self, spec: str) -> None:
        super().__init__(spec)
        self.digests: dict[str, str] = {}

    def content(self, name: str) -> bytes | bytearray:
        """The bytes of a file. Raises Finding."""
        content = super().content(name)
        self.digests[name] = digest(content)
        return content


def reported(request: ReportRequest) -> Reported:
    """All cases that are asked for, solved. Raises what solving raises: with a case unsolved there is no report."""
    shown, options = units(request.units), solver_options(request)
    given = overrides(request.set)
    text = text_in(request.spec)
    files = DigestedFiles(request.spec)
    spec, cases = load_with_cases(request.spec, given, not given, text, files)
    chosen = _chosen(request, cases)
    told = chosen or {"": spec}
    outcomes: list[Outcome] = []
    runs: list[ReportedRun] = []
    if "" not in told and request.case is None and spec.expect:  # what is expected of the scene as it stands
        outcomes += _outcomes(_solved("", spec, options, told=False), request, "")
    for name, one in told.items():
        study = _solved(name, one, options, told=True)
        outcomes += _outcomes(study, request, name)
        runs.append(_run(name, spec.cases.get(name, ""), study, shown))
        warn(one, study.results, request.quiet, f"heun: case {name}" if name else "heun", study.later_warnings)
    imprint = Imprint(request.date or "", request.author or "", request.project or "")
    left_out = [name for name in cases if name not in told]
    unchecked = [AS_IT_STANDS] if request.case is not None and spec.expect else []
    unchecked += [name for name in left_out if cases[name].expect]
    return Reported(
        spec, text, files.digests, runs, outcomes, list(_given(request)), left_out, unchecked,
        not request.no_reduce, shown, imprint,
    )  # fmt: skip


def _chosen(request: ReportRequest, cases: Mapping[str, Spec]) -> dict[str, Spec]:
    """The cases of `--case`, all without it. Raises UsageError."""
    if request.case is None:
        return dict(cases)
    names = [name.strip() for name in request.case.split(",")]
    for name in names:
        if name not in cases:
            hint = did_you_mean(name, cases, "cases") if cases else "cases: {NAME: {set: {PARAMETER: VALUE}}}"
            raise UsageError(Problem("unknown-case", f"--case {name}: there is no such load case", hint=hint))
    return {name: cases[name] for name in names}


def _solved(name: str, spec: Spec, options: Options, *, told: bool) -> Study:
    """A case with all that is told of it, and all that is expected. Raises what `solve` does, with the case's name."""
    asked = asked_by([path for item in spec.expect for path in item.paths], spec) if spec.expect else Selection(EMPTY)
    if told:
        asked = asked.with_all(Selection(wanted_of(spec) | DRAWN))
    own = replace(options, wanted=asked.reports, entries=asked.entries, time_limit=alarm.remaining(),
                  room=Room(*memory.room("table")))  # fmt: skip
    try:
        with placed(spec):
            return solve(spec, own)
    except HeunError as error:
        if name:
            error.tell(*(each._replace(message=f"in case {name}: {each.message}") for each in error.problems))
        raise


def wanted_of(spec: Spec) -> frozenset[str]:
    """The reports that are told of a scene: of blows at time 0 alone the blows."""
    return BLOWS_ALONE if spec.analysis.type == "impulse" else LOADS


def _outcomes(study: Study, request: ReportRequest, name: str) -> list[Outcome]:
    return [outcome_of(compare(study, item), request.spec, name) for item in study.spec.expect]


def _run(name: str, title: str, study: Study, shown: Units) -> ReportedRun:
    """A case with its numbers, as they are told."""
    labels = replace(labels_of(study.spec), units=shown)
    page = page_of(study.results, labels, study.magnitudes)
    if study.results.impulses:
        page = page._replace(struck=study.struck_along([load.name for load in RESULTANTS]))
    wanted = wanted_of(study.spec)
    kept, searched = keep(study, wanted, whole_course=False), looks_between(study, wanted)
    return ReportedRun(name, title, study, kept, page, searched)


def _given(request: ReportRequest) -> Iterator[str]:
    """What of the command line changes the numbers, as it was given."""
    yield from (f"--set {word}" for word in request.set)
    for name in OPTIONS:
        if (value := getattr(request, name)) is not None:
            yield f"--{name} {value}"
    yield from (f"--{name.replace('_', '-')}" for name in SWITCHES if getattr(request, name))
