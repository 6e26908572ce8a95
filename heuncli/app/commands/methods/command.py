"""`heun methods`: list the integration methods and their purpose."""

from __future__ import annotations

import json

from heuncli.app.cli.output import emit
from heuncli.app.cli.target import choose_format
from heuncli.app.commands.methods.request import MethodsRequest
from heuncli.output.tables.methods_table import make_methods_table, to_json_block
from heuncli.output.tables.text_table import DEFAULT_WIDTH, format_plain

FORMATS = ("table", "json")


def main(request: MethodsRequest) -> int:
    """Run the command; returns the exit code."""
    form = choose_format(request.format, request.output, FORMATS)
    text = (
        json.dumps(to_json_block(), indent=1) + "\n"
        if form == "json"
        else format_plain(make_methods_table(), DEFAULT_WIDTH)
    )
    emit(text, request.output)
    return 0
