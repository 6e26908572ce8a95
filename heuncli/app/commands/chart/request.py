"""Options and arguments of `heun chart`."""

from typing import Annotated

from heuncli.app.cli.options import CASE, FORMAT, OUTPUT, QUIET, SET, SPEC, Option
from heuncli.base.named_tuples import NamedTuple


class ChartRequest(NamedTuple):
    """Speed against accuracy: methods at several tolerances or steps, which ones fail, and where."""

    spec: Annotated[str, SPEC]
    format: Annotated[str | None, FORMAT] = None
    output: Annotated[str | None, OUTPUT] = None
    save: Annotated[
        str | None, Option(("--save",), "Draw it there, too: chart.svg; .png and .pdf by matplotlib.", "FILE")
    ] = None
    methods: Annotated[str | None, Option(("--methods",), "These alone; heun methods lists them.", "NAME,...")] = None
    tolerances: Annotated[
        str | None, Option(("--tolerances",), "Local tolerances of adaptive methods.", "NUMBER,...")
    ] = None
    steps: Annotated[str | None, Option(("--steps",), "Steps of methods of fixed step [s].", "NUMBER,...")] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    time_limit: Annotated[
        float | None, Option(("--time-limit",), "After that long no run is begun; what is left is told.", "SECONDS")
    ] = None
    quiet: Annotated[bool, QUIET] = False
