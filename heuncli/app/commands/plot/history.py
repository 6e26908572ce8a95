"""`heun plot SPEC PATH...`: draw numbers over time, or over another number."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from heuncli.app.cli.solving import collect_results
from heuncli.app.cli.target import parse_units
from heuncli.app.commands.plot.plot_target import PlotTarget
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.sources import load_specs, require_joint_paths, solve_source
from heuncli.output.drawing.figure import Figure
from heuncli.output.figures.curves import MeasuredPoints
from heuncli.output.figures.histories import make_history
from heuncli.output.snapshots import measure
from heuncli.results.results_schema import EVENTS, IMPULSES
from heuncli.scene.file_format.models import Spec
from heuncli.study.queries.measure import MeasureRequest
from heuncli.study.queries.measure_uncertainty import find_unit


def draw(target: PlotTarget, request: PlotRequest) -> Figure:
    """Draw the figure. Raises UsageError, NotDrawable, SpecError and what solving raises."""
    paths = [*target.paths, *([] if request.x is None else [request.x])]
    require_joint_paths(paths, request)
    specs = load_specs(target.files, request)
    for name, spec in specs:
        measure.require_known_paths([MeasureRequest("", path) for path in paths], spec, f"heun plot {name}".rstrip())
    points = _read_points(target, request, specs[0][1])
    needed = [*paths, IMPULSES, EVENTS]  # these are marked in the figure
    sources = [solve_source(name, spec, needed, request) for name, spec in specs]
    return make_history(sources, target.paths, parse_units(request.units), request.x, points)


def _read_points(target: PlotTarget, request: PlotRequest, spec: Spec) -> list[MeasuredPoints]:
    """Read the measured points. Raises SpecError with every problem of any of the files."""
    x_unit = "s" if request.x is None else find_unit(request.x, spec)
    y_units = [find_unit(path, spec) for path in target.paths]
    return collect_results([partial(_read_file, words, x_unit, y_units) for words in request.measured])


def _read_file(words: str, x_unit: str, y_units: Sequence[str]) -> MeasuredPoints:
    from heuncli.output.figures.measurements import parse_points_query, read_points  # rarely used

    return read_points(parse_points_query(words), x_unit, y_units)
