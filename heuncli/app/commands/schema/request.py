"""Options of `heun schema`."""

from typing import Annotated

from heuncli.app.cli.options import OUTPUT, Option
from heuncli.base.named_tuples import NamedTuple


class SchemaRequest(NamedTuple):
    """Print the JSON Schema of specs, for editors."""

    results: Annotated[bool, Option(("--results",), "Print the schema of the results of heun run --format json.")] = (
        False
    )
    output: Annotated[str | None, OUTPUT] = None
