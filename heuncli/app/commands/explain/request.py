"""Options and arguments of `heun explain`."""

from typing import Annotated

from heuncli.app.cli.options import OUTPUT, Option
from heuncli.base.named_tuples import NamedTuple


class ExplainRequest(NamedTuple):
    """Explain an error code, a result path or a topic of the manual, or list the topics."""

    topic: Annotated[
        str | None,
        Option((), "Page, command, error code, result path or equation number. Default: list the pages.", "TOPIC"),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    no_pager: Annotated[bool, Option(("--no-pager",), "Do not use a pager on a terminal.")] = False
