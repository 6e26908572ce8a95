"""`heun balance`: mass effects over a cycle, by orders; what lowers them."""

from __future__ import annotations

from heuncli.analyses.balancing.study import balance
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.options import FORMATS
from heuncli.app.cli.output import emit, save
from heuncli.app.cli.picture_files import saved_beside
from heuncli.app.cli.solving import overrides, warn
from heuncli.app.cli.target import format_of
from heuncli.app.commands.balance import page as report
from heuncli.app.commands.balance.options import options
from heuncli.app.commands.balance.request import BalanceRequest
from heuncli.output.drawing.as_file import as_file
from heuncli.output.tables.export import dump
from heuncli.scene.file_format.load import load
from heuncli.study.quantities.table_units import Units


def main(request: BalanceRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = format_of(request.format, request.output, FORMATS)
    drawn = saved_beside(request.save, request.output)
    spec = load(request.spec, overrides=overrides(request.set), checking=False, case=request.case)
    require_other_file(request.output, [request.spec])
    if request.save is not None:
        require_other_file(request.save, [request.spec], "--save")
    found = balance(spec, options(request, spec))
    if drawn is not None and request.save is not None:
        from heuncli.output.drawing.layout import laid_out
        from heuncli.output.figures.orders import BalancedScene, orders

        save(as_file(laid_out(orders([BalancedScene("", found)], Units())), drawn), request.save)
    if form == "json":
        text = dump(report.block(found))
    else:
        text = report.to_csv(found) if form == "csv" else report.write(found)
    emit(text, request.output)
    warn(spec, None, request.quiet)
    return 0
