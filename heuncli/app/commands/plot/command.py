"""`heun plot`: draw a figure of solved scenes, modes, orders or sweeps."""

from __future__ import annotations

from importlib import import_module

from heuncli.app.cli.figure_options import render_text, require_figure_form, require_width
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.output import emit, save
from heuncli.app.cli.target import parse_units
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.target import KINDS, parse_words, require_applicable_options
from heuncli.output.drawing.drawing_files import encode_drawing
from heuncli.output.drawing.figure import Figure
from heuncli.study.quantities.captions import check_text


def main(request: PlotRequest) -> int:
    """Run the command; returns the exit code."""
    target = parse_words(request.words)
    require_applicable_options(target.kind, request)
    require_other_file(request.output, target.files)
    form = require_figure_form(request.output, "-o") if request.output is not None else None
    require_width(request.width)
    parse_units(request.units)  # raises UsageError before the work
    module = import_module(f"heuncli.app.commands.plot.{KINDS[target.kind].module}")
    figure: Figure = getattr(module, f"draw_{target.kind}")(target, request)
    if request.title is not None:
        figure = figure._replace(title=check_text("--title", request.title))
    if form is None or request.output is None:
        emit(render_text(figure, request.width), None)
        return 0
    from heuncli.output.drawing.layout import lay_out

    save(encode_drawing(lay_out(figure), form), request.output)
    return 0
