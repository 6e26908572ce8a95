"""The minimum and maximum of each number over all load cases: their texts, and the case that governs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.client_report.report_data import ReportData, ReportedRun
from heuncli.output.documents.document import append_unit
from heuncli.output.snapshots.columns import format_place
from heuncli.output.snapshots.envelopes import Bound
from heuncli.output.snapshots.golden_file import BEYOND, NumberSnapshot
from heuncli.results.results import Array, CutPosition
from heuncli.study.quantities.digits import OPEN, UNKNOWN, Style, choose_style, format_error, write_times
from heuncli.study.quantities.table_units import Units

LEAST, GREATEST = "least", "greatest"
PLACE_DECIMALS = 9  # of places [m]
LOWEST, HIGHEST = ".lowest", ".highest"  # of a series of cuts


class CaseExtreme(NamedTuple):
    """An extreme in one case.

    value: in SI, or a word such as `open` in its place
    time: its instant [s], or None
    place: its place along a series of cuts, or None
    """

    value: float | str
    time: float | None
    place: str | None


class CaseExtremes(NamedTuple):
    """The minimum and maximum of a number in one case, and its stated error [SI].

    is_partly_open: whether it is indeterminate at some of the instants
    is_known: whether it is known at all instants
    """

    low: CaseExtreme
    high: CaseExtreme
    error: float
    unit: str
    is_partly_open: bool
    is_known: bool

    @property
    def values(self) -> list[float]:
        """The one or two extremes that are numbers."""
        return [end.value for end in (self.low, self.high) if isinstance(end.value, float)]


def find_extremes(run: ReportedRun, path: str) -> CaseExtremes | None:
    """Find the extremes of a number in one case, for a series of cuts those over the whole run; None if the case has no
    such number.
    """
    numbers = run.snapshot.numbers
    is_open = _is_open(run, path)
    if path in numbers:
        return _make_extremes(numbers[path], numbers[path], has_open_instants=is_open)
    if path + LOWEST not in numbers:
        return None
    extremes = _make_extremes(numbers[path + LOWEST], numbers[path + HIGHEST], has_open_instants=is_open)
    return extremes._replace(
        low=_add_place(extremes.low, run, path, np.nanargmin), high=_add_place(extremes.high, run, path, np.nanargmax)
    )


def _add_place(
    extreme: CaseExtreme, run: ReportedRun, path: str, find_index: Callable[[Array], np.intp]
) -> CaseExtreme:
    """Add the place to an extreme along a series of cuts that is constant in time; their snapshot holds none."""
    if extreme.place is not None or not isinstance(extreme.value, float):
        return extreme
    _, name, *quantity = path.split(".")
    section = run.results.sections[name]
    values = section["stress"][quantity[1]] if quantity[0] == "stress" else section[quantity[0]]
    if not np.isfinite(values[0]).any():
        return extreme
    cut = int(find_index(values[0]))
    side = section["side"][cut] if section.get("side") else None
    return extreme._replace(place=format_place(CutPosition(float(section["s"][cut]), side, cut)))


def _is_open(run: ReportedRun, path: str) -> bool:
    """Return whether a number is indeterminate at some instant; a stress is if any load of its section is."""
    name = ".".join(path.split(".")[:2]) if ".stress." in path else path
    return any(each == name or each.startswith(f"{name}.") for each in run.snapshot.open)


def _make_extremes(lowest: NumberSnapshot, highest: NumberSnapshot, *, has_open_instants: bool) -> CaseExtremes:
    low = CaseExtreme(lowest.values.get(LEAST, UNKNOWN), lowest.least_at, lowest.least_place)
    high = CaseExtreme(highest.values.get(GREATEST, UNKNOWN), highest.greatest_at, highest.greatest_place)
    words = {word for word in (*lowest.values.values(), *highest.values.values()) if isinstance(word, str)}
    is_open = has_open_instants or OPEN in words
    is_partly_open = is_open and isinstance(low.value, float) and isinstance(high.value, float)
    return CaseExtremes(
        low, high, max(lowest.error, highest.error), lowest.unit, is_partly_open, not is_open and not words - {BEYOND}
    )


class GoverningBounds(NamedTuple):
    """The governing minimum and maximum of each number, by path."""

    least: Mapping[str, Bound]
    greatest: Mapping[str, Bound]

    def find_least(self, path: str) -> Bound | None:
        """Return the smallest value of all cases."""
        return self.least.get(path) or self.least.get(path + LOWEST)

    def find_greatest(self, path: str) -> Bound | None:
        """Return the largest value of all cases."""
        return self.greatest.get(path) or self.greatest.get(path + HIGHEST)


def find_governing(data: ReportData) -> GoverningBounds:
    """Find the case that governs each number."""
    least = {row.path: row.least for row in data.envelope if row.least is not None}
    greatest = {row.path: row.greatest for row in data.envelope if row.greatest is not None}
    return GoverningBounds(least, greatest)


def choose_family_style(ends: Sequence[CaseExtremes], data: ReportData, size: float) -> Style:
    """Choose the style for numbers of one family.

    size: factor from SI to the display unit
    """
    scale = max((abs(value) for extremes in ends for value in extremes.values), default=0.0)
    error = max((extremes.error for extremes in ends), default=0.0)
    lost = max((run.page.certain.rounding_of(extremes.unit) for extremes in ends for run in data.runs), default=0.0)
    return choose_style(scale * size, error * size, lost * size)


def format_extreme(value: float | str, number_style: Style, size: float) -> str:
    """Format an extreme, or the word in its place."""
    if isinstance(value, float):
        return number_style.write(value * size)
    return UNKNOWN if value == BEYOND else OPEN if value == OPEN else UNKNOWN


def is_steady(ends: CaseExtremes, number_style: Style, size: float) -> bool:
    """Return whether minimum and maximum have the same text; then no instant is shown for them."""
    return format_extreme(ends.low.value, number_style, size) == format_extreme(ends.high.value, number_style, size)


def format_place_in_unit(place: str | None, units: Units, *, with_unit: bool = True) -> str:
    """Format a place along a series of cuts, which is stored in metres, and the side on which the load there is
    counted.
    """
    if place is None:
        return ""
    distance, _, side = place.partition(" m")
    unit, size = units.find("m")
    return f"{round(float(distance), PLACE_DECIMALS) * size:.5g}{f' {unit}' * with_unit}{side}"


def format_instant(time: float | None, run: ReportedRun) -> str:
    """Format an instant; empty if there is none or if the run has only one."""
    times = run.results.time
    if time is None or len(times) == 1:
        return ""
    return write_times([time], float(np.ptp(times)))[0]


class GreatestOfCases(NamedTuple):
    """The largest value of a number over all cases, with what a sentence about it needs.

    size: factor from SI to `unit`
    place, instant: as texts, or empty
    """

    name: str
    unit: str
    high: Bound
    error: float
    number_style: Style
    size: float
    place: str
    instant: str

    def format_value(self) -> str:
        """Format the largest value with its unit and its error."""
        value, error = self.number_style.write(self.high.value * self.size), format_error(self.error * self.size)
        return f"{append_unit(value, self.unit)} (± {append_unit(error, self.unit)})"

    @property
    def position_text(self) -> str:
        """The place, instant and case of the largest value, as the end of a sentence."""
        parts = [f"at s = {self.place}"] if self.place else []
        parts += [f"at t = {self.instant} s"] if self.instant else []
        parts += [f"in case {self.high.case}"] if self.high.case else []
        return "".join(f", {part}" for part in parts)


def find_greatest_of_cases(
    data: ReportData, path: str, name: str, *, by_magnitude: bool = False
) -> GreatestOfCases | None:
    """Find the largest value of a number over all cases; None if no case knows it, or if it is 0 in all.

    by_magnitude: whether the magnitude counts and not the signed value
    """
    extremes_by_case = {run.name: ends for run in data.runs if (ends := find_extremes(run, path)) is not None}
    if by_magnitude:
        extremes_by_case = {case: _use_magnitude(ends) for case, ends in extremes_by_case.items()}
    known = {case: ends for case, ends in extremes_by_case.items() if isinstance(ends.high.value, float)}
    if not known:
        return None
    case, ends = max(known.items(), key=lambda pair: pair[1].high.value)
    run = next(run for run in data.runs if run.name == case)
    unit, size = data.units.find(ends.unit)
    high = Bound(float(ends.high.value), ends.high.time, case)
    number_style = choose_family_style(list(known.values()), data, size)
    if number_style.write(high.value * size) == "0":
        return None
    is_constant = ends.high.place is None and is_steady(ends, number_style, size)
    instant = "" if is_constant else format_instant(ends.high.time, run)
    return GreatestOfCases(
        name, unit, high, ends.error, number_style, size, format_place_in_unit(ends.high.place, data.units), instant
    )


def _use_magnitude(ends: CaseExtremes) -> CaseExtremes:
    """Return the extremes with the larger magnitude as maximum."""
    low, high = ends.low, ends.high
    if isinstance(low.value, float) and isinstance(high.value, float) and -low.value > abs(high.value):
        return ends._replace(low=high, high=low._replace(value=-low.value))
    return ends


def find_uncertain_cases(data: ReportData, path: str) -> list[str]:
    """Find the cases in which a number is indeterminate or not known at some instant, so that it may be larger
    there.
    """
    return [run.case_label for run, ends in iter_run_extremes(data, path) if not ends.is_known]


def iter_run_extremes(data: ReportData, path: str) -> Iterator[tuple[ReportedRun, CaseExtremes]]:
    """Yield the cases that have a number, each with its extremes."""
    for run in data.runs:
        extremes = find_extremes(run, path)
        if extremes is not None:
            yield run, extremes
