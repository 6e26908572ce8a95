"""Options and arguments of `heun explain`."""

from typing import Annotated

from heuncli.app.cli.options import OUTPUT, Option
from heuncli.base.named_tuples import NamedTuple


class ExplainRequest(NamedTuple):
    """Show a page or section of the manual, or explain a term or code."""

    topic: Annotated[
        str | None,
        Option(
            (),
            "A page, 'PAGE SECTION', a word, a command, a code, a result path or an equation's number. "
            "Default: list the pages.",
            "TOPIC",
        ),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    no_pager: Annotated[bool, Option(("--no-pager",), "Do not use a pager on a terminal.")] = False
