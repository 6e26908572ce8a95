"""Options and arguments of `heun balance`."""

from typing import Annotated

from heuncli.app.cli.options import CASE, FORMAT, OUTPUT, QUIET, SET, SPEC, TIME_LIMIT, Option
from heuncli.base.named_tuples import NamedTuple


class BalanceRequest(NamedTuple):
    """Find inertia forces (mass effects) over a cycle: foundation loads by order, counterweights, flywheel."""

    spec: Annotated[str, SPEC]
    format: Annotated[str | None, FORMAT] = None
    output: Annotated[str | None, OUTPUT] = None
    save: Annotated[
        str | None,
        Option(("--save",), "Also draw the orders in this file: chart.svg, .png or .pdf.", "FILE"),
    ] = None
    cycle: Annotated[
        str | None, Option(("--cycle",), "Angle that defines the cycle. Default: the driven angle.", "J.angle")
    ] = None
    turns: Annotated[
        str | None,
        Option(("--turns",), "Revolutions per cycle; 2 gives half orders. Default: found from the loads.", "1|2"),
    ] = None
    rate: Annotated[
        str | None, Option(("--rate",), "Speed of rotation, such as 1500rpm. Default: the speed at the start.", "RATE")
    ] = None
    period: Annotated[
        str | None,
        Option(("--period",), "Count orders in time instead, for a motion with this period.", "SECONDS"),
    ] = None
    orders: Annotated[
        str | None, Option(("--orders",), "Show only these orders, counted per revolution.", "NUMBER,...")
    ] = None
    about: Annotated[
        str | None, Option(("--about",), "Reference point of moments. Default: foundation.about.", "POINT|X,Y,Z")
    ] = None
    counterweight: Annotated[
        tuple[str, ...],
        Option(
            ("--counterweight",), "Find the best counterweight at this point. May be repeated.", "BODY.POINT[:radius=R]"
        ),
    ] = ()
    minimise: Annotated[
        str | None,
        Option(
            ("--minimise",),
            "Quantity that counterweights minimise. Default: force; mix if a body has two counterweights.",
            "force|moment|mix",
        ),
    ] = None
    lever: Annotated[
        str | None, Option(("--lever",), "Length by which mix divides moments. Default: the model size.", "LENGTH")
    ] = None
    flywheel: Annotated[
        str | None, Option(("--flywheel",), "Find the flywheel for this coefficient of speed fluctuation.", "[J=]DELTA")
    ] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
