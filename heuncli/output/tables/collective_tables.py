"""Load collectives as tables, as plain data for JSON, and as CSV in long form (manual/collectives.md)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from heuncli.output.tables.text_table import TextColumn, TextTable, head
from heuncli.results.results import Array
from heuncli.study.load_cycles.counted import REFERENCE, Collective
from heuncli.study.quantities.digits import Style, rough, style, write, write_times
from heuncli.study.quantities.error_digits import with_digits
from heuncli.study.quantities.table_units import Units

CLOSED = "closed"  # of a repeated history, where each time counts alike
CSV_COLUMNS = ("path", "quantity", "unit", "slope", "above", "up_to", "mean_above", "mean_up_to", "value")
NO_SIGN = (
    "a magnitude has no sign: where the load reverses it counts twice, with half the range; components (.x, .y, .z) "
    "keep their sign"
)
NEVER_NEGATIVE = "a magnitude has no sign: where the load reverses it counts twice, with half the range"
NO_CYCLES = "no cycles: it does not vary by more than its error"
BLOWS = "blows: the loads on both sides of their jumps count; their impulses (N·s) are in no collective"


def tables(one: Collective, units: Units, *, struck: bool) -> list[TextTable]:
    """What is told of a collective; struck: whether there were blows."""
    found = [ranges_table(one, units, struck=struck)]
    if one.total:
        found += [equivalents_table(one, units)] if one.equivalents else []
        found += [crossings_table(one, units), matrix_table(one, units)]
    return found


def ranges_table(one: Collective, units: Units, *, struck: bool) -> TextTable:
    """Cycles by class of ranges, with their share of the damage, and what was counted below."""
    unit, size = units.of(one.history.unit)
    limits = limit_texts(one, one.matrix.ranges * size, size)
    beyond = one.counts[::-1].cumsum()[::-1]
    columns = [TextColumn(head("range above", unit)), TextColumn(head("up to", unit)), TextColumn("cycles")]
    columns += [TextColumn("with larger ones"), *(TextColumn(f"damage, m = {s:g}") for s in one.asked.slopes)]
    rows = tuple(
        (limits[k], limits[k + 1], number(one.counts[k]), number(beyond[k]), *map(percent, one.shares[:, k]))
        for k in range(len(one.counts))
    )
    heading = f"COLLECTIVE {one.history.path}  rainflow cycles (ASTM E1049-85) by range, {told_times(one)}"
    return TextTable(heading, tuple(columns), rows if one.total else (), tuple(notes(one, units, struck=struck)))


def told_times(one: Collective) -> str:
    """Over which time, and how often it was told."""
    times = one.history.times
    begin, end = write_times((float(times[0]), float(times[-1])), float(np.ptp(times)))
    span = f"t = {begin} to {end} s"
    if one.asked.closed:
        return f"{span}, repeated for ever: of each time"
    return f"{span}, {one.asked.repeat} times in a row" if one.asked.repeat > 1 else span


def notes(one: Collective, units: Units, *, struck: bool) -> Iterator[str]:
    """What stands below the classes."""
    unit, size = units.of(one.history.unit)
    low, high = texts(np.array([one.history.values.min(), one.history.values.max()]) * size, one.history.error * size)
    behind = f" {unit}" if unit != "1" else ""
    yield f"{of_cycles(one.total)} of {one.points} turning points between {low} and {high}{behind}"
    if not one.total:
        yield NO_CYCLES
    if one.below.cycles:
        small = rough(one.below.range * size)
        yield f"below the error: {of_cycles(one.below.cycles)}, no larger than {small}{behind}; in no class, no sum"
    if one.history.is_magnitude:
        yield NO_SIGN if one.history.of_vector else NEVER_NEGATIVE
    if struck:
        yield BLOWS


def equivalents_table(one: Collective, units: Units) -> TextTable:
    """The damage-equivalent ranges, and their errors."""
    unit, size = units.of(one.history.unit)
    columns = tuple(map(TextColumn, ("slope m", "of cycles", head("range", unit), head("error", unit))))
    rows = tuple(
        (f"{own.slope:g}", number(own.cycles), with_digits(own.range * size, own.error * size), rough(own.error * size))
        for own in one.equivalents
    )
    heading = f"EQUIVALENT RANGE {one.history.path}  of equal cycles that do the damage of all: (Σ n R^m / N)^(1/m)"
    return TextTable(heading, columns, rows)


def crossings_table(one: Collective, units: Units) -> TextTable:
    """How often levels are passed."""
    unit, size = units.of(one.history.unit)
    own = one.crossings
    rows = zip(
        limit_texts(one, own.levels * size, size),
        *(map(number, counts) for counts in (own.counted(REFERENCE), own.up, own.down)),
        strict=True,
    )
    columns = (TextColumn(head("level", unit)), TextColumn("crossings"), TextColumn("upwards"), TextColumn("downwards"))
    heading = f"LEVEL CROSSINGS {one.history.path}  (E1049, 5.1) upwards from 0 on, downwards below"
    return TextTable(heading, columns, tuple(rows))


def matrix_table(one: Collective, units: Units) -> TextTable:
    """Cycles by range and mean; classes without any are left out."""
    unit, size = units.of(one.history.unit)
    limits, means = (limit_texts(one, limits * size, size) for limits in (one.matrix.ranges, one.matrix.means))
    shown = np.flatnonzero(one.matrix.counts.any(axis=0)).tolist()
    columns = TextColumn(head("range", unit), "left"), *(TextColumn(f"{means[j]} ... {means[j + 1]}") for j in shown)
    rows = tuple(
        (f"{limits[i]} ... {limits[i + 1]}", *(number(n) if n else "" for n in one.matrix.counts[i, shown].tolist()))
        for i in np.flatnonzero(one.matrix.counts.any(axis=1)).tolist()
    )
    heading = f"RANGE AND MEAN {one.history.path}  cycles by range (rows) and mean (columns)"
    return TextTable(heading, columns, rows)


def limit_texts(one: Collective, values: Array, size: float) -> list[str]:
    """Limits of classes, and levels: at a thousandth of what they are apart, but no decimals are enough."""
    apart = float(np.abs(np.diff(values)).min(initial=np.inf))
    return texts(values, max(one.history.error * size, min(1e-3 * apart, 1.0) if np.isfinite(apart) else 0.0))


def texts(values: Array, error: float) -> list[str]:
    """Numbers that err by so much, at the digits that this leaves."""
    largest = float(np.abs(values).max(initial=0.0))
    how = style(largest, error)
    return write(values.tolist(), how if how.known else Style(0, exponent=True))


def number(n: float) -> str:
    """How many: whole, or with a half."""
    return f"{n:.12g}"


def of_cycles(n: float) -> str:
    """So many cycles, in words."""
    return f"{number(n)} cycle{'s' * (n != 1.0)}"


def percent(share: float) -> str:
    """A share of the damage."""
    return "0" if not share else f"{100.0 * share:.1f} %" if share >= 0.0005 else "< 0.1 %"


def block(one: Collective) -> dict[str, Any]:
    """A collective as plain data for JSON; SI."""
    times, asked = one.history.times, one.asked
    return {
        "unit": one.history.unit,
        "magnitude": one.history.is_magnitude,
        "time": [float(times[0]), float(times[-1])],
        "repeat": CLOSED if asked.closed else asked.repeat,
        "error": one.history.error,
        "lowest": float(one.history.values.min()),
        "highest": float(one.history.values.max()),
        "turning_points": one.points,
        "cycles": one.total,
        "below_error": one.below._asdict(),
        "equivalent": [own._asdict() for own in one.equivalents],
        "ranges": {
            "limits": one.matrix.ranges, "cycles": one.counts,
            "damage": [{"slope": s, "shares": own} for s, own in zip(asked.slopes, one.shares, strict=True)],
        },
        "matrix": {"ranges": one.matrix.ranges, "means": one.matrix.means, "cycles": one.matrix.counts},
        "crossings": {
            "reference": REFERENCE, "levels": one.crossings.levels, "counted": one.crossings.counted(REFERENCE),
            "up": one.crossings.up, "down": one.crossings.down,
        },
        "rainflow": {"from": one.cycles.begin, "to": one.cycles.end, "count": one.cycles.counts},
    }  # fmt: skip


def csv_lines(several: Sequence[Collective]) -> Iterator[str]:
    """Collectives in long form, a line a number; what is empty does not apply. SI."""
    yield ",".join(CSV_COLUMNS) + "\n"
    for one in several:
        path, unit = one.history.path, one.history.unit
        for quantity, of, where, value in csv_rows(one):
            yield ",".join([path, quantity, unit if of else "1", *where, repr(value + 0.0)]) + "\n"


def csv_rows(one: Collective) -> Iterator[tuple[str, bool, Sequence[str], float]]:
    """What is told, whether it has the unit of the path, its slope and limits as text, the number."""
    limits, means = one.matrix.ranges.tolist(), one.matrix.means.tolist()
    nowhere = ("",) * 5
    yield "lowest", True, nowhere, float(one.history.values.min())
    yield "highest", True, nowhere, float(one.history.values.max())
    yield "error", True, nowhere, one.history.error
    yield "cycles", False, nowhere, one.total
    yield "cycles_below_error", False, nowhere, one.below.cycles
    for own in one.equivalents:
        slope = (repr(own.slope), "", "", "", "")
        yield "equivalent_range", True, slope, own.range
        yield "equivalent_range_error", True, slope, own.error
        yield "equivalent_cycles", False, slope, own.cycles
    for k, n in enumerate(one.counts.tolist()):
        yield "range_cycles", False, ("", repr(limits[k]), repr(limits[k + 1]), "", ""), n
    for s, own_shares in zip(one.asked.slopes, one.shares.tolist(), strict=True):
        for k, share in enumerate(own_shares):
            yield "range_damage", False, (repr(s), repr(limits[k]), repr(limits[k + 1]), "", ""), share
    for i, j in np.argwhere(one.matrix.counts).tolist():
        ends = (limits[i], limits[i + 1], means[j], means[j + 1])
        yield "range_mean_cycles", False, ("", *map(repr, ends)), float(one.matrix.counts[i, j])
    crossed = one.crossings
    for name, counts in (("counted", crossed.counted(REFERENCE)), ("up", crossed.up), ("down", crossed.down)):
        for level, n in zip(crossed.levels.tolist(), counts.tolist(), strict=True):
            yield f"crossings_{name}", False, ("", repr(level), "", "", ""), n
