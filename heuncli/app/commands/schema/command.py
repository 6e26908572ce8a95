"""`heun schema`: print the JSON Schema of specs or of results."""

from __future__ import annotations

import json

from heuncli.app.cli.output import emit
from heuncli.app.commands.schema.request import SchemaRequest


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
