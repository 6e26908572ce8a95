"""`heun probe`: find where a motion comes near to states that numerical methods cannot handle."""

from __future__ import annotations

from heuncli.analyses.motion_diagnostics.study import probe
from heuncli.app.cli import timeout
from heuncli.app.cli.documents import emit_document
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.solving import parse_overrides, print_warnings
from heuncli.app.cli.target import choose_format
from heuncli.app.commands.probe.page import make_document
from heuncli.app.commands.probe.request import ProbeRequest
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options

FORMATS = ("table", "json")


def main(request: ProbeRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = choose_format(request.format, request.output, FORMATS)
    spec = load(request.spec, overrides=parse_overrides(request.set), checking=False, case=request.case)
    require_other_file(request.output, [request.spec])
    results = probe(spec, Options(time_limit=timeout.remaining_time()))
    emit_document(make_document(results), form, request.output)
    print_warnings(spec, None, request.quiet)
    return 0
