"""`heun balance`: mass effects over a cycle, by orders; what lowers them."""

from __future__ import annotations

from heuncli.balancing.study import balance
from heuncli.cli.guard import require_other_file
from heuncli.cli.options import FORMATS
from heuncli.cli.output import emit, save
from heuncli.cli.picture_files import saved_beside
from heuncli.cli.solving import overrides, warn
from heuncli.cli.target import format_of
from heuncli.commands.balance import page as report
from heuncli.commands.balance.options import options
from heuncli.commands.balance.request import BalanceRequest
from heuncli.drawing.as_file import as_file
from heuncli.report.export import dump
from heuncli.report.table_units import Units
from heuncli.spec.load import load


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
        from heuncli.drawing.layout import laid_out
        from heuncli.pictures.orders import BalancedScene, orders

        save(as_file(laid_out(orders([BalancedScene("", found)], Units())), drawn), request.save)
    if form == "json":
        text = dump(report.block(found))
    else:
        text = report.to_csv(found) if form == "csv" else report.write(found)
    emit(text, request.output)
    warn(spec, None, request.quiet)
    return 0
