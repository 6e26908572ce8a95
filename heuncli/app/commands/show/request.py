"""Options and arguments of `heun show`."""

from typing import Annotated

from heuncli.app.cli.options import (
    CASE,
    LABEL,
    LEAST_NORM,
    METHOD,
    NO_REDUCE,
    QUIET,
    SET,
    SPEC,
    STEP,
    TIME_LIMIT,
    TITLE,
    TOLERANCE,
    Option,
)
from heuncli.base.named_tuples import NamedTuple


class ShowRequest(NamedTuple):
    """Show the moving machine and its loads on a self-contained page for a browser."""

    spec: Annotated[str, SPEC]
    output: Annotated[
        str | None,
        Option(
            ("--output", "-o"),
            "Output file: page x.html, or x.png, x.gif, x.mp4 made by programs on PATH; - is standard output.",
            "FILE",
        ),
    ] = None
    glb: Annotated[str | None, Option(("--glb",), "Also write the moving bodies as animated glTF: x.glb.", "FILE")] = (
        None
    )
    frames: Annotated[
        int | None, Option(("--frames",), "Maximum number of instants on the page. Default: 600.", "NUMBER")
    ] = None
    at: Annotated[
        float | None, Option(("--at",), "Instant of x.png [s]. Default: when the joint forces are greatest.", "T")
    ] = None
    units: Annotated[str | None, Option(("--units",), "Units of the page, such as kN,mm,deg,rpm.", "UNIT,...")] = None
    set: Annotated[tuple[str, ...], SET] = ()
    title: Annotated[str | None, TITLE] = None
    label: Annotated[tuple[str, ...], LABEL] = ()
    case: Annotated[str | None, CASE] = None
    method: Annotated[str | None, METHOD] = None
    step: Annotated[float | None, STEP] = None
    tolerance: Annotated[float | None, TOLERANCE] = None
    no_reduce: Annotated[bool, NO_REDUCE] = False
    least_norm: Annotated[bool, LEAST_NORM] = False
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
