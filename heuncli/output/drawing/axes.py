"""The axes of a panel: their ends and round numbers, the pixels of their values, and how they are drawn."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.output.drawing import style
from heuncli.output.drawing.figure import Scaling
from heuncli.output.drawing.shapes import Line, Shape, Text
from heuncli.results.results import Array

MINUS = "\N{MINUS SIGN}"
MANTISSAS = (1.0, 2.0, 5.0, 10.0)
ANGLE_STEPS = (15.0, 30.0, 45.0, 90.0, 180.0, 360.0)  # degrees
MAX_DECIMALS, MIN_LARGE = 4, 1e6  # an axis with more decimals or larger numbers has exponents
END_MARGIN = 0.06  # of the range, at both ends
ZERO_SHARE = 0.3
MAX_STEPS = 1e8  # steps from zero: farther numbers are too long for an axis


def choose_ticks(scaling: Scaling, max_ticks: int) -> list[tuple[float, str]]:
    """Choose round numbers between the ends of an axis, ascending, with their texts."""
    if scaling.tick_texts:
        return list(scaling.tick_texts)
    if scaling.is_logarithmic:
        decades = _choose_decades(scaling.low, scaling.high, max_ticks)
        if len(decades) > 1:
            return decades  # else the axis is so short that linear ticks are better
    span = scaling.high - scaling.low
    is_angle = "[deg]" in scaling.label or "[°]" in scaling.label
    step = _choose_step(span / max(max_ticks, 1), is_angle=is_angle)
    first, last = math.ceil(scaling.low / step - 1e-9), math.floor(scaling.high / step + 1e-9)
    if last <= first:  # one number does not show the scale
        step = _choose_step(span / 5.0, is_angle=is_angle)
        first, last = math.ceil(scaling.low / step - 1e-9), math.floor(scaling.high / step + 1e-9)
    if max(abs(first), abs(last)) > MAX_STEPS:
        return []
    values = [k * step for k in range(first, last + 1)]
    places = 0 if is_angle and step in ANGLE_STEPS else -math.floor(math.log10(step) + 1e-9)
    has_exponent = max(map(abs, values)) >= MIN_LARGE or places > MAX_DECIMALS
    return [(value, format_tick(value, places, has_exponent=has_exponent)) for value in values]


def _choose_step(min_step: float, *, is_angle: bool) -> float:
    """Return the smallest round step that is not below `min_step`."""
    if is_angle and 10.0 < min_step <= ANGLE_STEPS[-1]:
        return next(step for step in ANGLE_STEPS if step >= min_step)
    power = 10.0 ** math.floor(math.log10(min_step))
    return next(power * mantissa for mantissa in MANTISSAS if power * mantissa >= min_step * (1.0 - 1e-12))


def _choose_decades(low: float, high: float, max_ticks: int) -> list[tuple[float, str]]:
    """Choose powers of ten, and multiples between them if there are few."""
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    for multiples in ((1, 2, 3, 5, 7), (1, 2, 5), (1, 3), (1,)):
        values = [m * 10.0**k for k in powers for m in multiples]
        within = [v for v in values if low * (1.0 - 1e-9) <= v <= high * (1.0 + 1e-9)]
        if len(within) <= max_ticks or multiples == (1,):
            stride = max(1, math.ceil(len(within) / max(max_ticks, 1)))
            return [(v, format_short(v)) for v in within[::stride]]
    return []


def format_tick(value: float, places: int, *, has_exponent: bool) -> str:
    """Format a round number with so many decimals, or with an exponent."""
    if value == 0.0:
        return "0"
    if not has_exponent:
        return write_minus(f"{value:.{max(places, 0)}f}")
    digits = max(0, places + math.floor(math.log10(abs(value)) + 1e-9))
    mantissa, _, exponent = f"{value:.{digits}e}".partition("e")
    return write_minus(f"{mantissa.rstrip('0').rstrip('.') if '.' in mantissa else mantissa}e{int(exponent)}")


def format_short(value: float, digits: int = 6) -> str:
    """Format a number with at most six digits and a short exponent, such as 1e7 or 2.5e-6."""
    mantissa, e, exponent = f"{float(f'{value:.{digits}g}'):.6g}".partition("e")
    return write_minus(mantissa + (f"e{int(exponent)}" if e else ""))


def write_minus(text: str) -> str:
    """Replace the hyphens of a number by minus signs (U+2212)."""
    return text.replace("-", MINUS)


def is_zero_near(low: float, high: float) -> bool:
    """Return whether an axis should include zero: the smaller magnitude is below ZERO_SHARE of the larger."""
    return low <= 0.0 <= high or min(abs(low), abs(high)) < ZERO_SHARE * max(abs(low), abs(high))


def choose_ends(low: float, high: float, *, zero: bool = False, margin: float = END_MARGIN) -> tuple[float, float]:
    """Choose the ends of an axis for values in this range, with a margin; zero: it must be on the axis, and is its end
    if all values have one sign.
    """
    if zero:
        low, high = min(low, 0.0), max(high, 0.0)
    span = high - low
    if not span > 1e-12 * max(abs(low), abs(high)):
        span = abs(low) or 1.0
        return low - 0.5 * span, high + 0.5 * span
    return low - margin * span * (not zero or low < 0.0), high + margin * span * (not zero or high > 0.0)


class PanelBox(NamedTuple):
    """The field of a panel in pixels, and its axes."""

    left: float
    top: float
    right: float
    bottom: float
    x_scaling: Scaling
    y_scaling: Scaling

    def to_pixel_x(self, value: float) -> float:
        """Return the pixel of a value on the horizontal axis."""
        return self.left + self.x_scaling.to_share(value) * (self.right - self.left)

    def to_pixel_y(self, value: float) -> float:
        """Return the pixel of a value on the vertical axis."""
        return self.bottom - self.y_scaling.to_share(value) * (self.bottom - self.top)

    def to_pixels(self, x: Array, y: Array) -> Array:
        """Return the pixels of points, (n, 2)."""
        return np.column_stack(
            [_scale_values(self.to_pixel_x, x, self.x_scaling), _scale_values(self.to_pixel_y, y, self.y_scaling)]
        )


def _scale_values(to_pixel: Callable[[float], float], values: Array, scaling: Scaling) -> Array:
    """Return the pixels of many values on an axis."""
    values = np.asarray(values, dtype=np.float64)
    if scaling.is_logarithmic:
        with np.errstate(invalid="ignore", divide="ignore"):
            values = np.log(values)
        low, high = math.log(scaling.low), math.log(scaling.high)
    else:
        low, high = scaling.low, scaling.high
    first, last = to_pixel(scaling.low), to_pixel(scaling.high)
    return np.asarray(first + (values - low) / (high - low) * (last - first))


def lay_out_axes(box: PanelBox) -> tuple[list[Shape], list[Shape]]:
    """Return the grid, which is below all else, and the zero lines, the axes with their numbers, and the labels."""
    width, height = box.right - box.left, box.bottom - box.top
    max_ticks = max(3, int(width / style.PER_TICK_X)), max(2, int(height / style.PER_TICK_Y))
    grid: list[Shape] = []
    axes: list[Shape] = []
    for value, text in choose_ticks(box.x_scaling, max_ticks[0]):
        x = box.to_pixel_x(value)
        is_zero = _is_zero(value, box.x_scaling)
        colour = style.GREY if is_zero else style.FAINT
        (axes if is_zero else grid).append(Line(((x, box.top), (x, box.bottom)), colour, style.GRID_WIDTH))
        axes.append(Line(((x, box.bottom), (x, box.bottom + style.TICK_LENGTH)), style.GREY, style.GRID_WIDTH))
        if box.x_scaling.shown_label:
            axes.append(Text(x, box.bottom + 18.0, escape(text), style.SMALL_SIZE, "middle"))
    for value, text in choose_ticks(box.y_scaling, max_ticks[1]):
        y = box.to_pixel_y(value)
        is_zero = _is_zero(value, box.y_scaling)
        colour = style.GREY if is_zero else style.FAINT
        (axes if is_zero else grid).append(Line(((box.left, y), (box.right, y)), colour, style.GRID_WIDTH))
        axes.append(Text(box.left - 7.0, y + 4.0, escape(text), style.SMALL_SIZE, "end"))
    corners = (box.left, box.top), (box.left, box.bottom), (box.right, box.bottom)
    axes.append(Line(corners, style.BLACK, style.AXIS_WIDTH))
    if box.x_scaling.shown_label:
        middle = (box.left + box.right) / 2.0
        axes.append(Text(middle, box.bottom + 36.0, escape(box.x_scaling.shown_label), style.NAME_SIZE, "middle"))
    if box.y_scaling.label:
        label_place = max(box.left - 64.0, 16.0), (box.top + box.bottom) / 2.0
        axes.append(Text(*label_place, escape(box.y_scaling.label), style.NAME_SIZE, "middle", is_vertical=True))
    return grid, axes


def _is_zero(value: float, scaling: Scaling) -> bool:
    return value == 0.0 and not scaling.is_logarithmic and not scaling.tick_texts
