"""Options and arguments of `heun balance`."""

from typing import Annotated

from heuncli.app.cli.options import CASE, FORMAT, OUTPUT, QUIET, SET, SPEC, TIME_LIMIT, Option
from heuncli.base.named_tuples import NamedTuple


class BalanceRequest(NamedTuple):
    """Mass effects over a cycle: force and moment on the foundation by orders, counterweights, a flywheel."""

    spec: Annotated[str, SPEC]
    format: Annotated[str | None, FORMAT] = None
    output: Annotated[str | None, OUTPUT] = None
    save: Annotated[
        str | None, Option(("--save",), "Draw the orders there, too: chart.svg; .png and .pdf by matplotlib.", "FILE")
    ] = None
    cycle: Annotated[
        str | None, Option(("--cycle",), "The angle that the cycle is counted in. Default: the driven one.", "J.angle")
    ] = None
    turns: Annotated[
        str | None,
        Option(("--turns",), "Turns of a cycle; two have half orders. Default: as the loads have it.", "1|2"),
    ] = None
    rate: Annotated[
        str | None, Option(("--rate",), "How fast it turns, such as 1500rpm. Default: as at the start.", "RATE")
    ] = None
    period: Annotated[
        str | None,
        Option(("--period",), "Orders of time instead, of a motion that comes back with this period.", "SECONDS"),
    ] = None
    orders: Annotated[str | None, Option(("--orders",), "These alone, counted per turn.", "NUMBER,...")] = None
    about: Annotated[
        str | None, Option(("--about",), "Where moments are taken. Default: as foundation.about.", "POINT|X,Y,Z")
    ] = None
    counterweight: Annotated[
        tuple[str, ...],
        Option(
            ("--counterweight",), "Find the weight there that leaves least. May be repeated.", "BODY.POINT[:radius=R]"
        ),
    ] = ()
    minimise: Annotated[
        str | None,
        Option(
            ("--minimise",),
            "What counterweights lower. Default: force; mix, if a body has two.",
            "force|moment|mix",
        ),
    ] = None
    lever: Annotated[
        str | None, Option(("--lever",), "By which a mix counts moments. Default: the scene's size.", "LENGTH")
    ] = None
    flywheel: Annotated[
        str | None, Option(("--flywheel",), "Find the wheel for this unevenness of the rate.", "[J=]DELTA")
    ] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
