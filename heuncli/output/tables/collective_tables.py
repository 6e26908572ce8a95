"""Load collectives of a solved scene: the histories of its numbers counted by rainflow, as tables, JSON and CSV.

    count_collective(study, "joints.main.force.y", slopes=(3.0, 5.0)).equivalents[0].range
The JSON is plain data, the CSV in long form (manual/collectives.md).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from heuncli.base.errors import Problem, SolveError, UsageError
from heuncli.output.documents.as_data import make_columns
from heuncli.output.documents.document import Cell, NumberCell, OutputColumn, OutputTable, append_unit
from heuncli.results.results import Array
from heuncli.study.load_collectives import (
    CODE,
    REFERENCE,
    Collective,
    Counting,
    InvalidOption,
    LoadHistory,
    make_collective,
    make_histories,
)
from heuncli.study.quantities.digits import Style, choose_style, format_error, write_numbers, write_times
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.measure_uncertainty import find_unit, measure_uncertainty
from heuncli.study.queries.study import Study

CLOSED = "closed"  # a history repeated endlessly
CSV_COLUMNS = make_columns("path quantity unit slope above up_to mean_above mean_up_to value")
NO_SIGN = (
    "a magnitude has no sign: a reversing load counts twice, at half the range; components (.x, .y, .z) keep their sign"
)
NEVER_NEGATIVE = "a magnitude has no sign: a reversing load counts twice, at half the range"
NO_CYCLES = "no cycles: the variation is within the error"
IMPACT_NOTE = "impulses: the loads before and after each jump count; the impulses themselves (N·s) are not included"


def count_collective(
    study: Study,
    path: str,
    *,
    slopes: Sequence[float] = (),
    cycles: float | None = None,
    bins: int = Counting().bins,
    repeat: int = 1,
    is_closed: bool = False,
) -> Collective:
    """Count the load collective of the number at a path over the motion; for a vector that of its magnitude.

    slopes: of Wöhler lines; each gives a damage-equivalent range
    cycles: number of cycles of these ranges; None for one per repetition of the motion
    bins: number of classes of ranges and means
    repeat: how often the motion is repeated
    is_closed: the motion is repeated endlessly, and one repetition is counted

    Raises NotOneNumber, SpecError [unknown-path], SolveError [no-collective], LimitError.
    """
    return count_collectives(study, [path], Counting(tuple(slopes), cycles, bins, repeat, is_closed))[0]


def count_collectives(study: Study, paths: Sequence[str], options: Counting) -> list[Collective]:
    """Count the collectives of several paths in one search.

    Raises as count_collective() does, and UsageError for options that do not fit together.
    """
    if unfit := options.find_invalid_options():
        raise UsageError(
            *(make_option_problem(problem, problem.name, getattr(options, problem.name)) for problem in unfit)
        )
    errors = {path: measure_uncertainty(study, path, "abs") or 0.0 for path in paths}
    found = make_histories(study, errors, {path: find_unit(path, study.spec) for path in paths})
    if options.is_endless or options.repeat > 1:
        require_closed(found)
    return [make_collective(history, options) for history in found]


def make_option_problem(unfit: InvalidOption, option: str, value: object) -> Problem:
    """Return the problem with an option."""
    message = f"{option} {value}: expected {unfit.requirement}"
    return Problem("bad-option", message, hint=f"for example {option} {unfit.example}")


def require_closed(histories: Sequence[LoadHistory]) -> None:
    """Raise SolveError if a history does not end where it began, within its errors: then it is no cycle."""
    problems = []
    for history in histories:
        gap, first, last = history.values[-1] - history.values[0], history.values[0], history.values[-1]
        if abs(gap) > 2.0 * history.error:
            ends_text = (
                f"it starts at {first:.6g} {history.unit} and ends at {last:.6g}, a difference of {abs(gap):.2g}"
            )
            message = (
                f"{history.path}: --repeat requires a periodic motion: {ends_text}; the error is {history.error:.1g}"
            )
            hint = "make the duration one period: --set analysis.duration=...; or start after the motion has settled"
            problems.append(Problem(CODE, message, hint=hint, entry_path="analysis"))
    if problems:
        raise SolveError(*problems)


def make_tables(collective: Collective, units: Units, *, has_impacts: bool) -> list[OutputTable]:
    """Make all tables of a collective; has_impacts: whether there were impacts during the run."""
    tables = [make_ranges_table(collective, units, has_impacts=has_impacts)]
    if collective.total_cycles:
        tables += [make_equivalents_table(collective, units)] if collective.equivalents else []
        tables += [make_crossings_table(collective, units), make_matrix_table(collective, units)]
    return tables


def make_ranges_table(collective: Collective, units: Units, *, has_impacts: bool) -> OutputTable:
    """Make the table of cycles by class of range, with their shares of the damage."""
    unit, per_si = units.find(collective.history.unit)
    limits = format_limits(collective, collective.matrix.ranges * per_si, per_si)
    larger_counts = collective.counts[::-1].cumsum()[::-1]
    columns = [
        OutputColumn("range above", unit=unit),
        OutputColumn("up to", unit=unit),
        OutputColumn("cycles"),
    ]
    columns += [OutputColumn("cumulative"), *(OutputColumn(f"damage, m = {s:g}") for s in collective.counting.slopes)]
    rows: list[tuple[Cell, ...]] = [
        (
            limits[k],
            limits[k + 1],
            make_count_cell(collective.counts[k]),
            make_count_cell(larger_counts[k]),
            *(NumberCell(float(share), write=format_share) for share in collective.shares[:, k]),
        )
        for k in range(len(collective.counts))
    ]
    heading = (
        f"LOAD SPECTRUM {collective.history.path}  rainflow cycles (ASTM E1049-85) by range, {format_times(collective)}"
    )
    return OutputTable(
        heading,
        columns,
        rows if collective.total_cycles else (),
        list(iter_notes(collective, units, has_impacts=has_impacts)),
    )


def format_times(collective: Collective) -> str:
    """Format the time span of a collective and how often it is repeated."""
    times = collective.history.times
    begin, end = write_times((float(times[0]), float(times[-1])), float(np.ptp(times)))
    span = f"t = {begin} to {end} s"
    if collective.counting.is_endless:
        return f"{span}, repeated indefinitely: counts per repetition"
    return f"{span}, repeated {collective.counting.repeat} times" if collective.counting.repeat > 1 else span


def iter_notes(collective: Collective, units: Units, *, has_impacts: bool) -> Iterator[str]:
    """Yield the notes below the table of ranges."""
    unit, per_si = units.find(collective.history.unit)
    low, high = format_values(
        np.array([collective.history.values.min(), collective.history.values.max()]) * per_si,
        collective.history.error * per_si,
    )
    yield (
        f"{format_cycles(collective.total_cycles)} from {collective.points} reversals between {low} "
        f"and {append_unit(high, unit)}"
    )
    if not collective.total_cycles:
        yield NO_CYCLES
    if collective.below_error.cycles:
        small = format_error(collective.below_error.range * per_si)
        yield (
            f"not counted: {format_cycles(collective.below_error.cycles)} of at most "
            f"{append_unit(small, unit)}, below the numerical error"
        )
    if collective.history.is_magnitude:
        yield NO_SIGN if collective.history.is_vector else NEVER_NEGATIVE
    if has_impacts:
        yield IMPACT_NOTE


def make_equivalents_table(collective: Collective, units: Units) -> OutputTable:
    """Make the table of damage-equivalent ranges and their errors."""
    unit, per_si = units.find(collective.history.unit)
    columns = (
        OutputColumn("slope m"), OutputColumn("cycles"), OutputColumn("range", unit=unit),
        OutputColumn("error", unit=unit),
    )  # fmt: skip
    rows = [
        (
            float(equivalent.slope),
            make_count_cell(equivalent.cycles),
            NumberCell(equivalent.range * per_si, equivalent.error * per_si),
            NumberCell(equivalent.error * per_si, write=format_error),
        )
        for equivalent in collective.equivalents
    ]
    heading = (
        f"EQUIVALENT RANGE {collective.history.path}  of constant cycles with the same damage: (Σ n R^m / N)^(1/m)"
    )
    return OutputTable(heading, columns, rows)


def make_crossings_table(collective: Collective, units: Units) -> OutputTable:
    """Make the table of how often each level is crossed."""
    unit, per_si = units.find(collective.history.unit)
    crossings = collective.crossings
    rows = zip(
        format_limits(collective, crossings.levels * per_si, per_si),
        *(
            map(make_count_cell, counts)
            for counts in (crossings.count_by_reference(REFERENCE), crossings.upward, crossings.downward)
        ),
        strict=True,
    )
    columns = (
        OutputColumn("level", unit=unit),
        OutputColumn("crossings"),
        OutputColumn("upwards"),
        OutputColumn("downwards"),
    )
    heading = (
        f"LEVEL CROSSINGS {collective.history.path}  (ASTM E1049, 5.1) counted upward at levels ≥ 0, downward below 0"
    )
    return OutputTable(heading, columns, tuple(rows))


def make_matrix_table(collective: Collective, units: Units) -> OutputTable:
    """Make the table of cycles by range and mean, without empty classes."""
    unit, per_si = units.find(collective.history.unit)
    limits, means = (
        format_limits(collective, limits * per_si, per_si)
        for limits in (collective.matrix.ranges, collective.matrix.means)
    )
    shown = np.flatnonzero(collective.matrix.counts.any(axis=0)).tolist()
    columns = (
        OutputColumn("range", "text", unit),
        *(OutputColumn(f"{means[j]} ... {means[j + 1]}") for j in shown),
    )
    rows = tuple(
        (
            f"{limits[i]} ... {limits[i + 1]}",
            *(make_count_cell(n) if n else None for n in collective.matrix.counts[i, shown].tolist()),
        )
        for i in np.flatnonzero(collective.matrix.counts.any(axis=1)).tolist()
    )
    heading = f"RANGE-MEAN MATRIX {collective.history.path}  cycles by range (rows) and mean (columns)"
    return OutputTable(heading, columns, rows)


def format_limits(collective: Collective, values: Array, per_si: float) -> list[str]:
    """Format class limits or levels to a thousandth of their distance, without decimals where those suffice."""
    distance = float(np.abs(np.diff(values)).min(initial=np.inf))
    return format_values(
        values, max(collective.history.error * per_si, min(1e-3 * distance, 1.0) if np.isfinite(distance) else 0.0)
    )


def format_values(values: Array, error: float) -> list[str]:
    """Format numbers with the digits that their error leaves."""
    largest = float(np.abs(values).max(initial=0.0))
    number_style = choose_style(largest, error)
    return write_numbers(values.tolist(), number_style if number_style.is_known else Style(0, has_exponent=True))


def format_count(n: float) -> str:
    """Format a count of cycles, which may end with a half."""
    return f"{n:.12g}"


def make_count_cell(n: float) -> NumberCell:
    """Make the cell of a count of cycles."""
    return NumberCell(float(n), write=format_count)


def format_cycles(n: float) -> str:
    """Format a count with its noun, such as `1 cycle`."""
    return f"{format_count(n)} cycle{'s' * (n != 1.0)}"


def format_share(share: float) -> str:
    """Format a share of the damage in percent."""
    return "0" if not share else f"{100.0 * share:.1f} %" if share >= 0.0005 else "< 0.1 %"


def to_json_block(collective: Collective) -> dict[str, Any]:
    """Return a collective as plain data for JSON, SI units."""
    times, options = collective.history.times, collective.counting
    return {
        "unit": collective.history.unit,
        "magnitude": collective.history.is_magnitude,
        "time": [float(times[0]), float(times[-1])],
        "repeat": CLOSED if options.is_endless else options.repeat,
        "error": collective.history.error,
        "lowest": float(collective.history.values.min()),
        "highest": float(collective.history.values.max()),
        "turning_points": collective.points,
        "cycles": collective.total_cycles,
        "below_error": collective.below_error._asdict(),
        "equivalent": [shares._asdict() for shares in collective.equivalents],
        "ranges": {
            "limits": collective.matrix.ranges,
            "cycles": collective.counts,
            "damage": [
                {"slope": s, "shares": shares} for s, shares in zip(options.slopes, collective.shares, strict=True)
            ],
        },
        "matrix": {
            "ranges": collective.matrix.ranges,
            "means": collective.matrix.means,
            "cycles": collective.matrix.counts,
        },
        "crossings": {
            "reference": REFERENCE,
            "levels": collective.crossings.levels,
            "counted": collective.crossings.count_by_reference(REFERENCE),
            "up": collective.crossings.upward,
            "down": collective.crossings.downward,
        },
        "rainflow": {"from": collective.cycles.begin, "to": collective.cycles.end, "count": collective.cycles.counts},
    }


def make_records(collectives: Sequence[Collective]) -> OutputTable:
    """Make the rows of the CSV in long form, one for each number, SI units. Fields that do not apply are empty."""
    rows: list[tuple[Cell, ...]] = []
    for collective in collectives:
        path, unit = collective.history.path, collective.history.unit
        for quantity, has_unit, limits, value in iter_records(collective):
            rows.append((path, quantity, unit if has_unit else "1", *limits, value + 0.0))
    return OutputTable("", CSV_COLUMNS, rows)


def iter_records(collective: Collective) -> Iterator[tuple[str, bool, Sequence[float | None], float]]:
    """Yield quantity, whether it has the unit of the path, slope and limits, and the number."""
    limits, means = collective.matrix.ranges.tolist(), collective.matrix.means.tolist()
    nowhere = (None,) * 5
    yield "lowest", True, nowhere, float(collective.history.values.min())
    yield "highest", True, nowhere, float(collective.history.values.max())
    yield "error", True, nowhere, collective.history.error
    yield "cycles", False, nowhere, collective.total_cycles
    yield "cycles_below_error", False, nowhere, collective.below_error.cycles
    for equivalent in collective.equivalents:
        slope = (equivalent.slope, None, None, None, None)
        yield "equivalent_range", True, slope, equivalent.range
        yield "equivalent_range_error", True, slope, equivalent.error
        yield "equivalent_cycles", False, slope, equivalent.cycles
    for k, n in enumerate(collective.counts.tolist()):
        yield "range_cycles", False, (None, limits[k], limits[k + 1], None, None), n
    for s, shares_of_slope in zip(collective.counting.slopes, collective.shares.tolist(), strict=True):
        for k, share in enumerate(shares_of_slope):
            yield "range_damage", False, (s, limits[k], limits[k + 1], None, None), share
    for i, j in np.argwhere(collective.matrix.counts).tolist():
        ends = (limits[i], limits[i + 1], means[j], means[j + 1])
        yield "range_mean_cycles", False, (None, *ends), float(collective.matrix.counts[i, j])
    crossings = collective.crossings
    for name, counts in (
        ("counted", crossings.count_by_reference(REFERENCE)),
        ("up", crossings.upward),
        ("down", crossings.downward),
    ):
        for level, n in zip(crossings.levels.tolist(), counts.tolist(), strict=True):
            yield f"crossings_{name}", False, (None, level, None, None, None), n
