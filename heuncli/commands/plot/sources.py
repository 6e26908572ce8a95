"""The runs that are drawn: each spec, in each load case that is asked for, solved for what the paths need."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import PurePath

from heuncli.cli import alarm, measure
from heuncli.cli.guard import require_other_file
from heuncli.cli.solving import choice, overrides, solver_options, warn
from heuncli.commands.plot.request import PlotRequest
from heuncli.kinetostatics.joint_axes import JOINT_AXES
from heuncli.pictures.courses import Pictured
from heuncli.records import replace
from heuncli.spec.load import load, load_with_cases
from heuncli.spec.models import Spec
from heuncli.spec.names import ALL_CASES
from heuncli.study.ask.measure import MeasureRequest
from heuncli.study.model.error_places import placed
from heuncli.study.model.selection import asked_by
from heuncli.study.workflow import solve


def solved(
    files: Sequence[str], paths: Sequence[str], request: PlotRequest, blocks: Sequence[str] = ()
) -> list[Pictured]:
    """The runs, in the order of the files and of their cases; what they are warned of is told.

    blocks: of the results, that are needed altogether beside what the paths need.
    """
    specs = [pair for file in files for pair in _specs(file, request)]
    asked = [MeasureRequest("", path) for path in paths]
    for _, spec in specs:
        measure.check(asked, spec, "heun plot")
    return [_solved(name if len(specs) > 1 else "", spec, [*paths, *blocks], request) for name, spec in specs]


def _specs(file: str, request: PlotRequest) -> Iterator[tuple[str, Spec]]:
    """A spec as it is, or in its cases, each with its name."""
    given, name = overrides(request.set), PurePath(file).stem
    if request.case is None:
        yield name, load(file, overrides=given, checking=False)
    elif request.case == ALL_CASES:
        for case, spec in load_with_cases(file, given, checking=False)[1].items():
            yield f"{name} {case}", spec
    else:
        for case in request.case.split(","):
            yield f"{name} {case}", load(file, overrides=given, checking=False, case=case)
    require_other_file(request.output, [file])


def _solved(name: str, spec: Spec, paths: Sequence[str], request: PlotRequest) -> Pictured:
    """One of them solved."""
    what = asked_by(paths, spec)
    axes = "world" if request.axes is None else choice("--axes", request.axes, JOINT_AXES)
    options = replace(
        solver_options(request), wanted=what.reports, entries=what.entries, axes=axes, time_limit=alarm.remaining()
    )
    with placed(spec):
        study = solve(spec, options)
    warn(spec, study.results, request.quiet)
    return Pictured(name, study)
