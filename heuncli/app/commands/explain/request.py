"""Options and arguments of `heun explain`."""

from typing import Annotated

from heuncli.app.cli.options import OUTPUT, Option
from heuncli.base.named_tuples import NamedTuple


class ExplainRequest(NamedTuple):
    """Tell of a code, a path of the results, a topic of the manual; or list them."""

    topic: Annotated[
        str | None,
        Option((), "A page, a command, a code, a path of results, an equation's number; without it, a list.", "TOPIC"),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    no_pager: Annotated[bool, Option(("--no-pager",), "All at once on a terminal, too.")] = False
