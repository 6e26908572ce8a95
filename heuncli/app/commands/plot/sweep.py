"""`heun plot sweep.sqlite`, or sweep.csv: draw the measures of a sweep over its parameters."""

from __future__ import annotations

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.target import parse_units
from heuncli.app.commands.plot.plot_target import PlotTarget
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.swept_files import read_sweep
from heuncli.base.errors import Problem
from heuncli.output.drawing.figure import Figure
from heuncli.output.figures.sweeps import make_sweep_figure


def draw(target: PlotTarget, request: PlotRequest) -> Figure:
    """Draw the figure. Raises UsageError, OutputError, NotDrawable."""
    if len(target.files) > 1:
        message = f"heun plot {' '.join(target.files)}: one sweep at a time, without a spec"
        raise UsageError(Problem("bad-option", message, hint="call it once for each"))
    return make_sweep_figure(read_sweep(target.files[0]), parse_units(request.units), target.paths)
