"""The envelope of load cases: the lowest and highest value of each number, with the instant and the case that governs.

No case governs if all are as high within their errors, as for numbers that are only rounding. If some are as high, they
are listed besides the highest.
"""

from __future__ import annotations

from collections.abc import Mapping

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.snapshots.golden_file import BEYOND, NumberSnapshot, RunSnapshot


class Bound(NamedTuple):
    """The lowest or highest value of all cases, its instant (None if it holds throughout), and the case.

    case: None if no case governs
    similar: the other cases whose value differs by no more than the stated errors
    is_rounding: whether the value is no larger than its own stated error
    """

    value: float
    time: float | None
    case: str | None
    similar: tuple[str, ...] = ()
    is_rounding: bool = False

    @property
    def governing(self) -> tuple[str, ...]:
        """The cases that govern."""
        return () if self.case is None else (self.case, *self.similar)


class NumberEnvelope(NamedTuple):
    """One number over all cases, SI units.

    unclear: by case, the word in place of its extreme
    """

    path: str
    unit: str
    least: Bound | None
    greatest: Bound | None
    unclear: Mapping[str, str]

    @property
    def unclear_text(self) -> str:
        """In which cases the number is not known, and why."""
        words = dict.fromkeys(self.unclear.values())
        return "; ".join(f"{word} in {', '.join(c for c, w in self.unclear.items() if w == word)}" for word in words)


def make_envelope(runs: Mapping[str, RunSnapshot]) -> list[NumberEnvelope]:
    """Make the envelope of every number of the cases."""
    paths = dict.fromkeys(path for run in runs.values() for path in run.numbers)
    return [_make_number_envelope(path, {name: run.numbers.get(path) for name, run in runs.items()}) for path in paths]


def _make_number_envelope(path: str, numbers: Mapping[str, NumberSnapshot | None]) -> NumberEnvelope:
    known_numbers: dict[str, NumberSnapshot] = {}
    unclear: dict[str, str] = {}
    unit = next(number.unit for number in numbers.values() if number is not None)
    for case, number in numbers.items():
        if number is None:
            unclear[case] = "missing"
            continue
        values = number.values
        low, high = values.get("least"), values.get("greatest")
        words = [value for value in (low, high, *values.values()) if isinstance(value, str) and value != BEYOND]
        if words:
            unclear[case] = words[0]
        known_numbers[case] = number
    return NumberEnvelope(
        path, unit, _find_bound(known_numbers, "least", -1.0), _find_bound(known_numbers, "greatest", 1.0), unclear
    )


def _find_bound(numbers: Mapping[str, NumberSnapshot], word: str, side: float) -> Bound | None:
    """Find the highest (side 1) or lowest (-1) value of all cases; None if no case has one."""
    known = {case: value for case, number in numbers.items() if isinstance(value := number.values.get(word), float)}
    if not known:
        return None
    case = max(known, key=lambda name: side * known[name])
    value, error = known[case], numbers[case].error
    is_rounding = abs(value) <= error
    similar = tuple(
        name for name, other in known.items() if name != case and abs(value - other) <= error + numbers[name].error
    )
    if similar and len(similar) == len(numbers) - 1:
        return Bound(value, None, None, (case, *similar), is_rounding)
    return Bound(value, getattr(numbers[case], f"{word}_at"), case, similar, is_rounding)
