"""Options and arguments of `heun chart`."""

from typing import Annotated

from heuncli.app.cli.options import CASE, FORMAT, OUTPUT, QUIET, SET, SPEC, Option
from heuncli.base.named_tuples import NamedTuple


class ChartRequest(NamedTuple):
    """Compare speed and accuracy of methods at several tolerances or steps, and show which fail and where."""

    spec: Annotated[str, SPEC]
    format: Annotated[str | None, FORMAT] = None
    output: Annotated[str | None, OUTPUT] = None
    save: Annotated[
        str | None,
        Option(("--save",), "Also draw the chart in this file: chart.svg, .png or .pdf.", "FILE"),
    ] = None
    methods: Annotated[
        str | None, Option(("--methods",), "Run only these methods; heun methods lists them.", "NAME,...")
    ] = None
    tolerances: Annotated[
        str | None, Option(("--tolerances",), "Local tolerances of adaptive methods.", "NUMBER,...")
    ] = None
    steps: Annotated[str | None, Option(("--steps",), "Step sizes of fixed-step methods [s].", "NUMBER,...")] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    time_limit: Annotated[
        float | None, Option(("--time-limit",), "Start no run after this time; runs left out are listed.", "SECONDS")
    ] = None
    quiet: Annotated[bool, QUIET] = False
