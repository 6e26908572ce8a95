"""Polar diagrams: vectors over a run as curves of their tips, such as where a load points on a journal or in a shell.

Marks along a curve are angles of the crank, or instants if nothing keeps turning.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.output.drawing.axes import choose_ends, choose_ticks, format_short
from heuncli.output.drawing.figure import Arrow, Figure, Item, Panel, Scaling, Spot, Strokes, Trace, Words
from heuncli.output.figures.courses import FigureSource, TurningRun, describe_number, find_vectors, make_title
from heuncli.output.figures.curves import choose_number_style, draw_direction_arrows, format_number
from heuncli.output.figures.tips import (
    LargestVector,
    TipCurve,
    find_firings,
    find_largest,
    make_tip_curves,
    project_vectors,
)
from heuncli.output.figures.windows import clip_strokes
from heuncli.results.results import Array
from heuncli.scene.file_format.names import GROUND
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.digits import UNKNOWN, ReaderStyle
from heuncli.study.quantities.labels import make_labels
from heuncli.study.quantities.table_units import Units
from heuncli.study.search.grid import find_jump_sides

HEIGHT = 520.0  # pixels
MIN_ASPECT = 0.75  # minimum ratio of the sides of a panel
MARK_STEPS = (30, 45, 90, 180, 360, 720, 1440, 3600)  # degrees between marks
MAX_MARKS, MAX_LABELS = 16, 9
N_INSTANT_MARKS = 9  # marks of a run that does not keep turning
LABEL_STEP = 90  # degrees between labels of marks
FIRING_PEN, N_ARROW_POINTS = 1, 40
ARROW_LENGTH, MAX_WIDTH = 14.0, 700.0  # pixels
VISIBLE_JUMP = 0.01  # share of a panel's width: larger jumps are drawn as jumps
RAY_STEP, ARC_STEP = 30, 3  # degrees
N_RINGS = 5  # the largest number up to the farther side of the window
RIM = 0.94  # share of a ray at which its angle stands
MARK_SPACE, LABEL_SPACE = 0.02, 0.1  # smallest distances of marks along a curve, and of their labels, in window sides
SAME_PLACE = 0.01  # of the distance of labels: marks that are closer share one
MIN_RAY = 0.2  # of the farthest point of the window: a shorter ray has no angle
MIN_RING_SPACE = 0.06  # of that: numbers of rings that are closer to a curve are worse than fewer numbers


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
    panels = [_make_panel(group, largest, units, axes) for group in groups.values()]
    words = list(describe_runs(sources, curves))
    notes = [note for curve in curves for note in make_notes(curve, largest[curve.pen], units)]
    return Figure(make_title(sources), words, panels, (), notes)


def _make_panel(
    group: Sequence[TipCurve], largest: Mapping[int, LargestVector | None], units: Units, axes: str
) -> Panel:
    """Make the panel of the curves of one unit in one plane, with equal scales about the origin."""
    known_largest = [largest_vector for curve in group if (largest_vector := largest[curve.pen]) is not None]
    style = choose_number_style(group[0].unit, max((vector.magnitude for vector in known_largest), default=0.0), units)
    per_si = style.per_si
    unknown = per_si * max(
        (largest_vector.error for largest_vector in known_largest if largest_vector.magnitude <= largest_vector.error),
        default=0.0,
    )
    x_limits, y_limits = _choose_limits(
        [per_si * curve.x for curve in group], [per_si * curve.y for curve in group], unknown
    )
    names = group[0].plane.names
    x, y = Scaling(names[0], *x_limits), Scaling(names[1], *y_limits)
    tips = [per_si * np.column_stack([curve.x, curve.y]) for curve in group]
    arrows = [per_si * np.linspace((0.0, 0.0), (vector.x, vector.y), N_ARROW_POINTS) for vector in known_largest]
    items: list[Item] = [*make_polar_grid((x, y), [*tips, *arrows], names, style.unit)]
    items.append(Spot(0.0, 0.0, "", None, "square", is_filled=True))
    for curve in group:
        items += _draw_curve(curve, largest[curve.pen], style, (x, y))
    items += _draw_marks(group, per_si, MARK_SPACE * (x.high - x.low), LABEL_SPACE * (x.high - x.low))
    captions = [curve.caption for curve in group]
    title = f"{captions[0]}: {describe_frame(group[0], axes)}" if len(group) == 1 else describe_frame(group[0], axes)
    legend = () if len(group) == 1 else tuple((curve.caption, curve.pen) for curve in group)
    return Panel(x, y, tuple(items), HEIGHT, has_equal_scales=True, is_bare=True, title=title, legend=legend)


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


def _draw_curve(
    curve: TipCurve, largest: LargestVector | None, style: ReaderStyle, sides: tuple[Scaling, Scaling]
) -> Iterator[Item]:
    """Draw a curve with its direction and its largest vector."""
    x, y = style.per_si * curve.x, style.per_si * curve.y
    yield Trace(curve.name, *_break_at_jumps(curve.turning.times, x, y, sides[0].high - sides[0].low), curve.pen)
    pixel_size = max((sides[0].high - sides[0].low) / MAX_WIDTH, (sides[1].high - sides[1].low) / HEIGHT)
    yield from draw_direction_arrows(x, y, curve.pen, ARROW_LENGTH * pixel_size)
    if largest is not None and largest.magnitude > 0.0 and not largest.is_constant:
        yield Arrow(0.0, 0.0, style.per_si * largest.x, style.per_si * largest.y, curve.pen, is_thin=True)
        text = f"{format_magnitude(largest, style)} at {describe_angle(curve, largest)}"
        yield Spot(style.per_si * largest.x, style.per_si * largest.y, text, curve.pen, "circle", is_filled=True)


def _draw_marks(group: Sequence[TipCurve], per_si: float, mark_space: float, label_space: float) -> Iterator[Spot]:
    """Draw the marks along curves, with a label each quarter turn, and those of firing.

    mark_space, label_space: smallest distances of marks, and of marks with labels, in the unit of the figure; those at
    one place share a label
    """
    for curve in group:
        marks = [(time, text, "circle", curve.pen) for time, text in _find_marks(curve.turning)]
        marks += [(time, text, "diamond", FIRING_PEN) for time, text in find_firings(curve)]
        vectors = per_si * find_vectors(curve.study, curve.path, np.array([mark[0] for mark in marks]))
        places = zip(*(components.tolist() for components in curve.plane.project(vectors)), strict=True)
        spots = [
            Spot(x, y, text, pen, shape, is_filled=shape == "diamond")
            for (x, y), (_, text, shape, pen) in zip(places, marks, strict=True)
            if math.isfinite(x + y)
        ]
        yield from thin_marks(spots, mark_space, label_space)


def thin_marks(spots: Sequence[Spot], mark_space: float, label_space: float) -> list[Spot]:
    """Drop marks and labels that are too close to others of a curve; labelled marks first, and all firings stay."""
    shown: list[Spot] = []
    for spot in sorted(spots, key=lambda spot: (not spot.is_filled, not spot.text)):
        distances = [math.hypot(spot.x - other.x, spot.y - other.y) for other in shown]
        near = [other for other, distance in zip(shown, distances, strict=True) if distance < label_space]
        same = next((k for k, distance in enumerate(distances) if distance < SAME_PLACE * label_space), None)
        if spot.is_filled:
            shown.append(spot)
        elif same is not None and spot.text and shown[same].text and not shown[same].is_filled:
            if ", " not in shown[same].text:  # the ends of a cycle; a vector that rests has only two of its instants
                shown[same] = shown[same]._replace(text=f"{shown[same].text}, {spot.text}")
        elif min(distances, default=math.inf) >= mark_space:
            is_labelled = not any(other.text and not other.is_filled for other in near)
            shown.append(spot if is_labelled else spot._replace(text=""))
    return shown


def _break_at_jumps(times: Array, x: Array, y: Array, width: float) -> tuple[Array, Array]:
    """Insert gaps into the tips (n,) where they jump."""
    jumps = find_jump_sides(times) & (np.hypot(np.diff(x), np.diff(y)) > VISIBLE_JUMP * width)
    break_places = np.flatnonzero(jumps) + 1
    return np.insert(x, break_places, np.nan), np.insert(y, break_places, np.nan)


def _find_marks(turning: TurningRun) -> list[tuple[float, str]]:
    """Return the instants of marks along curves, ascending, and their labels: some angles, or the instants."""
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
    shown = LABEL_STEP if high - low <= MAX_LABELS * LABEL_STEP else step
    texts = [f"{degrees:g}°" if degrees % shown == 0 else "" for degrees in names]
    return sorted(zip(map(float, mark_times), texts, strict=True))


def make_polar_grid(
    sides: tuple[Scaling, Scaling], curves: Sequence[Array], names: tuple[str, str], unit: str
) -> list[Item]:
    """Make the grid about the origin.

    sides: the window; curves (n, 2): drawn in it, which the numbers of the rings avoid
    names: of the axes to the right and upwards
    """
    low, high = (np.array([getattr(side, end) for side in sides]) for end in ("low", "high"))
    reach = float(np.max(np.abs([low, high])))
    rings = [(value, text) for value, text in choose_ticks(Scaling("", 0.0, reach), N_RINGS) if value > 0.0]
    items: list[Item] = []
    angles = np.radians(np.arange(0, 360 + ARC_STEP, ARC_STEP))
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    for value, text in rings:
        arcs = np.stack([value * circle[:-1], value * circle[1:]], axis=1)
        items.append(Strokes(clip_strokes(arcs, low, high), is_faint=True, name=f"{text} {unit}"))
    items += _label_rings(rings, low, high, curves, unit)
    for degrees in sorted(range(0, 360, RAY_STEP), key=lambda angle: angle % 90):  # those of the axes first
        direction = _make_direction(degrees)
        ray = clip_strokes(np.array([[(0.0, 0.0), tuple(2.0 * reach * direction)]]), low, high)
        if len(ray):
            items.append(Strokes(ray, is_faint=True))
            axis = {0: f"{names[0]} ", 90: f"{names[1]} "}.get(degrees, "")
            x, y = (RIM * ray[0, 1]).tolist()
            if math.hypot(x, y) > MIN_RAY * reach:
                items.append(Words(x, y, f"{axis}{degrees}°", is_optional=True))
    return items


def _make_direction(degrees: float) -> Array:
    return np.array([math.cos(math.radians(degrees)), math.sin(math.radians(degrees))])


def _label_rings(
    rings: Sequence[tuple[float, str]], low: Array, high: Array, curves: Sequence[Array], unit: str
) -> Iterator[Words]:
    """Label the rings along the direction between two rays in which most of them are seen and the curves are far."""
    points = np.concatenate(curves)
    points = points[np.isfinite(points).all(axis=1)]
    reach = float(np.max(np.abs([low, high])))

    def find_room(degrees: int) -> tuple[bool, int, float]:
        places = [value * _make_direction(degrees) for value, _ in rings]
        seen = [place for place in places if (place > low).all() and (place < high).all()]
        distances = [float(np.hypot(*(points - place).T).min(initial=np.inf)) for place in seen]
        room = min(distances, default=0.0)
        return room >= MIN_RING_SPACE * reach, len(seen), room

    best = max(range(RAY_STEP // 2, 360, RAY_STEP), key=find_room)
    for value, text in rings:
        place = value * _make_direction(best)
        if (place > low).all() and (place < high).all():
            yield Words(float(place[0]), float(place[1]), f"{text} {unit}", is_optional=True)


def describe_runs(sources: Sequence[FigureSource], curves: Sequence[TipCurve]) -> Iterator[str]:
    """Yield a sentence for each run: the instants that are shown, and the angle that keeps turning."""
    for source in sources:
        curve = next(curve for curve in curves if curve.study is source.study)
        turning = curve.turning
        text = turning.describe(describe_number(source, turning.path) if turning.path else "")
        yield f"{source.name}: {text}" if source.name else text


def describe_frame(curve: TipCurve, axes: str) -> str:
    """Describe what a curve's loads act on, and in which axes they are drawn."""
    if curve.path.startswith("joints."):
        joint = curve.study.spec.joints[curve.path.split(".")[1]]
        first, second = (_describe_body(curve, body) for body in (joint.a, joint.b))
        frame = "world axes" if axes == "world" else f"in the axes of {first if axes == 'from' else second}"
        return f"reaction of {first} on {second}, {frame}"
    return "force on the foundation, world axes" if curve.path.startswith("foundation.") else "world axes"


def format_magnitude(largest: LargestVector, style: ReaderStyle) -> str:
    """Format the magnitude with its unit; `?` if its error is as large."""
    if largest.magnitude <= largest.error:
        return f"{UNKNOWN} {style.unit}"
    return format_number(largest.magnitude, largest.error, style)


def describe_angle(curve: TipCurve, largest: LargestVector) -> str:
    """Return the crank angle of the largest vector, else its instant."""
    turning = curve.turning
    if not turning.path:
        return f"{format_short(largest.time, 4)} s"
    angle = float(np.interp(largest.time, turning.times, turning.degrees))
    return _format_degrees(angle, 360.0 * turning.turns)


def _describe_body(curve: TipCurve, body: str) -> str:
    """Return the words for a body or the ground."""
    return describe_object("bodies" if body != GROUND else GROUND, body, make_labels(curve.study.spec))


def make_notes(curve: TipCurve, largest: LargestVector | None, units: Units) -> Iterator[str]:
    """Yield the largest vector with its direction and instant, and what is not drawn."""
    style = choose_number_style(curve.unit, 0.0 if largest is None else largest.magnitude, units)
    if largest is None:
        yield f"{curve.caption}: open or unknown, not drawn"
        return
    magnitude_text = format_magnitude(largest, style)
    if largest.is_constant:
        yield f"{curve.caption}: {magnitude_text} at all times"
    else:
        yield f"{curve.caption}: largest {magnitude_text} {_describe_largest(curve, largest)}"
    normal_components = project_vectors(curve.vectors, curve.plane.normal)
    largest_normal = float(np.nanmax(np.abs(normal_components), initial=0.0))
    if largest_normal > max(tolerances.TOLD_ACROSS * largest.magnitude, largest.error):
        yield f"{curve.caption}: normal to the plane up to {style.per_si * largest_normal:.4g} {style.unit}, not drawn"
    if np.isnan(curve.x + curve.y).any():
        yield f"{curve.caption}: partly open or unknown, not drawn there"
    elif np.isnan(normal_components).any():
        yield f"{curve.caption}: normal component open or unknown, not drawn"
    if "1" in curve.plane.names:
        words = (f"({', '.join(f'{x:.4g}' for x in e + 0.0)})" for e in (curve.plane.right, curve.plane.upward))
        yield f"{curve.caption}: directions 1 and 2 are {' and '.join(words)}"


def _describe_largest(curve: TipCurve, largest: LargestVector) -> str:
    """Describe the direction, the instant and the crank angle of the largest vector."""
    first, second = curve.plane.names
    direction = _format_degrees(math.degrees(math.atan2(largest.y, largest.x)), 360.0)
    direction_text = f"at {direction} from {first} to {second}"
    when = f"at t = {format_short(largest.time, 4)} s"
    turning = curve.turning
    if turning.path:
        caption = describe_number(FigureSource("", curve.study), turning.path)
        when += f", {caption} = {describe_angle(curve, largest)}"
    return f"{direction_text}, {when}"


def _format_degrees(angle: float, cycle: float) -> str:
    """Format an angle to four digits.

    cycle: degrees after which it starts again at 0; 0 if it does not
    """
    rounded = float(f"{angle % cycle if cycle else angle:.4g}")
    return f"{0.0 if cycle and rounded >= cycle else rounded:g}°"
