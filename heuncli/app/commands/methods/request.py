"""Options and arguments of `heun methods`."""

from typing import Annotated

from heuncli.app.cli.options import OUTPUT, Option
from heuncli.base.named_tuples import NamedTuple


class MethodsRequest(NamedTuple):
    """List the methods of integration, and what each is for."""

    format: Annotated[
        str | None,
        Option(("--format",), "How to write it. Default: by the name's end of -o FILE, else table.", "table|json"),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
