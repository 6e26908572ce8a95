"""Tables of events and of impacts.

Events are instants at which conditions change. Tables of impacts are in newton seconds: what met when, and for each
impact the jumps of velocity and the impulses.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.as_text import select_columns
from heuncli.output.documents.document import (
    Cell,
    NumberCell,
    OutputColumn,
    OutputTable,
    format_cell,
    is_zero_cell,
    make_number_cells,
)
from heuncli.output.tables import cut_tables
from heuncli.output.tables.indeterminate import make_sums_table
from heuncli.output.tables.instants_tables import make_group_cells, make_instants_tables
from heuncli.output.tables.table_blocks import RowGroup, TableBlock, build_block
from heuncli.output.tables.table_plans import IMPULSES
from heuncli.results.path_words import IMPULSE_BLOCKS, IMPULSE_UNITS, find_quantity
from heuncli.results.results import Array, Block, DeterminateSum, Extremes, Indices, Magnitudes, Results
from heuncli.results.results_schema import SHARES, XYZ
from heuncli.study.quantities.channels import Channel, iter_impulse_channels
from heuncli.study.quantities.cut_series import CutSeries, collect_cut_series
from heuncli.study.quantities.digits import (
    OPEN,
    UNKNOWN,
    UNKNOWN_NOTE,
    ZERO_NOTE,
    StatedErrors,
    add_axis_errors,
    choose_style,
    largest_magnitude,
    trim_zeros,
    write_times,
)
from heuncli.study.quantities.labels import Labels

EVENTS_HEADING = "EVENTS  times at which conditions change, and their new values"
EVENT_COLUMNS = (
    OutputColumn("event", "text"),
    OutputColumn("condition", "text"),
    OutputColumn("t [s]"),
    OutputColumn("becomes", "text"),
)
MARGINAL_NOTE = "marginal: the margin is as small as the error, so a slightly different run may not show it"
MAX_INSTANTS = 20  # instants of an event in a table, unless all are requested
MAX_SHOWN, MAX_LISTED = 3, 20  # impacts with tables, impacts in the list, unless all are requested
UNIT = "N·s"
IMPULSES_HEADING = (
    "IMPULSES  all impulses of the run: largest impulse and angular impulse on a joint, stop or the ground; "
    "kinetic energy"
)
N_LEADING = 3  # columns before the numbers of an impact: name, label and unit
NUMBER_HEADS = (*XYZ, "value")  # the value of a vector is its magnitude
IMPACT_COLUMNS = (
    *[OutputColumn("", "text")] * N_LEADING,
    *(OutputColumn(head, vector="numbers") for head in NUMBER_HEADS),
    OutputColumn("", "text", is_optional=True),  # notes
)
ENERGIES = ("energy_before", "energy_after", "energy_jump")


def make_events_table(results: Results, *, all_instants: bool = False) -> OutputTable:
    """Make the table of events; all_instants: show every instant of each event."""
    rows: list[tuple[str, ...]] = []
    is_marginal = False
    for name, event in results.events.items():
        event_lines = list(iter_event_lines(event))
        is_marginal = is_marginal or any(not math.isfinite(error) for error in event["error"])
        shown = event_lines if all_instants else event_lines[:MAX_INSTANTS]
        begins = "true" if event["begins"] else "false"
        shown = shown or [("", f"{begins} at all times")]
        rows += [(name, event["condition"], *shown[0]), *(("", "", *line) for line in shown[1:])]
        if len(event_lines) > len(shown):
            rows.append(("", f"{len(event_lines) - len(shown)} more with --all", "", ""))
    return OutputTable(EVENTS_HEADING, EVENT_COLUMNS, tuple(rows), (MARGINAL_NOTE,) if is_marginal else ())


def iter_event_lines(event: Block) -> Iterator[tuple[str, str]]:
    """Yield each instant with the digits that its error leaves, and what the condition becomes there."""
    for t, error, is_true in zip(event["time"].tolist(), event["error"].tolist(), event["to"], strict=True):
        becomes = "true" if is_true else "false"
        if not math.isfinite(error):
            yield f"{t:.3g}", f"{becomes}, marginal"
            continue
        number_style = choose_style(t, error)
        yield trim_zeros([number_style.write(t)])[0] if number_style.is_known else UNKNOWN, becomes


class ImpactReport(NamedTuple):
    """The impacts of a run, and the accuracy of their numbers.

    magnitudes: what the numbers are summed from
    series_extremes: for each impact, the extremes along its series of cuts
    details: whether to include tables that are shown only on request
    """

    results: Results
    labels: Labels
    stated_errors: StatedErrors
    magnitudes: Magnitudes
    series_extremes: Sequence[Mapping[str, Extremes]] = ()
    details: bool = True


def make_impulse_tables(report: ImpactReport, *, show_all: bool = False) -> list[OutputTable]:
    """Make a list of the impacts if there are several, and tables of each, or only of the largest if there are many."""
    impulses = report.results.impulses
    if not impulses:
        return []
    sizes = np.array([find_largest_impulses(impulse, report.labels) for impulse in impulses])
    shown = (
        np.arange(len(impulses))
        if show_all or len(impulses) <= MAX_SHOWN
        else _choose_largest(sizes @ [1.0, 1.0 / report.magnitudes.size])
    )
    tables = [make_impact_list(report, sizes, shown, show_all)] if len(impulses) > 1 else []
    return tables + [table for number in shown.tolist() for table in make_impact_tables(report, number, show_all)]


def find_largest_impulses(impulse: Block, labels: Labels) -> tuple[float, float]:
    """Return the largest impulse of a joint, stop, the ground or all bodies [N s], and the largest moment's [N m s]."""
    joints, ground = impulse.get("joints", {}), impulse.get("foundation", {})
    forces = [part["force"] for part in (*joints.values(), ground, ground.get("mass_effect", {})) if "force" in part]
    moments = [joint["moment"] for joint in joints.values() if "moment" in joint]
    for name, joint in joints.items():
        if "drive" in joint:
            (moments if labels.is_rotational("joints", name) else forces).append(joint["drive"])
    forces += [stop["force"] for stop in impulse.get("stops", {}).values() if "force" in stop]
    moments += [stop["moment"] for stop in impulse.get("stops", {}).values() if "moment" in stop]
    force, moment = (np.array([np.linalg.norm(part) for part in parts]) for parts in (forces, moments))
    return largest_magnitude(force), largest_magnitude(moment)


def _choose_largest(sizes: Array) -> Indices:
    """Return the indices of the largest impacts in their order; of equal ones the first."""
    largest_first = np.argsort(-sizes, kind="stable")
    return np.sort(largest_first[:MAX_SHOWN])


def make_impact_list(report: ImpactReport, sizes: Array, shown_numbers: Indices, show_all: bool) -> OutputTable:
    """Make the list with a row for each impact: its time, names, largest impulses, and effect on the kinetic energy."""
    impulses, stated_errors = report.results.impulses, report.stated_errors
    times = np.array([float(impulse["time"]) for impulse in impulses])
    energies = {key: np.array([float(impulse.get(key, np.nan)) for impulse in impulses]) for key in ENERGIES}
    si_units = (UNIT, IMPULSE_UNITS["N·m"])
    (energy_unit, joules), *impulse_units = (stated_errors.units.find(unit) for unit in ("J", *si_units))
    energy = make_number_cells(
        (joules * np.concatenate(list(energies.values()))).tolist(),
        stated_errors.choose_style("energy", "J", max(map(largest_magnitude, energies.values()))),
        joules * stated_errors.error_of("energy", "J"),
    )
    impulse, moment = (
        make_number_cells(
            (per_si * values).tolist(),
            stated_errors.choose_style("reactions", unit, largest_magnitude(values)),
            per_si * stated_errors.error_of("reactions", unit),
        )
        for values, unit, (_, per_si) in zip(sizes.T, si_units, impulse_units, strict=True)
    )
    clock = write_times(times.tolist(), float(np.ptp(report.results.time)) or float(np.ptp(times)))
    horizon = report.results.horizon
    rows = []
    listed = impulses if show_all else impulses[:MAX_LISTED]
    for i, block in enumerate(listed):
        cells: list[Cell] = [impulse[i], moment[i], *energy[i :: len(impulses)]]
        if horizon is not None and times[i] >= horizon:
            cells = [UNKNOWN] * len(cells)
        instant = NumberCell(float(times[i]), cached_text=clock[i])
        rows.append((i, instant, ", ".join(block["names"]), *cells))
    columns = (
        OutputColumn(""), OutputColumn("t", "instant", "s"), OutputColumn("cause", "text"),
        *(OutputColumn("largest", unit=unit) for unit, _ in impulse_units),
        *(OutputColumn(word, unit=energy_unit) for word in ("energy before", "after", "change")),
    )  # fmt: skip
    numbers = ", ".join(map(str, shown_numbers.tolist()))
    note = f"details below: {numbers} (the largest); all: --all or --format csv"
    hidden_note = f"{len(impulses) - len(listed)} further, the last at t = {clock[-1]} s"
    notes = (hidden_note,) * (len(listed) < len(impulses)) + (note,) * (len(shown_numbers) < len(impulses))
    return OutputTable(IMPULSES_HEADING, columns, tuple(rows), notes)


def make_impact_tables(report: ImpactReport, number: int, show_all: bool = False) -> list[OutputTable]:
    """Make the tables of an impact: loaded objects, central axis, series of cuts, shares by cause, determinate sums.

    number: of the impact in the run, from 0
    """
    impulse = report.results.impulses[number]
    view, labels = make_impact_results(report.results, impulse), report.labels
    title = f"IMPULSE at t = {float(impulse['time']):.6g} s ({', '.join(impulse['names'])})"
    prefix = f"{title}  "  # of the headings of its tables
    horizon = report.results.horizon
    stated_errors = add_axis_errors(report.stated_errors, view, report.magnitudes, UNIT)
    channels = list(iter_impulse_channels(impulse, labels))
    by_cause = any(channel.cause for channel in channels)
    blocks, tables, share_tables = list[TableBlock](), list[OutputTable](), list[OutputTable]()
    for plan in IMPULSES:
        block = build_block(plan, view, labels, channels) if report.details or not plan.is_detail else None
        if block is None:
            continue
        named = block._replace(heading=prefix + block.heading)
        blocks += [block] * plan.has_extremes
        tables += make_instants_tables(named, view.time, horizon, stated_errors) if not plan.has_extremes else []
        share_tables += make_share_tables(named, view, channels, stated_errors, horizon) if by_cause else []
    tables[:0] = [make_impact_table(title, blocks, view.time, horizon, stated_errors)] if blocks else []
    series_extremes = report.series_extremes[number] if report.series_extremes else {}
    for series in collect_cut_series(view, labels, IMPULSE_UNITS):
        series_tables = cut_tables.make_instants_tables(series, view.time, horizon, stated_errors, every_cut=show_all)
        if series.name in series_extremes:
            table = cut_tables.make_extremes_table(series, view.time, series_extremes[series.name], stated_errors)
            series_tables = [table, series_tables[0]._replace(heading=""), *series_tables[1:]]
        tables += [series_tables[0]._replace(heading=prefix + series_tables[0].heading), *series_tables[1:]]
        share_tables += [
            own._replace(heading=prefix + own.heading)
            for own in make_series_share_tables(series, view, stated_errors, horizon)
        ]
    tables += share_tables
    sums = make_sums_table(view, stated_errors, unit=UNIT)
    return [*tables, sums._replace(heading=prefix + sums.heading)] if sums else tables


def make_share_tables(
    block: TableBlock, view: Results, channels: Sequence[Channel], stated_errors: StatedErrors, horizon: float | None
) -> list[OutputTable]:
    """Make the tables of what each cause contributes to the impulses of a block."""
    from heuncli.output.tables import cause_tables  # few runs need it

    numbers = cause_tables.collect_shares(channels, view)
    return cause_tables.make_instants_tables(block, numbers, view.time, horizon, stated_errors)


def make_series_share_tables(
    series: CutSeries, view: Results, stated_errors: StatedErrors, horizon: float | None
) -> list[OutputTable]:
    """Make the tables of what each cause contributes to the impulses along a series of cuts, if that is requested."""
    if SHARES not in view.sections[series.name]:
        return []
    from heuncli.output.tables.page_cause_tables import make_series_instants_tables  # few runs need it

    return make_series_instants_tables(series, view, horizon, stated_errors)


def make_impact_results(results: Results, impulse: Block) -> Results:
    """Return the results of a run with the blocks of one impact in place of its own, at the instant of the impact."""
    parts: dict[str, Any] = {
        key: add_time_axis((key,), impulse.get(key, {})) for key in IMPULSE_BLOCKS if key != "certain_sums"
    }
    sums: list[DeterminateSum] = [
        {"terms": certain_sum["terms"], "value": np.atleast_1d(certain_sum["value"])}
        for certain_sum in impulse.get("certain_sums", ())
    ]
    time = np.array([float(impulse["time"])])
    return replace(results, time=time, impulses=[], certain_sums=sums, **parts)


def add_time_axis(keys: tuple[str, ...], value: Any) -> Any:
    """Add the axis of instants to a block of an impact."""
    if isinstance(value, dict):
        return {key: add_time_axis((*keys, key), member) for key, member in value.items()}
    row = find_quantity(keys)
    return np.asarray(value, dtype=np.float64)[None] if row is not None and row.is_timed else value


def make_impact_table(
    heading: str, blocks: Sequence[TableBlock], times: Array, horizon: float | None, stated_errors: StatedErrors
) -> OutputTable:
    """Combine the blocks of one impact in a single table, without rows and columns that are zero.

    times: the instant of the impact, (1,)
    """
    rows: list[tuple[Cell, ...] | str] = []
    notes, is_complete = list[str](), True
    for block in blocks:
        row_cells = [line for group in block.groups for line in _iter_rows(block, group, times, horizon, stated_errors)]
        nonzero = [line for line in row_cells if not all(map(is_zero_cell, line[N_LEADING:-1]))]
        is_complete &= len(nonzero) == len(row_cells)
        if nonzero:
            rows += [block.heading, *_blank_repeated_names(nonzero)]
            notes += block.notes
        words = {format_cell(cell) for line in nonzero for cell in line}
        notes += [note for word, note in (block.missing, (UNKNOWN, UNKNOWN_NOTE)) if word in words]
    if not rows:
        return OutputTable(heading, notes=("all values 0",))
    table = _drop_empty_columns(OutputTable(heading, IMPACT_COLUMNS, tuple(rows)))
    numbers = {column.title for column in table.columns} & set(NUMBER_HEADS)
    notes += [ZERO_NOTE] if not is_complete or len(numbers) < len(NUMBER_HEADS) else []
    return table._replace(notes=tuple(dict.fromkeys(notes)))


def _iter_rows(
    block: TableBlock, group: RowGroup, times: Array, horizon: float | None, stated_errors: StatedErrors
) -> Iterator[tuple[Cell, ...]]:
    """Yield for each vector, and each other number: name, label, unit, components, value, and the group's note."""
    cell_of_label = {
        label: cells_of_label[0]
        for label, cells_of_label in make_group_cells(block, group, times, horizon, stated_errors).items()
    }
    texts = {label: format_cell(cell) for label, cell in cell_of_label.items()}
    magnitudes = {row.family: texts[row.label] for row in group.rows if row.is_magnitude and row.vector}
    for _, vector_rows in groupby(group.rows, key=lambda row: row.vector or row.label):
        rows = list(vector_rows)
        if not _repeats_magnitude(rows[0], texts, magnitudes):
            cells = [cell_of_label[row.label] for row in rows]
            before = [None] * (len(NUMBER_HEADS) - len(cells))
            # the heading holds the key: "energy after" becomes "after"
            label = rows[0].vector or rows[0].label.removeprefix(f"{block.key} ")
            yield (group.caption, label, stated_errors.units.find(rows[0].unit)[0], *before, *cells, group.note)


def _repeats_magnitude(row: Channel, texts: Mapping[str, str], magnitudes: Mapping[str, str]) -> bool:
    """Return whether the row only repeats the vector's magnitude, as a radial force without an axial one."""
    known = texts[row.label] not in (OPEN, UNKNOWN)
    return known and not row.vector and row.is_magnitude and texts[row.label] == magnitudes.get(row.family)


def _blank_repeated_names(lines: Sequence[tuple[Cell, ...]]) -> Iterator[tuple[Cell, ...]]:
    """Show the name and note of consecutive rows of one object only in the first of them."""
    last_name = None
    for line in lines:
        yield line if line[0] != last_name or not last_name else ("", *line[1:-1], "")
        last_name = line[0]


def _drop_empty_columns(table: OutputTable) -> OutputTable:
    """Drop the columns that are empty or zero in every row."""
    cells = [row for row in table.rows if not isinstance(row, str)]
    shown_columns = [i for i in range(len(table.columns)) if not all(is_zero_cell(row[i]) for row in cells)]
    return select_columns(table, shown_columns)
