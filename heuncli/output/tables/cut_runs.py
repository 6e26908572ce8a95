"""Runs of cuts: the extremes over position and time, the envelope along the body, the diagram at an instant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.tables.text_table import TextColumn, TextTable, head
from heuncli.results.results import Array, Extremes, Indices, Place, Results
from heuncli.results.results_schema import MAGNITUDES, RESULTANTS, STRESSES, row_of
from heuncli.study.quantities.digits import (
    OPEN,
    OPEN_NOTE,
    UNKNOWN,
    UNKNOWN_NOTE,
    ZERO_NOTE,
    Certainty,
    Style,
    beyond_horizon,
    largest,
    style,
    write,
    write_times,
)
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.table_units import Shown, Units

STRETCH_NOTE = "extremes of the whole stretch, between the cuts and at its corners, too"
MOST_CUTS = 25  # of a diagram: evenly spaced cuts, with all jumps and extremes


class RunQuantity(NamedTuple):
    """A quantity along a run: its name in the results, its label, its unit, and whether it is never negative.

    bounds: which of its lowest and highest say something at a cut; size: of one of its unit in the results, here.
    """

    name: str
    label: str
    unit: str
    even: bool = False
    bounds: tuple[str, ...] = ("min", "max")
    size: float = 1.0


def _stress(name: str) -> RunQuantity:
    unit = row_of(f"sections.SECTION.stress.{name}").unit()
    bounds = ("min",) if name == "normal_min" else ("max",)
    return RunQuantity(name, name.replace("_", " "), unit, name in MAGNITUDES, bounds)


LOADS = tuple(RunQuantity(name, name, row_of(f"sections.SECTION.{name}").unit()) for name in RESULTANTS)
ALONG_STRESSES = tuple(_stress(name) for name in STRESSES)


class CutRun(NamedTuple):
    """One run of cuts: positions along the body [m], sides; its loads, then its stresses, (n, n_t, n_cuts).

    length: the unit in which positions are shown.
    """

    name: str
    heading: str
    s: Array
    side: tuple[str | None, ...]
    values: Array
    quantities: tuple[RunQuantity, ...] = LOADS
    length: Shown = ("m", 1.0)

    @property
    def loads(self) -> tuple[RunQuantity, ...]:
        """The resultants among the quantities: N, Q1, Q2, T, M1, M2."""
        return self.quantities[: len(LOADS)]

    @property
    def stresses(self) -> tuple[RunQuantity, ...]:
        """The stresses among the quantities, behind the resultants; none without section properties."""
        return self.quantities[len(LOADS) :]


def runs_of(results: Results, labels: Labels, units: Mapping[str, str] | None = None) -> list[CutRun]:
    """The runs of cuts among the sections; units: those that stand for others, of what is no force but an impulse."""
    shown = labels.units
    loads = tuple(_shown_in(load._replace(unit=(units or {}).get(load.unit, load.unit)), shown) for load in LOADS)
    runs = []
    for name, section in results.sections.items():
        if "s" not in section:
            continue
        info = labels.sections.get(name)
        of = f"{name} {info.body}" if info else name
        axis = f"e1 = {info.first_axis}, e2 = n × e1" if info else "e2 = n × e1"
        about = info.about if info else "the cut's point"
        whose = f"{'impulse of ' * bool(units)}the piece beyond the cut ON the part before it; N > 0 tension"
        heading = f"SECTION {of}  {whose}; {axis}; moments about {about}"
        stress = section.get("stress", {})
        stresses = tuple(_shown_in(own, shown) for own in ALONG_STRESSES if own.name in stress)
        own = [load.size * section[load.name] for load in loads]
        own += [one.size * stress[one.name] for one in stresses]
        side = tuple(section.get("side") or [None] * len(section["s"]))
        s = np.asarray(section["s"], dtype=np.float64)
        runs.append(CutRun(name, heading, s, side, np.stack(own), (*loads, *stresses), shown.of("m")))
    return runs


def _shown_in(quantity: RunQuantity, units: Units) -> RunQuantity:
    unit, size = units.of(quantity.unit)
    return quantity._replace(unit=unit, size=size)


def in_units(run: CutRun, found: Extremes) -> Extremes:
    """Extremes of the loads along a run, of results, as they are shown."""
    sizes = np.array([load.size for load in run.loads])
    return found._replace(low=sizes * found.low, high=sizes * found.high)


def extremes_tables(
    run: CutRun,
    times: Array,
    extremes: Extremes,
    places: Sequence[tuple[Place, Place]],
    certain: Certainty,
    cuts: Extremes | None = None,
) -> list[TextTable]:
    """Extremes over the whole stretch and time, of each quantity with their places; and those at each cut.

    cuts: those at the cuts that are shown, of one quantity after the other; without, among the samples.
    """
    kept = thinned(run)
    shape = len(run.quantities), len(kept)
    if cuts is None:
        own = run.values[:, :, kept].transpose(1, 0, 2).reshape(run.values.shape[1], -1)
        cuts = extremes_of_samples(times, own)
    extremes, places, cuts = one_source(run, kept, extremes, places, cuts)
    where = "between the samples, too" if cuts.searched else f"in {run.values.shape[1]} samples"
    notes = [f"envelope: lowest and highest at each cut over the run, {where}{_rest(run, kept)}"]
    table = extremes_table(run, times, extremes, places, certain)
    styles = _styles(run, certain, extremes)
    bounds = {"min": cuts.low.reshape(shape), "max": cuts.high.reshape(shape)}
    return [table, _envelope(run, bounds, kept, styles, notes)]


def extremes_of_samples(times: Array, values: Array) -> Extremes:
    """The lowest and the highest of columns (n_t, n) at the instants."""
    low = np.argmin(np.nan_to_num(values, nan=np.inf), axis=0)
    high = np.argmax(np.nan_to_num(values, nan=-np.inf), axis=0)
    column = np.arange(values.shape[1])
    return Extremes(values[low, column], times[low], column, values[high, column], times[high], column, searched=False)


def one_source(
    run: CutRun, kept: Indices, head: Extremes, places: Sequence[tuple[Place, Place]], cuts: Extremes
) -> tuple[Extremes, tuple[tuple[Place, Place], ...], Extremes]:
    """Extremes of the stretch and of its cuts, each the better of what two searches found there."""
    ends, ends_at = np.stack([head.low, head.high]), np.stack([head.low_at, head.high_at])
    bounds, instants = np.stack([cuts.low, cuts.high]), np.stack([cuts.low_at, cuts.high_at])
    found = [list(both) for both in places]
    for i in range(len(places)):
        for side, sign in ((0, -1.0), (1, 1.0)):
            own = slice(i * len(kept), (i + 1) * len(kept))
            best = int(np.argmax(np.nan_to_num(sign * bounds[side, own], nan=-np.inf)))
            cut = int(kept[best])
            if sign * bounds[side, own][best] > sign * ends[side, i]:
                ends[side, i], ends_at[side, i] = bounds[side, own][best], instants[side, own][best]
                found[i][side] = Place(float(run.s[cut]), run.side[cut], cut)
            elif found[i][side].cut in kept:
                bounds[side, own][kept == found[i][side].cut] = ends[side, i]
    whole = head._replace(low=ends[0], high=ends[1], low_at=ends_at[0], high_at=ends_at[1])
    return whole, tuple((a, b) for a, b in found), cuts._replace(low=bounds[0], high=bounds[1])


def _envelope(
    run: CutRun, bounds: Mapping[str, Array], kept: Indices, styles: Mapping[str, Style], notes: Sequence[str]
) -> TextTable:
    """A line a cut with the lowest and the highest there; what is 0 throughout is left out."""
    columns, texts, left_out = list[TextColumn](), list[list[str]](), False
    for i, own in enumerate(run.quantities):
        both = [write(bounds[word][i].tolist(), styles[own.unit]) for word in own.bounds]
        if {text for column in both for text in column} == {"0"}:
            left_out = True
            continue
        words = own.bounds if len(both) > 1 and both[0] != both[1] else ("",)  # what is steady is told once
        texts += both[: len(words)]
        columns += [TextColumn(head(f"{own.label} {word}".rstrip(), own.unit), vector=own.label) for word in words]
    if not columns:
        return TextTable("", notes=(*notes, "0 throughout"))
    shown = {text for column in texts for text in column}
    below = [*notes, *[ZERO_NOTE] * left_out]
    below += [note for word, note in ((OPEN, OPEN_NOTE), (UNKNOWN, UNKNOWN_NOTE)) if word in shown]
    return _at_cuts(run, kept, columns, texts, below)


def _at_cuts(
    run: CutRun, kept: Indices, columns: Sequence[TextColumn], texts: Sequence[Sequence[str]], notes: Sequence[str]
) -> TextTable:
    """A line a cut, behind its place and side."""
    positions = _positions(run)
    sides = any(side is not None for side in run.side)
    rows = tuple(
        (positions[cut], *([run.side[cut] or ""] if sides else []), *(column[j] for column in texts))
        for j, cut in enumerate(kept)
    )
    heads = [TextColumn(f"s [{run.length[0]}]"), *([TextColumn("side", "left")] if sides else [])]
    return TextTable("", (*heads, *columns), rows, tuple(notes))


def extremes_table(
    run: CutRun, times: Array, extremes: Extremes, places: Sequence[tuple[Place, Place]], certain: Certainty
) -> TextTable:
    """The lowest and the highest of each resultant over the whole stretch and time, with where and when."""
    styles = _styles(run, certain, extremes)
    span = float(np.ptp(times))
    rows: list[tuple[str, ...]] = []
    quantities = run.quantities[: len(extremes.low)]
    for i, own in enumerate(quantities):
        low, high = write([float(extremes.low[i]), float(extremes.high[i])], styles[own.unit])
        if low == high == "0":
            continue
        label, unit = own.label, own.unit if own.unit != "1" else ""
        if low == high:
            rows.append((label, unit, low, "", "", high, "", ""))
            continue
        clock = write_times([float(extremes.low_at[i]), float(extremes.high_at[i])], span)
        low_at, high_at = (
            "" if _steady(run.values[i][:, _nearest(run, place)], styles[own.unit]) else t
            for place, t in zip(places[i], clock, strict=True)
        )
        where = [position(place, run) for place in places[i]]
        rows.append((label, unit, low, where[0], low_at, high, where[1], high_at))
    at = f"at s [{run.length[0]}]"
    heads = ("min", at, "t [s]", "max", at, "t [s]")
    columns = (TextColumn("", "left"), TextColumn("", "left"), *(TextColumn(head) for head in heads))
    if len(times) == 1:
        columns, rows = columns[:4] + columns[5:7], [(*row[:4], *row[5:7]) for row in rows]
    if not rows:
        return TextTable(run.heading, notes=("0 throughout",))
    notes = (STRETCH_NOTE, *[OPEN_NOTE] * any(OPEN in row for row in rows))
    return TextTable(run.heading, columns, tuple(rows), (*notes, *[ZERO_NOTE] * (len(rows) < len(quantities))))


def instants_tables(
    run: CutRun, times: Array, horizon: float | None, certain: Certainty, *, every: bool = False
) -> list[TextTable]:
    """The diagram at each instant."""
    styles = _styles(run, certain)
    kept = np.arange(len(run.s)) if every else thinned(run)
    if len(times) == 1:
        diagram = _diagram(run, run.values[:, 0, :], kept, styles, [_rest(run, kept).lstrip("; ")])
        return [_without_zero(run, diagram._replace(heading=run.heading))]
    clock = write_times(times.tolist(), float(np.ptp(times)))
    rows: list[tuple[str, ...] | str] = []
    table = TextTable("")
    notes: tuple[str, ...] = ()
    for i, t in enumerate(times):
        lost = certain if horizon is not None and t >= horizon else None
        table = _diagram(run, run.values[:, i, :], kept, styles, [_rest(run, kept).lstrip("; ")], lost)
        rows += [f"t = {clock[i]} s", *table.rows]
        notes += table.notes
    return [_without_zero(run, TextTable(run.heading, table.columns, tuple(rows), tuple(dict.fromkeys(notes))))]


def thinned(run: CutRun) -> Indices:
    """Which cuts a diagram shows, at most about MOST_CUTS: evenly spaced ones, both ends, jumps and extremes."""
    n = len(run.s)
    if n <= MOST_CUTS:
        return np.arange(n)
    chosen = set(np.linspace(0, n - 1, MOST_CUTS // 2 + 1).round().astype(int).tolist())
    chosen |= {i for i, side in enumerate(run.side) if side is not None}
    flat = np.nan_to_num(run.values).max(axis=1), np.nan_to_num(run.values).min(axis=1)
    chosen |= {int(np.argmax(row)) for row in flat[0]} | {int(np.argmin(row)) for row in flat[1]}
    return np.array(sorted(chosen))


def _diagram(
    run: CutRun,
    values: Array,
    kept: Indices,
    styles: dict[str, Style],
    notes: Sequence[str],
    beyond: Certainty | None = None,
) -> TextTable:
    """A line a cut; `values` is (6, n_cuts). beyond: given where the instant is beyond the horizon."""
    texts = []
    for own, row in zip(run.quantities, values[:, kept].tolist(), strict=True):
        column = write(row, styles[own.unit])
        if beyond is not None:
            column = [beyond_horizon(value, own.unit, beyond, text) for value, text in zip(row, column, strict=True)]
        texts.append(column)
    shown = {text for column in texts for text in column}
    below = [note for note in notes if note]
    below += [note for word, note in ((OPEN, OPEN_NOTE), (UNKNOWN, UNKNOWN_NOTE)) if word in shown]
    columns = [TextColumn(head(own.label, own.unit), vector="loads") for own in run.loads]
    columns += [TextColumn(head(own.label, own.unit)) for own in run.stresses]
    return _at_cuts(run, kept, columns, texts, below)


def _without_zero(run: CutRun, table: TextTable) -> TextTable:
    """The diagrams without the quantities that are 0 throughout, if there are others."""
    cells = [row for row in table.rows if not isinstance(row, str)]
    lead = len(table.columns) - len(run.quantities)
    kept = [i for i in range(len(table.columns)) if i < lead or {row[i] for row in cells} != {"0"}]
    if len(kept) in (lead, len(table.columns)):
        return table
    rows = tuple(row if isinstance(row, str) else tuple(row[i] for i in kept) for row in table.rows)
    return TextTable(table.heading, tuple(table.columns[i] for i in kept), rows, (*table.notes, ZERO_NOTE))


def _styles(run: CutRun, certain: Certainty, extremes: Extremes | None = None) -> dict[str, Style]:
    """How numbers are written, by unit: by all numbers of that unit that are shown of the run."""
    bounds = np.zeros((2, 0)) if extremes is None else np.stack([extremes.low, extremes.high])
    styles = {}
    for unit in dict.fromkeys(own.unit for own in run.quantities):
        own = [i for i, other in enumerate(run.quantities) if other.unit == unit]
        scale = max(largest(run.values[own]), largest(bounds[:, [i for i in own if i < bounds.shape[1]]]))
        styles[unit] = certain.style("sections", unit, scale)
    return styles


def _steady(values: Array, how: Style) -> bool:
    """Whether the values of one cut are equal at all instants to the digits shown: then an extreme has no instant."""
    return how.write(float(np.min(values))) == how.write(float(np.max(values)))


def _nearest(run: CutRun, place: Place) -> int:
    """The asked cut at a place, or the nearest to it."""
    return int(np.argmin(np.abs(run.s - place.s))) if place.cut is None else place.cut


def position(place: Place, run: CutRun) -> str:
    """A place in words: the distance, and between the ends the side of what acts there."""
    side = [place.side] if place.side and 0.0 < place.s < run.s[-1] else []
    size = run.length[1]
    return " ".join([*write([size * place.s], style(size * largest(run.s), 0.0)), *side])


def _positions(run: CutRun) -> list[str]:
    s = run.length[1] * run.s
    return write(s.tolist(), style(largest(s), 0.0))


def _rest(run: CutRun, kept: Indices) -> str:
    if len(kept) == len(run.s):
        return ""
    return f"; {len(kept)} of {len(run.s)} cuts shown, jumps and extremes among them; every cut: --all, or --format csv"
