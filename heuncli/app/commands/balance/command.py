"""`heun balance`: mass effects over a cycle by orders, and counterweights or a flywheel that lower them."""

from __future__ import annotations

from heuncli.analyses.balancing.study import balance
from heuncli.app.cli.documents import emit_document
from heuncli.app.cli.figure_options import require_save_form
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.options import FORMATS
from heuncli.app.cli.output import save
from heuncli.app.cli.solving import parse_overrides, print_warnings
from heuncli.app.cli.target import choose_format
from heuncli.app.commands.balance.options import parse_options
from heuncli.app.commands.balance.page import make_document
from heuncli.app.commands.balance.request import BalanceRequest
from heuncli.output.drawing.drawing_files import encode_drawing
from heuncli.scene.file_format.load import load
from heuncli.study.quantities.table_units import Units


def main(request: BalanceRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = choose_format(request.format, request.output, FORMATS)
    figure_form = require_save_form(request.save, request.output)
    spec = load(request.spec, overrides=parse_overrides(request.set), checking=False, case=request.case)
    require_other_file(request.output, [request.spec])
    if request.save is not None:
        require_other_file(request.save, [request.spec], "--save")
    results = balance(spec, parse_options(request, spec))
    if figure_form is not None and request.save is not None:
        from heuncli.output.drawing.layout import lay_out
        from heuncli.output.figures.orders import BalancedScene, make_orders_figure

        save(
            encode_drawing(lay_out(make_orders_figure([BalancedScene("", results)], Units())), figure_form),
            request.save,
        )
    emit_document(make_document(results), form, request.output)
    print_warnings(spec, None, request.quiet)
    return 0
