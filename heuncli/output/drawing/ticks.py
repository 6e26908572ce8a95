"""Round numbers along an axis, and how they are written."""

from __future__ import annotations

import math

from heuncli.output.drawing.figure import Scaling

ROUND = (1.0, 2.0, 5.0, 10.0)
TURNS = (15.0, 30.0, 45.0, 90.0, 180.0, 360.0)  # degrees
FINEST = 4  # places behind the point, with more numbers have exponents
SPARE = 0.06  # of the span of what is drawn, beyond it at both ends
MANY = 1e8  # steps from zero: farther off, numbers are too long to stand beside an axis


def ticks(scaling: Scaling, most: int) -> list[tuple[float, str]]:
    """At most so many round numbers between the ends of an axis, ascending, with their texts."""
    if scaling.named:
        return list(scaling.named)
    if scaling.logarithmic:
        found = _decades(scaling.low, scaling.high, most)
        if len(found) > 1:
            return found  # else the axis is so short that even numbers tell it
    span = scaling.high - scaling.low
    turning = "[deg]" in scaling.label
    step = _step(span / max(most, 1), turning=turning)
    first, last = math.ceil(scaling.low / step - 1e-9), math.floor(scaling.high / step + 1e-9)
    if last <= first:  # one number does not tell how long the axis is
        step = _step(span / 5.0, turning=turning)
        first, last = math.ceil(scaling.low / step - 1e-9), math.floor(scaling.high / step + 1e-9)
    if max(abs(first), abs(last)) > MANY:
        return []
    values = [k * step for k in range(first, last + 1)]
    places = 0 if turning and step in TURNS else -math.floor(math.log10(step) + 1e-9)
    return [(value, written(value, places)) for value in values]


def _step(least: float, *, turning: bool) -> float:
    """The least round step that is not below that."""
    if turning and 10.0 < least <= TURNS[-1]:
        return next(step for step in TURNS if step >= least)
    power = 10.0 ** math.floor(math.log10(least))
    return next(power * mantissa for mantissa in ROUND if power * mantissa >= least * (1.0 - 1e-12))


def _decades(low: float, high: float, most: int) -> list[tuple[float, str]]:
    """Powers of ten, and between them multiples where these are few."""
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    for multiples in ((1, 2, 3, 5, 7), (1, 2, 5), (1, 3), (1,)):
        values = [m * 10.0**k for k in powers for m in multiples]
        within = [v for v in values if low * (1.0 - 1e-9) <= v <= high * (1.0 + 1e-9)]
        if len(within) <= most or multiples == (1,):
            every = max(1, math.ceil(len(within) / max(most, 1)))
            return [(v, short(v)) for v in within[::every]]
    return []


def written(value: float, places: int) -> str:
    """A round number to so many places behind the point: plain where it is of a common size, else with an exponent."""
    if value == 0.0:
        return "0" if places > FINEST else f"{0.0:.{max(places, 0)}f}"
    if 10.0**-FINEST <= abs(value) < 1e6:
        return f"{value:.{max(places, 0)}f}"
    digits = max(0, places + math.floor(math.log10(abs(value)) + 1e-9))
    mantissa, _, exponent = f"{value:.{digits}e}".partition("e")
    return f"{mantissa.rstrip('0').rstrip('.') if '.' in mantissa else mantissa}e{int(exponent)}"


def short(value: float, digits: int = 6) -> str:
    """A number to six digits, or to fewer, its exponent short: 1e7, 2.5e-6; whole ones below a million without one."""
    mantissa, e, exponent = f"{float(f'{value:.{digits}g}'):.6g}".partition("e")
    return mantissa + (f"e{int(exponent)}" if e else "")


def near_zero(low: float, high: float) -> bool:
    """Whether zero belongs on an axis: it is in reach of what is drawn, beside how far that goes."""
    return low <= 0.0 <= high or min(abs(low), abs(high)) < high - low


def ends(low: float, high: float, *, zero: bool = False, spare: float = SPARE) -> tuple[float, float]:
    """The ends of an axis for values between these, with room beyond; zero: it is on the axis, too."""
    if zero:
        low, high = min(low, 0.0), max(high, 0.0)
    span = high - low
    if not span > 1e-12 * max(abs(low), abs(high)):
        span = abs(low) or 1.0
        return low - 0.5 * span, high + 0.5 * span
    return low - spare * span, high + spare * span
