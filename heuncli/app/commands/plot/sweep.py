"""`heun plot sweep.sqlite`, or sweep.csv: what a sweep found, over what it varied."""

from __future__ import annotations

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.units import units
from heuncli.app.commands.plot.asked import PlotAsked
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.swept_files import table_of
from heuncli.base.errors import Problem
from heuncli.output.drawing.figure import Figure
from heuncli.output.figures.sweeps import sweep


def draw(asked: PlotAsked, request: PlotRequest) -> Figure:
    """The figure. Raises UsageError, OutputError, NotDrawable."""
    if len(asked.files) > 1:
        message = f"heun plot {' '.join(asked.files)}: one sweep at a time, and no spec beside it"
        raise UsageError(Problem("bad-option", message, hint="call it once for each"))
    return sweep(table_of(asked.files[0]), units(request.units), asked.paths)
