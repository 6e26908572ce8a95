"""`heun plot SPEC balance`: mass effects over a cycle, by orders."""

from __future__ import annotations

from heuncli.analyses.balancing.study import balance
from heuncli.app.cli.solving import warn
from heuncli.app.cli.units import units
from heuncli.app.commands.plot.asked import PlotAsked
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.sources import require_no_paths, specs_of
from heuncli.output.drawing.figure import Figure
from heuncli.output.figures.orders import BalancedScene, orders


def draw(asked: PlotAsked, request: PlotRequest) -> Figure:
    """The figure. Raises UsageError, SpecError, SolveError."""
    require_no_paths(asked)
    sources = []
    for name, spec in specs_of(asked.files, request):
        sources.append(BalancedScene(name, balance(spec)))
        warn(spec, None, request.quiet)
    return orders(sources, units(request.units))
