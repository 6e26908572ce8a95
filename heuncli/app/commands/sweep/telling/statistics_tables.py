"""The statistics of a random sweep as tables: what the sample tells of all that could be drawn, and Sobol indices."""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.analyses.sweep_store.columns import parameters_of
from heuncli.analyses.sweep_store.rows import SweepHead
from heuncli.analyses.variants.axes import Drawn
from heuncli.analyses.variants.indices import LEAST_BOUNDED
from heuncli.analyses.variants.sampling import SURE, Estimated
from heuncli.app.commands.sweep.telling.shown_rows import number_text, parameter_text, variants
from heuncli.app.commands.sweep.telling.statistics import MeasureStatistics
from heuncli.output.tables.plurals import count
from heuncli.output.tables.text_table import TextColumn, TextTable
from heuncli.study.quantities.digits import rough
from heuncli.study.quantities.table_units import Units

MOST_BLOCKS = 12  # combinations and measures that are shown without --all
SHARE = f"{100 * SURE:.0f} of 100"
HEADING = f"STATISTICS  each with its interval, which {SHARE} such samples have around the true one"
INDICES = f"SOBOL INDICES  shares of the variance, with intervals that {SHARE} such samples have around the true ones"
EVEN = "{} is more even than independent draws, for which the intervals are: the means are nearer than they say"
CALLED = {"lhs": "a Latin hypercube", "sobol": "a Sobol sequence"}
SPOILT = "{}: the runs' own errors, up to {}, are not small beside these intervals"
NOT_SHOWN = 0.1  # share of an interval that the runs' own errors may have untold
NO_INDICES = "{}: no Sobol indices: "
FLAT = "it varies by no more than the errors of its runs"
UNBOUNDED = "{}: no intervals of {} samples: they take " + f"{LEAST_BOUNDED} or more (--samples {LEAST_BOUNDED})"
FEW = "all {} variants of a sample are known of {} samples only"


def tables_of(head: SweepHead, found: Sequence[MeasureStatistics], units: Units, all_of_them: bool) -> list[TextTable]:
    """The tables; none where nothing was drawn."""
    if not found:
        return []
    shown = found if all_of_them else found[:MOST_BLOCKS]
    tables = [_statistics(head, shown, units, len(found) - len(shown))]
    draws = head.plan.draws
    if draws is not None and draws.each > 1:
        tables.append(_indices(head, shown, draws.laws))
    return tables


def label_of(head: SweepHead, one: MeasureStatistics, unit: str = "") -> str:
    """A measure at a combination of the axes: `max joints.main.force [N], n = 1000 rpm`."""
    known = {parameter.name: parameter for parameter in parameters_of(head.plan)}
    values = [(known[name], parameter_text(known[name], text)) for name, text in one.combination.items()]
    at = [f"{parameter.name} = {text}{f' {parameter.unit}' if parameter.unit else ''}" for parameter, text in values]
    text = head.measures[one.measure].text
    return ", ".join([f"{text} [{unit}]" if unit else text, *at])


def _statistics(head: SweepHead, found: Sequence[MeasureStatistics], units: Units, more: int) -> TextTable:
    columns = (TextColumn("", "left"), TextColumn("value"), TextColumn("from"), TextColumn("to"))
    rows: list[tuple[str, ...] | str] = []
    notes = _notes(head)
    for one in found:
        unit, size = units.of(head.measures[one.measure].unit)
        label = label_of(head, one, unit)
        rows.append(f"{label}: {variants(one.drawn)}{f', {one.left_out} left out' if one.left_out else ''}")
        if one.found is None:
            rows.append(("too few", "", "", ""))
            continue
        rows.append(_line("mean", one.found.mean, size))
        rows.append(_line("deviation", one.found.deviation, size))
        rows += [_line(f"{percent:g} %", value, size) for percent, value in one.found.percentiles]
        if spoilt(one):
            notes.append(SPOILT.format(label_of(head, one), f"{rough(size * one.error)} {unit}".rstrip()))
    if any("-" in row for row in rows):
        notes.append("-: so small a sample does not bound it on that side")
    if any(one.left_out for one in found):
        notes.append("left out: could not be solved, or the measure is not known")
    if more:
        notes.append(f"{count(more, 'block')} more: --all")
    return TextTable(HEADING, columns, tuple(rows), tuple(notes))


def _notes(head: SweepHead) -> list[str]:
    """How the sample was drawn."""
    draws = head.plan.draws
    assert draws is not None
    laws = {law.law for law in draws.laws}
    notes = [f"drawn with --seed {draws.seed}: the same call draws the same"]
    return notes + [EVEN.format(CALLED[law]) for law in CALLED if law in laws]


def spoilt(one: MeasureStatistics) -> bool:
    """Whether the errors of the runs count beside the interval of the mean."""
    mean = one.found.mean if one.found is not None else None
    return mean is not None and mean.low is not None and one.error > NOT_SHOWN * (mean.value - mean.low)


def _line(label: str, one: Estimated, size: float) -> tuple[str, ...]:
    """A statistic with the digits that its interval supports."""
    ends = [one.value if end is None else end for end in (one.low, one.high)]
    off = 0.5 * size * (ends[1] - ends[0])
    scale = size * max(abs(one.value), *map(abs, ends))
    texts = (number_text(size * end, 0.01 * off, scale) if end is not None else "-" for end in one)
    return (label, *texts)


def _indices(head: SweepHead, found: Sequence[MeasureStatistics], laws: Sequence[Drawn]) -> TextTable:
    names = ("", "first order", "from", "to", "total", "from", "to")
    columns = tuple(TextColumn(name, "left" if not name else "point") for name in names)
    rows: list[tuple[str, ...] | str] = []
    notes: list[str] = ["first order: of the parameter alone; total: with all that it does together with others"]
    for one in found:
        if one.indices is None:
            why = FLAT if one.flat else FEW.format(len(laws) + 2, one.samples)
            notes.append(NO_INDICES.format(label_of(head, one)) + why)
            continue
        rows.append(f"{label_of(head, one)}: {count(one.samples, 'sample')}")
        for law, of in zip(laws, one.indices, strict=True):
            rows.append((law.name, *("-" if end is None else f"{end:.3f}" for estimated in of for end in estimated)))
        if one.samples < LEAST_BOUNDED:
            notes.append(UNBOUNDED.format(label_of(head, one), one.samples))
    return TextTable(INDICES, columns, tuple(rows), tuple(notes))
