"""`heun plot`: read, solve, draw."""

from __future__ import annotations

from importlib import import_module

from heuncli.app.cli.figure_letters import in_letters, require_width
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.output import emit, save
from heuncli.app.cli.picture_files import picture_form
from heuncli.app.cli.units import units
from heuncli.app.commands.plot.asked import asked
from heuncli.app.commands.plot.kinds import require_heeded
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.output.drawing.as_file import as_file
from heuncli.output.drawing.figure import Figure


def main(request: PlotRequest) -> int:
    """Run the command; returns the exit code."""
    found = asked(request.words)
    require_heeded(found.what, request)
    require_other_file(request.output, found.files)
    form = picture_form(request.output, "-o") if request.output is not None else None
    require_width(request.width)
    units(request.units)  # said before the work
    draw = import_module(f"heuncli.app.commands.plot.{found.what}").draw
    figure: Figure = draw(found, request)
    if form is None or request.output is None:
        emit(in_letters(figure, request.width), None)
        return 0
    from heuncli.output.drawing.layout import laid_out

    save(as_file(laid_out(figure), form), request.output)
    return 0
