"""Section diagrams: N, Q1, Q2, T, M1, M2 over the way along a bar, stacked, hatched between curve and zero line.

At one instant a curve a quantity; over a run the lowest and the highest at each place as a band, with the curve of the
instant at which the quantity is largest. What is 0 all along is not drawn but named: no value of it is above what the
sums that it is of lose by rounding, or above its stated error, while others of its unit are above theirs. Where none of
its unit is, nothing is known of it.

Which side is in tension (--tension-side). Of a cut's face with the stress s at y1 e1 + y2 e2 from its centre,

    M' = int (y1 e1 + y2 e2) x n s dA = e1 int y2 s dA - e2 int y1 s dA      as (e1, e2, n) is right-handed

so M1 > 0 pulls on the side of e2, M2 > 0 on that of -e1. The ordinates of M1 point to e2, those of M2 to -e1.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.output.drawing.figure import Blank, Figure, Panel, Scaling, Upright
from heuncli.output.drawing.ticks import ends, short
from heuncli.output.figures.bars import WholeBar
from heuncli.output.figures.courses import Pictured, title_of
from heuncli.output.figures.diagram_panels import DrawnBar, diagram
from heuncli.results.results_schema import RESULTANT_UNITS, RESULTANTS
from heuncli.study.quantities.digits import OPEN, OPEN_NOTE, rough
from heuncli.study.quantities.labels import labels_of
from heuncli.study.quantities.table_units import Units

TURNED = frozenset({"M2"})  # whose ordinates point against e1, where they point to the side in tension
SIDES = {"M1": "e2 up", "M2": "e1 up"}
LETTERS = 0.009  # of a bar's length in a panel: what a letter of a name takes of it
AT = ": t = "  # between the name of a run and an instant of it
LONGEST = 60  # letters of the names at a place
BAND = (
    "band: lowest and highest over the run at each place; line: the instant of the largest magnitude, which is marked"
)
TENSION = "ordinates of M1 and M2 point to the side that bending puts in tension"


def diagrams(
    sources: Sequence[Pictured],
    names: Sequence[str],
    units: Units,
    at: Sequence[float] | None = None,
    tension_side: bool = False,
) -> Figure:
    """The diagrams of some runs of cuts, of one run or of several over each other.

    at: instants [s] within all runs and before their horizons, a curve each; by default what the whole run reaches.
    """
    panels, notes, legend = list[Panel](), list[str](), list[tuple[str, int]]()
    words = [sentence for source in sources for sentence in _words(source, at)]
    headings, banded = dict[str, dict[str, None]](), False
    for name in names:
        drawn = list(_drawn(sources, name, at))
        for source in sources:
            headings.setdefault(_heading(source, name), dict[str, None]())[name] = None
        for each in drawn:
            if each.name and (each.name, each.pen) not in legend:
                legend.append((each.name, each.pen))
        shown, left_out = _sorted_out(drawn)
        notes += [f"{name}: {text}" for text in left_out]
        panels += _panels(name, drawn, shown, units, tension_side=tension_side)
        banded = banded or any(each.reaches for each in drawn)
    if any(isinstance(item, Blank) and item.text.endswith(OPEN) for panel in panels for item in panel.items):
        notes.append(OPEN_NOTE)
    words += [f"{', '.join(own)}: {heading}" for heading, own in headings.items()]
    words += [BAND] * banded + [TENSION] * tension_side
    return Figure(title_of(sources), words, panels, legend, notes)


def _drawn(sources: Sequence[Pictured], name: str, at: Sequence[float] | None) -> Iterator[DrawnBar]:
    """The curves of a section, each with its pen."""
    number = 0
    for source in sources:
        bar = WholeBar(source.study, name)
        times = bar.instants
        if at is None and len(times) > 1:
            reaches = bar.reaches()
            yield DrawnBar(source.name, number, bar, {q: own.line for q, own in reaches.items()}, reaches)
            number += 1
            continue
        asked = list(at) if at is not None and len(times) > 1 else times.tolist()
        for t in asked:
            parts = [source.name, f"t = {short(t)} s" if len(asked) > 1 else ""]
            yield DrawnBar(": ".join(part for part in parts if part), number, bar, bar.at(t), {})
            number += 1


def _words(source: Pictured, at: Sequence[float] | None) -> Iterator[str]:
    """Of which run it is, and of which instants."""
    study = source.study
    results = study.results
    told = [source.name or str(results.spec.get("path", ""))]
    horizon = results.horizon
    if study.of_one_instant:
        told.append("at one instant")
    else:
        told.append(str(results.model.get("method", "")))
        alone = results.time if at is None else at
        told += [f"t = {short(float(alone[0]))} s"] * (len(alone) == 1)
    if horizon is not None:
        told.append(f"nothing is claimed, and drawn, from t = {horizon:.6g} s on")
    blows = len(study.history.blows)
    if study.spec.analysis.type == "impulse":
        told[1] = "impulses of a blow"
    elif blows:
        told.append(f"{blows} blow{'s' * (blows > 1)}, whose impulses are no part of it")
    yield "; ".join(part for part in told if part)


def _heading(source: Pictured, name: str) -> str:
    """What the diagrams of a section are of, in the words of its tables."""
    info = labels_of(source.study.spec).sections[name]
    axes = f"e1 = {info.first_axis}, e2 = n × e1; moments about {info.about}"
    return f"what the piece of {info.body} beyond s exerts ON the part before it; N > 0 tension; {axes}"


def _sorted_out(drawn: Sequence[DrawnBar]) -> tuple[list[str], list[str]]:
    """Which quantities are drawn, and sentences on those that are 0 all along."""
    zero, within, shown = list[str](), list[str](), list[str]()
    for quantity in RESULTANTS:
        verdicts = {_verdict(each, quantity) for each in drawn}
        own = zero if verdicts == {"zero"} else within if verdicts <= {"zero", "within"} else shown
        own.append(quantity)
    notes = [f"0 all along, and not drawn: {', '.join(zero)}"] if zero else []
    if within:
        error = {drawn[0].bar.unit(q): max(each.bar.error(q) for each in drawn) for q in within}
        told = ", ".join(f"{rough(size)} {unit}" for unit, size in error.items())
        notes.append(f"0 to their stated error ({told}), and not drawn: {', '.join(within)}")
    at_times = [q for q in shown if any(_open_at_times(each, q) for each in drawn)]
    if at_times:
        notes.append(f"open at some instants, which the band leaves out: {', '.join(at_times)}")
    return shown, notes


def _open_at_times(drawn: DrawnBar, quantity: str) -> bool:
    """Whether a quantity is open at some instants of a run, and not at others."""
    known = drawn.reaches and np.isfinite(drawn.reaches[quantity].low).any()
    return bool(known) and drawn.bar.open_somewhere(quantity)


def _verdict(drawn: DrawnBar, quantity: str) -> str:
    """Whether a quantity is zero, zero within its error, not known, or something; what is open is something."""
    bar, size = drawn.bar, drawn.size(quantity)
    if drawn.open_in_part(quantity):
        return "some"
    if size <= bar.certain.lost(bar.unit(quantity)) or size == 0.0:
        return "zero"
    if not drawn.is_zero(quantity):
        return "some"
    family = [q for q in RESULTANTS if RESULTANT_UNITS[q] == RESULTANT_UNITS[quantity]]
    return "within" if any(not drawn.is_zero(q) for q in family) else "unknown"


def _panels(
    name: str, drawn: Sequence[DrawnBar], shown: Sequence[str], units: Units, *, tension_side: bool
) -> Iterator[Panel]:
    """The panels of a section, the first with its name and what stands along the bar."""
    unit, size = units.of("m")
    length = max(each.bar.length for each in drawn) * size
    x = Scaling(f"s [{unit}]", *ends(0.0, length, spare=0.02))
    marks = _marks(_standing(drawn), length, size)
    for k, quantity in enumerate(shown):
        label = f"{quantity} [{units.of(drawn[0].bar.unit(quantity))[0]}]"
        if tension_side and quantity in SIDES:
            label += f", {SIDES[quantity]}"
        own = diagram(quantity, drawn, units, label, over=tension_side and quantity in TURNED)
        items = (*(Upright(s, "" if k else text, above=not k and bool(text)) for s, text in marks), *own.items)
        last = k == len(shown) - 1
        yield own._replace(x=x if last else x._replace(label=""), items=items, title="" if k else name)


def _standing(drawn: Sequence[DrawnBar]) -> list[tuple[float, list[str]]]:
    """What stands along the bars, by its place [m], ascending; where it is not the same on all, with their names."""
    bars = {id(each.bar): each for each in reversed(drawn)}
    own = [(each.name.partition(AT)[0], each.bar.standing) for each in reversed(bars.values())]
    first = own[0][1]
    if all(_same(first, other) for _, other in own[1:]):
        return first
    return sorted((s, [f"{whose}: {name}" for name in names]) for whose, standing in own for s, names in standing)


def _same(first: Sequence[tuple[float, list[str]]], other: Sequence[tuple[float, list[str]]]) -> bool:
    """Whether the same stands at the same places."""
    if [names for _, names in first] != [names for _, names in other]:
        return False
    return bool(np.allclose([s for s, _ in first], [s for s, _ in other]))


def _marks(standing: Sequence[tuple[float, list[str]]], length: float, size: float) -> list[tuple[float, str]]:
    """What stands along a bar: places, and the names there; those of close ones stand together at the first."""
    found: list[tuple[float, str]] = []
    first = 0  # of those whose names stand together
    for s, names in standing:
        text = ", ".join(names)
        if found and (size * s - found[first][0]) < LETTERS * length * 0.5 * (len(found[first][1]) + len(text) + 2):
            found[first] = found[first][0], f"{found[first][1]}, {text}"
            text = ""
        else:
            first = len(found)
        found.append((size * s, text))
    return [(s, text if len(text) <= LONGEST else f"{text[:LONGEST]}…") for s, text in found]
