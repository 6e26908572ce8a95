"""Tables of runs of cuts: extremes over position and time, the envelope along the body, the diagram at an instant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.document import Cell, OutputColumn, OutputTable, format_head
from heuncli.results.results import Array, CutPosition, Extremes, Indices, Results
from heuncli.results.results_schema import MAGNITUDES, RESULTANTS, STRESSES, find_row
from heuncli.study.quantities.digits import (
    OPEN,
    OPEN_NOTE,
    UNKNOWN,
    UNKNOWN_NOTE,
    ZERO_NOTE,
    StatedErrors,
    Style,
    choose_style,
    format_unclaimed,
    largest_magnitude,
    write_numbers,
    write_times,
)
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.table_units import DisplayUnit, Units

EXTREMES_NOTE = "extremes over the whole bar, also between the listed cuts"
MAX_CUTS = 25  # in a diagram: evenly spaced cuts, with all jumps and extremes


class RunQuantity(NamedTuple):
    """A quantity along a run of cuts.

    name: in the results
    is_magnitude: whether it is never negative
    bounds: which of "min" and "max" are of interest at a cut
    size: factor from the unit of the results to the unit shown
    """

    name: str
    label: str
    unit: str
    is_magnitude: bool = False
    bounds: tuple[str, ...] = ("min", "max")
    size: float = 1.0


def _make_stress_quantity(name: str) -> RunQuantity:
    unit = find_row(f"sections.SECTION.stress.{name}").select_unit()
    bounds = ("min",) if name == "normal_min" else ("max",)
    return RunQuantity(name, name.replace("_", " "), unit, name in MAGNITUDES, bounds)


LOADS = tuple(RunQuantity(name, name, find_row(f"sections.SECTION.{name}").select_unit()) for name in RESULTANTS)
ALONG_STRESSES = tuple(_make_stress_quantity(name) for name in STRESSES)


class CutRun(NamedTuple):
    """One run of cuts.

    s: positions along the body [m]
    side: of each cut, which side of a load that acts there; None elsewhere
    values: section forces, then stresses, (n, n_t, n_cuts), in the units shown
    length: the unit in which positions are shown
    """

    name: str
    heading: str
    s: Array
    side: tuple[str | None, ...]
    values: Array
    quantities: tuple[RunQuantity, ...] = LOADS
    length: DisplayUnit = ("m", 1.0)

    @property
    def loads(self) -> tuple[RunQuantity, ...]:
        """The section forces among the quantities: N, Q1, Q2, T, M1, M2."""
        return self.quantities[: len(LOADS)]

    @property
    def stresses(self) -> tuple[RunQuantity, ...]:
        """The stresses among the quantities, after the section forces; none without section properties."""
        return self.quantities[len(LOADS) :]


def collect_runs(results: Results, labels: Labels, units: Mapping[str, str] | None = None) -> list[CutRun]:
    """Collect the runs of cuts among the sections.

    units: replacements of units, for impulses instead of forces
    """
    display_units = labels.units
    loads = tuple(
        _convert_quantity(load._replace(unit=(units or {}).get(load.unit, load.unit)), display_units) for load in LOADS
    )
    runs = []
    for name, section in results.sections.items():
        if "s" not in section:
            continue
        info = labels.sections.get(name)
        subject = f"{name}, body {info.body}" if info else name
        axis = f"e1 = {info.first_axis}, e2 = n × e1" if info else "e2 = n × e1"
        reference_point = info.moment_point if info else "the cut's point"
        meaning = f"{'impulse' if units else 'force'} of the far side on the near side of the cut; N > 0 tension"
        heading = f"SECTION {subject}  {meaning}; {axis}; moments about {reference_point}"
        stress = section.get("stress", {})
        stresses = tuple(
            _convert_quantity(run_values, display_units) for run_values in ALONG_STRESSES if run_values.name in stress
        )
        run_values = [load.size * section[load.name] for load in loads]
        run_values += [stress_quantity.size * stress[stress_quantity.name] for stress_quantity in stresses]
        side = tuple(section.get("side") or [None] * len(section["s"]))
        s = np.asarray(section["s"], dtype=np.float64)
        runs.append(CutRun(name, heading, s, side, np.stack(run_values), (*loads, *stresses), display_units.find("m")))
    return runs


def _convert_quantity(quantity: RunQuantity, units: Units) -> RunQuantity:
    unit, size = units.find(quantity.unit)
    return quantity._replace(unit=unit, size=size)


def convert_extremes(run: CutRun, extremes: Extremes) -> Extremes:
    """Convert the extremes of section forces along a run from the units of results to those shown."""
    sizes = np.array([load.size for load in run.loads])
    return extremes._replace(low=sizes * extremes.low, high=sizes * extremes.high)


def make_extremes_tables(
    run: CutRun,
    times: Array,
    extremes: Extremes,
    places: Sequence[tuple[CutPosition, CutPosition]],
    certain: StatedErrors,
    cuts: Extremes | None = None,
) -> list[OutputTable]:
    """Make two tables: extremes of each quantity over the whole length and time, with their places; extremes at each
    cut.

    cuts: extremes at the cuts shown, quantity by quantity; without them, the extremes among the samples
    """
    shown_cuts = choose_cuts(run)
    shape = len(run.quantities), len(shown_cuts)
    if cuts is None:
        columns = run.values[:, :, shown_cuts].transpose(1, 0, 2).reshape(run.values.shape[1], -1)
        cuts = find_sample_extremes(times, columns)
    extremes, places, cuts = merge_extremes(run, shown_cuts, extremes, places, cuts)
    where = "also between the output times" if cuts.is_searched else f"at {run.values.shape[1]} output times"
    notes = [f"envelope: minimum and maximum at each cut over the run, {where}{_format_hidden_cuts(run, shown_cuts)}"]
    table = make_extremes_table(run, times, extremes, places, certain)
    styles = _choose_styles(run, certain, extremes)
    bounds = {"min": cuts.low.reshape(shape), "max": cuts.high.reshape(shape)}
    return [table, _make_envelope(run, bounds, shown_cuts, styles, notes)]


def find_sample_extremes(times: Array, values: Array) -> Extremes:
    """Return the lowest and highest of each column (n_t, n) among the samples."""
    low = np.argmin(np.nan_to_num(values, nan=np.inf), axis=0)
    high = np.argmax(np.nan_to_num(values, nan=-np.inf), axis=0)
    column = np.arange(values.shape[1])
    return Extremes(
        values[low, column], times[low], column, values[high, column], times[high], column, is_searched=False
    )


def merge_extremes(
    run: CutRun, shown_cuts: Indices, head: Extremes, places: Sequence[tuple[CutPosition, CutPosition]], cuts: Extremes
) -> tuple[Extremes, tuple[tuple[CutPosition, CutPosition], ...], Extremes]:
    """Merge the extremes of the whole length and of its cuts, so that each is the better result of two searches."""
    ends, ends_at = np.stack([head.low, head.high]), np.stack([head.low_at, head.high_at])
    bounds, instants = np.stack([cuts.low, cuts.high]), np.stack([cuts.low_at, cuts.high_at])
    best_places = [list(both) for both in places]
    for i in range(len(places)):
        for side, sign in ((0, -1.0), (1, 1.0)):
            columns = slice(i * len(shown_cuts), (i + 1) * len(shown_cuts))
            best = int(np.argmax(np.nan_to_num(sign * bounds[side, columns], nan=-np.inf)))
            cut = int(shown_cuts[best])
            if sign * bounds[side, columns][best] > sign * ends[side, i]:
                ends[side, i], ends_at[side, i] = bounds[side, columns][best], instants[side, columns][best]
                best_places[i][side] = CutPosition(float(run.s[cut]), run.side[cut], cut)
            elif best_places[i][side].cut in shown_cuts:
                bounds[side, columns][shown_cuts == best_places[i][side].cut] = ends[side, i]
    merged = head._replace(low=ends[0], high=ends[1], low_at=ends_at[0], high_at=ends_at[1])
    return merged, tuple((a, b) for a, b in best_places), cuts._replace(low=bounds[0], high=bounds[1])


def _make_envelope(
    run: CutRun, bounds: Mapping[str, Array], shown_cuts: Indices, styles: Mapping[str, Style], notes: Sequence[str]
) -> OutputTable:
    """Make the table of the lowest and highest value at each cut; quantities that are zero throughout are left out."""
    columns, texts, left_out = list[OutputColumn](), list[list[str]](), False
    for i, quantity in enumerate(run.quantities):
        both = [write_numbers(bounds[word][i].tolist(), styles[quantity.unit]) for word in quantity.bounds]
        if {text for column in both for text in column} == {"0"}:
            left_out = True
            continue
        words = quantity.bounds if len(both) > 1 and both[0] != both[1] else ("",)  # a constant value has one column
        texts += both[: len(words)]
        columns += [
            OutputColumn(format_head(f"{quantity.label} {word}".rstrip(), quantity.unit), vector=quantity.label)
            for word in words
        ]
    if not columns:
        return OutputTable("", notes=(*notes, "all values 0"))
    shown = {text for column in texts for text in column}
    all_notes = [*notes, *[ZERO_NOTE] * left_out]
    all_notes += [note for word, note in ((OPEN, OPEN_NOTE), (UNKNOWN, UNKNOWN_NOTE)) if word in shown]
    return _make_cuts_table(run, shown_cuts, columns, texts, all_notes)


def _make_cuts_table(
    run: CutRun,
    shown_cuts: Indices,
    columns: Sequence[OutputColumn],
    texts: Sequence[Sequence[str]],
    notes: Sequence[str],
) -> OutputTable:
    """Make a table with a row for each cut that begins with its position and side."""
    positions = _format_positions(run)
    sides = any(side is not None for side in run.side)
    rows = tuple(
        (positions[cut], *([run.side[cut] or ""] if sides else []), *(column[j] for column in texts))
        for j, cut in enumerate(shown_cuts)
    )
    heads = [OutputColumn(f"s [{run.length[0]}]"), *([OutputColumn("side", "text")] if sides else [])]
    return OutputTable("", (*heads, *columns), rows, tuple(notes))


def make_extremes_table(
    run: CutRun,
    times: Array,
    extremes: Extremes,
    places: Sequence[tuple[CutPosition, CutPosition]],
    certain: StatedErrors,
) -> OutputTable:
    """Make the table of the lowest and highest value of each quantity over the whole length and time, with place and
    instant.
    """
    styles = _choose_styles(run, certain, extremes)
    span = float(np.ptp(times))
    rows: list[tuple[str, ...]] = []
    quantities = run.quantities[: len(extremes.low)]
    for i, quantity in enumerate(quantities):
        low, high = write_numbers([float(extremes.low[i]), float(extremes.high[i])], styles[quantity.unit])
        if low == high == "0":
            continue
        label, unit = quantity.label, quantity.unit if quantity.unit != "1" else ""
        if low == high:
            rows.append((label, unit, low, "", "", high, "", ""))
            continue
        clock = write_times([float(extremes.low_at[i]), float(extremes.high_at[i])], span)
        low_at, high_at = (
            "" if _is_constant(run.values[i][:, _find_nearest_cut(run, place)], styles[quantity.unit]) else t
            for place, t in zip(places[i], clock, strict=True)
        )
        where = [format_place(place, run) for place in places[i]]
        rows.append((label, unit, low, where[0], low_at, high, where[1], high_at))
    position_head = f"at s [{run.length[0]}]"
    heads = ("min", position_head, "t [s]", "max", position_head, "t [s]")
    columns = (OutputColumn("", "text"), OutputColumn("", "text"), *(OutputColumn(head) for head in heads))
    if len(times) == 1:
        columns, rows = columns[:4] + columns[5:7], [(*row[:4], *row[5:7]) for row in rows]
    if not rows:
        return OutputTable(run.heading, notes=("all values 0",))
    notes = (EXTREMES_NOTE, *[OPEN_NOTE] * any(OPEN in row for row in rows))
    return OutputTable(run.heading, columns, tuple(rows), (*notes, *[ZERO_NOTE] * (len(rows) < len(quantities))))


def make_instants_tables(
    run: CutRun, times: Array, horizon: float | None, certain: StatedErrors, *, every_cut: bool = False
) -> list[OutputTable]:
    """Make the table with the diagram at each instant."""
    styles = _choose_styles(run, certain)
    shown_cuts = np.arange(len(run.s)) if every_cut else choose_cuts(run)
    if len(times) == 1:
        diagram = _make_diagram(
            run, run.values[:, 0, :], shown_cuts, styles, [_format_hidden_cuts(run, shown_cuts).lstrip("; ")]
        )
        return [_drop_zero_columns(run, diagram._replace(heading=run.heading))]
    clock = write_times(times.tolist(), float(np.ptp(times)))
    rows: list[Sequence[Cell] | str] = []
    table = OutputTable("")
    notes: tuple[str, ...] = ()
    for i, t in enumerate(times):
        certain_beyond = certain if horizon is not None and t >= horizon else None
        table = _make_diagram(
            run,
            run.values[:, i, :],
            shown_cuts,
            styles,
            [_format_hidden_cuts(run, shown_cuts).lstrip("; ")],
            certain_beyond,
        )
        rows += [f"t = {clock[i]} s", *table.rows]
        notes = (*notes, *table.notes)
    return [_drop_zero_columns(run, OutputTable(run.heading, table.columns, tuple(rows), tuple(dict.fromkeys(notes))))]


def choose_cuts(run: CutRun) -> Indices:
    """Choose the cuts that a diagram shows, about MAX_CUTS: evenly spaced ones, both ends, all jumps and extremes."""
    n = len(run.s)
    if n <= MAX_CUTS:
        return np.arange(n)
    chosen = set(np.linspace(0, n - 1, MAX_CUTS // 2 + 1).round().astype(int).tolist())
    chosen |= {i for i, side in enumerate(run.side) if side is not None}
    flat = np.nan_to_num(run.values).max(axis=1), np.nan_to_num(run.values).min(axis=1)
    chosen |= {int(np.argmax(row)) for row in flat[0]} | {int(np.argmin(row)) for row in flat[1]}
    return np.array(sorted(chosen))


def _make_diagram(
    run: CutRun,
    values: Array,
    shown_cuts: Indices,
    styles: dict[str, Style],
    notes: Sequence[str],
    certain_beyond: StatedErrors | None = None,
) -> OutputTable:
    """Make the diagram at one instant, a row for each cut.

    values: (n, n_cuts)
    certain_beyond: given if the instant is beyond the horizon
    """
    texts = []
    for quantity, row in zip(run.quantities, values[:, shown_cuts].tolist(), strict=True):
        column = write_numbers(row, styles[quantity.unit])
        if certain_beyond is not None:
            column = [
                format_unclaimed(value, quantity.unit, certain_beyond, text)
                for value, text in zip(row, column, strict=True)
            ]
        texts.append(column)
    shown = {text for column in texts for text in column}
    all_notes = [note for note in notes if note]
    all_notes += [note for word, note in ((OPEN, OPEN_NOTE), (UNKNOWN, UNKNOWN_NOTE)) if word in shown]
    columns = [OutputColumn(format_head(quantity.label, quantity.unit), vector="loads") for quantity in run.loads]
    columns += [OutputColumn(format_head(quantity.label, quantity.unit)) for quantity in run.stresses]
    return _make_cuts_table(run, shown_cuts, columns, texts, all_notes)


def _drop_zero_columns(run: CutRun, table: OutputTable) -> OutputTable:
    """Drop the quantities that are zero throughout, unless all of them are."""
    cells = [row for row in table.rows if not isinstance(row, str)]
    lead = len(table.columns) - len(run.quantities)
    shown_columns = [i for i in range(len(table.columns)) if i < lead or {row[i] for row in cells} != {"0"}]
    if len(shown_columns) in (lead, len(table.columns)):
        return table
    rows = tuple(row if isinstance(row, str) else tuple(row[i] for i in shown_columns) for row in table.rows)
    return OutputTable(table.heading, tuple(table.columns[i] for i in shown_columns), rows, (*table.notes, ZERO_NOTE))


def _choose_styles(run: CutRun, certain: StatedErrors, extremes: Extremes | None = None) -> dict[str, Style]:
    """Choose the number style of each unit from all numbers of that unit that are shown of the run."""
    bounds = np.zeros((2, 0)) if extremes is None else np.stack([extremes.low, extremes.high])
    styles = {}
    for unit in dict.fromkeys(indices.unit for indices in run.quantities):
        indices = [i for i, other in enumerate(run.quantities) if other.unit == unit]
        scale = max(
            largest_magnitude(run.values[indices]),
            largest_magnitude(bounds[:, [i for i in indices if i < bounds.shape[1]]]),
        )
        styles[unit] = certain.choose_style("sections", unit, scale)
    return styles


def _is_constant(values: Array, number_style: Style) -> bool:
    """Return whether the values at one cut are equal at all instants to the digits shown; then an extreme has no
    instant.
    """
    return number_style.write(float(np.min(values))) == number_style.write(float(np.max(values)))


def _find_nearest_cut(run: CutRun, place: CutPosition) -> int:
    """Return the index of the cut at a place, or of the nearest one."""
    return int(np.argmin(np.abs(run.s - place.s))) if place.cut is None else place.cut


def format_place(place: CutPosition, run: CutRun) -> str:
    """Format a place: its distance, and between the ends the side of the load that acts there."""
    side = [place.side] if place.side and 0.0 < place.s < run.s[-1] else []
    size = run.length[1]
    return " ".join([*write_numbers([size * place.s], choose_style(size * largest_magnitude(run.s), 0.0)), *side])


def _format_positions(run: CutRun) -> list[str]:
    s = run.length[1] * run.s
    return write_numbers(s.tolist(), choose_style(largest_magnitude(s), 0.0))


def _format_hidden_cuts(run: CutRun, shown_cuts: Indices) -> str:
    if len(shown_cuts) == len(run.s):
        return ""
    return (
        f"; {len(shown_cuts)} of {len(run.s)} cuts shown, including jumps and extremes; all cuts: --all or --format csv"
    )
