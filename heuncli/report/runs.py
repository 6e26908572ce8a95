"""Runs of cuts: the extremes over position and time, the envelope along the body, the diagram at an instant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from heuncli.report.labels import Labels
from heuncli.report.numbers import (
    OPEN,
    OPEN_NOTE,
    UNKNOWN,
    UNKNOWN_NOTE,
    Certainty,
    Style,
    beyond_horizon,
    largest,
    style,
    write,
    write_times,
)
from heuncli.report.table import Column, Table
from heuncli.results import Array, Extremes, Indices, Place, Results
from heuncli.results_schema import row_of

RESULTANTS = tuple((name, row_of(f"sections.SECTION.{name}").unit()) for name in ("N", "Q1", "Q2", "T", "M1", "M2"))
STRETCH_NOTE = "extremes of the whole stretch, between the cuts and at its corners, too"
MOST_CUTS = 25  # of a diagram: evenly spaced cuts, with all jumps and extremes


class Run(NamedTuple):
    """One run of cuts: positions along the body, sides, and its resultants (6, n_t, n_cuts), with their units."""

    name: str
    heading: str
    s: Array
    side: tuple[str | None, ...]
    values: Array
    resultants: tuple[tuple[str, str], ...] = RESULTANTS


def runs_of(results: Results, labels: Labels, units: Mapping[str, str] | None = None) -> list[Run]:
    """The runs of cuts among the sections; units: those that stand for others, of what is no force but an impulse."""
    resultants = tuple((name, (units or {}).get(unit, unit)) for name, unit in RESULTANTS)
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
        values = np.stack([section[quantity] for quantity, _ in RESULTANTS])
        side = tuple(section.get("side") or [None] * len(section["s"]))
        runs.append(Run(name, heading, np.asarray(section["s"], dtype=np.float64), side, values, resultants))
    return runs


def extremes_tables(
    run: Run, times: Array, extremes: Extremes, places: Sequence[tuple[Place, Place]], certain: Certainty
) -> list[Table]:
    """Extremes over the whole stretch and time, (6,) each with their places; at each cut the value farthest from 0."""
    styles = _styles(run, certain, extremes)
    envelope = np.take_along_axis(run.values, _farthest(run.values)[:, None, :], axis=1)[:, 0, :]
    kept = thinned(run)
    notes = [f"envelope: at each cut the value farthest from zero in {run.values.shape[1]} samples" + _rest(run, kept)]
    table = extremes_table(run, times, extremes, places, certain)
    return [table, _diagram(run, envelope, kept, styles, notes)]


def extremes_table(
    run: Run, times: Array, extremes: Extremes, places: Sequence[tuple[Place, Place]], certain: Certainty
) -> Table:
    """The lowest and the highest of each resultant over the whole stretch and time, with where and when."""
    styles = _styles(run, certain, extremes)
    span = float(np.ptp(times))
    rows: list[tuple[str, ...]] = []
    for i, (label, unit) in enumerate(run.resultants):
        low, high = write([float(extremes.low[i]), float(extremes.high[i])], styles[unit])
        if low == high:
            rows.append((label, unit, low, "", "", high, "", ""))
            continue
        clock = write_times([float(extremes.low_at[i]), float(extremes.high_at[i])], span)
        low_at, high_at = (
            "" if _steady(run.values[i][:, _nearest(run, place)], styles[unit]) else t
            for place, t in zip(places[i], clock, strict=True)
        )
        where = [position(place, run.s) for place in places[i]]
        rows.append((label, unit, low, where[0], low_at, high, where[1], high_at))
    heads = ("min", "at s [m]", "t [s]", "max", "at s [m]", "t [s]")
    columns = (Column("", "left"), Column("", "left"), *(Column(head) for head in heads))
    if len(times) == 1:
        columns, rows = columns[:4] + columns[5:7], [(*row[:4], *row[5:7]) for row in rows]
    is_open = any(OPEN in row for row in rows)
    return Table(run.heading, columns, tuple(rows), (STRETCH_NOTE, *((OPEN_NOTE,) if is_open else ())))


def instants_tables(
    run: Run, times: Array, horizon: float | None, certain: Certainty, *, every: bool = False
) -> list[Table]:
    """The diagram at each instant."""
    styles = _styles(run, certain)
    kept = np.arange(len(run.s)) if every else thinned(run)
    if len(times) == 1:
        diagram = _diagram(run, run.values[:, 0, :], kept, styles, [_rest(run, kept).lstrip("; ")])
        return [Table(run.heading, diagram.columns, diagram.rows, diagram.notes)]
    clock = write_times(times.tolist(), float(np.ptp(times)))
    rows: list[tuple[str, ...] | str] = []
    table = Table("")
    notes: tuple[str, ...] = ()
    for i, t in enumerate(times):
        lost = certain if horizon is not None and t >= horizon else None
        table = _diagram(run, run.values[:, i, :], kept, styles, [_rest(run, kept).lstrip("; ")], lost)
        rows += [f"t = {clock[i]} s", *table.rows]
        notes += table.notes
    return [Table(run.heading, table.columns, tuple(rows), tuple(dict.fromkeys(notes)))]


def thinned(run: Run) -> Indices:
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
    run: Run,
    values: Array,
    kept: Indices,
    styles: dict[str, Style],
    notes: Sequence[str],
    beyond: Certainty | None = None,
) -> Table:
    """A line a cut; `values` is (6, n_cuts). beyond: given where the instant is beyond the horizon."""
    positions = _positions(run.s)
    texts = []
    for (_, unit), row in zip(run.resultants, values[:, kept].tolist(), strict=True):
        own = write(row, styles[unit])
        if beyond is not None:
            own = [beyond_horizon(value, unit, beyond, text) for value, text in zip(row, own, strict=True)]
        texts.append(own)
    sides = any(side is not None for side in run.side)
    rows = tuple(
        (positions[cut], *([run.side[cut] or ""] if sides else []), *(column[j] for column in texts))
        for j, cut in enumerate(kept)
    )
    heads = [Column("s [m]"), *([Column("side", "left")] if sides else [])]
    shown = {text for column in texts for text in column}
    below = [note for note in notes if note]
    below += [note for word, note in ((OPEN, OPEN_NOTE), (UNKNOWN, UNKNOWN_NOTE)) if word in shown]
    return Table("", (*heads, *(Column(f"{label} [{unit}]") for label, unit in run.resultants)), rows, tuple(below))


def _styles(run: Run, certain: Certainty, extremes: Extremes | None = None) -> dict[str, Style]:
    """The style of forces and that of moments, by all that is shown of them."""
    bounds = np.zeros((2, len(run.resultants))) if extremes is None else np.stack([extremes.low, extremes.high])
    styles = {}
    for unit in dict.fromkeys(unit for _, unit in run.resultants):
        own = [i for i, (_, other) in enumerate(run.resultants) if other == unit]
        scale = max(largest(run.values[own]), largest(bounds[:, own]))
        styles[unit] = certain.style("sections", unit, scale)
    return styles


def _farthest(values: Array) -> Indices:
    """Index of the instant at which each is farthest from zero, (6, n_cuts); the first where all are open."""
    farthest: Indices = np.argmax(np.nan_to_num(np.abs(values), nan=-1.0), axis=1)
    return farthest


def _steady(values: Array, how: Style) -> bool:
    """Whether the values of one cut are equal at all instants to the digits shown: then an extreme has no instant."""
    return how.write(float(np.min(values))) == how.write(float(np.max(values)))


def _nearest(run: Run, place: Place) -> int:
    """The asked cut at a place, or the nearest to it."""
    return int(np.argmin(np.abs(run.s - place.s))) if place.cut is None else place.cut


def position(place: Place, s: Array) -> str:
    """A place in words: the distance, and between the ends the side of what acts there."""
    side = [place.side] if place.side and 0.0 < place.s < s[-1] else []
    return " ".join([*write([place.s], style(largest(s), 0.0)), *side])


def _positions(s: Array) -> list[str]:
    return write(s.tolist(), style(largest(s), 0.0))


def _rest(run: Run, kept: Indices) -> str:
    if len(kept) == len(run.s):
        return ""
    return f"; {len(kept)} of {len(run.s)} cuts shown, jumps and extremes among them; every cut: --all, or --format csv"
