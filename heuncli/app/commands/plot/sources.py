"""Load and solve the runs that are drawn: each spec, in each requested load case, for the paths that the figure
needs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import PurePath

from heuncli.app.cli import timeout
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.solving import (
    apply_captions,
    apply_captions_to_cases,
    make_solver_options,
    parse_overrides,
    print_warnings,
    require_cases,
    require_choice,
)
from heuncli.app.cli.target import require_other_file
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.reactions import JOINT_AXES
from heuncli.output.figures.courses import FigureSource
from heuncli.output.tables import measure
from heuncli.results.path_words import split_path
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load, load_with_cases
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import ALL_CASES
from heuncli.scene.file_format.reading import STANDARD_INPUT
from heuncli.study.model.selection import select_paths
from heuncli.study.model.setup import attach_locations
from heuncli.study.queries.at_option import find_requested_times, make_extreme_requests, parse
from heuncli.study.workflow import solve


class PlotTarget(NamedTuple):
    """The files, the kind of figure, and its paths."""

    files: Sequence[str]
    kind: str
    paths: Sequence[str]


def load_specs(files: Sequence[str], request: PlotRequest) -> list[tuple[str, Spec]]:
    """Load the specs, in the order of the files and of their cases, each with its name; a single one has an empty
    name.
    """
    specs = [
        pair
        for file, name in zip(files, _choose_names(files), strict=True)
        for pair in _load_cases(file, name, request)
    ]
    return specs if len(specs) > 1 else [("", spec) for _, spec in specs]


def _choose_names(files: Sequence[str]) -> list[str]:
    """Return the names of the files: empty for a single one; without folder and ending if these names differ."""
    if len(files) == 1:
        return [""]
    stems = ["standard input" if file == STANDARD_INPUT else PurePath(file).stem for file in files]
    return stems if len(set(stems)) == len(stems) else list(files)


def _load_cases(file: str, name: str, request: PlotRequest) -> Iterator[tuple[str, Spec]]:
    """Yield the spec, or each of its load cases, with its name."""
    settings = parse_overrides(request.set)
    if request.case is None:
        yield name, apply_captions(load(file, overrides=settings, checking=False), request.captions)
    elif request.case == ALL_CASES:
        cases = load_with_cases(file, settings, checking=False)[1]
        require_cases(cases)
        for case, spec in apply_captions_to_cases(cases, request.captions).items():
            yield f"{name} {case}".lstrip(), spec
    else:
        for case in map(str.strip, request.case.split(",")):
            spec = load(file, overrides=settings, checking=False, case=case)
            yield f"{name} {case}".lstrip(), apply_captions(spec, request.captions)
    require_other_file(request.output, [file])


def parse_instants(source: FigureSource, words: str) -> Array:
    """Return the instants of --at in a run, (n,) ascending. Raises UsageError, also for instants from the horizon
    on.
    """
    times = find_requested_times(parse(words), source.study)
    horizon = source.study.results.horizon
    if horizon is not None and times[-1] >= horizon:
        late = times[times >= horizon][0]
        message = f"--at {late:.6g}: results are not reliable from t = {horizon:.6g} s on and are not drawn"
        raise UsageError(Problem("bad-option", message, hint="give an earlier instant"))
    return times


def list_extreme_paths(words: str | None, spec: Spec) -> list[str]:
    """List the paths at whose extremes `--at` wants a figure. Raises UsageError, SpecError."""
    requests = make_extreme_requests(parse(words)) if words is not None else []
    measure.require_known_paths(requests, spec, "--at")
    return [one.path for one in requests]


def require_joint_paths(paths: Sequence[str], request: PlotRequest) -> None:
    """Raise UsageError for --axes if no load of a joint is drawn."""
    if request.axes is not None and not any("joints" in split_path(path) for path in paths):
        message = f"--axes {request.axes} has no effect on {', '.join(paths)}: it applies to joint loads"
        raise UsageError(Problem("bad-option", message, hint="leave it out, or draw a joint: joints.NAME.force"))


def require_no_paths(target: PlotTarget) -> None:
    """Raise UsageError for paths if the figure shows the whole scene."""
    if target.paths:
        message = f"heun plot {target.kind} {' '.join(target.paths)}: {target.kind} draws the whole model"
        raise UsageError(Problem("bad-option", message, hint=f"heun plot {target.files[0]} {target.kind}"))


def solve_source(name: str, spec: Spec, paths: Sequence[str], request: PlotRequest) -> FigureSource:
    """Solve a spec for what some paths need, and print its warnings."""
    selection = select_paths(paths, spec)
    axes = "world" if request.axes is None else require_choice("--axes", request.axes, JOINT_AXES)
    options = replace(
        make_solver_options(request.solver),
        requested_reports=selection.reports,
        entries=selection.entries,
        axes=axes,
        time_limit=timeout.remaining_time(),
    )
    with attach_locations(spec):
        study = solve(spec, options)
    print_warnings(spec, study.results, request.quiet)
    return FigureSource(name, study)
