"""`heun modes`: small oscillations about the pose at rest."""

from __future__ import annotations

from heuncli.cli.guard import require_other_file
from heuncli.cli.left_out import named
from heuncli.cli.options import FORMATS
from heuncli.cli.output import emit
from heuncli.cli.solving import overrides, warn
from heuncli.cli.target import format_of
from heuncli.commands.modes import page as report
from heuncli.commands.modes.request import ModesRequest
from heuncli.oscillations.study import modes
from heuncli.oscillations.without import without
from heuncli.report.export import dump
from heuncli.spec.load import load


def main(request: ModesRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = format_of(request.format, request.output, FORMATS)
    spec = load(request.spec, overrides=overrides(request.set), checking=False, case=request.case)
    entries = named(spec, request.without)
    require_other_file(request.output, [request.spec])
    found = modes(without(spec, entries), entries)
    if form == "json":
        text = dump(found.block())
    else:
        text = report.to_csv(found) if form == "csv" else report.write(found)
    emit(text, request.output)
    warn(spec, None, request.quiet)
    return 0
