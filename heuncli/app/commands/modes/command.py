"""`heun modes`: compute small oscillations about the pose at rest."""

from __future__ import annotations

from heuncli.analyses.modes import compute_spec_modes, exclude_entries
from heuncli.app.cli.documents import emit_document
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.options import FORMATS
from heuncli.app.cli.solving import parse_overrides, print_warnings
from heuncli.app.cli.target import choose_format
from heuncli.app.cli.without_option import find_excluded
from heuncli.app.commands.modes.page import make_document
from heuncli.app.commands.modes.request import ModesRequest
from heuncli.scene.file_format.load import load


def main(request: ModesRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = choose_format(request.format, request.output, FORMATS)
    spec = load(request.spec, overrides=parse_overrides(request.set), checking=False, case=request.case)
    entries = find_excluded(spec, request.without)
    require_other_file(request.output, [request.spec])
    scene_modes = compute_spec_modes(exclude_entries(spec, entries), entries)
    emit_document(make_document(scene_modes), form, request.output)
    print_warnings(spec, None, request.quiet)
    return 0
