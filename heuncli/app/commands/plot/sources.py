"""The runs that are drawn: each spec, in each load case that is asked for, solved for what the paths need."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import PurePath

from heuncli.app.cli import alarm
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.solving import choice, overrides, require_cases, solver_options, warn
from heuncli.app.commands.plot.asked import PlotAsked
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.base.errors import Problem
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.joint_axes import JOINT_AXES
from heuncli.output.figures.courses import Pictured
from heuncli.output.snapshots import measure
from heuncli.results.results import Array
from heuncli.results.run_places import words_of
from heuncli.scene.file_format.load import load, load_with_cases
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import ALL_CASES
from heuncli.scene.file_format.reading import STANDARD_INPUT
from heuncli.study.ask.asked_instants import measures, parse, times_of
from heuncli.study.model.error_places import placed
from heuncli.study.model.selection import asked_by
from heuncli.study.workflow import solve


def specs_of(files: Sequence[str], request: PlotRequest) -> list[tuple[str, Spec]]:
    """The specs, in the order of the files and of their cases, each with its name; of one alone that is empty."""
    specs = [pair for file, name in zip(files, _names(files), strict=True) for pair in _specs(file, name, request)]
    return specs if len(specs) > 1 else [("", spec) for _, spec in specs]


def _names(files: Sequence[str]) -> list[str]:
    """What files are called: nothing where there is one, without their folders and endings where that tells them."""
    if len(files) == 1:
        return [""]
    stems = ["standard input" if file == STANDARD_INPUT else PurePath(file).stem for file in files]
    return stems if len(set(stems)) == len(stems) else list(files)


def _specs(file: str, name: str, request: PlotRequest) -> Iterator[tuple[str, Spec]]:
    """A spec as it is, or in its cases, each with its name."""
    given = overrides(request.set)
    if request.case is None:
        yield name, load(file, overrides=given, checking=False)
    elif request.case == ALL_CASES:
        cases = load_with_cases(file, given, checking=False)[1]
        require_cases(cases)
        for case, spec in cases.items():
            yield f"{name} {case}".lstrip(), spec
    else:
        for case in map(str.strip, request.case.split(",")):
            yield f"{name} {case}".lstrip(), load(file, overrides=given, checking=False, case=case)
    require_other_file(request.output, [file])


def instants_before_horizon(source: Pictured, words: str) -> Array:
    """The instants of --at in a run, (n,) ascending. Raises UsageError, of those from the horizon on, too."""
    found = times_of(parse(words), source.study)
    horizon = source.study.results.horizon
    if horizon is not None and found[-1] >= horizon:
        late = found[found >= horizon][0]
        message = f"--at {late:.6g}: from t = {horizon:.6g} s on nothing is claimed, and so nothing is drawn"
        raise UsageError(Problem("bad-option", message, hint="an earlier instant"))
    return found


def extremes_asked(words: str | None, spec: Spec) -> list[str]:
    """The paths of a spec at whose extremes `--at` asks for a picture. Raises UsageError, SpecError."""
    several = measures(parse(words)) if words is not None else []
    measure.check(several, spec, "--at")
    return [one.path for one in several]


def require_joints(paths: Sequence[str], request: PlotRequest) -> None:
    """Raise UsageError for axes of joints where nothing that is drawn is a load of one."""
    if request.axes is not None and not any("joints" in words_of(path) for path in paths):
        message = f"--axes {request.axes} does nothing to {', '.join(paths)}: it is of the loads of joints"
        raise UsageError(Problem("bad-option", message, hint="leave it out, or draw a joint: joints.NAME.force"))


def require_no_paths(asked: PlotAsked) -> None:
    """Raise UsageError where a picture of the whole scene is asked for of some paths."""
    if asked.paths:
        message = f"heun plot {asked.what} {' '.join(asked.paths)}: {asked.what} is of the whole scene"
        raise UsageError(Problem("bad-option", message, hint=f"heun plot {asked.files[0]} {asked.what}"))


def solution(name: str, spec: Spec, paths: Sequence[str], request: PlotRequest) -> Pictured:
    """A spec solved for what some paths need; what it is warned of is told."""
    what = asked_by(paths, spec)
    axes = "world" if request.axes is None else choice("--axes", request.axes, JOINT_AXES)
    options = replace(
        solver_options(request), wanted=what.reports, entries=what.entries, axes=axes, time_limit=alarm.remaining()
    )
    with placed(spec):
        study = solve(spec, options)
    warn(spec, study.results, request.quiet)
    return Pictured(name, study)
