"""`heun plot SPEC PATH...`: numbers over time, or over another number."""

from __future__ import annotations

from heuncli.cli.units import units
from heuncli.commands.plot.asked import PlotAsked
from heuncli.commands.plot.request import PlotRequest
from heuncli.commands.plot.sources import all_solved, specs_asked
from heuncli.drawing.figure import Figure
from heuncli.pictures.histories import history
from heuncli.pictures.measurements import asked_points, measured
from heuncli.variants.stated import unit_of


def draw(asked: PlotAsked, request: PlotRequest) -> Figure:
    """The figure. Raises UsageError, SpecError and what solving raises."""
    over = [] if request.x is None else [request.x]
    paths = [*asked.paths, *over]
    specs = specs_asked(asked.files, paths, request)
    spec = specs[0][1]
    x_unit = "s" if request.x is None else unit_of(request.x, spec)
    kinds = [unit_of(path, spec) for path in asked.paths]
    points = [measured(asked_points(words), x_unit, kinds) for words in request.measured]
    return history(all_solved(specs, paths, request), asked.paths, units(request.units), request.x, points)
