"""Loads by their causes as tables: a line a number, a column a cause, their sum beside the total.

At instants every number has a line; over a run its lowest and its highest, with the shares at that instant: who is
responsible. The share of a magnitude is the part along the whole vector, so that these add up, too.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.tables.cut_runs import CutRun, RunQuantity, position
from heuncli.output.tables.table_blocks import NumberRow, RowGroup, TableBlock, rows_of
from heuncli.output.tables.table_plans import MASS_EFFECT
from heuncli.output.tables.text_table import INDENT, TextColumn, TextTable
from heuncli.results.results import Array, Extremes, Place, Results
from heuncli.results.results_schema import BY_CAUSE, SECTION_FORCES, SECTION_MOMENTS, SHARES
from heuncli.study.quantities.digits import (
    OPEN,
    OPEN_NOTE,
    UNKNOWN,
    UNKNOWN_NOTE,
    ZERO_NOTE,
    Certainty,
    beyond_horizon,
    write,
    write_times,
)
from heuncli.study.quantities.labels import distinguish
from heuncli.study.quantities.series import Series

OWN_COLUMNS = ("sum", "total")  # behind those of the causes
MOST_CAUSES = 9  # that have a column; the smallest of more are told together
ALONG_NOTE = "of |F| and |M| the share along the whole vector"
CAUSES_NOTE = "motion: the part quadratic in the velocities; drives: that of prescribed accelerations"
DIRECT_NOTE = "direct: the load itself, where it stands; the rest of its share acts through the motion it causes"
# Of a section's resultants: the vector and the axis of the section that each is a component of.
AXES = {
    name: (vector, axis)
    for vector, names in (("force", SECTION_FORCES), ("moment", SECTION_MOMENTS))
    for axis, name in enumerate(names)
}
Key = tuple[str, str, str]  # of a number: kind, name, label


class SharedNumber(NamedTuple):
    """A number over the instants with its shares by cause, and of these what the loads do directly, (n_t,) each."""

    row: NumberRow
    shares: dict[str, Array]
    direct: dict[str, Array]


class ShareLine(NamedTuple):
    """One number with its shares; the lines of one family share their decimals. when: beyond the horizon, or beside."""

    label: str
    at: str
    row: NumberRow
    shares: dict[str, float]
    total: float | None
    lost: bool = False
    beside: bool = False


LineGroups = Sequence[tuple[str, Sequence[ShareLine]]]  # titles and lines


def shared_rows(results: Results, series: Iterable[Series]) -> dict[Key, SharedNumber]:
    """The numbers that have shares, but those of runs of cuts; series: those walked of the results."""
    runs = {name for name, section in results.sections.items() if "s" in section}
    own: dict[tuple[str, str, str], dict[str, Series]] = {}
    whole: list[Series] = []
    for item in series:
        if item.kind == "sections" and item.name.split(".")[0] in runs:
            continue
        if item.cause:
            own.setdefault((item.kind, item.name, item.quantity), {})[item.cause] = item
        else:
            whole.append(item)
    found: dict[Key, SharedNumber] = {}
    for item in whole:
        shares = own.get((item.kind, item.name, item.quantity))
        if shares is None:
            continue
        direct = direct_of(results, item, own)
        for i, row in enumerate(rows_of(item)):
            parts = {cause: part_of(row, i, item, series.values) for cause, series in shares.items()}
            beside = {cause: values[:, i] for cause, values in direct.items() if i < values.shape[1]}
            found[item.kind, item.name, row.label] = SharedNumber(row, parts, beside)
    return found


def part_of(row: NumberRow, i: int, whole: Series, share: Array) -> Array:
    """A share in a component, or along the whole vector in its magnitude."""
    if i < share.shape[1]:
        return share[:, i]
    size = np.where(row.values > 0.0, row.values, 1.0)
    return np.asarray(np.einsum("ti,ti->t", share, whole.values) / size)


def direct_of(results: Results, item: Series, own: Mapping[Key, Mapping[str, Series]]) -> dict[str, Array]:
    """What the loads do directly in a quantity: in a section's along its axes."""
    name, axis = AXES.get(item.quantity, (item.quantity, None)) if item.kind == "sections" else (item.quantity, None)
    known = own.get((item.kind, item.name, f"direct_{name}"), {})
    if axis is None:
        return {cause: series.values for cause, series in known.items()}
    section = results.sections[item.name]
    n, e1 = section["normal"], section["first_axis"]
    along = (n, e1, np.cross(n, e1))[axis]
    return {cause: np.sum(series.values * along, axis=1)[:, None] for cause, series in known.items()}


def key_of(block: TableBlock, group: RowGroup, row: NumberRow) -> Key:
    """Under which kind, name and label the results have the number of a table's row."""
    if block.kind != "foundation":
        return block.kind, group.name, row.label
    name = group.name.replace("support ", "supports.", 1).replace("element ", "elements.", 1)
    return block.kind, {"total": "", "": MASS_EFFECT.key}.get(name, name), row.label  # the mass effects have no shares


def instants_table(
    block: TableBlock, shared: Mapping[Key, SharedNumber], times: Array, horizon: float | None, certain: Certainty
) -> list[TextTable]:
    """Every number of a block that has shares, at every instant; none where nothing has."""
    clock = [""] if len(times) == 1 else [f"{x} s" for x in write_times(times.tolist(), float(np.ptp(times)))]
    groups: list[tuple[str, list[ShareLine]]] = []
    for group in block.groups:
        lines: list[ShareLine] = []
        for row in group.rows:
            one = shared.get(key_of(block, group, row))
            for k, t in enumerate(times.tolist() if one is not None else []):
                assert one is not None
                lost, beside = horizon is not None and t >= horizon, t in certain.beside
                shares = {cause: float(values[k]) for cause, values in one.shares.items()}
                lines.append(ShareLine(row.label, clock[k], one.row, shares, float(one.row.values[k]), lost, beside))
                direct = {cause: float(values[k]) for cause, values in one.direct.items()}
                if direct:
                    lines.append(ShareLine(f"{row.label} direct", "", one.row, direct, None, lost, beside))
        groups.append((group.title, lines))
    return [table_of(heading_of(block), groups, certain)] if any(lines for _, lines in groups) else []


def extremes_table(
    block: TableBlock,
    shared: Mapping[Key, SharedNumber],
    instants: Array,
    extremes: Extremes,
    certain: Certainty,
    span: float,
) -> list[TextTable]:
    """The lowest and the highest of every number of a block, with the shares at their instants.

    shared: at `instants`, those of the extremes among them; extremes: of the block's rows, one after the other.
    """
    groups: list[tuple[str, list[ShareLine]]] = []
    place = 0
    for group in block.groups:
        lines: list[ShareLine] = []
        for row in group.rows:
            one = shared.get(key_of(block, group, row))
            if one is not None:
                low, high = (
                    (float(at[place]), float(value[place]))
                    for at, value in ((extremes.low_at, extremes.low), (extremes.high_at, extremes.high))
                )
                ends = [("", *high)] if low[1] == high[1] else [("min", *low), ("max", *high)]
                lines += [
                    line_at(one, instants, f"{row.label} {word}".rstrip(), at, value, span if word else 0.0)
                    for word, at, value in ends
                    if not (row.even and word == "min")
                ]
            place += 1
        groups.append((group.title, lines))
    return [table_of(heading_of(block), groups, certain)] if any(lines for _, lines in groups) else []


def line_at(one: SharedNumber, instants: Array, label: str, at: float, value: float, span: float) -> ShareLine:
    """The line of a number at an instant."""
    k = int(np.searchsorted(instants, at))
    clock = f"{write_times([at], span)[0]} s" if span > 0.0 else ""
    return ShareLine(label, clock, one.row, {cause: float(values[k]) for cause, values in one.shares.items()}, value)


def heading_of(block: TableBlock) -> str:
    """The block's heading, with what is told of it here."""
    return block.heading.replace("  ", f" {BY_CAUSE.upper()}  ", 1)


def table_of(heading: str, groups: LineGroups, certain: Certainty) -> TextTable:
    """The lines in their groups; a column a cause, those that are 0 throughout left out."""
    everything = [line for _, lines in groups for line in lines]
    known = dict.fromkeys(cause for line in everything for cause in line.shares)
    few, rest = chosen_causes(list(known), everything)
    heads = [*few, *[f"{len(rest)} others"] * bool(rest), *OWN_COLUMNS]
    rows: list[tuple[str, ...] | str] = []
    kept_lines: list[ShareLine] = []
    words, left_out = set[str](), False
    numbers: list[list[str]] = []
    for title, lines in groups:
        texts = texts_of(lines, heads[:-2], rest, certain)
        kept = [(line, own) for line, own in zip(lines, texts, strict=True) if set(own) - {"0", ""}]
        left_out = left_out or len(kept) < len(lines)
        opened = open_throughout(lines)
        kept = [(line, own) for line, own in kept if line.row.label not in opened]
        words |= {OPEN} if opened else set()
        rows += [title] if title and (kept or opened) else []
        rows += [(line.label, line.row.unit, line.at, *own) for line, own in kept]
        rows += [f"{INDENT}{OPEN}: {', '.join(opened)}"] if opened else []
        kept_lines += [line for line, _ in kept]
        numbers += [own for _, own in kept]
    if not numbers:
        return TextTable(heading, notes=(*map(str.strip, map(str, rows)), OPEN_NOTE) if rows else ("0 throughout",))
    empty = [i for i in range(len(heads) - 2) if all(own[i] in ("0", "") for own in numbers)]
    shown = [i for i in range(len(heads)) if i not in empty]
    lead = 3 if any(line.at for line in everything) else 2
    cells = [row if isinstance(row, str) else (*row[:lead], *(row[3 + i] for i in shown)) for row in rows]
    spoken = [distinguish(cause, OWN_COLUMNS) for cause in few] + heads[len(few) :]
    columns = [*(TextColumn(head, "left") for head in ("", "", "at")[:lead]), *(TextColumn(spoken[i]) for i in shown)]
    where = "in all that is not open" if words else "throughout"
    notes = [f"0 {where}: {', '.join(heads[i] for i in empty)}"] if empty else []
    notes += notes_of(kept_lines, {heads[i] for i in shown}, words.union(*numbers))
    notes += [ZERO_NOTE] if left_out else []
    return TextTable(heading, tuple(columns), tuple(cells), tuple(notes))


def open_throughout(lines: Sequence[ShareLine]) -> list[str]:
    """The labels of what is open in all its lines."""
    told = dict.fromkeys(line.row.label for line in lines if line.total is not None)
    known = {line.row.label for line in lines if line.total is not None and (line.beside or np.isfinite(line.total))}
    return [label for label in told if label not in known]


def chosen_causes(causes: Sequence[str], lines: Sequence[ShareLine]) -> tuple[list[str], list[str]]:
    """The causes that have a column, in their order, and the smallest of many, which have one together."""
    if len(causes) <= MOST_CAUSES:
        return list(causes), []
    scales = family_scales(lines)
    weight = dict.fromkeys(causes, 0.0)
    for line in lines:
        scale = scales[family_of(line)] or 1.0
        for cause, value in line.shares.items():
            weight[cause] = max(weight[cause], abs(value) / scale if np.isfinite(value) else 0.0)
    largest = sorted(causes, key=lambda cause: -weight[cause])[: MOST_CAUSES - 1]
    return [cause for cause in causes if cause in largest], [cause for cause in causes if cause not in largest]


def family_of(line: ShareLine) -> tuple[str, str]:
    """Lines that share their decimals."""
    return line.row.family, line.row.unit


def family_scales(lines: Iterable[ShareLine]) -> dict[tuple[str, str], float]:
    """The largest number of each family."""
    scales: dict[tuple[str, str], float] = {}
    for line in lines:
        numbers = [abs(x) for x in (*line.shares.values(), line.total or 0.0) if np.isfinite(x)]
        scales[family_of(line)] = max(scales.get(family_of(line), 0.0), *numbers, 0.0)
    return scales


def texts_of(
    lines: Sequence[ShareLine], columns: Sequence[str], rest: Sequence[str], certain: Certainty
) -> list[list[str]]:
    """The numbers of each line as text: of each column, of their sum, and the total."""
    numbers: list[list[float | None]] = []
    for line in lines:
        own: list[float | None] = [line.shares.get(name) for name in columns[: len(columns) - bool(rest)]]
        own += [sum(line.shares.get(cause, 0.0) for cause in rest)] * bool(rest)
        whole = sum(line.shares.values()) if line.total is not None else None
        numbers.append([*own, whole, line.total])
    texts: list[list[str]] = [[] for _ in lines]
    for family, scale in family_scales(lines).items():
        members = [i for i, line in enumerate(lines) if family_of(line) == family]
        row = lines[members[0]].row
        how = certain.style(f"{row.kind} {BY_CAUSE}", row.unit, scale)
        flat = iter(write([x for i in members for x in numbers[i] if x is not None], how))
        for i in members:
            texts[i] = ["" if x is None else told(x, next(flat), lines[i], certain) for x in numbers[i]]
    return texts


def told(value: float, text: str, line: ShareLine, certain: Certainty) -> str:
    """A number's text, where it is known."""
    if line.lost:
        return beyond_horizon(value, line.row.unit, certain, text)
    return UNKNOWN if text == OPEN and line.beside else text


def notes_of(lines: Sequence[ShareLine], shown: set[str], words: set[str]) -> list[str]:
    """What has to be said of the lines of a table, its columns and words."""
    notes = [CAUSES_NOTE] if "motion" in shown else []
    notes += [ALONG_NOTE] if any(line.label.startswith("|") for line in lines) else []
    notes += [DIRECT_NOTE] if any(line.total is None for line in lines) else []
    notes += [OPEN_NOTE] if OPEN in words else []
    return [*notes, UNKNOWN_NOTE] if UNKNOWN in words else notes


# Runs of cuts


def run_extremes_table(
    run: CutRun, results: Results, extremes: Extremes, places: Sequence[tuple[Place, Place]], certain: Certainty
) -> list[TextTable]:
    """The lowest and the highest of each resultant along a run, with their shares.

    results: with the run cut at the places of the lowest and the highest of every resultant, in this order.
    """
    lines: list[ShareLine] = []
    span = float(np.ptp(np.concatenate([extremes.low_at, extremes.high_at])))
    for i, load in enumerate(run.loads):
        ends = (("min", extremes.low, extremes.low_at), ("max", extremes.high, extremes.high_at))
        for j, (word, value, at) in enumerate(ends):
            k = int(np.searchsorted(results.time, at[i]))
            clock = [f"{write_times([float(at[i])], span)[0]} s"] if span > 0.0 else []
            where = ", ".join([f"s = {position(places[i][j], run)} {run.length[0]}", *clock])
            lines.append(line_of_run(results, run.name, load, f"{load.label} {word}", (k, 2 * i + j), where)
                         ._replace(total=float(value[i])))  # fmt: skip
    return of_run(run, lines, certain)


def run_instants_table(run: CutRun, results: Results, horizon: float | None, certain: Certainty) -> list[TextTable]:
    """The lowest and the highest of each resultant among the cuts at every instant, with their shares."""
    times = results.time.tolist()
    clock = [] if len(times) == 1 else [f", {text} s" for text in write_times(times, float(np.ptp(results.time)))]
    lines: list[ShareLine] = []
    for k, t in enumerate(times):
        for i, load in enumerate(run.loads):
            values = np.nan_to_num(run.values[i, k])
            for word, cut in (("min", int(np.argmin(values))), ("max", int(np.argmax(values)))):
                where = f"s = {position(Place(float(run.s[cut]), None, cut), run)} {run.length[0]}"
                where += clock[k] if clock else ""
                line = line_of_run(results, run.name, load, f"{load.label} {word}", (k, cut), where)
                lines.append(line._replace(lost=horizon is not None and t >= horizon))
    return of_run(run, lines, certain)


def line_of_run(
    results: Results, name: str, load: RunQuantity, label: str, at: tuple[int, int], where: str
) -> ShareLine:
    """The line of a resultant of a run at an instant and a cut."""
    quantity, unit = load.name, load.unit
    section = results.sections[name]
    shares = {cause: load.size * float(own[quantity][at]) for cause, own in section.get(SHARES, {}).items()}
    row = NumberRow(quantity, unit, AXES[quantity][0], "sections", np.zeros(0))
    return ShareLine(label, where, row, shares, load.size * float(section[quantity][at]))


def of_run(run: CutRun, lines: Sequence[ShareLine], certain: Certainty) -> list[TextTable]:
    """The table of a run, if it has shares."""
    heading = run.heading.replace("  ", f" {BY_CAUSE.upper()}  ", 1)
    return [table_of(heading, [("", lines)], certain)] if any(line.shares for line in lines) else []
