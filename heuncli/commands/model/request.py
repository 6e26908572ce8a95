"""What `heun model` is asked for: its options and arguments."""

from typing import Annotated

from heuncli.cli.options import CASE, NO_REDUCE, OUTPUT, QUIET, SET, SPEC, TIME_LIMIT, Option
from heuncli.named_tuples import NamedTuple


class ModelRequest(NamedTuple):
    """Tell which model is made of a scene, and why."""

    spec: Annotated[str, SPEC]
    format: Annotated[str | None, Option(("--format",), "How to write it. Default: text.", "text|json")] = None
    output: Annotated[str | None, OUTPUT] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    no_reduce: Annotated[bool, NO_REDUCE] = False
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
