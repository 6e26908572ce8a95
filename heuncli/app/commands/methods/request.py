"""Options and arguments of `heun methods`."""

from typing import Annotated

from heuncli.app.cli.options import OUTPUT, Option
from heuncli.base.named_tuples import NamedTuple


class MethodsRequest(NamedTuple):
    """List the integration methods and their uses."""

    format: Annotated[
        str | None,
        Option(("--format",), "Output format. Default: from the extension of -o FILE, else table.", "table|json"),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
