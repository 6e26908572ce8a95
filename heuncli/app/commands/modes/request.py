"""Options and arguments of `heun modes`."""

from typing import Annotated

from heuncli.app.cli.options import CASE, FORMAT, OUTPUT, QUIET, SET, SPEC, TIME_LIMIT, WITHOUT
from heuncli.base.named_tuples import NamedTuple


class ModesRequest(NamedTuple):
    """Find frequencies, damping and mode shapes of small oscillations about the rest position."""

    spec: Annotated[str, SPEC]
    format: Annotated[str | None, FORMAT] = None
    output: Annotated[str | None, OUTPUT] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    without: Annotated[tuple[str, ...], WITHOUT] = ()
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
