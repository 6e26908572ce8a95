"""`heun plot SPEC PATH...`: numbers over time, or over another number."""

from __future__ import annotations

from heuncli.cli.units import units
from heuncli.commands.plot.asked import PlotAsked
from heuncli.commands.plot.request import PlotRequest
from heuncli.commands.plot.sources import solved
from heuncli.drawing.figure import Figure
from heuncli.pictures.histories import history


def draw(asked: PlotAsked, request: PlotRequest) -> Figure:
    """The figure. Raises UsageError, SpecError and what solving raises."""
    over = [] if request.x is None else [request.x]
    sources = solved(asked.files, [*asked.paths, *over], request)
    return history(sources, asked.paths, units(request.units), request.x)
