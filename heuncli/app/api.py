"""The one way from a spec to a solved scene, for programs, notebooks and `heun run`.

    import heuncli
    study = heuncli.solve("engine.yaml", n="1500 rpm")

`read` and `solve_spec` are what the command line uses; `solve`, `solve_cases` and `validate` put the arguments of
Python in front of them, and hand over what in_python/ makes of the study; of that the command line loads nothing.
Nothing is printed. A scene may be solved in any thread.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from heuncli.base.errors import Problem, SpecError, UsageError
from heuncli.base.memory_left import room
from heuncli.base.nearest import nearest
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.joint_axes import JOINT_AXES
from heuncli.output.snapshots.selection import Only, only, selected
from heuncli.results.results_schema import REPORTS
from heuncli.scene.file_format.load import Given, load, load_with_cases
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import ALL_CASES
from heuncli.scene.file_format.source import SourceFile
from heuncli.study.ask.asked_values import choice, positive, tolerance
from heuncli.study.ask.study import Study
from heuncli.study.model.memory_estimate import Room
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve as solve_study

if TYPE_CHECKING:
    from heuncli.app.python.arguments import ArgumentKind
    from heuncli.app.python.given import SpecGiven
    from heuncli.app.python.solved import Solved


def read(
    path: str, given: Given, case: str | None = None, text: str | SourceFile | None = None
) -> tuple[Spec, dict[str, Spec]]:
    """The scene, and its load cases if all are asked for: case is a name, `all`, or None for the scene as it is.

    given: what is set in it; text: what stands for the file. Expectations need not fit the instants that are asked for.
    Raises SpecError.
    """
    if case == ALL_CASES:
        return load_with_cases(path, given, checking=False, text=text)
    return load(path, text, given, checking=False, case=case), {}


def solve_spec(spec: Spec, options: Options) -> Study:
    """A scene that was read, solved. Raises SpecError, LimitError, SolveError with places in the spec."""
    return solve_study(spec, options)


def solve(
    spec: SpecGiven | None = None,
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
    **parameters: object,
) -> Solved:
    """The scene solved as its analysis asks; what `heun run` does.

    spec: the path of a file, or a mapping with what a file holds. text: YAML in place of a file, whose name `spec` then
    is in messages; tables are looked for beside it.
    parameters, and set for those whose names are taken here and for dotted keys (`{"bodies.rod.mass": 2}`): values in
    SI, or texts with units ("1500 rpm"). case: a load case, on top of which these go.
    only: reports or entries that are solved for, as `--only` takes them ("joints", "sections.web"); by default those of
    the spec's `report`, else all. at: instants [s] of the run at which results are told, in place of those of the spec.
    tolerance, method, step: as in `analysis`. least_norm: a split of what is open. reduce: whether less than the whole
    scene may be solved. by_cause: loads by their causes. axes: of joint loads, "world", "from" or "to". time_limit [s]:
    how long solving may take; no signal is used, so that it holds in every thread, and the integration looks at it.

    Raises SpecError for a spec that is none, UsageError for arguments, SolveError for what cannot be solved, LimitError
    where a limit is reached: all are HeunError, whose `problems` have code, message, hint and place. Warns HeunWarning.
    """
    from heuncli.app.python.arguments import TEXT, check_arguments
    from heuncli.app.python.given import settings_of, source_of

    check_arguments(("case", case, TEXT), *_common(text, set, only, at, tolerance, method, step, time_limit, axes))
    _check_truths(least_norm=least_norm, reduce=reduce, by_cause=by_cause)
    name, source = source_of(spec, text)
    _require_no_all(case)
    options = _options(tolerance, method, step, least_norm, reduce, axes)
    wanted = _only(only)
    begun = time.perf_counter()
    with _meant(parameters):
        scene, _ = read(name, settings_of(set or {}, parameters), case, source)
    options = replace(options, load_seconds=time.perf_counter() - begun, time_limit=_limit(time_limit))
    return _answered(scene, options, wanted, by_cause, at)


def solve_cases(
    spec: SpecGiven | None = None,
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
    **parameters: object,
) -> dict[str, Solved]:
    """Each load case of the scene, solved, by its name; arguments and what is raised as of `solve`.

    time_limit [s]: of each case. Raises UsageError where the spec has no load cases.
    """
    from heuncli.app.python.arguments import check_arguments
    from heuncli.app.python.given import settings_of, source_of

    check_arguments(*_common(text, set, only, at, tolerance, method, step, time_limit, axes))
    _check_truths(least_norm=least_norm, reduce=reduce, by_cause=by_cause)
    name, source = source_of(spec, text)
    options = _options(tolerance, method, step, least_norm, reduce, axes)
    options = replace(options, time_limit=_limit(time_limit))
    wanted = _only(only)
    with _meant(parameters):
        _, cases = read(name, settings_of(set or {}, parameters), ALL_CASES, source)
    if not cases:
        hint = "cases: {NAME: {set: {PARAMETER: VALUE}}}"
        raise UsageError(Problem("unknown-case", "solve_cases: the spec has no load cases", hint=hint))
    return {case: _answered(scene, options, wanted, by_cause, at) for case, scene in cases.items()}


def validate(spec: SpecGiven | None = None, *, text: str | None = None) -> tuple[Problem, ...]:
    """The warnings of a spec and of its load cases, each with code, message, hint and place; nothing is solved.

    spec, text: as of `solve`. Raises SpecError with every problem of the spec, in the order of the lines.
    """
    from heuncli.app.python.arguments import TEXT, check_arguments
    from heuncli.app.python.given import source_of

    check_arguments(("text", text, TEXT))
    name, source = source_of(spec, text)
    scene, cases = load_with_cases(name, (), text=source)
    return tuple(dict.fromkeys(problem for one in (scene, *cases.values()) for problem in one.warnings))


def _answered(
    scene: Spec, options: Options, wanted: Only | None, by_cause: bool, at: float | Sequence[float] | None
) -> Solved:
    """A scene solved by options of Python, and its warnings told."""
    from heuncli.app.python.solved import told

    default = frozenset(REPORTS) if scene.report is None else frozenset(scene.report)
    what = selected(wanted, scene, default, by_cause=by_cause)
    options = replace(options, room=Room(*room("table")))
    study = solve_spec(scene, replace(options, wanted=what.reports, entries=what.entries))
    return told(study, at)


def _common(
    text: object, settings: object, only: object, at: object, tolerance: object, method: object, step: object,
    time_limit: object, axes: object,
) -> list[tuple[str, object, ArgumentKind]]:  # fmt: skip
    """The arguments of both ways to solve, with their names and kinds."""
    from heuncli.app.python.arguments import MAPPING, NUMBER, NUMBERS, TEXT, TEXTS

    return [
        ("text", text, TEXT), ("set", settings, MAPPING), ("only", only, TEXTS), ("at", at, NUMBERS),
        ("tolerance", tolerance, NUMBER), ("method", method, TEXT), ("step", step, NUMBER),
        ("time_limit", time_limit, NUMBER), ("axes", axes, TEXT),
    ]  # fmt: skip


def _check_truths(**given: object) -> None:
    from heuncli.app.python.arguments import TRUTH, check_arguments

    check_arguments(*((name, value, TRUTH) for name, value in given.items()), optional=False)


def _options(
    of: float | None, method: str | None, step: float | None, least_norm: bool, reduce: bool, axes: str
) -> Options:
    return Options(
        tolerance=tolerance(of, ""), method=method, step=positive("step", step), least_norm=least_norm, reduce=reduce,
        axes=choice("axes", axes, JOINT_AXES),
    )  # fmt: skip


def _only(words: str | Iterable[str] | None) -> Only | None:
    if words is None:
        return None
    return only(words.split(",") if isinstance(words, str) else words, "only", "study.measure")


@contextmanager
def _meant(parameters: Mapping[str, object]) -> Iterator[None]:
    """Say of an argument that is no parameter of the scene which option may be meant."""
    try:
        yield
    except SpecError as error:
        options = {name: nearest(name, solve.__kwdefaults__ or {}) for name in parameters}
        likely = {name: f"did you mean the option {option}?" for name, option in options.items() if option}
        for problem in error.problems:
            name = str(problem.location.file).partition("=")[0] if problem.location is not None else ""
            if problem.code == "no-such-key" and name in likely:
                error.tell(*(each._replace(hint=likely[name]) if each is problem else each for each in error.problems))
        raise


def _limit(seconds: float | None) -> float | None:
    if seconds is not None and not 0.0 < seconds < math.inf:
        hint = "such as 60, in s; without it there is none"
        raise UsageError(Problem("bad-option", f"time_limit {seconds:g}: expected a positive number", hint=hint))
    return seconds


def _require_no_all(case: str | None) -> None:
    if case == ALL_CASES:
        hint = "heuncli.solve_cases gives each of them"
        raise UsageError(Problem("bad-option", "case all: one scene is solved", hint=hint))
