"""`heun methods`: the methods of integration, and what each is for."""

from __future__ import annotations

import json

from heuncli.cli.output import emit
from heuncli.cli.target import format_of
from heuncli.commands.methods.request import MethodsRequest
from heuncli.report.methods_table import block, table
from heuncli.report.text_table import WIDTH, plain

FORMATS = ("table", "json")


def main(request: MethodsRequest) -> int:
    """Run the command; returns the exit code."""
    form = format_of(request.format, request.output, FORMATS)
    text = json.dumps(block(), indent=1) + "\n" if form == "json" else plain(table(), WIDTH)
    emit(text, request.output)
    return 0
