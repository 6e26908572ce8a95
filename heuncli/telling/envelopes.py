"""The envelope of load cases: the lowest and the highest of each number, with the instant and the case that governs."""

from __future__ import annotations

from collections.abc import Mapping

from heuncli.named_tuples import NamedTuple
from heuncli.telling.kept import BEYOND, KeptNumber, KeptRun


class Bound(NamedTuple):
    """The lowest or highest of all cases: its value, its instant where it is not throughout, and the case."""

    value: float
    at: float | None
    case: str


class Enveloped(NamedTuple):
    """One number over all cases, in SI; unclear: by case what stands in the place of an extreme there."""

    path: str
    unit: str
    least: Bound | None
    greatest: Bound | None
    unclear: Mapping[str, str]

    @property
    def lacks(self) -> str:
        """In which cases it is not known, and why."""
        words = dict.fromkeys(self.unclear.values())
        return "; ".join(f"{word} in {', '.join(c for c, w in self.unclear.items() if w == word)}" for word in words)


def envelope(runs: Mapping[str, KeptRun]) -> list[Enveloped]:
    """Every number of the cases: the lowest and the highest of all, and the cases of which that is not known."""
    paths = dict.fromkeys(path for run in runs.values() for path in run.numbers)
    return [_enveloped(path, {name: run.numbers.get(path) for name, run in runs.items()}) for path in paths]


def _enveloped(path: str, numbers: Mapping[str, KeptNumber | None]) -> Enveloped:
    least: Bound | None = None
    greatest: Bound | None = None
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
        if isinstance(low, float) and (least is None or low < least.value):
            least = Bound(low, number.least_at, case)
        if isinstance(high, float) and (greatest is None or high > greatest.value):
            greatest = Bound(high, number.greatest_at, case)
    return Enveloped(path, unit, least, greatest, unclear)
