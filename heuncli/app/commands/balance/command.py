"""`heun balance`: mass effects over a cycle by orders, and counterweights or a flywheel that lower them."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from heuncli.analyses.balancing.results import BalanceOptions, FlywheelRequest, WeightRequest
from heuncli.analyses.balancing.study import balance
from heuncli.app.cli.documents import emit_document
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.figure_output import require_save_form
from heuncli.app.cli.options import CASE, FORMAT, FORMATS, OUTPUT, QUIET, SET, SPEC, TIME_LIMIT, Option
from heuncli.app.cli.output import save
from heuncli.app.cli.solving import load_spec, print_warnings, require_choice
from heuncli.app.cli.target import choose_format, require_other_file
from heuncli.app.commands.balance.page import make_document
from heuncli.base.errors import Finding, Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import suggest
from heuncli.base.units import LENGTH, RATE, TIME, Dimension
from heuncli.output.drawing.drawing_files import encode_drawing
from heuncli.results.results import Array
from heuncli.scene.expressions.scope import Scope
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.quantity import read_number
from heuncli.study.quantities.table_units import Units


class BalanceRequest(NamedTuple):
    """The options and arguments of `heun balance`."""

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


def main(request: BalanceRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = choose_format(request.format, request.output, FORMATS)
    figure_form = require_save_form(request.save, request.output)
    spec = load_spec(request)
    require_other_file(request.output, [request.spec])
    if request.save is not None:
        require_other_file(request.save, [request.spec], "--save")
    results = balance(spec, parse_options(request, spec))
    if figure_form is not None and request.save is not None:
        from heuncli.output.drawing.layout import lay_out
        from heuncli.output.figures.orders import BalancedScene, make_orders_figure

        save(
            encode_drawing(lay_out(make_orders_figure([BalancedScene("", results)], Units())), figure_form),
            request.save,
        )
    emit_document(make_document(results), form, request.output)
    print_warnings(spec, None, request.quiet)
    return 0


TURNS = ("1", "2")
MINIMISED = ("force", "moment", "mix")


def parse_options(request: BalanceRequest, spec: Spec) -> BalanceOptions:
    """Parse the cycle, its orders, counterweights and flywheel. Raises UsageError with all that do not go together."""
    require_cycle_options(request)
    turns = None if request.turns is None else int(require_choice("--turns", request.turns, TURNS))
    about, place = parse_about(request.about, spec)
    rate = None if request.rate is None else parse_quantity("--rate", request.rate, RATE, "1500rpm")
    if rate == 0.0:
        raise UsageError(Problem("bad-option", "--rate 0: nothing rotates", hint="for example --rate 1500rpm"))
    lever = (
        None
        if request.lever is None
        else require_positive("--lever", parse_quantity("--lever", request.lever, LENGTH, "300mm"))
    )
    return BalanceOptions(
        cycle=request.cycle, turns=turns, rate=rate, orders=parse_orders(request.orders), about=about, place=place,
        weights=tuple(parse_weight(words) for words in request.counterweight),
        minimise=None if request.minimise is None else require_choice("--minimise", request.minimise, MINIMISED),
        lever=lever, flywheel=None if request.flywheel is None else parse_wheel(request.flywheel),
        period=None if request.period is None else parse_period(request.period),
    )  # fmt: skip


def require_cycle_options(request: BalanceRequest) -> None:
    """Raise UsageError for options of a cycle of angle if orders of time are requested (--period)."""
    if request.period is None:
        return
    cycle_options = {
        "--cycle": request.cycle, "--turns": request.turns, "--rate": request.rate,
        "--counterweight": request.counterweight, "--minimise": request.minimise, "--lever": request.lever,
        "--flywheel": request.flywheel,
    }  # fmt: skip
    hint = "leave out one of them; --period uses the motion as specified"
    wrong = [
        Problem("bad-option", f"--period and {name} cannot be combined", hint=hint)
        for name, value in cycle_options.items()
        if value
    ]
    if wrong:
        raise UsageError(*wrong)


def parse_period(words: str) -> float:
    """Parse --period, a time with or without a unit [s]. Raises UsageError."""
    return require_positive("--period", parse_quantity("--period", words, TIME, "20 ms"), "time", "20 ms")


def require_positive(option: str, value: float, quantity_name: str = "length", example: str = "60mm") -> float:
    """Return the value if it is above 0. Raises UsageError."""
    if value <= 0.0:
        message = f"{option} {value:g}: expected a {quantity_name} above 0"
        raise UsageError(Problem("bad-option", message, hint=f"for example {example}"))
    return value


def parse_weight(words: str) -> WeightRequest:
    """Parse a place of `--counterweight`: BODY.POINT, and the radius from it."""
    place, colon, rest = words.partition(":")
    body, dot, point = place.partition(".")
    key, equals, value = rest.partition("=")
    if not (body and dot and point) or (colon and (key.strip() != "radius" or not equals)):
        message = f"--counterweight {words}: expected BODY.POINT, or BODY.POINT:radius=LENGTH"
        raise UsageError(Problem("bad-option", message, hint="for example --counterweight crank.main:radius=60mm"))
    radius = None
    if colon:
        radius = require_positive(
            "--counterweight radius", parse_quantity("--counterweight radius", value, LENGTH, "60mm")
        )
    return WeightRequest(body, point, radius)


def parse_wheel(words: str) -> FlywheelRequest:
    """Parse `--flywheel`: the unevenness as 1% or 0.01, and the joint before it."""
    joint, equals, value = words.partition("=") if "=" in words else ("", "", words)
    text = value.strip()
    try:
        delta = float(text.removesuffix("%")) / (100.0 if text.endswith("%") else 1.0)
    except ValueError:
        delta = 0.0
    if not 0.0 < delta < 1.0 or (equals and not joint.strip()):
        message = f"--flywheel {words}: expected a speed fluctuation between 0 and 1"
        raise UsageError(Problem("bad-option", message, hint="for example --flywheel main=1%, or --flywheel 0.01"))
    return FlywheelRequest(joint.strip().removesuffix(".angle"), delta)


def parse_quantity(option: str, words: str, dimension: Dimension, example: str) -> float:
    """Parse a number, with or without a unit."""
    try:
        return read_number(words, dimension, Scope())
    except Finding as finding:
        hint = f"{finding.hint}; for example {option} {example}" if finding.hint else f"for example {option} {example}"
        raise UsageError(Problem("bad-option", f"{option} {words}: {finding}", hint=hint)) from None


def parse_orders(words: str | None) -> tuple[float, ...] | None:
    """Parse `--orders`, ascending: positive multiples of a half."""
    if words is None:
        return None
    try:
        orders = sorted({float(word) for word in words.split(",")})
    except ValueError:
        orders = []
    if not orders or any(not (order > 0.0 and (2.0 * order).is_integer()) for order in orders):
        message = f"--orders {words}: expected whole or half orders"
        raise UsageError(Problem("bad-option", message, hint="for example --orders 1,2,4,6, or 0.5,1 with --turns 2"))
    return tuple(orders)


def parse_about(words: str | None, spec: Spec) -> tuple[Array | None, str]:
    """Return the point of `--about` and its name: a ground point, or three numbers."""
    if words is None:
        return None, ""
    name = words.removeprefix("ground.")
    if name in spec.ground.points:
        return np.array(spec.ground.points[name]), name
    parts = words.split(",")
    if len(parts) == 3:
        return np.array([parse_quantity("--about", part.strip(), LENGTH, "0,0,100mm") for part in parts]), ""
    known = [*spec.ground.points]
    hint = (
        f"{suggest(name, known, 'points')}; or give three numbers" if known else "give three numbers: --about 0,0,0.1"
    )
    raise UsageError(Problem("bad-option", f"--about {words}: no point of the ground has this name", hint=hint))
