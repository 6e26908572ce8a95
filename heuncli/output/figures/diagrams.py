"""Section diagrams: N, Q1, Q2, T, M1, M2 along a bar in stacked panels, hatched between curve and zero line.

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

import numpy as np

from heuncli.output.drawing.figure import Blank, Figure, Panel, Scaling, VerticalMark
from heuncli.output.drawing.ticks import choose_ends, format_short
from heuncli.output.figures.bars import WholeBar
from heuncli.output.figures.courses import FigureSource, make_title
from heuncli.output.figures.diagram_panels import BarCurves, make_panel
from heuncli.results.results_schema import RESULTANT_UNITS, RESULTANTS
from heuncli.study.quantities.digits import OPEN, OPEN_NOTE, format_error
from heuncli.study.quantities.labels import make_labels
from heuncli.study.quantities.table_units import Units

INVERTED = frozenset({"M2"})  # on the tension side their ordinates point against e1
TENSION_SIDES = {"M1": "e2 up", "M2": "e1 up"}
LETTER_WIDTH = 0.009  # width of a letter, as a share of the bar's length
INSTANT_SEPARATOR = ": t = "  # between the name of a run and an instant
MAX_NAMES_LENGTH = 60  # letters of the names at a place
BAND_SENTENCE = (
    "band: minimum and maximum over the run at each position; line: at the time of the largest magnitude (marked)"
)
TENSION_SENTENCE = "M1 and M2 are plotted on the tension side"


def make_diagrams(
    sources: Sequence[FigureSource],
    names: Sequence[str],
    units: Units,
    times: Sequence[float] | None = None,
    tension_side: bool = False,
) -> Figure:
    """Make the section diagrams of some series of cuts, of one run or of several over each other.

    times: instants [s] within all runs and before their horizons, a curve each; by default the range over the whole run
    """
    panels, notes, legend = list[Panel](), list[str](), list[tuple[str, int]]()
    words = [sentence for source in sources for sentence in _describe_source(source, times)]
    headings, has_bands = dict[str, dict[str, None]](), False
    for name in names:
        bars = list(_make_bars(sources, name, times))
        for source in sources:
            headings.setdefault(_make_heading(source, name), dict[str, None]())[name] = None
        for bar in bars:
            if bar.name and (bar.name, bar.pen) not in legend:
                legend.append((bar.name, bar.pen))
        shown, left_out = _choose_quantities(bars)
        notes += [f"{name}: {text}" for text in left_out]
        panels += _make_panels(name, bars, shown, units, tension_side=tension_side)
        has_bands = has_bands or any(bar.ranges for bar in bars)
    if any(isinstance(item, Blank) and item.text.endswith(OPEN) for panel in panels for item in panel.items):
        notes.append(OPEN_NOTE)
    words += [f"{', '.join(section_names)}: {heading}" for heading, section_names in headings.items()]
    words += [BAND_SENTENCE] * has_bands + [TENSION_SENTENCE] * tension_side
    return Figure(make_title(sources), words, panels, legend, notes)


def _make_bars(sources: Sequence[FigureSource], name: str, given_times: Sequence[float] | None) -> Iterator[BarCurves]:
    """Yield the curves of a section, each with its pen."""
    number = 0
    for source in sources:
        bar = WholeBar(source.study, name)
        times = bar.instants
        if given_times is None and len(times) > 1:
            ranges = bar.make_ranges()
            yield BarCurves(
                source.name, number, bar, {q: load_range.main_line for q, load_range in ranges.items()}, ranges
            )
            number += 1
            continue
        curve_times = list(given_times) if given_times is not None and len(times) > 1 else times.tolist()
        for t in curve_times:
            parts = [source.name, f"t = {format_short(t)} s" if len(curve_times) > 1 else ""]
            yield BarCurves(": ".join(part for part in parts if part), number, bar, bar.make_lines(t), {})
            number += 1


def _describe_source(source: FigureSource, times: Sequence[float] | None) -> Iterator[str]:
    """Yield the sentence that names the run and its instants."""
    study = source.study
    results = study.results
    parts = [source.name or str(results.spec.get("path", ""))]
    horizon = results.horizon
    if study.has_one_instant:
        parts.append("at one instant")
    else:
        parts.append(str(results.model.get("method", "")))
        shown_times = results.time if times is None else times
        parts += [f"t = {format_short(float(shown_times[0]))} s"] * (len(shown_times) == 1)
    if horizon is not None:
        parts.append(f"no results claimed or drawn from t = {horizon:.6g} s on")
    n_impacts = len(study.history.impulses)
    if study.spec.analysis.type == "impulse":
        parts[1] = "impulses only"
    elif n_impacts:
        parts.append(f"{n_impacts} impulse{'s' * (n_impacts > 1)}, not included")
    yield "; ".join(part for part in parts if part)


def _make_heading(source: FigureSource, name: str) -> str:
    """Describe the diagrams of a section in the words of its tables."""
    info = make_labels(source.study.spec).sections[name]
    axes = f"e1 = {info.first_axis}, e2 = n × e1; moments about {info.moment_point}"
    return f"{info.body}: force of the far side on the near side of the cut; N > 0 tension; {axes}"


def _choose_quantities(bars: Sequence[BarCurves]) -> tuple[list[str], list[str]]:
    """Return the quantities to draw, and sentences on those that are 0 all along."""
    zero, within, shown = list[str](), list[str](), list[str]()
    for quantity in RESULTANTS:
        verdicts = {_classify(bar, quantity) for bar in bars}
        matching_list = zero if verdicts == {"zero"} else within if verdicts <= {"zero", "within"} else shown
        matching_list.append(quantity)
    notes = [f"all zero, not drawn: {', '.join(zero)}"] if zero else []
    if within:
        error = {bars[0].bar.find_unit(q): max(bar.bar.find_error(q) for bar in bars) for q in within}
        errors_text = ", ".join(f"{format_error(size)} {unit}" for unit, size in error.items())
        notes.append(f"zero within the stated error ({errors_text}), not drawn: {', '.join(within)}")
    partly_open = [q for q in shown if any(_is_open_at_times(bar, q) for bar in bars)]
    if partly_open:
        notes.append(f"open at some times, not included in the band: {', '.join(partly_open)}")
    return shown, notes


def _is_open_at_times(bar: BarCurves, quantity: str) -> bool:
    """Return whether a quantity is open at some instants of a run but not at all."""
    has_known = bar.ranges and np.isfinite(bar.ranges[quantity].low).any()
    return bool(has_known) and bar.bar.is_open_somewhere(quantity)


def _classify(curves: BarCurves, quantity: str) -> str:
    """Classify a quantity as "zero", "within" its error, "unknown", or "some"; what is open is "some"."""
    bar, magnitude = curves.bar, curves.find_magnitude(quantity)
    if curves.is_partly_open(quantity):
        return "some"
    if magnitude <= bar.certain.rounding_of(bar.find_unit(quantity)) or magnitude == 0.0:
        return "zero"
    if not curves.is_zero(quantity):
        return "some"
    family = [q for q in RESULTANTS if RESULTANT_UNITS[q] == RESULTANT_UNITS[quantity]]
    return "within" if any(not curves.is_zero(q) for q in family) else "unknown"


def _make_panels(
    name: str, bars: Sequence[BarCurves], quantities: Sequence[str], units: Units, *, tension_side: bool
) -> Iterator[Panel]:
    """Yield the panels of a section; the first shows its name and what is attached along the bar."""
    unit, size = units.find("m")
    length = max(bar.bar.length for bar in bars) * size
    x = Scaling(f"s [{unit}]", *choose_ends(0.0, length, margin=0.02))
    marks = _make_marks(_collect_attachments(bars), length, size)
    for k, quantity in enumerate(quantities):
        label = f"{quantity} [{units.find(bars[0].bar.find_unit(quantity))[0]}]"
        if tension_side and quantity in TENSION_SIDES:
            label += f", {TENSION_SIDES[quantity]}"
        panel = make_panel(quantity, bars, units, label, is_inverted=tension_side and quantity in INVERTED)
        items = (
            *(VerticalMark(s, "" if k else text, is_above=not k and bool(text)) for s, text in marks),
            *panel.items,
        )
        is_last = k == len(quantities) - 1
        yield panel._replace(x=x if is_last else x._replace(label=""), items=items, title="" if k else name)


def _collect_attachments(bars: Sequence[BarCurves]) -> list[tuple[float, list[str]]]:
    """Collect what is attached along the bars by its place [m], ascending; if the bars differ, with their names."""
    distinct_bars = {id(bar.bar): bar for bar in reversed(bars)}
    lists = [
        (bar.name.partition(INSTANT_SEPARATOR)[0], bar.bar.attachments) for bar in reversed(distinct_bars.values())
    ]
    first = lists[0][1]
    if all(_are_same(first, other) for _, other in lists[1:]):
        return first
    return sorted(
        (s, [f"{bar_name}: {name}" for name in names]) for bar_name, attachments in lists for s, names in attachments
    )


def _are_same(first: Sequence[tuple[float, list[str]]], other: Sequence[tuple[float, list[str]]]) -> bool:
    """Return whether two lists have the same names at the same places."""
    if [names for _, names in first] != [names for _, names in other]:
        return False
    return bool(np.allclose([s for s, _ in first], [s for s, _ in other]))


def _make_marks(attachments: Sequence[tuple[float, list[str]]], length: float, size: float) -> list[tuple[float, str]]:
    """Return places and the names there; the names of close places are joined at the first."""
    marks: list[tuple[float, str]] = []
    first = 0  # index of the place where joined names are shown
    for s, names in attachments:
        text = ", ".join(names)
        if marks and (size * s - marks[first][0]) < LETTER_WIDTH * length * 0.5 * (
            len(marks[first][1]) + len(text) + 2
        ):
            marks[first] = marks[first][0], f"{marks[first][1]}, {text}"
            text = ""
        else:
            first = len(marks)
        marks.append((size * s, text))
    return [(s, text if len(text) <= MAX_NAMES_LENGTH else f"{text[:MAX_NAMES_LENGTH]}…") for s, text in marks]
