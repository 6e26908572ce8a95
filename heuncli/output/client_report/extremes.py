"""The minimum and maximum of each number over all load cases: their texts, and the case that governs."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.client_report.report_data import ReportData, ReportedRun
from heuncli.output.documents.document import append_unit
from heuncli.output.snapshots.envelopes import Bound
from heuncli.output.snapshots.golden_file import BEYOND, NumberSnapshot
from heuncli.results.results import Array, CutPosition
from heuncli.results.results_paths import find_values
from heuncli.study.quantities.digits import OPEN, UNKNOWN, ReaderStyle, choose_reader_style
from heuncli.study.quantities.table_units import Units

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
LEAST, GREATEST = "least", "greatest"
PLACE_DECIMALS = 9  # decimals to which places along a series [m] are rounded
DECIMALS = {"m": 3, "mm": 1}  # decimals of places as they are shown; in other units 4
NOISE = 1e-3  # relative to the largest of a family: a smaller number is shown as a dash
DASH, MINUS = "–", "−"
INSTANT_DIGITS = 3  # digits of an instant, relative to the run's length
LOWEST, HIGHEST = ".lowest", ".highest"  # ends of the paths of extremes along a series of cuts


class CaseExtreme(NamedTuple):
    """An extreme in one case.

    value: in SI, or a word such as `open` in its place
    time: its instant [s], or None
    place: its place along a series of cuts, or None
    """

    value: float | str
    time: float | None
    place: CutPosition | None


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
    """Find the extremes of a number in one case; None if the case has no such number.

    Those along a series of cuts are over its whole length.
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
    found = find_values(run.results, path)
    values, section = found.values[0], run.results.sections[found.keys[1]]
    if not np.isfinite(values).any():
        return extreme
    cut = int(find_index(values))
    side = section["side"][cut] if section.get("side") else None
    return extreme._replace(place=CutPosition(float(section["s"][cut]), side, cut))


def _is_open(run: ReportedRun, path: str) -> bool:
    """Return whether a number is indeterminate at some instant; a stress or a deflection is if any load of its
    section is.
    """
    name = ".".join(path.split(".")[:2]) if ".stress." in path or ".deflection." in path else path
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


class Family(NamedTuple):
    """How the numbers of one family are written: four significant digits, noise as a dash.

    noise: magnitudes below it are shown as a dash [SI]
    """

    style: ReaderStyle
    noise: float

    @property
    def unit(self) -> str:
        """The display unit, empty for a plain number."""
        return "" if self.style.unit == "1" else self.style.unit

    def write(self, value: float | str) -> str:
        """Format a number [SI] or the word in its place."""
        if isinstance(value, str):
            return OPEN if value == OPEN else UNKNOWN
        return DASH if abs(value) < self.noise or value == 0.0 else self.style.write_with_error(value)


def choose_family(ends: Sequence[CaseExtremes], data: ReportData, all_ends: Sequence[CaseExtremes] = ()) -> Family:
    """Choose how numbers of one family and unit are written; all_ends: those by whose size the unit is chosen."""
    unit = ends[0].unit
    scale, unit_scale = (
        max((abs(value) for extremes in group for value in extremes.values), default=0.0)
        for group in (ends, all_ends or ends)
    )
    rounding = max((run.page.stated_errors.rounding_of(unit) for run in data.runs), default=0.0)
    error = max((extremes.error for extremes in ends), default=0.0)
    noise = math.inf if scale <= rounding else NOISE * scale
    return Family(choose_style_in_unit(data, unit, scale, unit_scale, error), noise)


def choose_style_in_unit(
    data: ReportData, unit: str, scale: float, unit_scale: float, error: float = 0.0
) -> ReaderStyle:
    """Choose the style of numbers whose largest is `scale`, in the unit that suits `unit_scale`; SI."""
    style = choose_reader_style(unit, scale, data.units, error)
    if unit_scale == scale:
        return style
    per_si = choose_reader_style(unit, unit_scale, data.units).per_si
    shown_unit = choose_reader_style(unit, unit_scale, data.units).unit
    shift = round(math.log10(style.per_si / per_si)) if style.per_si != per_si else 0
    return ReaderStyle(shown_unit, per_si, max(style.decimals + shift, 0), per_si * error)


def format_power(value: float, digits: int = 1) -> str:
    """Format a small or large number for a reader: 3·10⁻⁹, 10⁻⁶, 0.02, 0; a dash for one that is not known."""
    if not math.isfinite(value):
        return DASH
    if value == 0.0:
        return "0"
    mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
    if -3 <= int(exponent) <= max(3, digits - 1):
        return f"{value:.{digits}g}" if int(exponent) < digits else f"{value:.0f}"
    return f"{float(mantissa):g}·10{str(int(exponent)).translate(SUPERSCRIPTS)}".removeprefix("1·")


def format_place(place: CutPosition | None, units: Units) -> str:
    """Format a place along a series of cuts, and the side on which the load there is counted; in tables, whose heads
    have the unit.
    """
    return "" if place is None else " ".join([_format_distance(place, units), *([place.side] if place.side else [])])


def describe_place(place: CutPosition | None, units: Units) -> str:
    """Describe a place along a series of cuts as part of a sentence; empty without one."""
    if place is None:
        return ""
    return f"{f'just {place.side}' if place.side else 'at'} s = {_format_distance(place, units)} {units.find('m')[0]}"


def _format_distance(place: CutPosition, units: Units) -> str:
    unit, per_si = units.find("m")
    text = f"{round(place.s, PLACE_DECIMALS) * per_si:.{DECIMALS.get(unit, 4)}f}"
    return text.rstrip("0").rstrip(".")


def format_instant(time: float | None, run: ReportedRun) -> str:
    """Format an instant with three digits of the run's length; empty if there is none or if the run has only one."""
    times = run.results.time
    if time is None or len(times) == 1:
        return ""
    span = float(np.ptp(times))
    decimals = max(0, INSTANT_DIGITS - math.floor(math.log10(span))) if span > 0.0 else 0
    return f"{time:.{decimals}f}".replace("-", MINUS)


class GreatestOfCases(NamedTuple):
    """The number of largest magnitude over all cases, with its sign.

    run: the case; extreme: value, instant and place
    """

    name: str
    path: str
    run: ReportedRun
    extreme: CaseExtreme
    ends: CaseExtremes
    family: Family

    @property
    def value(self) -> float:
        """The number [SI]."""
        assert isinstance(self.extreme.value, float)
        return self.extreme.value

    @property
    def text(self) -> str:
        """The number with its unit."""
        return append_unit(self.family.write(self.value), self.family.unit)

    @property
    def is_steady(self) -> bool:
        """Whether the number is the same at all instants, to the digits shown."""
        return self.family.write(self.ends.low.value) == self.family.write(self.ends.high.value)

    @property
    def instant(self) -> str:
        """The instant as text; empty if there is none."""
        return "" if self.is_steady and not self.extreme.place else format_instant(self.extreme.time, self.run)


def find_greatest_of_cases(data: ReportData, path: str, name: str) -> GreatestOfCases | None:
    """Find the number of largest magnitude over all cases; None if no case knows it, or if it is noise in all."""
    best: tuple[float, ReportedRun, CaseExtreme, CaseExtremes] | None = None
    for run, ends in iter_run_extremes(data, path):
        for end in (ends.high, ends.low):
            if isinstance(end.value, float) and (best is None or abs(end.value) > best[0]):
                best = abs(end.value), run, end, ends
    if best is None:
        return None
    family = choose_family([best[3]], data)
    if family.write(best[2].value) == DASH:
        return None
    return GreatestOfCases(name, path, best[1], best[2], best[3], family)


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
