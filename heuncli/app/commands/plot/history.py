"""`heun plot SPEC PATH...`: numbers over time, or over another number."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from heuncli.app.cli.solving import all_or_errors
from heuncli.app.cli.units import units
from heuncli.app.commands.plot.asked import PlotAsked
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.sources import require_joints, solution, specs_of
from heuncli.output.drawing.figure import Figure
from heuncli.output.figures.histories import history
from heuncli.output.figures.measured_points import MeasuredPoints
from heuncli.output.snapshots import measure
from heuncli.results.results_schema import BLOWS, EVENTS
from heuncli.scene.file_format.models import Spec
from heuncli.study.ask.measure import MeasureRequest
from heuncli.study.quantities.stated import unit_of


def draw(asked: PlotAsked, request: PlotRequest) -> Figure:
    """The figure. Raises UsageError, NotDrawable, SpecError and what solving raises."""
    paths = [*asked.paths, *([] if request.x is None else [request.x])]
    require_joints(paths, request)
    specs = specs_of(asked.files, request)
    for name, spec in specs:
        measure.check([MeasureRequest("", path) for path in paths], spec, f"heun plot {name}".rstrip())
    points = _points(asked, request, specs[0][1])
    needed = [*paths, BLOWS, EVENTS]  # these are marked
    sources = [solution(name, spec, needed, request) for name, spec in specs]
    return history(sources, asked.paths, units(request.units), request.x, points)


def _points(asked: PlotAsked, request: PlotRequest, spec: Spec) -> list[MeasuredPoints]:
    """What was measured. Raises SpecError with all that is wrong with any of the files."""
    x_unit = "s" if request.x is None else unit_of(request.x, spec)
    kinds = [unit_of(path, spec) for path in asked.paths]
    return all_or_errors([partial(_measured, words, x_unit, kinds) for words in request.measured])


def _measured(words: str, x_unit: str, kinds: Sequence[str]) -> MeasuredPoints:
    from heuncli.output.figures.measurements import asked_points, measured  # few pictures have any

    return measured(asked_points(words), x_unit, kinds)
