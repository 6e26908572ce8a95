"""`heun modes`: small oscillations about the pose at rest."""

from __future__ import annotations

from heuncli.analyses.modes.study import modes
from heuncli.analyses.modes.without import without
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.left_out import named
from heuncli.app.cli.options import FORMATS
from heuncli.app.cli.output import emit
from heuncli.app.cli.solving import overrides, warn
from heuncli.app.cli.target import format_of
from heuncli.app.commands.modes import page as report
from heuncli.app.commands.modes.request import ModesRequest
from heuncli.output.tables.export import dump
from heuncli.scene.file_format.load import load


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
