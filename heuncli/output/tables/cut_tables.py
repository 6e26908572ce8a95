"""Tables of series of cuts: extremes over position and time, the envelope along the body, the diagram at an instant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.output.documents.as_text import select_columns
from heuncli.output.documents.document import Cell, OutputColumn, OutputTable, format_cell, make_number_cells
from heuncli.results.results import Array, CutPosition, Extremes, Indices
from heuncli.results.results_schema import STRESSES
from heuncli.study.quantities.cut_series import (
    CutSeries,
    choose_cuts,
    find_sample_extremes,
    merge_extremes,
    select_extremes,
    split_into_cuts,
)
from heuncli.study.quantities.digits import (
    OPEN,
    OPEN_NOTE,
    UNKNOWN,
    UNKNOWN_NOTE,
    ZERO_COLUMNS_NOTE,
    ZERO_NOTE,
    StatedErrors,
    Style,
    choose_style,
    format_unclaimed,
    largest_magnitude,
    write_numbers,
    write_times,
)

EXTREMES_NOTE = "extremes over the whole bar, also between the listed cuts"

BOTH_BOUNDS = ("min", "max")
BOUNDS = dict.fromkeys(STRESSES, ("max",)) | {"normal_min": ("min",)}  # those of interest at a cut; else both


def make_extremes_tables(
    series: CutSeries, times: Array, extremes: Extremes, stated_errors: StatedErrors, cuts: Extremes | None = None
) -> list[OutputTable]:
    """Make two tables: extremes of each quantity over the whole length and time, and extremes at each cut.

    extremes: of the channels along the series
    cuts: of all quantities at the cuts that are shown; without them, the extremes among the samples
    """
    shown_cuts = choose_cuts(series)
    if cuts is None:
        columns = [channel.values for channel in split_into_cuts(series.channels, shown_cuts)]
        cuts = find_sample_extremes(times, np.stack(columns, axis=1))
    head, cuts = merge_extremes(series, shown_cuts, select_extremes(series, extremes), cuts)
    where = "also between the output times" if cuts.is_searched else f"at {len(series.channels[0].values)} output times"
    hidden = _format_hidden_cuts(series, shown_cuts)
    notes = [f"envelope: minimum and maximum at each cut over the run, {where}{hidden}"]
    shape = len(series.channels), len(shown_cuts)
    bounds = {"min": cuts.low.reshape(shape), "max": cuts.high.reshape(shape)}
    styles = _choose_styles(series, stated_errors, head)
    envelope = _make_envelope(series, bounds, shown_cuts, styles, notes, stated_errors)
    return [make_extremes_table(series, times, head, stated_errors), envelope]


def _make_envelope(
    series: CutSeries,
    bounds: Mapping[str, Array],
    shown_cuts: Indices,
    styles: Mapping[str, Style],
    notes: Sequence[str],
    stated_errors: StatedErrors,
) -> OutputTable:
    """Make the table of the lowest and highest value at each cut; quantities that are zero throughout are left out."""
    columns, cells, left_out = list[OutputColumn](), list[Sequence[Cell]](), False
    for i, channel in enumerate(series.channels):
        unit, per_si = stated_errors.units.find(channel.unit)
        words: Sequence[str] = BOUNDS.get(channel.quantity, BOTH_BOUNDS)
        error = per_si * stated_errors.find_error(channel)
        both = [make_number_cells((per_si * bounds[word][i]).tolist(), styles[channel.unit], error) for word in words]
        texts = [[cell.text for cell in column] for column in both]
        if {text for column in texts for text in column} == {"0"}:
            left_out = True
            continue
        words = words if len(texts) > 1 and texts[0] != texts[1] else ("",)  # a constant value has one column
        cells += both[: len(words)]
        columns += [OutputColumn(f"{channel.label} {word}".rstrip(), unit=unit, vector=channel.label) for word in words]
    if not columns:
        return OutputTable("", notes=(*notes, "all values 0"))
    return _make_cuts_table(series, shown_cuts, columns, cells, [*notes, *[ZERO_COLUMNS_NOTE] * left_out])


def _make_cuts_table(
    series: CutSeries,
    shown_cuts: Indices,
    columns: Sequence[OutputColumn],
    cells: Sequence[Sequence[Cell]],
    notes: Sequence[str],
) -> OutputTable:
    """Make a table with a row for each cut that begins with its position and side; cells: by columns."""
    unit, per_si = series.length
    positions = make_number_cells((per_si * series.s).tolist(), choose_style(per_si * largest_magnitude(series.s), 0.0))
    sides = any(side is not None for side in series.side)
    rows = tuple(
        (positions[cut], *([series.side[cut] or ""] if sides else []), *(column[j] for column in cells))
        for j, cut in enumerate(shown_cuts)
    )
    heads = [OutputColumn("s", unit=unit), *([OutputColumn("side", "text")] if sides else [])]
    shown = {format_cell(cell) for column in cells for cell in column}
    word_notes = (note for word, note in ((OPEN, OPEN_NOTE), (UNKNOWN, UNKNOWN_NOTE)) if word in shown)
    return OutputTable("", (*heads, *columns), rows, (*notes, *word_notes))


def make_extremes_table(
    series: CutSeries, times: Array, extremes: Extremes, stated_errors: StatedErrors
) -> OutputTable:
    """Make the table of the lowest and highest value of each quantity over length and time, with place and instant."""
    extremes = select_extremes(series, extremes)
    styles = _choose_styles(series, stated_errors, extremes)
    span, has_times = float(np.ptp(times)), len(times) > 1
    rows: list[tuple[Cell, ...]] = []
    channels = series.channels[: len(extremes.low)]
    for i, channel in enumerate(channels):
        unit, per_si = stated_errors.units.find(channel.unit)
        ends = [per_si * float(extremes.low[i]), per_si * float(extremes.high[i])]
        low, high = make_number_cells(ends, styles[channel.unit], per_si * stated_errors.find_error(channel))
        if low.text == high.text == "0":
            continue
        label, unit = channel.label, unit if unit != "1" else ""
        if low.text == high.text:
            rows.append((label, unit, low, "", "", high, "", "") if has_times else (label, unit, low, "", high, ""))
            continue
        where = [format_place(place, series) for place in extremes.places[i]]
        if not has_times:
            rows.append((label, unit, low, where[0], high, where[1]))
            continue
        clock = write_times([float(extremes.low_at[i]), float(extremes.high_at[i])], span)
        low_at, high_at = (
            "" if _is_constant(per_si * channel.values[:, series.find_nearest_cut(place)], styles[channel.unit]) else t
            for place, t in zip(extremes.places[i], clock, strict=True)
        )
        rows.append((label, unit, low, where[0], low_at, high, where[1], high_at))
    ends_columns = [
        column
        for word in ("min", "max")
        for column in (
            OutputColumn(word),
            OutputColumn("at s", unit=series.length[0]),
            *([OutputColumn("t", "instant", "s")] if has_times else []),
        )
    ]
    columns = (OutputColumn("", "text"), OutputColumn("", "text"), *ends_columns)
    if not rows:
        return OutputTable(series.heading, notes=("all values 0",))
    is_open = any(format_cell(cell) == OPEN for row in rows for cell in row)
    notes = (EXTREMES_NOTE, *[OPEN_NOTE] * is_open)
    return OutputTable(series.heading, columns, tuple(rows), (*notes, *[ZERO_NOTE] * (len(rows) < len(channels))))


def make_instants_tables(
    series: CutSeries, times: Array, horizon: float | None, stated_errors: StatedErrors, *, every_cut: bool = False
) -> list[OutputTable]:
    """Make the table with the diagram at each instant: the numbers of every shown cut.

    horizon: the instant [s] from which on nothing is claimed
    every_cut: show all cuts, not only about MAX_CUTS
    """
    styles = _choose_styles(series, stated_errors)
    shown_cuts = np.arange(len(series.s)) if every_cut else choose_cuts(series)
    hidden_note = [_format_hidden_cuts(series, shown_cuts).lstrip("; ")]
    if len(times) == 1:
        diagram = _make_diagram(series, 0, shown_cuts, styles, hidden_note, stated_errors)
        return [_drop_zero_columns(series, diagram._replace(heading=series.heading))]
    clock = write_times(times.tolist(), float(np.ptp(times)))
    rows: list[Sequence[Cell] | str] = []
    table = OutputTable("")
    notes: tuple[str, ...] = ()
    for i, t in enumerate(times):
        is_beyond = horizon is not None and t >= horizon
        table = _make_diagram(series, i, shown_cuts, styles, hidden_note, stated_errors, is_beyond=is_beyond)
        rows += [f"t = {clock[i]} s", *table.rows]
        notes = (*notes, *table.notes)
    return [
        _drop_zero_columns(series, OutputTable(series.heading, table.columns, tuple(rows), tuple(dict.fromkeys(notes))))
    ]


def _make_diagram(
    series: CutSeries,
    instant: int,
    shown_cuts: Indices,
    styles: dict[str, Style],
    notes: Sequence[str],
    stated_errors: StatedErrors,
    *,
    is_beyond: bool = False,
) -> OutputTable:
    """Make the diagram at an instant, by its index, a row for each cut; is_beyond: whether it is beyond the horizon."""
    cells, columns = list[Sequence[Cell]](), list[OutputColumn]()
    for i, channel in enumerate(series.channels):
        row, (unit, per_si) = channel.values[instant, shown_cuts], stated_errors.units.find(channel.unit)
        columns.append(OutputColumn(channel.label, unit=unit, vector="loads" if i < len(series.loads) else ""))
        numbers = make_number_cells(
            (per_si * row).tolist(), styles[channel.unit], per_si * stated_errors.find_error(channel)
        )
        if is_beyond:
            values = zip(row.tolist(), numbers, strict=True)
            cells.append([format_unclaimed(value, channel.unit, stated_errors, cell.text) for value, cell in values])
        else:
            cells.append(numbers)
    return _make_cuts_table(series, shown_cuts, columns, cells, [note for note in notes if note])


def _drop_zero_columns(series: CutSeries, table: OutputTable) -> OutputTable:
    """Drop the quantities that are zero throughout, unless all of them are."""
    cells = [row for row in table.rows if not isinstance(row, str)]
    lead, n = len(table.columns) - len(series.channels), len(table.columns)
    shown_columns = [i for i in range(n) if i < lead or {format_cell(row[i]) for row in cells} != {"0"}]
    if len(shown_columns) in (lead, n):
        return table
    return select_columns(table, shown_columns)._replace(notes=(*table.notes, ZERO_COLUMNS_NOTE))


def _choose_styles(
    series: CutSeries, stated_errors: StatedErrors, extremes: Extremes | None = None
) -> dict[str, Style]:
    """Choose the number style of each unit from all numbers of that unit that are shown of the series."""
    bounds = np.zeros((2, 0)) if extremes is None else np.stack([extremes.low, extremes.high])
    scales: dict[str, float] = {}
    for i, channel in enumerate(series.channels):
        largest = max(largest_magnitude(channel.values), largest_magnitude(bounds[:, i : i + 1]))
        scales[channel.unit] = max(scales.get(channel.unit, 0.0), largest)
    return {unit: stated_errors.choose_style("sections", unit, scale) for unit, scale in scales.items()}


def _is_constant(values: Array, number_style: Style) -> bool:
    """Return whether the values (n_t,) at one cut are equal to the digits shown; then an extreme has no instant."""
    return number_style.write(float(np.min(values))) == number_style.write(float(np.max(values)))


def format_place(place: CutPosition, series: CutSeries) -> str:
    """Format a place: its distance, and between the ends the side of the load that acts there."""
    side = [place.side] if place.side and 0.0 < place.s < series.s[-1] else []
    per_si = series.length[1]
    return " ".join(
        [*write_numbers([per_si * place.s], choose_style(per_si * largest_magnitude(series.s), 0.0)), *side]
    )


def _format_hidden_cuts(series: CutSeries, shown_cuts: Indices) -> str:
    """Format how many of the cuts are shown, after a semicolon; "" if all are."""
    if len(shown_cuts) == len(series.s):
        return ""
    counts = f"{len(shown_cuts)} of {len(series.s)}"
    return f"; {counts} cuts shown, including jumps and extremes; all cuts: --all or --format csv"
