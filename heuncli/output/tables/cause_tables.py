"""Tables of loads by cause: a row for each number, a column for each cause, then the sum of the shares and the total.

At given instants every number has a row. Over a run, the minimum and the maximum of each number are shown with the
shares at their instants, which shows what causes them. The share of a magnitude is the component along the whole
vector, so that these shares add up as well.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.as_text import INDENT
from heuncli.output.documents.document import Cell, NumberCell, OutputColumn, OutputTable, format_cell, is_zero_cell
from heuncli.output.tables.table_blocks import TableBlock
from heuncli.results.path_words import BY_CAUSE
from heuncli.results.results import Array, Extremes, Results
from heuncli.results.results_schema import SECTION_FORCES, SECTION_MOMENTS
from heuncli.study.quantities.channels import Channel
from heuncli.study.quantities.digits import (
    OPEN,
    OPEN_NOTE,
    UNKNOWN,
    UNKNOWN_NOTE,
    ZERO_NOTE,
    StatedErrors,
    format_unclaimed,
    write_numbers,
    write_times,
)
from heuncli.study.quantities.labels import distinguish

TOTAL_COLUMNS = ("sum", "total")  # after those of the causes
MAX_CAUSE_COLUMNS = 9  # further, smaller causes share one column
ALONG_NOTE = "|F|, |M|: component of each contribution along the total"
CAUSES_NOTE = "motion: from inertia forces quadratic in the velocities; drives: from prescribed accelerations"
DIRECT_NOTE = (
    "direct: the load itself, where it is applied; the rest of its contribution acts through the motion it causes"
)
# Section force -> the vector, and the axis of the section, of which it is the component.
AXES = {
    name: (vector, axis)
    for vector, names in (("force", SECTION_FORCES), ("moment", SECTION_MOMENTS))
    for axis, name in enumerate(names)
}


class NumberWithShares(NamedTuple):
    """The channel of a number, its shares by cause, and the direct shares of the loads; (n_t,) each."""

    row: Channel
    shares: dict[str, Array]
    direct: dict[str, Array]


class ShareLine(NamedTuple):
    """One table row: a number with its shares. The rows of one family show the same decimals.

    position: the instant, or the place along a series of cuts as text
    total: the number itself, None for a row of direct shares
    is_beyond_horizon: whether nothing is claimed at its instant
    is_uncertain: whether the instant is so near a singular position that the number is not known
    """

    label: str
    position: Cell
    row: Channel
    shares: dict[str, float]
    total: float | None
    is_beyond_horizon: bool = False
    is_uncertain: bool = False


LineGroups = Sequence[tuple[str, Sequence[ShareLine]]]  # titles and lines


def collect_shares(channels: Iterable[Channel], results: Results) -> dict[str, NumberWithShares]:
    """Collect the numbers that have shares by cause, by their paths, except those of series of cuts.

    channels: all of the results
    """
    runs = {name for name, section in results.sections.items() if "s" in section}
    shares_of: dict[str, dict[str, Channel]] = {}
    totals: list[Channel] = []
    for channel in channels:
        if channel.kind == "sections" and channel.name.split(".")[0] in runs:
            continue
        if channel.cause:
            shares_of.setdefault(channel._replace(cause="").path, {})[channel.cause] = channel
        else:
            totals.append(channel)
    numbers: dict[str, NumberWithShares] = {}
    for total in totals:
        shares = shares_of.get(total.path)
        if shares is None:
            continue
        direct = find_direct_shares(results, total, shares_of)
        for i, row in enumerate(total.numbers):
            parts = {cause: project_share(row, i, total, share.values) for cause, share in shares.items()}
            direct_parts = {cause: values[:, i] for cause, values in direct.items() if i < values.shape[1]}
            numbers[row.path] = NumberWithShares(row, parts, direct_parts)
    return numbers


def project_share(row: Channel, i: int, total: Channel, share: Array) -> Array:
    """Return the share in component i, or, for the magnitude, the share's component along the whole vector; (n_t,)."""
    if i < share.shape[1]:
        return share[:, i]
    magnitude = np.where(row.values > 0.0, row.values, 1.0)
    return np.asarray(np.einsum("ti,ti->t", share, total.values) / magnitude)


def find_direct_shares(
    results: Results, item: Channel, shares_of: Mapping[str, Mapping[str, Channel]]
) -> dict[str, Array]:
    """Find the direct shares of the loads in a quantity, (n_t, n) each.

    Of a section force they are the components of the direct force or moment along the section's axes n, e1, e2.
    """
    is_resultant = item.kind == "sections" and item.quantity in AXES
    vector, axis = AXES[item.quantity] if is_resultant else (item.quantity, None)
    direct_shares = shares_of.get(item._replace(quantity=f"direct_{vector}").path, {})
    if axis is None:
        return {cause: share.values for cause, share in direct_shares.items()}
    section = results.sections[item.name]
    n, e1 = section["normal"], section["first_axis"]
    direction = (n, e1, np.cross(n, e1))[axis]
    return {cause: np.sum(share.values * direction, axis=1)[:, None] for cause, share in direct_shares.items()}


def make_instants_tables(
    block: TableBlock,
    numbers: Mapping[str, NumberWithShares],
    times: Array,
    horizon: float | None,
    stated_errors: StatedErrors,
) -> list[OutputTable]:
    """Make the table of all numbers of a block that have shares, at every instant. Empty list if there are none.

    times (n_t,): of the numbers [s]
    horizon: the instant from which on nothing is claimed
    """
    clock: list[Cell] = [""] if len(times) == 1 else [*_make_instants(times.tolist(), float(np.ptp(times)))]
    groups: list[tuple[str, list[ShareLine]]] = []
    for group in block.groups:
        lines: list[ShareLine] = []
        for row in group.rows:
            number = numbers.get(row.path)
            if number is None:
                continue
            for k, t in enumerate(times.tolist()):
                doubts = horizon is not None and t >= horizon, t in stated_errors.singular_times
                value = float(number.row.values[k])
                lines.append(ShareLine(row.label, clock[k], number.row, _select(number.shares, k), value, *doubts))
                if number.direct:
                    direct = _select(number.direct, k)
                    lines.append(ShareLine(f"{row.label} direct", "", number.row, direct, None, *doubts))
        groups.append((group.title, lines))
    return (
        [make_share_table(make_shares_heading(block.heading), groups, stated_errors)]
        if any(lines for _, lines in groups)
        else []
    )


def make_extremes_tables(
    block: TableBlock,
    numbers: Mapping[str, NumberWithShares],
    instants: Array,
    extremes: Extremes,
    stated_errors: StatedErrors,
    span: float,
) -> list[OutputTable]:
    """Make the table of the minimum and maximum of every number of a block, with the shares at their instants.

    numbers: at `instants`, which include those of the extremes
    extremes: of the channels
    span: length of the run [s]
    """
    groups: list[tuple[str, list[ShareLine]]] = []
    for group in block.groups:
        lines: list[ShareLine] = []
        for row in group.rows:
            number = numbers.get(row.path)
            if number is None:
                continue
            found = extremes.find([row.path])
            low, high = (float(found.low_at[0]), float(found.low[0])), (float(found.high_at[0]), float(found.high[0]))
            ends = [("", *high)] if low[1] == high[1] else [("min", *low), ("max", *high)]
            lines += [
                make_share_line(number, instants, f"{row.label} {word}".rstrip(), time, value, span if word else 0.0)
                for word, time, value in ends
                if not (row.is_magnitude and word == "min")
            ]
        groups.append((group.title, lines))
    return (
        [make_share_table(make_shares_heading(block.heading), groups, stated_errors)]
        if any(lines for _, lines in groups)
        else []
    )


def make_share_line(
    number: NumberWithShares, instants: Array, label: str, time: float, value: float, span: float
) -> ShareLine:
    """Make the row of a number at one of the instants; span: length of the run [s], 0 to show no instant."""
    k = int(np.searchsorted(instants, time))
    clock: Cell = _make_instants([time], span)[0] if span > 0.0 else ""
    return ShareLine(label, clock, number.row, _select(number.shares, k), value)


def _select(shares: Mapping[str, Array], k: int) -> dict[str, float]:
    """Select the shares at the instant k."""
    return {cause: float(values[k]) for cause, values in shares.items()}


def _make_instants(times: Sequence[float], span: float) -> list[NumberCell]:
    """Make the cells of instants, which are printed with their unit."""
    texts = write_times(times, span)
    return [NumberCell(t, cached_text=f"{text} s") for t, text in zip(times, texts, strict=True)]


def make_shares_heading(heading: str) -> str:
    """Add to the heading of a block or series of cuts the remark that its loads are by cause."""
    return heading.replace("  ", f" {BY_CAUSE.upper()}  ", 1)


def make_share_table(heading: str, groups: LineGroups, stated_errors: StatedErrors) -> OutputTable:
    """Make the table of grouped rows with a column for each cause. Rows and columns that are zero are left out."""
    all_lines = [line for _, lines in groups for line in lines]
    causes = dict.fromkeys(cause for line in all_lines for cause in line.shares)
    shown_causes, small_causes = choose_causes(list(causes), all_lines)
    heads = [*shown_causes, *[f"{len(small_causes)} others"] * bool(small_causes), *TOTAL_COLUMNS]
    rows: list[tuple[Cell, ...] | str] = []
    shown_lines: list[ShareLine] = []
    special_words, left_out = set[str](), False
    number_cells: list[list[Cell]] = []
    for title, lines in groups:
        open_labels = find_indeterminate_labels(lines)
        cells_of_lines = zip(lines, make_share_cells(lines, heads[:-2], small_causes, stated_errors), strict=True)
        nonzero = [(line, cells) for line, cells in cells_of_lines if not all(map(is_zero_cell, cells))]
        shown_here = [(line, cells) for line, cells in nonzero if line.row.label not in open_labels]
        left_out = left_out or len(nonzero) < len(lines)
        rows += [title] if title and (shown_here or open_labels) else []
        rows += [
            (line.label, stated_errors.units.find(line.row.unit)[0], line.position, *cells)
            for line, cells in shown_here
        ]
        rows += [f"{INDENT}{OPEN}: {', '.join(open_labels)}"] if open_labels else []
        special_words |= {OPEN} if open_labels else set()
        shown_lines += [line for line, _ in shown_here]
        number_cells += [cells for _, cells in shown_here]
    if not number_cells:
        return OutputTable(heading, notes=(*map(str.strip, map(str, rows)), OPEN_NOTE) if rows else ("all values 0",))
    empty = [i for i in range(len(heads) - 2) if all(is_zero_cell(cells[i]) for cells in number_cells)]
    shown = [i for i in range(len(heads)) if i not in empty]
    lead = 3 if any(line.position for line in all_lines) else 2  # columns before the numbers: label, unit, position
    shown_rows = [row if isinstance(row, str) else (*row[:lead], *(row[3 + i] for i in shown)) for row in rows]
    titles = [distinguish(cause, TOTAL_COLUMNS) for cause in shown_causes] + heads[len(shown_causes) :]
    columns = [
        *(OutputColumn(head, "text") for head in ("", "", "at")[:lead]),
        *(OutputColumn(titles[i]) for i in shown),
    ]
    where = " except where open" if special_words else ""
    notes = [f"all values 0{where}: {', '.join(heads[i] for i in empty)}"] if empty else []
    special_words |= {format_cell(cell) for cells in number_cells for cell in cells}
    notes += make_notes(shown_lines, {heads[i] for i in shown}, special_words)
    notes += [ZERO_NOTE] if left_out else []
    return OutputTable(heading, tuple(columns), tuple(shown_rows), tuple(notes))


def find_indeterminate_labels(lines: Sequence[ShareLine]) -> list[str]:
    """Return the labels of the numbers that are indeterminate in all their rows."""
    totals = [
        (line.row.label, line.is_uncertain or np.isfinite(line.total)) for line in lines if line.total is not None
    ]
    known = {label for label, is_known in totals if is_known}
    return [label for label in dict.fromkeys(label for label, _ in totals) if label not in known]


def choose_causes(causes: Sequence[str], lines: Sequence[ShareLine]) -> tuple[list[str], list[str]]:
    """Split the causes into those with a column of their own, in their order, and small ones that share one column."""
    if len(causes) <= MAX_CAUSE_COLUMNS:
        return list(causes), []
    scales = find_family_scales(lines)
    weight = dict.fromkeys(causes, 0.0)
    for line in lines:
        scale = scales[find_family(line)] or 1.0
        for cause, value in line.shares.items():
            weight[cause] = max(weight[cause], abs(value) / scale if np.isfinite(value) else 0.0)
    largest = sorted(causes, key=lambda cause: -weight[cause])[: MAX_CAUSE_COLUMNS - 1]
    return [cause for cause in causes if cause in largest], [cause for cause in causes if cause not in largest]


def find_family(line: ShareLine) -> tuple[str, str]:
    """Return the family and unit of a row: rows of one family show the same decimals."""
    return line.row.family, line.row.unit


def find_family_scales(lines: Iterable[ShareLine]) -> dict[tuple[str, str], float]:
    """Return the largest absolute number of each family."""
    scales: dict[tuple[str, str], float] = {}
    for line in lines:
        numbers = [abs(x) for x in (*line.shares.values(), line.total or 0.0) if np.isfinite(x)]
        scales[find_family(line)] = max(scales.get(find_family(line), 0.0), *numbers, 0.0)
    return scales


def make_share_cells(
    lines: Sequence[ShareLine], columns: Sequence[str], small_causes: Sequence[str], stated_errors: StatedErrors
) -> list[list[Cell]]:
    """Make the cells of each row: one for each column, their sum, and the total."""
    numbers: list[list[float | None]] = []
    own_columns = columns[: len(columns) - bool(small_causes)]
    for line in lines:
        own: list[float | None] = [line.shares.get(name) for name in own_columns]
        others = [sum(line.shares.get(cause, 0.0) for cause in small_causes)] * bool(small_causes)
        share_sum = sum(line.shares.values()) if line.total is not None else None
        numbers.append([*own, *others, share_sum, line.total])
    cells: list[list[Cell]] = [[] for _ in lines]
    for family, scale in find_family_scales(lines).items():
        members = [i for i, line in enumerate(lines) if find_family(line) == family]
        row = lines[members[0]].row
        per_si = stated_errors.units.find(row.unit)[1]
        kind = f"{row.error_kind} {BY_CAUSE}"
        number_style, error = (
            stated_errors.choose_style(kind, row.unit, scale),
            per_si * stated_errors.error_of(kind, row.unit),
        )
        flat = iter(write_numbers([per_si * x for i in members for x in numbers[i] if x is not None], number_style))
        for i in members:
            cells[i] = [
                None
                if x is None
                else make_cell(NumberCell(per_si * x, error, None, next(flat)), x, lines[i], stated_errors)
                for x in numbers[i]
            ]
    return cells


def make_cell(cell: NumberCell, value: float, line: ShareLine, stated_errors: StatedErrors) -> Cell:
    """Return the cell of a number, or a word where it is beyond the horizon or uncertain; value: SI."""
    if line.is_beyond_horizon:
        return format_unclaimed(value, line.row.unit, stated_errors, cell.text)
    if cell.text == OPEN:
        return UNKNOWN if line.is_uncertain else OPEN
    return cell


def make_notes(lines: Sequence[ShareLine], heads: set[str], words: set[str]) -> list[str]:
    """Return the notes that explain the rows, column heads and special words of a table."""
    notes = [CAUSES_NOTE] if "motion" in heads else []
    notes += [ALONG_NOTE] if any(line.label.startswith("|") for line in lines) else []
    notes += [DIRECT_NOTE] if any(line.total is None for line in lines) else []
    notes += [OPEN_NOTE] if OPEN in words else []
    return [*notes, UNKNOWN_NOTE] if UNKNOWN in words else notes
