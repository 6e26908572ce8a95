"""Options and arguments of `heun model`."""

from typing import Annotated

from heuncli.app.cli.options import CASE, NO_REDUCE, OUTPUT, QUIET, SET, SPEC, TIME_LIMIT, VIEW, WIDTH, Option
from heuncli.base.named_tuples import NamedTuple


class ModelRequest(NamedTuple):
    """Show the model that heun makes from a spec, and why."""

    spec: Annotated[str, SPEC]
    format: Annotated[str | None, Option(("--format",), "Output format. Default: text.", "text|json")] = None
    output: Annotated[str | None, OUTPUT] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    no_reduce: Annotated[bool, NO_REDUCE] = False
    sketch: Annotated[bool, Option(("--sketch",), "Add a text drawing of the assembled machine.")] = False
    view: Annotated[str | None, VIEW] = None
    width: Annotated[int | None, WIDTH] = None
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
