"""Options and arguments of `heun plot`."""

from typing import Annotated

from heuncli.app.cli.options import QUIET, SET, TIME_LIMIT, VIEW, WIDTH, WITHOUT, CaptionRequest, Option, SolverRequest
from heuncli.base.named_tuples import NamedTuple


class PlotRequest(NamedTuple):
    """The options and arguments of `heun plot`."""

    words: Annotated[
        tuple[str, ...],
        Option(
            (),
            "Specs, then one of: paths, such as joints.main.force (over time); sections.NAME (along the bar); "
            "polar joints.NAME; scene; modes; balance. Or the store or CSV file of a sweep.",
            "SPEC... WHAT...",
        ),
    ]
    output: Annotated[
        str | None,
        Option(
            ("--output", "-o"),
            "Output file: x.svg, x.png or x.pdf. Default: draw on the terminal.",
            "FILE",
        ),
    ] = None
    x: Annotated[
        str | None,
        Option(("--x",), "Quantity on the x axis in place of time, such as coordinates.shaft.angle.", "PATH"),
    ] = None
    measured: Annotated[
        tuple[str, ...],
        Option(
            ("--with",),
            "Add measured points from columns of a CSV file, as t:F or t[ms]:2[kN]. May be repeated.",
            "FILE:X:Y",
        ),
    ] = ()
    at: Annotated[
        str | None,
        Option(
            ("--at",),
            "Instants of diagrams and of the scene, as in heun export; for the scene also start or worst (default).",
            "WHEN,...",
        ),
    ] = None
    axes: Annotated[
        str | None,
        Option(("--axes",), "Axes of joint loads: world, or those of one of the two bodies.", "world|from|to"),
    ] = None
    view: Annotated[str | None, VIEW] = None
    tension_side: Annotated[bool, Option(("--tension-side",), "Draw bending moments on the tension side.")] = False
    without: Annotated[tuple[str, ...], WITHOUT] = ()
    width: Annotated[int | None, WIDTH] = None
    units: Annotated[str | None, Option(("--units",), "Units of the axes, such as kN,mm,deg,rpm.", "UNIT,...")] = None
    set: Annotated[tuple[str, ...], SET] = ()
    captions: CaptionRequest = CaptionRequest()
    case: Annotated[str | None, Option(("--case",), "Overlay these load cases, or all.", "NAME,...|all")] = None
    solver: SolverRequest = SolverRequest()
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
