"""The options of `heun balance` as numbers and names. Raises UsageError for what they cannot mean."""

from __future__ import annotations

import numpy as np

from heuncli.analyses.balancing.asked import AskedWeight, AskedWheel, BalanceOptions
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.solving import choice
from heuncli.app.commands.balance.request import BalanceRequest
from heuncli.base.errors import Finding, Problem
from heuncli.base.nearest import did_you_mean
from heuncli.base.units import LENGTH, RATE, TIME, Dimension
from heuncli.results.results import Array
from heuncli.scene.expressions.grammar import Scope
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.quantity import number

TURNS = ("1", "2")
MINIMISED = ("force", "moment", "mix")


def options(request: BalanceRequest, spec: Spec) -> BalanceOptions:
    """What is asked for."""
    require_alone(request)
    turns = None if request.turns is None else int(choice("--turns", request.turns, TURNS))
    about, place = about_of(request.about, spec)
    rate = None if request.rate is None else quantity("--rate", request.rate, RATE, "1500rpm")
    if rate == 0.0:
        raise UsageError(Problem("bad-option", "--rate 0: nothing turns", hint="such as --rate 1500rpm"))
    lever = None if request.lever is None else positive("--lever", quantity("--lever", request.lever, LENGTH, "300mm"))
    return BalanceOptions(
        cycle=request.cycle, turns=turns, rate=rate, orders=orders_asked(request.orders), about=about, place=place,
        weights=tuple(weight_asked(words) for words in request.counterweight),
        minimise=None if request.minimise is None else choice("--minimise", request.minimise, MINIMISED),
        lever=lever, flywheel=None if request.flywheel is None else wheel_asked(request.flywheel),
        period=None if request.period is None else period_of(request.period),
    )  # fmt: skip


def require_alone(request: BalanceRequest) -> None:
    """Raise UsageError for what is of an angle's cycle, where orders of time are asked for."""
    if request.period is None:
        return
    given = {
        "--cycle": request.cycle, "--turns": request.turns, "--rate": request.rate,
        "--counterweight": request.counterweight, "--minimise": request.minimise, "--lever": request.lever,
        "--flywheel": request.flywheel,
    }  # fmt: skip
    hint = "leave out the one or the other: orders of time are of the motion as it is"
    wrong = [Problem("bad-option", f"--period and {name}", hint=hint) for name, value in given.items() if value]
    if wrong:
        raise UsageError(*wrong)


def period_of(words: str) -> float:
    """The seconds of --period."""
    return positive("--period", quantity("--period", words, TIME, "20 ms"), "time", "20 ms")


def positive(option: str, value: float, what: str = "length", example: str = "60mm") -> float:
    """The value, if it is above 0."""
    if value <= 0.0:
        message = f"{option} {value:g}: expected a {what} above 0"
        raise UsageError(Problem("bad-option", message, hint=f"such as {example}"))
    return value


def weight_asked(words: str) -> AskedWeight:
    """A place of `--counterweight`: BODY.POINT, and how far from it."""
    place, colon, rest = words.partition(":")
    body, dot, point = place.partition(".")
    key, equals, value = rest.partition("=")
    if not (body and dot and point) or (colon and (key.strip() != "radius" or not equals)):
        message = f"--counterweight {words}: expected BODY.POINT, or BODY.POINT:radius=LENGTH"
        raise UsageError(Problem("bad-option", message, hint="such as --counterweight crank.main:radius=60mm"))
    radius = None
    if colon:
        radius = positive("--counterweight radius", quantity("--counterweight radius", value, LENGTH, "60mm"))
    return AskedWeight(body, point, radius)


def wheel_asked(words: str) -> AskedWheel:
    """The unevenness of `--flywheel`, as 1% or 0.01, and the joint before it."""
    joint, equals, value = words.partition("=") if "=" in words else ("", "", words)
    text = value.strip()
    try:
        delta = float(text.removesuffix("%")) / (100.0 if text.endswith("%") else 1.0)
    except ValueError:
        delta = 0.0
    if not 0.0 < delta < 1.0 or (equals and not joint.strip()):
        message = f"--flywheel {words}: expected an unevenness between 0 and 1"
        raise UsageError(Problem("bad-option", message, hint="such as --flywheel main=1%, or --flywheel 0.01"))
    return AskedWheel(joint.strip().removesuffix(".angle"), delta)


def quantity(option: str, words: str, dimension: Dimension, example: str) -> float:
    """A number, or one with a unit."""
    try:
        return number(words, dimension, Scope())
    except Finding as finding:
        hint = f"{finding.hint}; such as {option} {example}" if finding.hint else f"such as {option} {example}"
        raise UsageError(Problem("bad-option", f"{option} {words}: {finding}", hint=hint)) from None


def orders_asked(words: str | None) -> tuple[float, ...] | None:
    """The orders of `--orders`, ascending: positive multiples of a half."""
    if words is None:
        return None
    try:
        found = sorted({float(word) for word in words.split(",")})
    except ValueError:
        found = []
    if not found or any(not (order > 0.0 and (2.0 * order).is_integer()) for order in found):
        message = f"--orders {words}: expected orders, whole or half ones"
        raise UsageError(Problem("bad-option", message, hint="such as --orders 1,2,4,6, or 0.5,1 of two turns"))
    return tuple(found)


def about_of(words: str | None, spec: Spec) -> tuple[Array | None, str]:
    """The point of `--about`, and its name: a ground point, or three numbers."""
    if words is None:
        return None, ""
    name = words.removeprefix("ground.")
    if name in spec.ground.points:
        return np.array(spec.ground.points[name]), name
    parts = words.split(",")
    if len(parts) == 3:
        return np.array([quantity("--about", part.strip(), LENGTH, "0,0,100mm") for part in parts]), ""
    known = [*spec.ground.points]
    hint = f"{did_you_mean(name, known, 'points')}; or three numbers" if known else "three numbers: --about 0,0,0.1"
    raise UsageError(Problem("bad-option", f"--about {words}: no point of the ground has this name", hint=hint))
