"""`heun schema`: print the JSON Schema of specs or of results."""

from __future__ import annotations

import json
from typing import Annotated

from heuncli.app.cli.options import OUTPUT, Option
from heuncli.app.cli.output import emit
from heuncli.base.named_tuples import NamedTuple


class SchemaRequest(NamedTuple):
    """The options and arguments of `heun schema`."""

    results: Annotated[bool, Option(("--results",), "Print the schema of the results of heun run --format json.")] = (
        False
    )
    output: Annotated[str | None, OUTPUT] = None


def main(request: SchemaRequest) -> int:
    """Run the command; returns the exit code."""
    if request.results:
        from heuncli.output.tables.results_json_schema import make_results_schema

        schema = make_results_schema()
    else:
        from heuncli.scene.file_format.json_schema import make_spec_schema

        schema = make_spec_schema()
    emit(json.dumps(schema, indent=1, ensure_ascii=False) + "\n", request.output)
    return 0
