"""`heun probe`: what a motion comes near to, of what methods cannot bear."""

from __future__ import annotations

from heuncli.analyses.probing.study import probe
from heuncli.app.cli import alarm
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.output import emit
from heuncli.app.cli.solving import overrides, warn
from heuncli.app.cli.target import format_of
from heuncli.app.commands.probing import page as report
from heuncli.app.commands.probing.request import ProbeRequest
from heuncli.output.tables.export import dump
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options

FORMATS = ("table", "json")


def main(request: ProbeRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = format_of(request.format, request.output, FORMATS)
    spec = load(request.spec, overrides=overrides(request.set), checking=False, case=request.case)
    require_other_file(request.output, [request.spec])
    found = probe(spec, Options(time_limit=alarm.remaining()))
    emit(dump(found.block()) if form == "json" else report.write(found), request.output)
    warn(spec, None, request.quiet)
    return 0
