"""Indeterminate loads in words: a line for things of a kind with the same open loads, and sums that are determinate.

A sum: `joints.top Fz + joints.bottom Fz = 49.05 N; distribution indeterminate`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.document import OutputTable
from heuncli.output.tables.extremes_tables import PART
from heuncli.output.tables.nouns import format_count, join_ranges
from heuncli.output.tables.table_blocks import TableBlock, format_component
from heuncli.results.results import Array, DeterminateSum, Results
from heuncli.results.results_schema import AXIAL_FORCES, RESULTANTS, SECTION_FORCES, XYZ
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.channels import Channel
from heuncli.study.quantities.cut_series import CutSeries
from heuncli.study.quantities.digits import StatedErrors, format_unclaimed, largest_magnitude, write_numbers
from heuncli.study.quantities.labels import Labels

ADJECTIVES = ("radial", "axial")  # of the loads of a joint with an axis
MAX_COMPONENTS = 4  # with more, "loads" says as much
MAX_TERMS = 6  # tables show short sums of forces, JSON shows all
TURNING_FACTOR_NOTE = "(t): factor varies with position, shown for the first instant; all values: --format json"
FORCES = frozenset({"force", *AXIAL_FORCES, *SECTION_FORCES})


class IndeterminateGroup(NamedTuple):
    """Things of one kind, and what of their loads is indeterminate throughout, in words.

    paths: of the numbers
    """

    kind: str
    what: str
    names: tuple[str, ...]
    paths: tuple[str, ...]


def find_indeterminate_groups(
    blocks: Iterable[TableBlock], cut_series: Iterable[CutSeries]
) -> list[IndeterminateGroup]:
    """Find the groups of a run, in the order of its tables, which show these blocks and series of cuts."""
    groups: dict[tuple[str, str], tuple[list[str], list[str]]] = {}
    for kind, name, rows in _iter_things(blocks, cut_series):
        unknown = [channel for channel in rows if np.isnan(channel.values).all()]
        if unknown and PART not in name:
            names, paths = groups.setdefault((kind, _describe_loads(kind, unknown)), ([], []))
            names.append(name)
            paths += [channel.path for channel in unknown]
    return [IndeterminateGroup(*key, tuple(names), tuple(paths)) for key, (names, paths) in groups.items()]


def _iter_things(
    blocks: Iterable[TableBlock], cut_series: Iterable[CutSeries]
) -> Iterator[tuple[str, str, Sequence[Channel]]]:
    """Yield kind, name and channels of all that may be indeterminate; supports and elements repeat joints and loads."""
    for block in blocks:
        if block.kind in ("joints", "sensors", "stops", "couplings", "sections"):
            yield from ((block.kind, group.name, group.rows) for group in block.groups)
    yield from (("sections", series.name, series.loads) for series in cut_series)


def _describe_loads(kind: str, unknown: Sequence[Channel]) -> str:
    """Describe indeterminate loads: "radial loads", "tooth forces", "N, M1"."""
    quantities = dict.fromkeys(channel.quantity for channel in unknown)
    adjectives = [word for word in ADJECTIVES if word in quantities]
    if kind == "couplings":
        return "tooth forces" if "normal" in quantities else "tensions" if "tension" in quantities else "loads"
    if adjectives:
        return f"{' and '.join(adjectives)} loads"
    if kind == "sections":
        components = [quantity for quantity in quantities if quantity in RESULTANTS]
    else:
        components = [channel.label for channel in unknown if channel.vector and not channel.is_magnitude]
    return ", ".join(components) if 0 < len(components) < MAX_COMPONENTS else "loads"


def format_indeterminate(groups: Iterable[IndeterminateGroup], labels: Labels, redundant: int = 0) -> list[str]:
    """Format one line for each group; the last gives the number of redundant constraints."""
    lines = []
    for group in groups:
        names = join_ranges(describe_object(group.kind, name, labels) for name in group.names)
        lines.append(f"indeterminate: {group.what} of {', '.join(names)}")
    if lines and redundant:
        lines[-1] += f" ({format_count(redundant, 'redundant constraint')})"
    return lines


def make_sums_table(
    results: Results, stated_errors: StatedErrors, last_instant: Results | None = None, unit: str = "N"
) -> OutputTable | None:
    """Make the table of sums that are determinate although their terms are not; None if there are none.

    last_instant: results at the last instant, if the run ends beyond its horizon
    unit: SI unit of forces, N·s for impulses
    """
    if not results.certain_sums:
        return None
    ends = [None] * len(results.certain_sums) if last_instant is None else last_instant.certain_sums
    all_lines = [
        _format_sum(block, stated_errors, end, unit) for block, end in zip(results.certain_sums, ends, strict=True)
    ]
    lines = [line for line in all_lines if line is not None]
    n_hidden = len(results.certain_sums) - len(lines)
    hidden_note = f"{n_hidden} more in --format json (moments, or more than {MAX_TERMS} terms)" if n_hidden else ""
    notes = [
        *lines,
        *([TURNING_FACTOR_NOTE] if any("(t)·" in line for line in lines) else []),
        *([hidden_note] if hidden_note else []),
    ]
    axes = ", world axes" if "axes" in results.model else ""  # other axes are given elsewhere
    return OutputTable(f"DETERMINATE SUMS  of indeterminate reactions{axes}", notes=tuple(notes))


def _format_sum(
    block: DeterminateSum, stated_errors: StatedErrors, last_instant: DeterminateSum | None, si_unit: str
) -> str | None:
    """Format one sum with its value, or its first, last, smallest and largest value; None if it is too long or has
    moments.
    """
    terms = {path: np.atleast_1d(np.asarray(factor, dtype=np.float64)) for path, factor in block["terms"].items()}
    if len(terms) > MAX_TERMS or not all(_is_force(path) for path in terms):
        return None
    unit, per_si = stated_errors.units.find(si_unit)
    values = np.asarray(block["value"], dtype=np.float64)
    numbers = [per_si * value for value in (values[0], values[-1], np.nanmin(values), np.nanmax(values))]
    texts = write_numbers(numbers, stated_errors.choose_style("reactions", si_unit, largest_magnitude(values)))
    if last_instant is not None:
        texts[1] = format_unclaimed(last_instant["value"][-1], si_unit, stated_errors, texts[1])
    if texts == ["0"] * 4 and _states_equality(terms):
        return " = ".join(map(format_path, terms)) + "; magnitude indeterminate"
    sum_text = _format_terms(terms)
    if len(set(texts)) == 1:
        value = "0" if texts[0] == "0" else f"{texts[0]} {unit}"
        return f"{sum_text} = {value}; distribution indeterminate"
    first, last, low, high = texts
    range_text = f"{first} {unit} first, {last} {unit} last, {low} to {high} {unit} over the output times"
    return f"{sum_text} = {range_text}; distribution indeterminate"


def format_path(path: str) -> str:
    """Format a path as the tables name it: `joints.top.force.z` becomes `joints.top Fz`."""
    name, _, component = path.rpartition(".")
    if component in XYZ:
        name, _, quantity = name.rpartition(".")
        component = f"{quantity}.{component}"
    return f"{name} {format_component(component)}"


def _is_force(path: str) -> bool:
    return bool(FORCES.intersection(path.split(".")[-2:]))


def _states_equality(terms: Mapping[str, Array]) -> bool:
    """Return whether the sum states that two components are equal."""
    factors = list(terms.values())
    return len(factors) == 2 and bool(np.all(factors[0] + factors[1] == 0.0))


def _format_terms(terms: Mapping[str, Array]) -> str:
    text = ""
    for path, factors in terms.items():
        is_constant = bool(np.all(factors == factors[0]))
        size = abs(float(factors[0]))
        number = "" if is_constant and size == 1.0 else f"{size:.4g}·" if is_constant else f"{size:.4g}(t)·"
        sign = "−" if factors[0] < 0.0 else "+"
        text += (
            f" {sign} {number}{format_path(path)}"
            if text
            else f"{'−' if sign == '−' else ''}{number}{format_path(path)}"
        )
    return text
