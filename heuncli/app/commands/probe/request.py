"""Options and arguments of `heun probe`."""

from typing import Annotated

from heuncli.app.cli.options import CASE, OUTPUT, QUIET, SET, SPEC, TIME_LIMIT, Option
from heuncli.base.named_tuples import NamedTuple


class ProbeRequest(NamedTuple):
    """Show where a motion is numerically difficult (singular positions, stiffness, chaos), with a verdict."""

    spec: Annotated[str, SPEC]
    format: Annotated[
        str | None,
        Option(("--format",), "Output format. Default: from the extension of -o FILE, else table.", "table|json"),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
