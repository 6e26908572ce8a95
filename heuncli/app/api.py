"""Solve a spec: the single route for programs, notebooks and `heun run`.

    import heuncli
    study = heuncli.solve("engine.yaml", n="1500 rpm")

The command line uses `read` and `solve_spec`. `solve`, `solve_cases`, `validate` and `report` add Python arguments; the
command line loads none of these, nor the objects of app/python that they return. Nothing is printed. A scene may be
solved in any thread.
"""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from heuncli.base.errors import Problem, SpecError, UsageError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.process import result_memory
from heuncli.base.records import replace
from heuncli.base.spelling import find_similar
from heuncli.loads.kinetostatics.reactions import JOINT_AXES
from heuncli.output.tables.report_selection import ReportChoice, parse_choice, select_reports
from heuncli.results.results_schema import REPORTS
from heuncli.scene.file_format.load import Overrides, load, load_with_cases
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import ALL_CASES
from heuncli.scene.file_format.source import SourceFile
from heuncli.study.model.memory import MemoryBudget
from heuncli.study.model.options import Options, require_choice, require_positive, require_tolerance
from heuncli.study.quantities.captions import set_captions
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve as solve_study

if TYPE_CHECKING:
    from heuncli.app.python.arguments import ArgumentKind, SpecSource
    from heuncli.app.python.solved_scene import Solved


class SolverArguments(NamedTuple):
    """The arguments of the solver in a Python call, as they are given: not checked yet."""

    tolerance: float | None
    method: str | None
    step: float | None
    least_norm: bool
    reduce: bool
    time_limit: float | None
    axes: str = "world"


def read(
    path: str, settings: Overrides, case: str | None = None, text: str | SourceFile | None = None
) -> tuple[Spec, dict[str, Spec]]:
    """Read the scene, and its load cases if `case` is `all`.

    settings: values set in the spec
    case: the name of a load case, `all`, or None for the scene as it is
    text: the content to read in place of the file

    Expectations need not fit the requested instants. Raises SpecError.
    """
    if case == ALL_CASES:
        return load_with_cases(path, settings, checking=False, text=text)
    return load(path, text, settings, checking=False, case=case), {}


def solve_spec(spec: Spec, options: Options) -> Study:
    """Solve a scene that was read. Raises SpecError, LimitError, SolveError with locations in the spec."""
    return solve_study(spec, options)


def solve(
    spec: SpecSource | None = None,
    *,
    text: str | None = None,
    case: str | None = None,
    set: Mapping[str, object] | None = None,
    only: str | Sequence[str] | None = None,
    at: float | Sequence[float] | None = None,
    tolerance: float | None = None,
    method: str | None = None,
    step: float | None = None,
    least_norm: bool = False,
    reduce: bool = True,
    by_cause: bool = False,
    axes: str = "world",
    time_limit: float | None = None,
    title: str | None = None,
    labels: Mapping[str, str] | None = None,
    **parameters: object,
) -> Solved:
    """Solve a scene as its analysis says; the same as `heun run`.

    spec: the path of a file, or a mapping with the content of a spec
    text: YAML in place of a file; messages then name it by `spec`, and tables are looked for in that folder
    parameters: values of parameters, in SI or as texts with units ("1500 rpm")
    set: the same for parameters whose names are arguments here, and for dotted keys (`{"bodies.rod.mass": 2}`)
    case: a load case; parameters and `set` apply on top of it
    only: reports or entries, as `--only` takes them ("joints", "sections.web"); default: the spec's, else everything
    at: instants [s] of the run at which results are given, in place of the spec's
    tolerance, method, step: as in `analysis`
    least_norm: distribute indeterminate reactions by the minimum-norm solution; by_cause: also loads by their causes
    reduce: whether heun may solve a reduced scene
    axes: axes of joint loads, "world", "from" or "to"
    time_limit: longest solving time [s]; the integration checks the clock, in any thread
    title, labels: words in place of those of the spec (`{"joints.main": "Main bearing"}`)

    Raises SpecError for an invalid spec, UsageError for invalid arguments, SolveError if the scene cannot be solved,
    LimitError if a limit is reached. All are HeunError, whose `problems` have code, message, hint and location. Warns
    HeunWarning.
    """
    from heuncli.app.python.arguments import TEXT, check_arguments, make_settings, resolve_source

    solver = SolverArguments(tolerance, method, step, least_norm, reduce, time_limit, axes)
    check_arguments(("case", case, TEXT), *_list_arguments(text, set, only, at, solver), *_list_captions(title, labels))
    _check_booleans(least_norm=least_norm, reduce=reduce, by_cause=by_cause)
    name, source = resolve_source(spec, text)
    _require_single_case(case)
    options = _make_options(solver)
    selection = _parse_only(only)
    start = time.perf_counter()
    with _suggest_options(parameters, solve):
        scene, _ = read(name, make_settings(set or {}, parameters), case, source)
    scene = set_captions(scene, title, (labels or {}).items())
    options = replace(options, load_seconds=time.perf_counter() - start, time_limit=_check_time_limit(time_limit))
    return _solve_selected(scene, options, selection, by_cause, at)


def solve_cases(
    spec: SpecSource | None = None,
    *,
    text: str | None = None,
    set: Mapping[str, object] | None = None,
    only: str | Sequence[str] | None = None,
    at: float | Sequence[float] | None = None,
    tolerance: float | None = None,
    method: str | None = None,
    step: float | None = None,
    least_norm: bool = False,
    reduce: bool = True,
    by_cause: bool = False,
    axes: str = "world",
    time_limit: float | None = None,
    title: str | None = None,
    labels: Mapping[str, str] | None = None,
    **parameters: object,
) -> dict[str, Solved]:
    """Solve each load case of a scene; returns them by name. Arguments and errors are those of `solve`.

    time_limit: longest solving time of each case [s]

    Raises UsageError if the spec has no load cases.
    """
    from heuncli.app.python.arguments import check_arguments, make_settings, resolve_source

    solver = SolverArguments(tolerance, method, step, least_norm, reduce, time_limit, axes)
    check_arguments(*_list_arguments(text, set, only, at, solver), *_list_captions(title, labels))
    _check_booleans(least_norm=least_norm, reduce=reduce, by_cause=by_cause)
    name, source = resolve_source(spec, text)
    options = _make_options(solver)
    options = replace(options, time_limit=_check_time_limit(time_limit))
    selection = _parse_only(only)
    with _suggest_options(parameters, solve_cases):
        _, cases = read(name, make_settings(set or {}, parameters), ALL_CASES, source)
    if not cases:
        hint = "cases: {NAME: {set: {PARAMETER: VALUE}}}"
        raise UsageError(Problem("unknown-case", "solve_cases: the spec has no load cases", hint=hint))
    cases = {case: set_captions(scene, title, (labels or {}).items()) for case, scene in cases.items()}
    return {case: _solve_selected(scene, options, selection, by_cause, at) for case, scene in cases.items()}


def report(
    spec: SpecSource | None, output: str | os.PathLike[str], *, text: str | None = None, format: str | None = None,
    case: str | Sequence[str] | None = None, set: Mapping[str, object] | None = None, units: str | None = None,
    chapters: str | Sequence[str] | None = None, paper: str = "a4", landscape: bool = False,
    decimal_comma: bool = False, company: str | None = None, project: str | None = None, part: str | None = None,
    revision: str | None = None, author: str | None = None, date: str | None = None,
    logo: str | os.PathLike[str] | None = None, tolerance: float | None = None, method: str | None = None,
    step: float | None = None, least_norm: bool = False, reduce: bool = True, time_limit: float | None = None,
    title: str | None = None, labels: Mapping[str, str] | None = None, **parameters: object,
) -> bool:  # fmt: skip
    """Write the client report that `heun report` writes; returns whether all that the spec expects is met.

    spec, text, set, parameters: as in `solve`; a mapping is refused, because a report prints the text of its spec
    output: the file, whose ending is .html, .pdf or .md; with `format` ("html", "pdf", "md") any name
    case: load cases, "full,empty" or a list; default: all
    units, chapters, paper, landscape, decimal_comma, logo: as the options of `heun report`
    company, project, part, revision, author, date: the title block
    tolerance, method, step, least_norm, reduce, title, labels: as in `solve`
    time_limit: longest solving time of each case [s]

    Raises what `solve` does, and OutputError if the file cannot be written or no program prints PDF. Warns HeunWarning.
    """
    from heuncli.app.python.arguments import FILE, TEXT, TEXTS, check_arguments, make_settings
    from heuncli.app.python.report_call import ReportCall, write_called_report

    imprint = {
        "company": company, "project": project, "part": part, "revision": revision, "author": author, "date": date,
    }  # fmt: skip
    solver = SolverArguments(tolerance, method, step, least_norm, reduce, time_limit)
    check_arguments(("output", output, FILE), ("paper", paper, TEXT), optional=False)
    check_arguments(
        *_list_arguments(text, set, None, None, solver),
        *_list_captions(title, labels), ("format", format, TEXT), ("case", case, TEXTS), ("units", units, TEXT),
        ("chapters", chapters, TEXTS), ("logo", logo, FILE), *((key, word, TEXT) for key, word in imprint.items()),
    )  # fmt: skip
    _check_booleans(landscape=landscape, decimal_comma=decimal_comma, least_norm=least_norm, reduce=reduce)
    options = _make_options(solver)
    call = ReportCall(
        spec=spec, text=text, output=os.fspath(output), format=format, case=case, units=units, chapters=chapters,
        settings=make_settings(set or {}, parameters), paper=paper, landscape=landscape, decimal_comma=decimal_comma,
        imprint=imprint, logo=logo, options=options, time_limit=_check_time_limit(time_limit), title=title,
        labels=labels or {},
    )  # fmt: skip
    with _suggest_options(parameters, report):
        return write_called_report(call)


def validate(spec: SpecSource | None = None, *, text: str | None = None) -> tuple[Problem, ...]:
    """Return the warnings of a spec and of its load cases, each with code, message, hint and location; nothing is
    solved.

    spec, text: as in `solve`

    Raises SpecError with every problem of the spec, in the order of the lines.
    """
    from heuncli.app.python.arguments import TEXT, check_arguments, resolve_source

    check_arguments(("text", text, TEXT))
    name, source = resolve_source(spec, text)
    scene, cases = load_with_cases(name, (), text=source)
    return tuple(dict.fromkeys(problem for one in (scene, *cases.values()) for problem in one.warnings))


def _solve_selected(
    scene: Spec,
    options: Options,
    selection: ReportChoice | None,
    by_cause: bool,
    instants: float | Sequence[float] | None,
) -> Solved:
    """Solve a scene with the options of a Python call, and emit its warnings."""
    from heuncli.app.python.solved_scene import make_solved

    default = frozenset(REPORTS) if scene.report.results is None else frozenset(scene.report.results)
    what = select_reports(selection, scene, default, by_cause=by_cause)
    options = replace(options, memory_budget=MemoryBudget(*result_memory("table")))
    study = solve_spec(scene, replace(options, requested_reports=what.reports, entries=what.entries))
    return make_solved(study, instants)


def _list_arguments(
    text: object, settings: object, only: object, instants: object, solver: SolverArguments
) -> list[tuple[str, object, ArgumentKind]]:
    """Return the arguments that several functions share, but for the booleans, as (name, value, kind)."""
    from heuncli.app.python.arguments import MAPPING, NUMBER, NUMBERS, TEXT, TEXTS

    return [
        ("text", text, TEXT), ("set", settings, MAPPING), ("only", only, TEXTS), ("at", instants, NUMBERS),
        ("tolerance", solver.tolerance, NUMBER), ("method", solver.method, TEXT), ("step", solver.step, NUMBER),
        ("time_limit", solver.time_limit, NUMBER), ("axes", solver.axes, TEXT),
    ]  # fmt: skip


def _list_captions(title: object, labels: object) -> list[tuple[str, object, ArgumentKind]]:
    """Return the captions as (name, value, kind)."""
    from heuncli.app.python.arguments import CAPTIONS, TEXT

    return [("title", title, TEXT), ("labels", labels, CAPTIONS)]


def _check_booleans(**arguments: object) -> None:
    """Raise UsageError for arguments that are not True or False."""
    from heuncli.app.python.arguments import BOOLEAN, check_arguments

    check_arguments(*((name, value, BOOLEAN) for name, value in arguments.items()), optional=False)


def _make_options(solver: SolverArguments) -> Options:
    """Check the values of the solver's arguments, but for the time limit, and make its options. Raises UsageError."""
    return Options(
        tolerance=require_tolerance(solver.tolerance, ""),
        method=solver.method,
        step=require_positive("step", solver.step),
        least_norm=solver.least_norm,
        reduce=solver.reduce,
        axes=require_choice("axes", solver.axes, JOINT_AXES),
    )


def _parse_only(words: str | Iterable[str] | None) -> ReportChoice | None:
    """Parse which results are requested; None for the spec's choice. Raises UsageError."""
    if words is None:
        return None
    return parse_choice(words.split(",") if isinstance(words, str) else words, "only", "study.measure")


@contextmanager
def _suggest_options(parameters: Mapping[str, object], function: Callable[..., object]) -> Iterator[None]:
    """Add a hint to the error of an unknown parameter whose name resembles an option of the function."""
    try:
        yield
    except SpecError as error:
        known: Mapping[str, object] = getattr(function, "__kwdefaults__", None) or {}
        options = {name: find_similar(name, known) for name in parameters}
        likely = {name: f"did you mean the option {option}?" for name, option in options.items() if option}
        for problem in error.problems:
            name = str(problem.location.file).partition("=")[0] if problem.location is not None else ""
            if problem.code == "no-such-key" and name in likely:
                error.replace_problems(
                    *(each._replace(hint=likely[name]) if each is problem else each for each in error.problems)
                )
        raise


def _check_time_limit(seconds: float | None) -> float | None:
    """Return the time limit. Raises UsageError if it is not a positive number."""
    if seconds is not None and not 0.0 < seconds < math.inf:
        hint = "for example 60, in s; leave it out for no limit"
        raise UsageError(Problem("bad-option", f"time_limit {seconds:g}: expected a positive number", hint=hint))
    return seconds


def _require_single_case(case: str | None) -> None:
    """Raise UsageError if all load cases are requested."""
    if case == ALL_CASES:
        hint = "use heuncli.solve_cases for all load cases"
        raise UsageError(Problem("bad-option", "case all: solve() solves one load case", hint=hint))
