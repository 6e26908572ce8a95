"""Section diagrams: N, Q1, Q2, T, M1, M2 along a bar in stacked panels, hatched between curve and zero line; below
them the deflections w1, w2, if they are computed.

At one instant there is a curve for each quantity. Over a run the lowest and highest values at each place are a band,
with the curve of the instant at which the quantity is largest. A quantity that is 0 all along is named but not drawn:
no value of it is larger than the rounding error of the sums it is computed from, or than its stated error, while others
of its unit are larger than theirs. If none of its unit is, nothing is known of it.

Which side is in tension (--tension-side): for the face of a cut with the stress s at y1 e1 + y2 e2 from its centre,

    M' = int (y1 e1 + y2 e2) x n s dA = e1 int y2 s dA - e2 int y1 s dA      as (e1, e2, n) is right-handed

so M1 > 0 pulls on the side of e2, M2 > 0 on that of -e1. The ordinates of M1 point to e2, those of M2 to -e1.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from enum import Enum

import numpy as np

from heuncli.output.drawing.axes import choose_ends, format_short
from heuncli.output.drawing.figure import (
    Arrow,
    Blank,
    Figure,
    Item,
    Panel,
    PlaceLabel,
    Polygon,
    Scaling,
    Strokes,
    Symbol,
    VerticalMark,
    Words,
)
from heuncli.output.figures.courses import FigureSource, make_title, require_claimed
from heuncli.output.figures.diagram_panels import BarCurves, make_panel
from heuncli.study.quantities.captions import WORDS, describe_object
from heuncli.study.quantities.digits import OPEN, OPEN_NOTE, choose_reader_style, format_error
from heuncli.study.quantities.labels import make_labels
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.bar_curves import BarAttachment, BarExtremes
from heuncli.study.queries.bars import WholeBar

INVERTED = frozenset({"M2"})  # on the tension side their ordinates point against e1
TENSION_SIDES = {"M1": "e2", "M2": "e1"}  # the axis that points up
INSTANT_SEPARATOR = ": t = "  # between the name of a run and an instant
BAND_SENTENCE = "Thin lines: range over the run; thick line: at the instant of the greatest magnitude."
TENSION_SENTENCE = "M1 and M2 are drawn on the tension side."
REFERENCES = {
    "chord": "the chord between the ends",
    "start": "the tangent at the start",
    "end": "the tangent at the end",
}
HEIGHT = 104.0  # pixels; the axis of the sketch is in pixels, too, with the bar about 0
UPPER, LOWER = 44.0, 60.0  # pixels above and below the bar's axis
HALF_DEPTH = 5.0  # half the depth of the drawn bar
ARROW_LENGTH = 24.0
DIMENSION, TICK = 48.0, 4.0  # distance of the dimension line below the axis, and half the height of its ticks
SYMBOLS = {"support": "foot", "clamp": "clamp", "joint": "circle", "mass": "mass", "couple": "turning"}  # else arrows
DOWN = (0.0, -1.0)


class Verdict(Enum):
    """What a quantity is along a bar."""

    SHOWN = "it differs from zero somewhere, or is open somewhere"
    ZERO = "zero but for rounding"
    WITHIN_ERROR = "zero within its stated error, while others of its unit are larger than theirs"
    UNKNOWN = "no larger than its stated error, as all others of its unit"


def make_diagrams(
    sources: Sequence[FigureSource],
    entries: Sequence[str],
    units: Units,
    times: Sequence[float] | None = None,
    tension_side: bool = False,
    known_extremes: BarExtremes | None = None,
) -> Figure:
    """Make the section diagrams of some series of cuts, of one run or of several over each other.

    entries: names of series of cuts, or such as NAME.deflection or NAME.deflection.w2 for these panels alone
    times: instants [s] within all runs and before their horizons, a curve each; by default the range over the whole run
    known_extremes: of the only series of cuts over the only run, if they are searched already
    """
    panels, notes, legend = list[Panel](), list[str](), list[tuple[str, int]]()
    words = [sentence for source in sources for sentence in _describe_source(source, times)]
    headings, has_bands = dict[str, None](), False
    for name, _, wanted in (entry.partition(".") for entry in entries):
        bars = list(_make_bars(sources, name, times, known_extremes))
        for source in sources:
            headings[_make_heading(source, name)] = None
        for bar in bars:
            if bar.name and (bar.name, bar.pen) not in legend:
                legend.append((bar.name, bar.pen))
        shown, left_out = _choose_quantities(bars, wanted)
        notes += [f"{name}: {text}" for text in left_out]
        panels += _make_panels(name, bars, shown, units, tension_side=tension_side, has_title=len(entries) > 1)
        has_bands = has_bands or any(bar.ranges for bar in bars)
    if any(isinstance(item, Blank) and item.text.endswith(OPEN) for panel in panels for item in panel.items):
        notes.append(OPEN_NOTE)
    words += headings
    words += [BAND_SENTENCE] * has_bands + [TENSION_SENTENCE] * tension_side
    return Figure(make_title(sources), words, panels, legend, notes)


def _make_bars(
    sources: Sequence[FigureSource], name: str, given_times: Sequence[float] | None, known_extremes: BarExtremes | None
) -> Iterator[BarCurves]:
    """Yield the curves of a section, each with its pen."""
    number = 0
    for source in sources:
        bar = WholeBar(source.study, name)
        if not bar.has_impulses:
            require_claimed(source.study)
        times = bar.instants
        if given_times is None and len(times) > 1:
            ranges = bar.make_ranges(known_extremes)
            yield BarCurves(
                source.name, number, bar, {q: load_range.main_line for q, load_range in ranges.items()}, ranges
            )
            number += 1
            continue
        curve_times = list(given_times) if given_times is not None and len(times) > 1 else times.tolist()
        for t in curve_times:
            parts = [source.name, f"t = {format_short(t, 4)} s" if len(curve_times) > 1 else ""]
            yield BarCurves(": ".join(part for part in parts if part), number, bar, bar.make_lines(t), {})
            number += 1


def _describe_source(source: FigureSource, times: Sequence[float] | None) -> Iterator[str]:
    """Yield what a reader must know of a run: its only instant, its horizon, impulses that are left out."""
    study = source.study
    results, horizon = study.results, study.results.horizon
    shown_times = results.time if times is None else times
    parts = []
    if not study.has_one_instant and len(shown_times) == 1:
        parts.append(f"t = {format_short(float(shown_times[0]), 4)} s")
    if horizon is not None:
        parts.append(f"no results claimed or drawn from t = {horizon:.6g} s on")
    n_impacts = len(study.history.impulses)
    if study.spec.analysis.type == "impulse":
        parts.append("impulses only")
    elif n_impacts:
        parts.append(f"{n_impacts} impulse{'s' * (n_impacts > 1)}, not included")
    if parts:
        yield "; ".join([f"{source.name}: {parts[0]}" if source.name else parts[0], *parts[1:]])


def _make_heading(source: FigureSource, name: str) -> str:
    """Describe the signs and axes of a section in one line."""
    labels = make_labels(source.study.spec)
    info = labels.sections[name]
    body, section = describe_object("bodies", info.body, labels), describe_object("sections", name, labels)
    what = body if body == section else f"{section}, body {body}"
    point = "" if info.moment_point == "the cut's point" else f"; moments about {info.moment_point}"
    theory = source.study.spec.sections[name].beam_theory
    beam = "" if theory is None else f"; w1, w2: deflection along e1, e2 from {REFERENCES[theory.reference]}"
    return f"{what}: N > 0 tension; e1 = {info.first_axis}, e2 = n × e1{point}{beam}"


def _choose_quantities(bars: Sequence[BarCurves], wanted: str) -> tuple[list[str], list[str]]:
    """Return the quantities to draw, and sentences on those that are 0 all along.

    wanted: only those that begin with these words; slopes are drawn only if they are wanted by name
    """
    zero, zero_within_error, shown = list[str](), list[str](), list[str]()
    common = [q for q in bars[0].bar.quantities if all(q in bar.bar.quantities for bar in bars)]
    for quantity in common:
        if quantity != wanted and (
            "slope" in quantity or not f"{quantity}.".startswith(f"{wanted}." if wanted else "")
        ):
            continue
        verdicts = {_classify(bar, quantity) for bar in bars}
        if verdicts == {Verdict.ZERO}:
            zero.append(quantity)
        elif verdicts <= {Verdict.ZERO, Verdict.WITHIN_ERROR}:
            zero_within_error.append(quantity)
        else:
            shown.append(quantity)
    notes = [f"all zero, not drawn: {_join_symbols(zero)}"] if zero else []
    if zero_within_error:
        error = {bars[0].bar.find_unit(q): max(bar.bar.find_error(q) for bar in bars) for q in zero_within_error}
        errors_text = ", ".join(f"{format_error(size)} {unit}" for unit, size in error.items())
        notes.append(f"zero within the stated error ({errors_text}), not drawn: {_join_symbols(zero_within_error)}")
    partly_open = [q for q in shown if any(_is_open_at_times(bar, q) for bar in bars)]
    if partly_open:
        notes.append(f"open at some times, not included in the band: {_join_symbols(partly_open)}")
    return shown, notes


def _join_symbols(quantities: Sequence[str]) -> str:
    return ", ".join(quantity.rpartition(".")[2] for quantity in quantities)


def _is_open_at_times(bar: BarCurves, quantity: str) -> bool:
    """Return whether a quantity is open at some instants of a run but not at all."""
    has_known = bar.ranges and np.isfinite(bar.ranges[quantity].low).any()
    return bool(has_known) and bar.bar.is_open_somewhere(quantity)


def _classify(curves: BarCurves, quantity: str) -> Verdict:
    """Classify a quantity by its largest magnitude, its rounding and its stated error; what is open is shown."""
    bar, magnitude = curves.bar, curves.find_magnitude(quantity)
    if curves.is_partly_open(quantity):
        return Verdict.SHOWN
    if magnitude <= bar.stated_errors.rounding_of(bar.find_unit(quantity)) or magnitude == 0.0:
        return Verdict.ZERO
    if not curves.is_zero(quantity):
        return Verdict.SHOWN
    family = [q for q in bar.quantities if bar.find_unit(q) == bar.find_unit(quantity)]
    return Verdict.WITHIN_ERROR if any(not curves.is_zero(q) for q in family) else Verdict.UNKNOWN


def _make_panels(
    name: str,
    bars: Sequence[BarCurves],
    quantities: Sequence[str],
    units: Units,
    *,
    tension_side: bool,
    has_title: bool,
) -> Iterator[Panel]:
    """Yield the sketches of the bars of a section, and the panels of its quantities on the same axis."""
    length = max(bar.bar.length for bar in bars)
    style = choose_reader_style("m", length, units)
    x = Scaling(f"s [{style.unit}]", *choose_ends(0.0, style.per_si * length, margin=0.02))
    sketched = _list_distinct_bars(bars)
    for source_name, bar in sketched.items():
        title = f"{name}: {source_name}" if len(sketched) > 1 else name * has_title
        yield make_sketch(_mark_couples(bar), x, bar.length, style.per_si, style.unit, title)
    places = sorted({style.per_si * attachment.s for bar in sketched.values() for attachment in bar.attachments})
    for k, quantity in enumerate(quantities):
        panel = make_panel(quantity, bars, units, style, is_inverted=tension_side and quantity in INVERTED)
        symbol = quantity.rpartition(".")[2]
        words = str(WORDS[quantity]).removesuffix(f" {symbol}")  # of one text: section forces have no components
        title = f"{words[:1].upper()}{words[1:]} {symbol}"
        if tension_side and quantity in TENSION_SIDES:
            title += f", {TENSION_SIDES[quantity]} up"
        items = (*(VerticalMark(s, "") for s in places), *panel.items)
        is_last = k == len(quantities) - 1
        yield panel._replace(x=x if is_last else x._replace(hides_label=True), items=items, title=title)


def _list_distinct_bars(bars: Sequence[BarCurves]) -> dict[str, WholeBar]:
    """List the bars by the names of their runs; once if what is attached to them is the same in all."""
    distinct_bars = {id(bar.bar): bar for bar in reversed(bars)}
    named = {bar.name.partition(INSTANT_SEPARATOR)[0]: bar.bar for bar in reversed(distinct_bars.values())}
    name, first = next(iter(named.items()))
    are_same = all(
        np.isclose(first.length, other.length) and _are_same(first.attachments, other.attachments)
        for other in named.values()
    )
    return {name: first} if are_same else named


def _are_same(first: Sequence[BarAttachment], other: Sequence[BarAttachment]) -> bool:
    """Return whether two lists have the same names at the same places."""
    if [attachment[1:] for attachment in first] != [attachment[1:] for attachment in other]:
        return False
    return bool(np.allclose([attachment.s for attachment in first], [attachment.s for attachment in other]))


def _mark_couples(bar: WholeBar) -> list[BarAttachment]:
    """Return what acts on a bar, with a kind of its own for couples, which are no forces."""
    forces = bar.study.spec.forces
    return [
        attachment._replace(kind="couple")
        if attachment.kind == "force" and attachment.name in forces and forces[attachment.name].type == "couple"
        else attachment
        for attachment in bar.attachments
    ]


def make_sketch(
    attachments: Sequence[BarAttachment], x: Scaling, length: float, per_si: float, unit: str, title: str = ""
) -> Panel:
    """Make the sketch of a bar on the horizontal axis of its diagrams.

    length: of the bar [m]; per_si: display units in a metre
    """
    items = tuple(_iter_items(attachments, length, per_si, unit))
    return Panel(x._replace(hides_label=True), Scaling("", -LOWER, UPPER), items, HEIGHT, is_bare=True, title=title)


def _iter_items(attachments: Sequence[BarAttachment], length: float, per_si: float, unit: str) -> Iterator[Item]:
    """Yield the bar, what acts on it, and the dimension line."""
    end = per_si * length
    corners = np.array([[0.0, -HALF_DEPTH], [end, -HALF_DEPTH], [end, HALF_DEPTH], [0.0, HALF_DEPTH]])
    yield Polygon("bar", corners, is_filled=True)
    for attachment in attachments:
        s = per_si * attachment.s
        symbol = SYMBOLS.get(attachment.kind)
        if symbol is None:
            yield Arrow(s, HALF_DEPTH + ARROW_LENGTH, 0.0, -ARROW_LENGTH, None)
        elif symbol == "foot":
            yield Symbol(s, -HALF_DEPTH, symbol, DOWN)
        elif symbol == "clamp":  # outwards at the ends of the bar
            yield Symbol(s, 0.0, symbol, (-1.0, 0.0) if attachment.s < 0.5 * length else (1.0, 0.0))
        else:
            yield Symbol(s, 0.0, symbol)
    texts: dict[float, list[str]] = {}
    for attachment in attachments:
        texts.setdefault(attachment.s, []).append(attachment.name.replace("_", " "))
    for s, names in texts.items():
        yield PlaceLabel(per_si * s, HALF_DEPTH, ", ".join(names), ", ".join(names))
    ticks = sorted({0.0, end, *(per_si * attachment.s for attachment in attachments)})
    strokes = [[(0.0, -DIMENSION), (end, -DIMENSION)]]
    strokes += [[(s, -DIMENSION - TICK), (s, -DIMENSION + TICK)] for s in ticks]
    yield Strokes(np.array(strokes))
    yield Words(0.5 * end, -DIMENSION + 9.0, f"{format_short(end, 4)} {unit}")
