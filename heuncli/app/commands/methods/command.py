"""`heun methods`: the methods of integration, and what each is for."""

from __future__ import annotations

import json

from heuncli.app.cli.output import emit
from heuncli.app.cli.target import format_of
from heuncli.app.commands.methods.request import MethodsRequest
from heuncli.output.tables.methods_table import block, table
from heuncli.output.tables.text_table import WIDTH, plain

FORMATS = ("table", "json")


def main(request: MethodsRequest) -> int:
    """Run the command; returns the exit code."""
    form = format_of(request.format, request.output, FORMATS)
    text = json.dumps(block(), indent=1) + "\n" if form == "json" else plain(table(), WIDTH)
    emit(text, request.output)
    return 0
