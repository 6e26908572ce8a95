"""One panel of a section diagram: curves over the way along a bar, hatches, signs, extremes, and what is open."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import Band, Blank, Item, Panel, Scaling, Spot, Strokes, Trace, Words
from heuncli.output.drawing.ticks import ends, short, ticks
from heuncli.output.figures.bars import AlongBar, Extreme, Reach, WholeBar
from heuncli.output.figures.error_bands import is_seen
from heuncli.output.figures.happenings import instant
from heuncli.results.results import Array, Mask
from heuncli.study.quantities.digits import OPEN, style, write
from heuncli.study.quantities.table_units import Units

HIGH, LOW = 150.0, 56.0  # pixels of a panel, and of one in which all is open
ORDINATES = 60  # of a hatch along a bar
FREE = 0.011  # of a bar's length: how far from a sign ordinates are
WIDE, HIGH_ENOUGH = 0.05, 0.15  # of a bar's length, of the largest value: what is less has no sign written in it
MARKED = 0.004  # of the largest magnitude of a quantity: half a pixel, below which an extreme is not marked
TICKS = 4  # of an axis that is turned over
SPARE = 0.22  # of a panel's height, beyond what is drawn: room for the words at extremes
UNKNOWN = "not known: the stated error is as large as the numbers"


class DrawnBar(NamedTuple):
    """What is drawn of a bar with a pen: its quantities at an instant, or over the run."""

    name: str
    pen: int
    bar: WholeBar
    lines: Mapping[str, AlongBar]
    reaches: Mapping[str, Reach]

    def extremes(self, quantity: str) -> tuple[Extreme, Extreme]:
        """The lowest and the highest of a quantity."""
        if quantity in self.reaches:
            return self.reaches[quantity].lowest, self.reaches[quantity].highest
        return self.lines[quantity].low, self.lines[quantity].high

    def size(self, quantity: str) -> float:
        """Its largest magnitude; nan where it is open all over."""
        return max(abs(one.value) for one in self.extremes(quantity))

    def open_in_part(self, quantity: str) -> bool:
        """Whether it is open anywhere along the bar, at any instant."""
        lines = [self.lines[quantity].values, *([self.reaches[quantity].low] if self.reaches else [])]
        return self.bar.open_somewhere(quantity) or any(bool(np.isnan(values).any()) for values in lines)

    def is_zero(self, quantity: str) -> bool:
        """Whether it is not told from 0 wherever it is known."""
        return self.size(quantity) <= self.bar.error(quantity)


class Scales(NamedTuple):
    """How numbers stand in a panel: how many units of s and of the quantity are one in SI; up: -1 if turned over."""

    s: float
    value: float
    up: float
    units: tuple[str, str]


def diagram(quantity: str, drawn: Sequence[DrawnBar], units: Units, label: str, *, over: bool) -> Panel:
    """The panel of a quantity; over: with its axis turned over, so that what is positive points down."""
    length, own = units.of("m"), units.of(drawn[0].bar.unit(quantity))
    to = Scales(length[1], own[1], -1.0 if over else 1.0, (length[0], own[0]))
    y = _scaling(quantity, drawn, to, label)
    items = [item for each in drawn for item in _of_one(each, quantity, to, y, alone=len(drawn) == 1)]
    is_open = all(np.isnan(each.size(quantity)) for each in drawn)
    return Panel(y, y, tuple(items), LOW if is_open else HIGH)


def _scaling(quantity: str, drawn: Sequence[DrawnBar], to: Scales, label: str) -> Scaling:
    """The axis of a quantity, with its zero."""
    told = [each for each in drawn if not each.is_zero(quantity)]
    values = np.array([to.up * to.value * one.value for each in told for one in each.extremes(quantity)])
    known = values[np.isfinite(values)]
    if not known.size:
        return Scaling(label, -1.0, 1.0, named=((0.0, "0"),))
    low, high = ends(float(known.min()), float(known.max()), zero=True, spare=SPARE)
    if to.up > 0.0:
        return Scaling(label, low, high)
    return Scaling(label, low, high, named=tuple((-v, text) for v, text in ticks(Scaling(label, -high, -low), TICKS)))


def _of_one(drawn: DrawnBar, quantity: str, to: Scales, y: Scaling, *, alone: bool) -> Iterator[Item]:
    """What is drawn of a bar; alone: it is the only one, whose ordinates are hatched."""
    line, reach = drawn.lines[quantity], drawn.reaches.get(quantity)
    whose = f"{drawn.name}: " if drawn.name else ""
    if drawn.is_zero(quantity) and not drawn.open_in_part(quantity):
        yield Blank(0.0, to.s * drawn.bar.length, f"{whose}{UNKNOWN}")
        return
    s, known = line.s, np.isfinite(line.values)
    if reach is not None:
        known = np.isfinite(reach.low)
        s = reach.s
    for a, b in stretches(s, ~known):
        yield Blank(to.s * a, to.s * b, f"{whose}{OPEN}")
    if drawn.is_zero(quantity):  # where it is known
        yield Trace(f"{whose}{quantity}", to.s * line.s, 0.0 * line.values, drawn.pen)
        return
    up = to.up * to.value
    if reach is not None:
        both = np.sort(up * np.stack([reach.low, reach.high]), axis=0)
        yield Band(f"{whose}lowest and highest of {quantity}", to.s * reach.s, both[0], both[1], drawn.pen)
    values, error = up * line.values, to.value * drawn.bar.error(quantity)
    if is_seen(error, y, HIGH):
        both = np.clip([values - error, values + error], y.low, y.high)
        yield Band(f"{whose}stated error of {quantity}", to.s * line.s, both[0], both[1], drawn.pen)
    if alone:
        signs = list(_signs(to.s * line.s, values, to.up))
        yield from _hatch(to.s * line.s, values, drawn.pen, [sign.x for sign in signs])
        yield from signs
    yield from _closed(to.s * line.s, values, drawn.pen)
    yield Trace(f"{whose}{quantity}", to.s * line.s, values, drawn.pen)
    yield from _extremes(drawn, quantity, to)


def _hatch(s: Array, values: Array, pen: int, free: Sequence[float]) -> Iterator[Strokes]:
    """Ordinates from zero to a curve, evenly spaced; free: places about which there are none, for a sign."""
    at = np.linspace(s[0], s[-1], ORDINATES + 1)[1:-1]
    between = np.interp(at, s, values)
    own = np.isfinite(between)
    for place in free:
        own &= np.abs(at - place) > FREE * (s[-1] - s[0])
    yield Strokes(_ordinates(at[own], between[own]), pen, 0.6)


def _closed(s: Array, values: Array, pen: int) -> Iterator[Strokes]:
    """The ordinates at the ends of what is known of a curve."""
    known = np.isfinite(values)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]]).astype(np.int8)))
    at_ends = np.concatenate([edges[::2], edges[1::2] - 1])
    yield Strokes(_ordinates(s[at_ends], values[at_ends]), pen, 1.2)


def _ordinates(s: Array, values: Array) -> Array:
    """Strokes from zero to the values, (n, 2, 2)."""
    return np.stack([np.stack([s, np.zeros_like(s)], axis=1), np.stack([s, values], axis=1)], axis=1)


def _signs(s: Array, values: Array, up: float) -> Iterator[Words]:
    """The sign of each lobe that has room for it, in the middle of its area."""
    known = np.where(np.isfinite(values), values, 0.0)
    most = float(np.abs(known).max())
    for a, b in stretches(s, known > 0.0) + stretches(s, known < 0.0):
        own = (s >= a) & (s <= b)
        x, height = s[own], np.abs(known[own])
        steps = np.diff(x) * 0.5 * (height[1:] + height[:-1])
        if b - a < WIDE * (s[-1] - s[0]) or height.max() < HIGH_ENOUGH * most or not steps.sum() > 0.0:
            continue
        middle = float(np.sum(steps * 0.5 * (x[1:] + x[:-1])) / steps.sum())
        value = float(np.interp(middle, s, known))
        yield Words(middle, 0.5 * value, "+" if up * value > 0.0 else "\N{MINUS SIGN}")


def stretches(s: Array, which: Mask) -> list[tuple[float, float]]:
    """From where to where along a bar something holds, told of its places one after the other."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], which, [False]]).astype(np.int8)))
    found = [(float(s[a]), float(s[b - 1])) for a, b in pairwise(edges.tolist())][::2]
    return [(a, b) for a, b in found if b > a]


def _extremes(drawn: DrawnBar, quantity: str, to: Scales) -> Iterator[Spot]:
    """The highest and the lowest with their values, and where and when they are; what is 0 is not marked."""
    low, high = drawn.extremes(quantity)
    error, bar = drawn.bar.error(quantity), drawn.bar
    how = style(to.value * drawn.size(quantity), to.value * error, to.value * bar.certain.lost(bar.unit(quantity)))
    reach = drawn.reaches.get(quantity)
    steady = high.value - low.value <= error
    for one in (high,) if steady else (high, low):
        if not abs(one.value) > max(error, MARKED * drawn.size(quantity)):
            continue
        (value,) = write([to.value * one.value], how)
        line = drawn.lines[quantity] if reach is None else reach.at_lowest if one is low else reach.at_highest
        s = first_place(one, line, error)
        where = [] if steady else [f"s = {short(to.s * s, 4)} {to.units[0]}"]
        when = [f"t = {instant(one.at)}"] if reach is not None and varies_at(s, reach, error) else []
        text = f"{value} at {', '.join([*where, *when])}" if where or when else value
        yield Spot(to.s * s, to.up * to.value * one.value, text, drawn.pen, filled=True)


def first_place(one: Extreme, line: AlongBar, error: float) -> float:
    """Where an extreme is: of a stretch along which it is the same to its error, the beginning."""
    with np.errstate(invalid="ignore"):
        same = np.abs(line.values - one.value) <= error
    return min(float(line.s[same][0]), one.s) if same.any() else one.s


def varies_at(s: float, reach: Reach, error: float) -> bool:
    """Whether a quantity changes with time at a place by more than its error."""
    k = np.abs(reach.s - s) <= np.abs(reach.s - s).min()
    return bool(np.nanmax(reach.high[k]) - np.nanmin(reach.low[k]) > 2.0 * error)
