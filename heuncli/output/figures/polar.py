"""Polar diagrams: vectors over a run as curves of their tips, such as where a load points on a journal or in a shell.

Marks along a curve are angles of the crank, or instants if nothing keeps turning.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from heuncli.output.drawing.figure import Arrow, Figure, Item, Panel, Scaling, Spot, Trace
from heuncli.output.drawing.ticks import choose_ends, choose_ticks
from heuncli.output.figures.certain import format_certain
from heuncli.output.figures.courses import FigureSource, find_vectors, make_title
from heuncli.output.figures.polar_words import describe_runs, make_notes
from heuncli.output.figures.tips import LargestVector, TipCurve, find_largest, make_tip_curves
from heuncli.output.figures.turning import TurningRun
from heuncli.results.results import Array
from heuncli.study.quantities.table_units import Units
from heuncli.study.search.extremes import find_jump_sides

HEIGHT = 460.0  # pixels
MIN_ASPECT = 0.75  # minimum ratio of the sides of a panel
MARK_STEPS = (30, 45, 90, 180, 360, 720, 1440, 3600)  # degrees between marks
MAX_MARKS = 16
N_INSTANT_MARKS = 9  # marks of a run that does not keep turning
LABEL_SPACE = (0.08, 0.04)  # shares of a panel's width and height between labels
MAX_NEIGHBOURS = 2  # other marks within that space; with more there is no label
ARROW_PLACES = (0.2, 0.55, 0.9)  # shares of a curve's points at which its direction is shown
ARROW_LENGTH, MAX_WIDTH = 14.0, 700.0  # pixels
VISIBLE_JUMP = 0.01  # share of a panel's width: larger jumps are drawn as jumps


def make_polar_figure(
    sources: Sequence[FigureSource], paths: Sequence[str], units: Units, axes: str = "world", view: str | None = None
) -> Figure:
    """Make the figure of some vectors.

    axes: the axes in which loads of joints are given
    view: the world axis along which they are seen

    Raises NotDrawable.
    """
    curves = list(make_tip_curves(sources, paths, axes, view))
    groups: dict[tuple[object, ...], list[TipCurve]] = {}
    for curve in curves:
        groups.setdefault((curve.unit, curve.plane.key), []).append(curve)
    largest = {curve.pen: find_largest(curve) for curve in curves}
    panels = [_make_panel(group, largest, units) for group in groups.values()]
    words = list(describe_runs(sources, curves, axes))
    notes = [note for curve in curves for note in make_notes(curve, largest[curve.pen], units)]
    return Figure(make_title(sources), words, panels, [(curve.name, curve.pen) for curve in curves], notes)


def _make_panel(group: Sequence[TipCurve], largest: Mapping[int, LargestVector | None], units: Units) -> Panel:
    """Make the panel of the curves of one unit in one plane, with equal scales about the origin."""
    unit, size = units.find(group[0].unit)
    known_largest = [largest_vector for curve in group if (largest_vector := largest[curve.pen]) is not None]
    unknown = size * max(
        (largest_vector.error for largest_vector in known_largest if largest_vector.magnitude <= largest_vector.error),
        default=0.0,
    )
    x_limits, y_limits = _choose_limits(
        [size * curve.x for curve in group], [size * curve.y for curve in group], unknown
    )
    quantity = _find_quantity(group)
    first, second = group[0].plane.names
    x, y = Scaling(f"{quantity}.{first} [{unit}]", *x_limits), Scaling(f"{quantity}.{second} [{unit}]", *y_limits)
    items: list[Item] = [Spot(0.0, 0.0, "", None, "square", is_filled=True)]
    label_places: list[tuple[float, float]] = [(0.0, 0.0)]
    for curve in group:
        items += _draw_curve(curve, largest[curve.pen], size, unit, (x, y))
        largest_vector = largest[curve.pen]
        if largest_vector is not None:
            label_places.append((size * largest_vector.x, size * largest_vector.y))
    items += _draw_marks(group, size, (x, y), label_places)
    return Panel(x, y, tuple(items), HEIGHT, has_equal_scales=True)


def _choose_limits(
    xs: Sequence[Array], ys: Sequence[Array], unknown: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the limits of both axes, which include the origin; neither side is too short.

    unknown: the error of vectors that are smaller than their error, so that rounding appears as a point and not as a
    curve
    """
    ranges = []
    for values in (np.concatenate(xs), np.concatenate(ys)):
        known = values[np.isfinite(values)]
        ranges.append((float(known.min(initial=-unknown)), float(known.max(initial=unknown))))
    longest = max(high - low for low, high in ranges) or 1.0
    limits = []
    for low, high in ranges:
        missing = max(0.0, MIN_ASPECT * longest - (high - low)) / 2.0
        limits.append(choose_ends(low - missing, high + missing, margin=0.1))
    return limits[0], limits[1]


def _find_quantity(group: Sequence[TipCurve]) -> str:
    """Return the name of the quantity, if all curves have the same."""
    names = {curve.path.rpartition(".")[2] for curve in group}
    return names.pop() if len(names) == 1 else "component"


def _draw_curve(
    curve: TipCurve, largest: LargestVector | None, size: float, unit: str, sides: tuple[Scaling, Scaling]
) -> Iterator[Item]:
    """Draw a curve with its direction and its largest vector."""
    x, y = size * curve.x, size * curve.y
    yield Trace(curve.name, *_break_at_jumps(curve.turning.times, x, y, sides[0].high - sides[0].low), curve.pen)
    pixel_size = max((sides[0].high - sides[0].low) / MAX_WIDTH, (sides[1].high - sides[1].low) / HEIGHT)
    yield from _draw_direction_arrows(x, y, curve.pen, ARROW_LENGTH * pixel_size)
    if largest is not None and largest.magnitude > 0.0 and not largest.is_constant:
        yield Arrow(0.0, 0.0, size * largest.x, size * largest.y, curve.pen)
        text = f"{format_certain(size * largest.magnitude, size * largest.error)} {unit}"
        yield Spot(size * largest.x, size * largest.y, text, curve.pen, "circle", is_filled=True)


def _draw_marks(
    group: Sequence[TipCurve], size: float, sides: tuple[Scaling, Scaling], label_places: list[tuple[float, float]]
) -> Iterator[Spot]:
    """Draw the marks along curves, with labels where they are not crowded.

    label_places: where other labels stand
    """
    marks: list[tuple[int, tuple[float, float], str]] = []
    for curve in group:
        marks_of_curve = _find_marks(curve.turning)
        vectors = size * find_vectors(curve.study, curve.path, np.array([time for time, _ in marks_of_curve]))
        places = zip(*(components.tolist() for components in curve.plane.project(vectors)), strict=True)
        marks += [(curve.pen, place, text) for place, (_, text) in zip(places, marks_of_curve, strict=True)]
    known_marks = [mark for mark in marks if all(map(math.isfinite, mark[1]))]
    for number, place, text in known_marks:
        n_neighbours = sum(_would_overlap(place, other, sides) for _, other, _ in known_marks) - 1
        has_room = n_neighbours <= MAX_NEIGHBOURS and not any(
            _would_overlap(place, other, sides) for other in label_places
        )
        yield Spot(*place, text if has_room else "", number)
        label_places += [place] if has_room else []


def _break_at_jumps(times: Array, x: Array, y: Array, width: float) -> tuple[Array, Array]:
    """Insert gaps into the tips (n,) where they jump."""
    jumps = find_jump_sides(times) & (np.hypot(np.diff(x), np.diff(y)) > VISIBLE_JUMP * width)
    break_places = np.flatnonzero(jumps) + 1
    return np.insert(x, break_places, np.nan), np.insert(y, break_places, np.nan)


def _draw_direction_arrows(x: Array, y: Array, number: int, length: float) -> Iterator[Arrow]:
    """Draw short arrows along a curve in the direction of time."""
    for share in ARROW_PLACES:
        k = int(share * (len(x) - 1))
        distances = np.hypot(x[k + 1 :] - x[k], y[k + 1 :] - y[k])
        far_enough = np.flatnonzero(distances >= 0.5 * length)
        if len(far_enough):
            j = k + 1 + int(far_enough[0])
            scale = length / float(distances[far_enough[0]])
            yield Arrow(x[k], y[k], scale * (x[j] - x[k]), scale * (y[j] - y[k]), number)


def _find_marks(turning: TurningRun) -> list[tuple[float, str]]:
    """Return the instants of marks along curves, ascending, and their labels: angles, or the instants."""
    times = turning.times
    if not turning.path:
        scaling = Scaling("", float(times[0]), float(times[-1]))
        return [(min(max(t, times[0]), times[-1]), f"{text} s") for t, text in choose_ticks(scaling, N_INSTANT_MARKS)]
    degrees_of_run = turning.degrees
    low, high = sorted((float(degrees_of_run[0]), float(degrees_of_run[-1])))
    many = math.ceil((high - low) / MARK_STEPS[-1] / MAX_MARKS)
    step = next((step for step in MARK_STEPS if (high - low) / step <= MAX_MARKS), MARK_STEPS[-1] * many)
    cycle = 360.0 * turning.turns
    mark_angles = [step * k for k in range(math.ceil(low / step - 1e-6), math.floor(high / step + 1e-6) + 1)]
    mark_angles = [degrees for degrees in mark_angles if not turning.turns or degrees < low + cycle - 1e-3]
    order = slice(None) if degrees_of_run[-1] > degrees_of_run[0] else slice(None, None, -1)
    mark_times = np.interp(mark_angles, degrees_of_run[order], times[order])
    names = [degrees % cycle if cycle else degrees for degrees in mark_angles]
    return sorted((float(t), f"{degrees:g}°") for t, degrees in zip(mark_times, names, strict=True))


def _would_overlap(place: tuple[float, float], other: tuple[float, float], sides: tuple[Scaling, Scaling]) -> bool:
    """Return whether a label at one place would overlap one at another."""
    return all(
        abs(a - b) < room * (side.high - side.low)
        for a, b, room, side in zip(place, other, LABEL_SPACE, sides, strict=True)
    )
