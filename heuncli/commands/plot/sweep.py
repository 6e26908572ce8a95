"""`heun plot sweep.sqlite`, or sweep.csv: what a sweep found, over what it varied."""

from __future__ import annotations

from heuncli.cli.entry import UsageError
from heuncli.cli.units import units
from heuncli.commands.plot.asked import PlotAsked
from heuncli.commands.plot.request import PlotRequest
from heuncli.commands.plot.swept_files import table_of
from heuncli.drawing.figure import Figure
from heuncli.errors import Problem
from heuncli.pictures.sweeps import sweep


def draw(asked: PlotAsked, request: PlotRequest) -> Figure:
    """The figure. Raises UsageError, OutputError, NotDrawable."""
    if len(asked.files) > 1:
        message = f"heun plot {' '.join(asked.files)}: one sweep at a time, and no spec beside it"
        raise UsageError(Problem("bad-option", message, hint="call it once for each"))
    return sweep(table_of(asked.files[0]), units(request.units), asked.paths)
