"""What `heun explain` is asked for: its options and arguments."""

from typing import Annotated, NamedTuple

from heuncli.cli.options import OUTPUT, Option


class ExplainRequest(NamedTuple):
    """Show a page of the manual, or the list of its pages."""

    topic: Annotated[
        str | None,
        Option((), "A page, a command, or the number of an equation; without it, the list of the pages.", "TOPIC"),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
