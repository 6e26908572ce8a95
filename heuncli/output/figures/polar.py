"""Vectors over a run as curves of their tips: where on a journal, in a shell or on the ground a load points.

Marks along a curve are angles of what turns, or instants where nothing turns on.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from heuncli.output.drawing.figure import Arrow, Figure, Item, Panel, Scaling, Spot, Trace
from heuncli.output.drawing.ticks import ends, ticks
from heuncli.output.figures.certain import certain
from heuncli.output.figures.courses import Pictured, title_of, vectors_at
from heuncli.output.figures.polar_words import notes_of, seen
from heuncli.output.figures.tips import Largest, TipCurve, largest_of, tip_curves
from heuncli.output.figures.turning import TurningRun
from heuncli.results.results import Array
from heuncli.study.quantities.table_units import Units
from heuncli.study.search.extremes import sides_of_jumps

HEIGHT = 460.0  # pixels
SLIM = 0.75  # of the longer side of a panel, what the shorter is at least
STEPS = (30, 45, 90, 180, 360, 720, 1440, 3600)  # degrees between marks
MOST_MARKS = 16
INSTANTS = 9  # marks of a run in which nothing turns on
ROOM = (0.08, 0.04)  # of a panel's width and height: nearer to other words none are written
CROWD = 2  # other marks within that, of which some have words
HEADINGS = (0.2, 0.55, 0.9)  # of a curve's points: where its direction is shown
HEADING, WIDE = 14.0, 700.0  # pixels: how long such an arrow is, and how wide a panel may be
JUMP = 0.01  # of a panel's width: what is drawn as a jump


def polar(
    sources: Sequence[Pictured], paths: Sequence[str], units: Units, axes: str = "world", view: str | None = None
) -> Figure:
    """The figure of some vectors; axes: of joints; view: the axis that they are seen along.

    Raises NotDrawable.
    """
    curves = list(tip_curves(sources, paths, axes, view))
    groups: dict[tuple[object, ...], list[TipCurve]] = {}
    for curve in curves:
        groups.setdefault((curve.unit, curve.plane.key), []).append(curve)
    largest = {curve.pen: largest_of(curve) for curve in curves}
    panels = [_panel(group, largest, units) for group in groups.values()]
    words = list(seen(sources, curves, axes))
    notes = [note for curve in curves for note in notes_of(curve, largest[curve.pen], units)]
    return Figure(title_of(sources), words, panels, [(curve.name, curve.pen) for curve in curves], notes)


def _panel(group: Sequence[TipCurve], largest: Mapping[int, Largest | None], units: Units) -> Panel:
    """The curves of one unit in one plane, with equal axes about their origin."""
    unit, size = units.of(group[0].unit)
    found = [own for curve in group if (own := largest[curve.pen]) is not None]
    unknown = size * max((own.error for own in found if own.size <= own.error), default=0.0)
    across, up = _sides([size * curve.x for curve in group], [size * curve.y for curve in group], unknown)
    quantity = _quantity(group)
    first, second = group[0].plane.names
    x, y = Scaling(f"{quantity}.{first} [{unit}]", *across), Scaling(f"{quantity}.{second} [{unit}]", *up)
    items: list[Item] = [Spot(0.0, 0.0, "", None, "square", filled=True)]
    written: list[tuple[float, float]] = [(0.0, 0.0)]
    for curve in group:
        items += _curve(curve, largest[curve.pen], size, unit, (x, y))
        own = largest[curve.pen]
        if own is not None:
            written.append((size * own.x, size * own.y))
    items += _marked(group, size, (x, y), written)
    return Panel(x, y, tuple(items), HEIGHT, equal=True)


def _sides(xs: Sequence[Array], ys: Sequence[Array], unknown: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """The ends of both axes, the origin between them, neither side too slim; unknown: the error of what is within it.

    So rounding is a point, not a curve.
    """
    sides = []
    for values in (np.concatenate(xs), np.concatenate(ys)):
        known = values[np.isfinite(values)]
        sides.append((float(known.min(initial=-unknown)), float(known.max(initial=unknown))))
    longest = max(high - low for low, high in sides) or 1.0
    found = []
    for low, high in sides:
        missing = max(0.0, SLIM * longest - (high - low)) / 2.0
        found.append(ends(low - missing, high + missing, spare=0.1))
    return found[0], found[1]


def _quantity(group: Sequence[TipCurve]) -> str:
    """What is drawn, if all is of one kind."""
    names = {curve.path.rpartition(".")[2] for curve in group}
    return names.pop() if len(names) == 1 else "component"


def _curve(
    curve: TipCurve, largest: Largest | None, size: float, unit: str, sides: tuple[Scaling, Scaling]
) -> Iterator[Item]:
    """A curve with its direction and its largest vector."""
    x, y = size * curve.x, size * curve.y
    yield Trace(curve.name, *_broken(curve.turning.times, x, y, sides[0].high - sides[0].low), curve.pen)
    unit_a_pixel = max((sides[0].high - sides[0].low) / WIDE, (sides[1].high - sides[1].low) / HEIGHT)
    yield from _headings(x, y, curve.pen, HEADING * unit_a_pixel)
    if largest is not None and largest.size > 0.0 and not largest.steady:
        yield Arrow(0.0, 0.0, size * largest.x, size * largest.y, curve.pen)
        text = f"{certain(size * largest.size, size * largest.error)} {unit}"
        yield Spot(size * largest.x, size * largest.y, text, curve.pen, "circle", filled=True)


def _marked(
    group: Sequence[TipCurve], size: float, sides: tuple[Scaling, Scaling], written: list[tuple[float, float]]
) -> Iterator[Spot]:
    """The marks along curves, with words where these are not in a crowd; written: where other words stand."""
    marks: list[tuple[int, tuple[float, float], str]] = []
    for curve in group:
        found = _marks(curve.turning)
        vectors = size * vectors_at(curve.study, curve.path, np.array([at for at, _ in found]))
        places = zip(*(own.tolist() for own in curve.plane.project(vectors)), strict=True)
        marks += [(curve.pen, place, text) for place, (_, text) in zip(places, found, strict=True)]
    known = [mark for mark in marks if all(map(math.isfinite, mark[1]))]
    for number, place, text in known:
        crowd = sum(_near(place, other, sides) for _, other, _ in known) - 1
        free = crowd <= CROWD and not any(_near(place, other, sides) for other in written)
        yield Spot(*place, text if free else "", number)
        written += [place] if free else []


def _broken(times: Array, x: Array, y: Array, width: float) -> tuple[Array, Array]:
    """The tips (n,), apart where they jump."""
    jumps = sides_of_jumps(times) & (np.hypot(np.diff(x), np.diff(y)) > JUMP * width)
    at = np.flatnonzero(jumps) + 1
    return np.insert(x, at, np.nan), np.insert(y, at, np.nan)


def _headings(x: Array, y: Array, number: int, length: float) -> Iterator[Arrow]:
    """Short arrows along a curve, the way that time goes."""
    for share in HEADINGS:
        k = int(share * (len(x) - 1))
        way = np.hypot(x[k + 1 :] - x[k], y[k + 1 :] - y[k])
        on = np.flatnonzero(way >= 0.5 * length)
        if len(on):
            j = k + 1 + int(on[0])
            scale = length / float(way[on[0]])
            yield Arrow(x[k], y[k], scale * (x[j] - x[k]), scale * (y[j] - y[k]), number)


def _marks(turning: TurningRun) -> list[tuple[float, str]]:
    """Instants that are marked along curves, ascending, and what is written there: angles, or the instants."""
    times = turning.times
    if not turning.path:
        scaling = Scaling("", float(times[0]), float(times[-1]))
        return [(min(max(t, times[0]), times[-1]), f"{text} s") for t, text in ticks(scaling, INSTANTS)]
    counted = turning.counted
    low, high = sorted((float(counted[0]), float(counted[-1])))
    many = math.ceil((high - low) / STEPS[-1] / MOST_MARKS)
    step = next((step for step in STEPS if (high - low) / step <= MOST_MARKS), STEPS[-1] * many)
    whole = 360.0 * turning.turns
    marked = [step * k for k in range(math.ceil(low / step - 1e-6), math.floor(high / step + 1e-6) + 1)]
    marked = [degrees for degrees in marked if not turning.turns or degrees < low + whole - 1e-3]
    order = slice(None) if counted[-1] > counted[0] else slice(None, None, -1)
    at = np.interp(marked, counted[order], times[order])
    names = [degrees % whole if whole else degrees for degrees in marked]
    return sorted((float(t), f"{degrees:g}°") for t, degrees in zip(at, names, strict=True))


def _near(place: tuple[float, float], other: tuple[float, float], sides: tuple[Scaling, Scaling]) -> bool:
    """Whether words at one place would stand in those at another."""
    return all(
        abs(a - b) < room * (side.high - side.low) for a, b, room, side in zip(place, other, ROOM, sides, strict=True)
    )
