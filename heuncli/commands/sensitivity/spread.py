"""What spreads of several numbers make of a measure together.

    worst case         sum |dm/dp| t
    root sum square    sqrt(sum (dm/dp t)^2), of spreads that hang on nothing in common

Both hold as far as the measure is linear over the spreads. So each number is also set to both ends of its spread; where
the measure there is further off the derivative than LINEAR, the larger of both changes is counted.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from heuncli.commands.sensitivity.results import Contribution, NoisyDerivative, NoisyValue, SpreadSum
from heuncli.named_tuples import NamedTuple
from heuncli.variants.written import WrittenNumber

LINEAR = 0.05  # of what the derivative says


class NumberSpread(NamedTuple):
    """A number and how far it may lie from its value, each way, in its unit."""

    number: WrittenNumber
    size: float


Ask = Callable[[Mapping[str, float]], NoisyValue]  # a measure, at distances of numbers from their values


def summed(ask: Ask, spreads: Sequence[NumberSpread], slopes: Mapping[str, NoisyDerivative]) -> SpreadSum:
    """What spreads make of a measure; slopes: dm/dp by name."""
    base = ask({})
    each = tuple(contribution(ask, base, spread, slopes[spread.number.name]) for spread in spreads)
    ways = {one.name: _way(one, slopes[one.name]) * one.spread for one in each}
    corners = ask({name: -way for name, way in ways.items()}), ask(ways)
    sizes = [(one.size, one.error) for one in each if one.size is not None]
    if len(sizes) < len(each):
        return SpreadSum(each, None, None, corners)
    worst = sum(size for size, _ in sizes), sum(error for _, error in sizes)
    root = math.sqrt(sum(size * size for size, _ in sizes))
    error = sum(size * error for size, error in sizes) / root if root else worst[1]
    return SpreadSum(each, worst, (root, error), corners)


def contribution(ask: Ask, base: NoisyValue, spread: NumberSpread, slope: NoisyDerivative) -> Contribution:
    """What the spread of one number makes of a measure."""
    name, t = spread.number.name, spread.size
    below, above = (_change(ask({name: way * t}), base) for way in (-1.0, 1.0))
    linear = abs(slope.value) * t if slope.value is not None else None
    ends = [each for each in (below, above) if each is not None]
    change = max((abs(value) for value, _ in ends), default=None)
    noise = max((error for _, error in ends), default=0.0)
    size, error = linear, slope.error * t
    if change is not None and (linear is None or not _agree(slope, t, below, above)):
        size, error = change, noise
    at_ends = (below[0] if below else None, above[0] if above else None)
    return Contribution(name, t, spread.number.unit, size, error, linear, *at_ends)


def _agree(
    slope: NoisyDerivative, t: float, below: tuple[float, float] | None, above: tuple[float, float] | None
) -> bool:
    """Whether what is found at both ends is what the derivative says."""
    said = (slope.value or 0.0) * t
    for way, found in ((-1.0, below), (1.0, above)):
        if found is not None and abs(found[0] - way * said) > LINEAR * abs(said) + slope.error * t + found[1]:
            return False
    return True


def _change(found: NoisyValue, base: NoisyValue) -> tuple[float, float] | None:
    """By how much a measure changes, and the error of that."""
    if found.value is None or base.value is None:
        return None
    return found.value - base.value, found.error + base.error


def _way(one: Contribution, slope: NoisyDerivative) -> float:
    """In which way a number raises the measure."""
    if slope.value is not None:
        return math.copysign(1.0, slope.value)
    return 1.0 if (one.above or 0.0) >= (one.below or 0.0) else -1.0
