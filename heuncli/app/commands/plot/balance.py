"""`heun plot SPEC balance`: draw mass effects over a cycle, by orders."""

from __future__ import annotations

from heuncli.analyses.balancing.study import balance
from heuncli.app.cli.solving import print_warnings
from heuncli.app.cli.target import parse_units
from heuncli.app.commands.plot.plot_target import PlotTarget
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.sources import load_specs, require_no_paths
from heuncli.output.drawing.figure import Figure
from heuncli.output.figures.orders import BalancedScene, make_orders_figure


def draw(target: PlotTarget, request: PlotRequest) -> Figure:
    """Draw the figure. Raises UsageError, SpecError, SolveError."""
    require_no_paths(target)
    sources = []
    for name, spec in load_specs(target.files, request):
        sources.append(BalancedScene(name, balance(spec)))
        print_warnings(spec, None, request.quiet)
    return make_orders_figure(sources, parse_units(request.units))
