"""The envelope of load cases: the lowest and the highest of each number, with the instant and the case that governs.

No case governs where all are as high but for their errors, as all are that are nothing but rounding; where some are,
the others stand beside the highest.
"""

from __future__ import annotations

from collections.abc import Mapping

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.snapshots.kept import BEYOND, KeptNumber, KeptRun


class Bound(NamedTuple):
    """The lowest or highest of all cases: its value, its instant where it is not throughout, and the case.

    case: None where no case governs; alike: the others that differ from it by no more than both state; is_rounding:
    whether the value is no more than its own stated error.
    """

    value: float
    at: float | None
    case: str | None
    alike: tuple[str, ...] = ()
    is_rounding: bool = False

    @property
    def governing(self) -> tuple[str, ...]:
        """The cases that govern."""
        return () if self.case is None else (self.case, *self.alike)


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
    found: dict[str, KeptNumber] = {}
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
        found[case] = number
    return Enveloped(path, unit, _bound(found, "least", -1.0), _bound(found, "greatest", 1.0), unclear)


def _bound(numbers: Mapping[str, KeptNumber], word: str, side: float) -> Bound | None:
    """The highest (side 1) or lowest (-1) of all cases; None where no case knows one."""
    known = {case: value for case, number in numbers.items() if isinstance(value := number.values.get(word), float)}
    if not known:
        return None
    case = max(known, key=lambda name: side * known[name])
    value, error = known[case], numbers[case].error
    noise = abs(value) <= error
    alike = tuple(
        name for name, other in known.items() if name != case and abs(value - other) <= error + numbers[name].error
    )
    if alike and len(alike) == len(numbers) - 1:
        return Bound(value, None, None, (case, *alike), noise)
    return Bound(value, getattr(numbers[case], f"{word}_at"), case, alike, noise)
