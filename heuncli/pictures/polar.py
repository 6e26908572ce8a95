"""Vectors over a run as curves of their tips: where on a journal, in a shell or on the ground a load points.

The largest is that of the parts in the plane, searched between the samples. Marks along a curve are angles of what
turns, or instants where nothing turns on.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from heuncli.drawing.figure import Arrow, Figure, Item, Panel, Scaling, Spot, Trace
from heuncli.drawing.ticks import ends, short, ticks
from heuncli.named_tuples import NamedTuple
from heuncli.pictures.certain import certain
from heuncli.pictures.courses import Pictured, instants, vectors_at
from heuncli.pictures.planes import Plane, plane_of, plane_seen_along
from heuncli.pictures.refusals import NotDrawable
from heuncli.pictures.turning import TurningRun, angles_of, turning_of
from heuncli.report.table_units import Units
from heuncli.results import Array
from heuncli.results_schema import SPACE
from heuncli.study.ask.measure import stated_error
from heuncli.study.ask.study import Study
from heuncli.study.search import extremes
from heuncli.study.search.extremes import sides_of_jumps
from heuncli.variants.stated import unit_of

HEIGHT = 460.0  # pixels
SLIM = 0.75  # of the longer side of a panel, what the shorter is at least
STEPS = (30, 45, 90, 180, 360, 720, 1440, 3600)  # degrees between marks
MOST_MARKS = 24
INSTANTS = 9  # marks of a run in which nothing turns on
ROOM = (0.08, 0.04)  # of a panel's width and height: nearer to other words none are written
HEADINGS = (0.2, 0.55, 0.9)  # of a curve's points: where its direction is shown
HEADING, WIDE = 14.0, 700.0  # pixels: how long such an arrow is, and how wide a panel may be
JUMP = 0.01  # of a panel's width: what is drawn as a jump
THRUST = 1e-6  # of the largest vector: what stands across the plane and is worth a note


class TipCurve(NamedTuple):
    """The tips of a vector: (n, 3), in a plane, over the instants of a turning; named in the legend, with its pen."""

    name: str
    path: str
    unit: str
    pen: int
    study: Study
    turning: TurningRun
    vectors: Array
    plane: Plane

    @property
    def x(self) -> Array:
        """To the right."""
        return np.asarray(self.vectors @ self.plane.right)

    @property
    def y(self) -> Array:
        """Up."""
        return np.asarray(self.vectors @ self.plane.up)


class Largest(NamedTuple):
    """The largest vector: its two parts, its magnitude in the plane and its stated error, its instant."""

    x: float
    y: float
    size: float
    error: float
    at: float


def polar(
    sources: Sequence[Pictured], paths: Sequence[str], units: Units, axes: str = "world", view: str | None = None
) -> Figure:
    """The figure of some vectors; axes: of joints; view: the axis that they are seen along.

    Raises NotDrawable.
    """
    curves = list(_curves(sources, paths, axes, view))
    groups: dict[tuple[object, ...], list[TipCurve]] = {}
    for curve in curves:
        groups.setdefault((curve.unit, curve.plane.key), []).append(curve)
    largest = {curve.pen: _largest(curve) for curve in curves}
    panels = [_panel(group, largest, units) for group in groups.values()]
    words = [f"{_called(source)}: {curve.turning.in_words}" for source, curve in _firsts(sources, curves)]
    words.append(_axes_in_words(axes, curves))
    notes = [note for curve in curves for note in _notes(curve, largest[curve.pen], units)]
    title = sources[0].study.results.title
    return Figure(title, words, panels, [(curve.name, curve.pen) for curve in curves], notes)


def _curves(sources: Sequence[Pictured], paths: Sequence[str], axes: str, view: str | None) -> Iterator[TipCurve]:
    """The curves, each with its pen."""
    number = 0
    for source in sources:
        study = source.study
        for path in paths:
            _require_vector(study, path)
        turning = _turning(study, paths)
        for path in paths:
            vectors = vectors_at(study, path, turning.times)
            plane = (
                plane_seen_along(view)
                if view is not None
                else plane_of(study, path, vectors, turning.times, axes, turning.path)
            )
            name = f"{source.name}: {path}" if source.name else path
            yield TipCurve(name, path, unit_of(path, study.spec), number, study, turning, vectors, plane)
            number += 1


def _require_vector(study: Study, path: str) -> None:
    """Raise NotDrawable where there is no vector over the instants."""
    numbers = study.numbers(path)
    if numbers.axes != (SPACE,) or not numbers.timed:
        message = f"polar {path}: a polar diagram is of a vector over the instants, and this is none"
        raise NotDrawable(message, "such as polar joints.main, or polar foundation")
    if study.of_one_instant:
        message = f"polar {path}: there is one instant, and so no curve"
        raise NotDrawable(message, "give the scene a motion: analysis.duration")


def _turning(study: Study, paths: Sequence[str]) -> TurningRun:
    """What is seen of a run."""
    candidates = [path for path in angles_of(study.spec) if path.split(".")[1] in study.results.coordinates]
    return turning_of(
        study, instants(study), candidates, lambda t: np.hstack([vectors_at(study, path, t) for path in paths])
    )


def _largest(curve: TipCurve) -> Largest | None:
    """The largest vector in the plane; None where none is known."""
    study, plane = curve.study, curve.plane

    def sample(times: Array) -> Array:
        own = vectors_at(study, curve.path, times)
        return np.asarray(((own @ plane.right) ** 2 + (own @ plane.up) ** 2)[:, None])

    looked_at = study.search_times
    times = curve.turning.times
    times = np.union1d(times, looked_at[(looked_at >= times[0]) & (looked_at <= times[-1])])
    error = stated_error(study, study.numbers(curve.path).keys)
    found = extremes.search(sample, times, errors=np.array([error]), even=np.array([True]), sides=(1.0,))
    at = float(found.high_at[0])
    if not np.isfinite(found.high[0]):
        return None
    vector = vectors_at(study, curve.path, np.array([at]))[0]
    x, y = float(vector @ plane.right), float(vector @ plane.up)
    return Largest(x, y, math.sqrt(float(found.high[0])), 0.0 if math.isnan(error) else error, at)


def _panel(group: Sequence[TipCurve], largest: Mapping[int, Largest | None], units: Units) -> Panel:
    """The curves of one unit in one plane, with equal axes about their origin."""
    unit, size = units.of(group[0].unit)
    across, up = _sides([size * curve.x for curve in group], [size * curve.y for curve in group])
    quantity = _quantity(group)
    first, second = group[0].plane.names
    x, y = Scaling(f"{quantity}.{first} [{unit}]", *across), Scaling(f"{quantity}.{second} [{unit}]", *up)
    items: list[Item] = [Spot(0.0, 0.0, "", None, "square", filled=True)]
    written: list[tuple[float, float]] = [(0.0, 0.0)]
    for curve in group:
        items += _curve(curve, largest[curve.pen], size, unit, (x, y), written)
    return Panel(x, y, tuple(items), HEIGHT, equal=True)


def _sides(xs: Sequence[Array], ys: Sequence[Array]) -> tuple[tuple[float, float], tuple[float, float]]:
    """The ends of both axes, the origin between them, neither side too slim."""
    sides = []
    for values in (np.concatenate(xs), np.concatenate(ys)):
        known = values[np.isfinite(values)]
        sides.append((float(known.min(initial=0.0)), float(known.max(initial=0.0))))
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
    curve: TipCurve, largest: Largest | None, size: float, unit: str, sides: tuple[Scaling, Scaling],
    written: list[tuple[float, float]],
) -> Iterator[Item]:  # fmt: skip
    """A curve with its direction, its marks and its largest vector."""
    x, y = size * curve.x, size * curve.y
    yield Trace(curve.name, *_broken(curve.turning.times, x, y, sides[0].high - sides[0].low), curve.pen)
    unit_a_pixel = max((sides[0].high - sides[0].low) / WIDE, (sides[1].high - sides[1].low) / HEIGHT)
    yield from _headings(x, y, curve.pen, HEADING * unit_a_pixel)
    if largest is not None and largest.size > 0.0:
        yield Arrow(0.0, 0.0, size * largest.x, size * largest.y, curve.pen)
        text = f"{certain(size * largest.size, size * largest.error)} {unit}"
        yield Spot(size * largest.x, size * largest.y, text, curve.pen, "circle", filled=True)
        written.append((size * largest.x, size * largest.y))
    for at, text in _marks(curve.turning):
        vector = vectors_at(curve.study, curve.path, np.array([at]))[0]
        place = size * float(vector @ curve.plane.right), size * float(vector @ curve.plane.up)
        if not all(map(math.isfinite, place)):
            continue
        free = not any(_near(place, other, sides) for other in written)
        yield Spot(*place, text if free else "", curve.pen)
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
    """Instants that are marked along curves, and what is written there: angles, or the instants themselves."""
    times = turning.times
    if not turning.path:
        scaling = Scaling("", float(times[0]), float(times[-1]))
        return [(min(max(t, times[0]), times[-1]), f"{text} s") for t, text in ticks(scaling, INSTANTS)]
    counted = turning.counted
    low, high = sorted((float(counted[0]), float(counted[-1])))
    step = next((step for step in STEPS if (high - low) / step <= MOST_MARKS), STEPS[-1])
    whole = 360.0 * turning.turns
    marked = [step * k for k in range(math.ceil(low / step - 1e-6), math.floor(high / step + 1e-6) + 1)]
    marked = [degrees for degrees in marked if not turning.turns or degrees < low + whole - 1e-3]
    order = slice(None) if counted[-1] > counted[0] else slice(None, None, -1)
    at = np.interp(marked, counted[order], times[order])
    names = [degrees % whole if whole else degrees for degrees in marked]
    return [(float(t), f"{degrees:g}°") for t, degrees in zip(at, names, strict=True)]


def _near(place: tuple[float, float], other: tuple[float, float], sides: tuple[Scaling, Scaling]) -> bool:
    """Whether words at one place would stand in those at another."""
    return all(
        abs(a - b) < room * (side.high - side.low) for a, b, room, side in zip(place, other, ROOM, sides, strict=True)
    )


def _firsts(sources: Sequence[Pictured], curves: Sequence[TipCurve]) -> Iterator[tuple[Pictured, TipCurve]]:
    """Each source with the first of its curves."""
    for source in sources:
        yield source, next(curve for curve in curves if curve.study is source.study)


def _called(source: Pictured) -> str:
    """How a run is called in the line that tells what is seen of it."""
    return source.name or str(source.study.results.spec.get("path", ""))


def _axes_in_words(axes: str, curves: Sequence[TipCurve]) -> str:
    """Whose loads these are, in which axes."""
    joints = [curve for curve in curves if curve.path.startswith("joints.")]
    on = "of a joint: what `from` exerts ON `to`; of the foundation: ON it; "
    if axes == "world" or not joints:
        return f"{on}world axes"
    bodies = {_body_of(curve, axes) for curve in joints}
    return f"{on}joints in the axes of {', '.join(sorted(bodies))} (`{axes}`)"


def _body_of(curve: TipCurve, axes: str) -> str:
    """The body whose axes a joint's loads are told in."""
    joint = curve.study.spec.joints[curve.path.split(".")[1]]
    return joint.a if axes == "from" else joint.b


def _notes(curve: TipCurve, largest: Largest | None, units: Units) -> Iterator[str]:
    """The largest with its direction and instant; what is not drawn."""
    unit, size = units.of(curve.unit)
    if largest is None:
        yield f"{curve.name}: open or not known, and not drawn"
        return
    first, second = curve.plane.names
    when = f"at t = {short(float(f'{largest.at:.5g}'))} s"
    if curve.turning.path:
        angle = float(np.interp(largest.at, curve.turning.times, curve.turning.counted))
        whole = 360.0 * curve.turning.turns
        when += f", {curve.turning.path} = {_degrees(angle, whole)}"
    way = f"towards {_degrees(math.degrees(math.atan2(largest.y, largest.x)), 360.0)} from {first} to {second}"
    yield f"{curve.name}: largest {certain(size * largest.size, size * largest.error)} {unit} {way}, {when}"
    along = float(np.nanmax(np.abs(curve.vectors @ curve.plane.across), initial=0.0))
    if along > THRUST * largest.size:
        yield f"{curve.name}: across the plane up to {size * along:.4g} {unit}, not drawn"
    if np.isnan(curve.vectors).any():
        yield f"{curve.name}: open or not known in parts, and not drawn there"
    if "1" in curve.plane.names:
        words = (f"({', '.join(f'{x:.4g}' for x in e + 0.0)})" for e in (curve.plane.right, curve.plane.up))
        yield f"{curve.name}: directions 1 and 2 are {' and '.join(words)}"


def _degrees(angle: float, whole: float) -> str:
    """An angle to four digits, of a circle or a cycle within that; whole: 0 where it is counted on."""
    told = float(f"{angle % whole if whole else angle:.4g}")
    return f"{0.0 if whole and told >= whole else told:g}°"
