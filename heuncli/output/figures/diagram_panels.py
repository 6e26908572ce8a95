"""One panel of a section diagram: curves along a bar, hatches, signs, extremes, and what is open."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.axes import choose_ends, choose_ticks, format_short
from heuncli.output.drawing.figure import Band, Blank, Item, Panel, Scaling, Spot, Strokes, Trace, Words
from heuncli.output.drawing.style import HATCH_WIDTH, LEFT, RIGHT, SIGN_SIZE, WIDTH
from heuncli.output.figures.curves import choose_number_style, is_visible
from heuncli.results.results import Array, Mask
from heuncli.study.quantities.digits import OPEN, ReaderStyle
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.bar_curves import BarLine, BarRange, Extreme
from heuncli.study.queries.bars import WholeBar

PANEL_HEIGHT, OPEN_PANEL_HEIGHT = 150.0, 56.0  # pixels; the second if all is open
N_ORDINATES = 60  # of a hatch along a bar
BAR_SHARE = 1.04  # width of a panel in lengths of the bar
SIGN_CLEARANCE = 10.0  # pixels beside the middle of a sign without ordinates
MIN_LOBE_WIDTH, MIN_LOBE_HEIGHT = 20.0, 20.0  # pixels; smaller lobes have no sign
MIN_MARKED = 0.004  # share of the largest magnitude (half a pixel); smaller extremes are not marked
MAX_TICKS = 4  # of an inverted axis
LABEL_MARGIN = 0.22  # share of a panel's height, for labels of extremes
UNKNOWN_NOTE = "unknown: the stated error is as large as the values"


class BarCurves(NamedTuple):
    """The curves of a bar that are drawn with one pen: its quantities at an instant, or over the run."""

    name: str
    pen: int
    bar: WholeBar
    lines: Mapping[str, BarLine]
    ranges: Mapping[str, BarRange]

    def find_extremes(self, quantity: str) -> tuple[Extreme, Extreme]:
        """Return the lowest and highest value of a quantity."""
        if quantity in self.ranges:
            return self.ranges[quantity].lowest, self.ranges[quantity].highest
        return self.lines[quantity].low, self.lines[quantity].high

    def find_magnitude(self, quantity: str) -> float:
        """Return the largest magnitude of a quantity; nan if it is open everywhere."""
        return max(abs(extreme.value) for extreme in self.find_extremes(quantity))

    def is_partly_open(self, quantity: str) -> bool:
        """Return whether a quantity is open anywhere along the bar, at any instant."""
        lines = [self.lines[quantity].values, *([self.ranges[quantity].low] if self.ranges else [])]
        return self.bar.is_open_somewhere(quantity) or any(bool(np.isnan(values).any()) for values in lines)

    def is_zero(self, quantity: str) -> bool:
        """Return whether a quantity is no larger than its error wherever it is known."""
        return self.find_magnitude(quantity) <= self.bar.find_error(quantity)


class DisplayScales(NamedTuple):
    """How numbers are shown in a panel: the styles of the distance and of the quantity, -1 if the axis points down."""

    length: ReaderStyle
    quantity: ReaderStyle
    sign: float

    @property
    def s(self) -> float:
        """The number of display units in a metre."""
        return self.length.per_si

    @property
    def value(self) -> float:
        """The number of display units in one SI unit of the quantity."""
        return self.quantity.per_si


def make_panel(
    quantity: str, bars: Sequence[BarCurves], units: Units, length: ReaderStyle, *, is_inverted: bool
) -> Panel:
    """Make the panel of a quantity; is_inverted: positive values point down."""
    magnitudes = [bar.find_magnitude(quantity) for bar in bars]
    style = choose_number_style(bars[0].bar.find_unit(quantity), np.nanmax([0.0, *magnitudes]), units)
    scales = DisplayScales(length, style, -1.0 if is_inverted else 1.0)
    y = _make_axis(quantity, bars, scales, f"{quantity.rpartition('.')[2]} [{style.unit}]")
    items = [item for bar in bars for item in _draw_bar(bar, quantity, scales, y, alone=len(bars) == 1)]
    is_open = all(np.isnan(magnitude) for magnitude in magnitudes)
    return Panel(y, y, tuple(items), OPEN_PANEL_HEIGHT if is_open else PANEL_HEIGHT)


def _make_axis(quantity: str, bars: Sequence[BarCurves], scales: DisplayScales, label: str) -> Scaling:
    """Make the axis of a quantity, which includes zero."""
    nonzero_bars = [bar for bar in bars if not bar.is_zero(quantity)]
    values = np.array(
        [scales.sign * scales.value * extreme.value for bar in nonzero_bars for extreme in bar.find_extremes(quantity)]
    )
    known = values[np.isfinite(values)]
    if not known.size:
        return Scaling(label, -1.0, 1.0, tick_texts=((0.0, "0"),))
    low, high = choose_ends(float(known.min()), float(known.max()), zero=True, margin=LABEL_MARGIN)
    if scales.sign > 0.0:
        return Scaling(label, low, high)
    return Scaling(
        label,
        low,
        high,
        tick_texts=tuple((-v, text) for v, text in choose_ticks(Scaling(label, -high, -low), MAX_TICKS)),
    )


def _draw_bar(bar: BarCurves, quantity: str, scales: DisplayScales, y: Scaling, *, alone: bool) -> Iterator[Item]:
    """Yield the items of one bar; alone: it is the only one, and its ordinates are hatched."""
    line, load_range = bar.lines[quantity], bar.ranges.get(quantity)
    prefix = f"{bar.name}: " if bar.name else ""
    if bar.is_zero(quantity) and not bar.is_partly_open(quantity):
        yield Blank(0.0, scales.s * bar.bar.length, f"{prefix}{UNKNOWN_NOTE}")
        return
    s, is_known = line.s, np.isfinite(line.values)
    if load_range is not None:
        is_known = np.isfinite(load_range.low)
        s = load_range.s
    for a, b in find_intervals(s, ~is_known):
        yield Blank(scales.s * a, scales.s * b, f"{prefix}{OPEN}")
    if bar.is_zero(quantity):  # zero where it is known
        yield Trace(f"{prefix}{quantity}", scales.s * line.s, 0.0 * line.values, bar.pen)
        return
    factor = scales.sign * scales.value
    if load_range is not None:
        band = np.sort(factor * np.stack([load_range.low, load_range.high]), axis=0)
        name = f"{prefix}minimum and maximum of {quantity}"
        yield Band(name, scales.s * load_range.s, band[0], band[1], bar.pen, has_edges=True)
    values, error = factor * line.values, scales.value * bar.bar.find_error(quantity)
    if is_visible(error, y, PANEL_HEIGHT):
        band = np.clip([values - error, values + error], y.low, y.high)
        yield Band(f"{prefix}stated error of {quantity}", scales.s * line.s, band[0], band[1], bar.pen)
    if alone and load_range is None:
        signs = list(_draw_signs(scales.s * line.s, values, y, scales.sign))
        yield from _draw_hatch(scales.s * line.s, values, bar.pen, [sign.x for sign in signs])
        yield from signs
        yield from _draw_end_ordinates(scales.s * line.s, values, bar.pen)
    yield Trace(f"{prefix}{quantity}", scales.s * line.s, values, bar.pen)
    yield from _mark_extremes(bar, quantity, scales)


def _draw_hatch(s: Array, values: Array, pen: int, clear_places: Sequence[float]) -> Iterator[Strokes]:
    """Draw ordinates from zero to a curve, evenly spaced; none near `clear_places`, where a sign stands."""
    ordinate_places = np.linspace(s[0], s[-1], N_ORDINATES + 1)[1:-1]
    between = np.interp(ordinate_places, s, values)
    is_drawn = np.isfinite(between)
    for place in clear_places:
        is_drawn &= np.abs(ordinate_places - place) > SIGN_CLEARANCE / _find_pixels(s)
    yield Strokes(_make_ordinates(ordinate_places[is_drawn], between[is_drawn]), pen, HATCH_WIDTH, is_hatch=True)


def _draw_end_ordinates(s: Array, values: Array, pen: int) -> Iterator[Strokes]:
    """Draw the ordinates at the ends of the known parts of a curve."""
    is_known = np.isfinite(values)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], is_known, [False]]).astype(np.int8)))
    at_ends = np.concatenate([edges[::2], edges[1::2] - 1])
    yield Strokes(_make_ordinates(s[at_ends], values[at_ends]), pen, 1.2)


def _make_ordinates(s: Array, values: Array) -> Array:
    """Return strokes from zero to the values, (n, 2, 2)."""
    return np.stack([np.stack([s, np.zeros_like(s)], axis=1), np.stack([s, values], axis=1)], axis=1)


def _find_pixels(s: Array) -> float:
    """Return the number of pixels in a unit of a bar's length."""
    return (WIDTH - LEFT - RIGHT) / (BAR_SHARE * float(s[-1] - s[0]))


def _draw_signs(s: Array, values: Array, y: Scaling, sign: float) -> Iterator[Words]:
    """Draw the sign of each lobe that has room for its disc between the zero line and the curve."""
    known = np.where(np.isfinite(values), values, 0.0)
    pixels, height_pixels = _find_pixels(s), PANEL_HEIGHT / (y.high - y.low)
    for a, b in find_intervals(s, known > 0.0) + find_intervals(s, known < 0.0):
        in_lobe = (s >= a) & (s <= b)
        x, height = s[in_lobe], np.abs(known[in_lobe])
        steps = np.diff(x) * 0.5 * (height[1:] + height[:-1])
        if pixels * (b - a) < MIN_LOBE_WIDTH or not steps.sum() > 0.0:
            continue
        middle = float(np.sum(steps * 0.5 * (x[1:] + x[:-1])) / steps.sum())
        under = np.interp([middle - SIGN_SIZE / pixels, middle, middle + SIGN_SIZE / pixels], x, height)
        if height_pixels * under.min() < MIN_LOBE_HEIGHT:
            continue
        direction = 1.0 if float(np.interp(middle, s, known)) > 0.0 else -1.0
        text = "+" if sign * direction > 0.0 else "\N{MINUS SIGN}"
        yield Words(middle, 0.5 * direction * float(under.min()), text, is_sign=True)


def find_intervals(s: Array, which: Mask) -> list[tuple[float, float]]:
    """Return from where to where along a bar a mask of its places holds."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], which, [False]]).astype(np.int8)))
    intervals = [(float(s[a]), float(s[b - 1])) for a, b in pairwise(edges.tolist())][::2]
    return [(a, b) for a, b in intervals if b > a]


def _mark_extremes(bar_curves: BarCurves, quantity: str, scales: DisplayScales) -> Iterator[Spot]:
    """Mark the highest and lowest value with their place and instant; values of 0 are not marked."""
    low, high = bar_curves.find_extremes(quantity)
    error, bar = bar_curves.bar.find_error(quantity), bar_curves.bar
    number_style = scales.quantity._replace(error=scales.value * error)
    load_range = bar_curves.ranges.get(quantity)
    is_constant = high.value - low.value <= error
    rounding = bar.stated_errors.rounding_of(bar.find_unit(quantity))
    least = max(error, rounding, MIN_MARKED * bar_curves.find_magnitude(quantity))
    for extreme in (high,) if is_constant else (high, low):
        if not abs(extreme.value) > least:
            continue
        line = (
            bar_curves.lines[quantity]
            if load_range is None
            else load_range.at_lowest
            if extreme is low
            else load_range.at_highest
        )
        s = find_first_place(extreme, line, error)
        where = [] if is_constant else [f"{format_short(scales.s * s, 4)} {scales.length.unit}"]
        if load_range is not None and is_varying_at(s, load_range, error):
            where.append(f"t = {format_short(extreme.time, 4)} s")
        value = f"{number_style.write(extreme.value)} {scales.quantity.unit}"
        text = f"{value} at {', '.join(where)}" if where else value
        yield Spot(scales.s * s, scales.sign * scales.value * extreme.value, text, bar_curves.pen, is_filled=True)


def find_first_place(extreme: Extreme, line: BarLine, error: float) -> float:
    """Return the place of an extreme; if it is the same within its error over a length, the beginning of that."""
    with np.errstate(invalid="ignore"):
        is_same = np.abs(line.values - extreme.value) <= error
    return min(float(line.s[is_same][0]), extreme.s) if is_same.any() else extreme.s


def is_varying_at(s: float, load_range: BarRange, error: float) -> bool:
    """Return whether a quantity changes with time at a place by more than its error."""
    nearest = np.abs(load_range.s - s) <= np.abs(load_range.s - s).min()
    return bool(np.nanmax(load_range.high[nearest]) - np.nanmin(load_range.low[nearest]) > 2.0 * error)
