"""The lowest and the highest of a number over all load cases: as they are written, and which case governs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.client_report.reported import Reported, ReportedRun
from heuncli.output.snapshots.columns import position
from heuncli.output.snapshots.envelopes import Bound
from heuncli.output.snapshots.kept import BEYOND, KeptNumber
from heuncli.results.results import Array, Place
from heuncli.study.quantities.digits import OPEN, UNKNOWN, Style, rough, style, write_times
from heuncli.study.quantities.table_units import Units

LEAST, GREATEST = "least", "greatest"
FINEST = 9  # decimals of places [m]: what is below is nothing
LOWEST, HIGHEST = ".lowest", ".highest"  # of a run of cuts


class ReachedExtreme(NamedTuple):
    """An extreme of one case: its value in SI or the word in its place, its instant, and where it is along a run."""

    value: float | str
    at: float | None
    place: str | None


class Ends(NamedTuple):
    """The lowest and the highest of a number in one case, and the error that its run states [SI].

    parts_open: whether it is open at some of the instants; whole: whether it is known at all of them.
    """

    low: ReachedExtreme
    high: ReachedExtreme
    error: float
    unit: str
    parts_open: bool
    whole: bool

    @property
    def values(self) -> list[float]:
        """Those of the two that are numbers."""
        return [end.value for end in (self.low, self.high) if isinstance(end.value, float)]


def ends_of(run: ReportedRun, path: str) -> Ends | None:
    """The extremes of a number of one case, of a run of cuts those over its whole stretch; None where it has none."""
    numbers = run.kept.numbers
    opened = _is_opened(run, path)
    if path in numbers:
        return _ends(numbers[path], numbers[path], opened=opened)
    if path + LOWEST not in numbers:
        return None
    ends = _ends(numbers[path + LOWEST], numbers[path + HIGHEST], opened=opened)
    return ends._replace(
        low=_placed(ends.low, run, path, np.nanargmin), high=_placed(ends.high, run, path, np.nanargmax)
    )


def _placed(end: ReachedExtreme, run: ReportedRun, path: str, which: Callable[[Array], np.intp]) -> ReachedExtreme:
    """An extreme along a run of cuts with its place; of one that is the same at all instants no place is kept."""
    if end.place is not None or not isinstance(end.value, float):
        return end
    _, name, *quantity = path.split(".")
    section = run.results.sections[name]
    values = section["stress"][quantity[1]] if quantity[0] == "stress" else section[quantity[0]]
    if not np.isfinite(values[0]).any():
        return end
    cut = int(which(values[0]))
    side = section["side"][cut] if section.get("side") else None
    return end._replace(place=position(Place(float(section["s"][cut]), side, cut)))


def _is_opened(run: ReportedRun, path: str) -> bool:
    """Whether a number is open at some instant of the run; a stress is where a load of its section is."""
    whole = ".".join(path.split(".")[:2]) if ".stress." in path else path
    return any(each == whole or each.startswith(f"{whole}.") for each in run.kept.open)


def _ends(lowest: KeptNumber, highest: KeptNumber, *, opened: bool) -> Ends:
    low = ReachedExtreme(lowest.values.get(LEAST, UNKNOWN), lowest.least_at, lowest.least_place)
    high = ReachedExtreme(highest.values.get(GREATEST, UNKNOWN), highest.greatest_at, highest.greatest_place)
    words = {word for word in (*lowest.values.values(), *highest.values.values()) if isinstance(word, str)}
    is_open = opened or OPEN in words
    parts = is_open and isinstance(low.value, float) and isinstance(high.value, float)
    return Ends(low, high, max(lowest.error, highest.error), lowest.unit, parts, not is_open and not words - {BEYOND})


class Governing(NamedTuple):
    """By path the cases of the lowest and of the highest."""

    least: Mapping[str, Bound]
    greatest: Mapping[str, Bound]

    def low(self, path: str) -> Bound | None:
        """The lowest of all cases."""
        return self.least.get(path) or self.least.get(path + LOWEST)

    def high(self, path: str) -> Bound | None:
        """The highest of all cases."""
        return self.greatest.get(path) or self.greatest.get(path + HIGHEST)


def governing(of: Reported) -> Governing:
    """Which case governs each number."""
    least = {row.path: row.least for row in of.envelope if row.least is not None}
    greatest = {row.path: row.greatest for row in of.envelope if row.greatest is not None}
    return Governing(least, greatest)


def style_of(ends: Sequence[Ends], of: Reported, size: float) -> Style:
    """How numbers of one family are written in a unit of which so many are one in SI."""
    scale = max((abs(value) for one in ends for value in one.values), default=0.0)
    error = max((one.error for one in ends), default=0.0)
    lost = max((run.page.certain.lost(one.unit) for one in ends for run in of.runs), default=0.0)
    return style(scale * size, error * size, lost * size)


def text_of(value: float | str, how: Style, size: float) -> str:
    """An extreme as it is written."""
    if isinstance(value, float):
        return how.write(value * size)
    return UNKNOWN if value == BEYOND else OPEN if value == OPEN else UNKNOWN


def is_steady(ends: Ends, how: Style, size: float) -> bool:
    """Whether the lowest and the highest are the same to the digits that are written: then neither has an instant."""
    return text_of(ends.low.value, how, size) == text_of(ends.high.value, how, size)


def place_text(place: str | None, units: Units, *, named: bool = True) -> str:
    """A place along a run of cuts, which is kept in metres, with the side of what acts there; named: its unit, too."""
    if place is None:
        return ""
    distance, _, side = place.partition(" m")
    unit, size = units.of("m")
    return f"{round(float(distance), FINEST) * size:.5g}{f' {unit}' * named}{side}"


def instant_text(at: float | None, run: ReportedRun) -> str:
    """An instant as it is written; nothing where there is none, or only one."""
    times = run.results.time
    if at is None or len(times) == 1:
        return ""
    return write_times([at], float(np.ptp(times)))[0]


class GreatestOfCases(NamedTuple):
    """A number over all cases, ready to be told in a sentence; high: the highest."""

    name: str
    unit: str
    high: Bound
    error: float
    how: Style
    size: float
    place: str
    at: str

    def high_text(self) -> str:
        """The highest with its unit and its error."""
        unit = f" {self.unit}" if self.unit != "1" else ""
        return f"{self.how.write(self.high.value * self.size)}{unit} (± {rough(self.error * self.size)}{unit})"

    @property
    def where(self) -> str:
        """Where, when and in which case that is."""
        parts = [f"at s = {self.place}"] if self.place else []
        parts += [f"at t = {self.at} s"] if self.at else []
        parts += [f"in case {self.high.case}"] if self.high.case else []
        return "".join(f", {part}" for part in parts)


def spread_of(of: Reported, path: str, name: str, *, signed: bool = False) -> GreatestOfCases | None:
    """The highest of a number over all cases; None where no case knows it, or it is 0 in all.

    signed: whether its size counts, and not its sign.
    """
    found = {run.name: ends for run in of.runs if (ends := ends_of(run, path)) is not None}
    if signed:
        found = {case: _by_size(ends) for case, ends in found.items()}
    known = {case: ends for case, ends in found.items() if isinstance(ends.high.value, float)}
    if not known:
        return None
    case, ends = max(known.items(), key=lambda pair: pair[1].high.value)
    run = next(run for run in of.runs if run.name == case)
    unit, size = of.units.of(ends.unit)
    high = Bound(float(ends.high.value), ends.high.at, case)
    how = style_of(list(known.values()), of, size)
    if how.write(high.value * size) == "0":
        return None
    steady = ends.high.place is None and is_steady(ends, how, size)
    at = "" if steady else instant_text(ends.high.at, run)
    return GreatestOfCases(name, unit, high, ends.error, how, size, place_text(ends.high.place, of.units), at)


def _by_size(ends: Ends) -> Ends:
    """The extremes of the size of a number with a sign: as its highest the one that is larger."""
    low, high = ends.low, ends.high
    if isinstance(low.value, float) and isinstance(high.value, float) and -low.value > abs(high.value):
        return ends._replace(low=high, high=low._replace(value=-low.value))
    return ends


def lacking(of: Reported, path: str) -> list[str]:
    """The cases in which a number is open or not known at some instant: it may be larger there."""
    return [run.told for run, ends in runs_in(of, path) if not ends.whole]


def runs_in(of: Reported, path: str) -> Iterator[tuple[ReportedRun, Ends]]:
    """The cases that have a number, with its extremes."""
    for run in of.runs:
        ends = ends_of(run, path)
        if ends is not None:
            yield run, ends
