"""Make the tables of a random sweep's statistics: estimates for the whole population, and Sobol indices."""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.analyses.sweep_rows import SweepHead, make_parameter_columns
from heuncli.analyses.variants.parameters import RandomVariable
from heuncli.analyses.variants.sample_statistics import CONFIDENCE, MIN_INDEX_BOUNDED, BoundedEstimate
from heuncli.app.commands.sweep.statistics import MeasureStatistics
from heuncli.app.commands.sweep.tables import choose_number_style, format_parameter, format_variant_count
from heuncli.output.documents.document import Cell, NumberCell, OutputColumn, OutputTable
from heuncli.output.tables.nouns import format_count
from heuncli.study.quantities.digits import format_error
from heuncli.study.quantities.table_units import Units

MAX_BLOCKS = 12  # combinations and measures that are shown without --all
SHARE = f"{100 * CONFIDENCE:.0f} %"
HEADING = f"STATISTICS  with {SHARE} confidence intervals"
INDICES = f"SOBOL INDICES  fractions of the variance, with {SHARE} confidence intervals"
EVEN = "{} is more uniform than independent samples, for which the intervals hold: the means are more accurate"
CALLED = {"lhs": "a Latin hypercube", "sobol": "a Sobol sequence"}
SPOILT = "{}: errors of the runs, up to {}, are not small compared with these intervals"
ERROR_SHARE = 0.1  # share of an interval; larger errors of the runs get a note
NO_INDICES = "{}: no Sobol indices: "
FLAT = "it varies by no more than the errors of its runs"
UNBOUNDED = "{}: no intervals for {} samples: " + f"{MIN_INDEX_BOUNDED} or more needed (--samples {MIN_INDEX_BOUNDED})"
FEW = "all {} variants of a sample are known for {} samples only"


def make_statistics_tables(
    head: SweepHead, statistics: Sequence[MeasureStatistics], units: Units, all_of_them: bool
) -> list[OutputTable]:
    """Make the tables; none if no parameter is random."""
    if not statistics:
        return []
    selected = statistics if all_of_them else statistics[:MAX_BLOCKS]
    tables = [_make_statistics_table(head, selected, units, len(statistics) - len(selected))]
    draws = head.plan.draws
    if draws is not None and draws.each > 1:
        tables.append(_make_index_table(head, selected, draws.laws))
    return tables


def format_label(head: SweepHead, statistics: MeasureStatistics, unit: str = "") -> str:
    """Return a measure with the combination of the axes: `max joints.main.force [N], n = 1000 rpm`."""
    known = {parameter.name: parameter for parameter in make_parameter_columns(head.plan)}
    values = [(known[name], format_parameter(value)) for name, value in statistics.combination.items()]
    axis_texts = [
        f"{parameter.name} = {text}{f' {parameter.unit}' if parameter.unit else ''}" for parameter, text in values
    ]
    text = head.measures[statistics.measure].text
    return ", ".join([f"{text} [{unit}]" if unit else text, *axis_texts])


def _make_statistics_table(
    head: SweepHead, selection: Sequence[MeasureStatistics], units: Units, omitted: int
) -> OutputTable:
    """Make the table of mean, deviation and percentiles, with their confidence intervals."""
    columns = (OutputColumn("", "text"), OutputColumn("value"), OutputColumn("from"), OutputColumn("to"))
    rows: list[tuple[Cell, ...] | str] = []
    notes = _make_notes(head)
    for statistics in selection:
        unit, size = units.find(head.measures[statistics.measure].unit)
        label = format_label(head, statistics, unit)
        rows.append(
            f"{label}: {format_variant_count(statistics.drawn_count)}"
            f"{f', {statistics.left_out} left out' if statistics.left_out else ''}"
        )
        if statistics.sample is None:
            rows.append(("too few", "", "", ""))
            continue
        rows.append(_make_row("mean", statistics.sample.mean, size))
        rows.append(_make_row("deviation", statistics.sample.deviation, size))
        rows += [_make_row(f"{percent:g} %", value, size) for percent, value in statistics.sample.percentiles]
        if has_large_errors(statistics):
            error = f"{format_error(size * statistics.error)} {unit}".rstrip()
            notes.append(SPOILT.format(format_label(head, statistics), error))
    if any("-" in row for row in rows):
        notes.append("-: the sample is too small for a bound on this side")
    if any(statistics.left_out for statistics in selection):
        notes.append("left out: could not be solved, or the measure is not known")
    if omitted:
        notes.append(f"{format_count(omitted, 'block')} more: --all")
    return OutputTable(HEADING, columns, tuple(rows), tuple(notes))


def _make_notes(head: SweepHead) -> list[str]:
    """Return notes on how the sample was drawn."""
    draws = head.plan.draws
    assert draws is not None
    laws = {law.law for law in draws.laws}
    notes = [f"random samples with --seed {draws.seed}: the same command gives the same samples"]
    return notes + [EVEN.format(CALLED[law]) for law in CALLED if law in laws]


def has_large_errors(statistics: MeasureStatistics) -> bool:
    """Return whether the errors of the runs matter relative to the interval of the mean."""
    mean = statistics.sample.mean if statistics.sample is not None else None
    return mean is not None and mean.low is not None and statistics.error > ERROR_SHARE * (mean.value - mean.low)


def _make_row(label: str, estimate: BoundedEstimate, size: float) -> tuple[Cell, ...]:
    """Make the row of a statistic with the digits that its interval supports."""
    ends = [estimate.value if end is None else end for end in (estimate.low, estimate.high)]
    half_width = 0.5 * size * (ends[1] - ends[0])
    scale = size * max(abs(estimate.value), *map(abs, ends))
    error = 0.01 * half_width
    numbers = [None if end is None else size * end for end in estimate]
    cells = ("-" if x is None else NumberCell(x, error, choose_number_style(x, error, scale).write) for x in numbers)
    return (label, *cells)


def _make_index_table(
    head: SweepHead, selection: Sequence[MeasureStatistics], laws: Sequence[RandomVariable]
) -> OutputTable:
    """Make the table of the Sobol indices, and say why some are missing."""
    names = ("", "first order", "from", "to", "total", "from", "to")
    columns = tuple(OutputColumn(name, "text" if not name else "number") for name in names)
    rows: list[tuple[Cell, ...] | str] = []
    notes: list[str] = ["first order: of the parameter alone; total: including its interactions"]
    for statistics in selection:
        if statistics.indices is None:
            why = FLAT if statistics.is_constant else FEW.format(len(laws) + 2, statistics.samples)
            notes.append(NO_INDICES.format(format_label(head, statistics)) + why)
            continue
        rows.append(f"{format_label(head, statistics)}: {format_count(statistics.samples, 'sample')}")
        for law, index_pair in zip(laws, statistics.indices, strict=True):
            ends = [end for estimated in index_pair for end in estimated]
            cells = ("-" if end is None else NumberCell(end, write="{:.3f}".format) for end in ends)
            rows.append((law.name, *cells))
        if statistics.samples < MIN_INDEX_BOUNDED:
            notes.append(UNBOUNDED.format(format_label(head, statistics), statistics.samples))
    return OutputTable(INDICES, columns, tuple(rows), tuple(notes))
