"""`--measure`: one number of a run, such as `max abs sections.middle.M1` or `at 0.5 energy.kinetic`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from heuncli.cli.entry import UsageError
from heuncli.cli.solving import SAME_INSTANT, extremes, report_of
from heuncli.errors import Problem
from heuncli.report.export import dump
from heuncli.report.labels import Labels
from heuncli.report.numbers import OPEN
from heuncli.results import Array, Results
from heuncli.results_paths import find
from heuncli.study.solve import Study

FORMS = "expected [max | min | max abs | first | final | at T] PATH"
HINT = "such as --measure 'max abs sections.middle.M1'"


class Measure(NamedTuple):
    """What is measured: `how` is max, min, abs, first, final, at or empty (a number that has no instants)."""

    how: str
    path: str
    at: float | None = None

    @property
    def wanted(self) -> frozenset[str] | None:
        """The report that has to be computed; None for the usual ones."""
        return report_of(self.path)


def parse(text: str) -> Measure:
    """The Measure that the words mean. Raises UsageError."""
    words = text.split()
    match words:
        case [path] if path not in ("max", "min", "abs", "first", "final", "at"):
            return Measure("", path)
        case ["max" | "min" | "abs" | "first" | "final" as how, path]:
            return Measure(how, path)
        case ["max", "abs", path]:
            return Measure("abs", path)
        case ["at", t, path] if _is_number(t):
            return Measure("at", path, float(t))
    raise UsageError(Problem("bad-option", f"--measure '{text}': {FORMS}", hint=HINT))


def value(asked: Measure, study: Study) -> tuple[float, float | None]:
    """The number, and its instant if it has one; nan is open."""
    results: Results = study.results
    found = find(results, asked.path)
    if not found.timed:
        if asked.how:
            raise _refuse(asked, "has no instants: give the path alone")
        if found.values.size != 1:
            raise _refuse(asked, f"is {found.values.size} numbers: say which, as .x or .0")
        return float(found.values.reshape(())), None
    if asked.how in ("max", "min", "abs"):
        return peak(study, asked.path, asked.how)
    if asked.how == "at":
        at = _instant(asked, results.time)
        found, t = find(study.resample(np.array([at])), asked.path), at
        number = _one(asked, found.values[0], found.of_vectors)
    elif asked.how or len(results.time) == 1:
        place = -1 if asked.how == "final" else 0
        t, number = float(results.time[place]), _one(asked, found.values[place], found.of_vectors)
    else:
        raise _refuse(asked, f"runs over {len(results.time)} instants: say max, min, max abs, first, final or at T")
    return number, t


def peak(study: Study, path: str, how: str) -> tuple[float, float]:
    """Highest (`max`), lowest (`min`) or largest (`abs`) value over the run, searched between the samples, and when.

    A vector counts by its magnitude, a run of cuts over all its cuts.
    """
    asked = find(study.results, path)
    shape, vector = asked.values.shape[1:], asked.of_vectors

    def columns(results: Results) -> Array:
        values = find(results, path).values
        flat = values.reshape(len(values), -1)
        # The square of a magnitude is smooth where the magnitude is zero.
        return np.einsum("ijk,ijk->ij", *2 * [flat.reshape(len(values), -1, 3)]) if vector else flat

    n = int(np.prod(shape, dtype=int)) // (3 if vector else 1)
    found = extremes(study, columns, [list(range(n))])
    low, high = float(found.low[0]), float(found.high[0])
    if how == "abs" and abs(low) > abs(high):
        how, low = "min", abs(low)
    result, at = (low, found.low_at) if how == "min" else (high, found.high_at)
    return float(np.sqrt(result)) if vector else result, float(at[0])


def write(asked: Measure, study: Study, labels: Labels, form: str) -> str:
    """The number as text, all its digits; as JSON with its instant."""
    number, at = value(asked, study)
    if form == "json":
        return dump({"measure": f"{asked.how} {asked.path}".strip(), "value": number, "at": at})
    return f"{OPEN if np.isnan(number) else repr(number)}\n"


def _one(asked: Measure, numbers: Array, of_vectors: bool) -> float:
    if numbers.size == 1:
        return float(numbers.reshape(()))
    if of_vectors and numbers.ndim == 1:
        return float(np.linalg.norm(numbers))
    raise _refuse(asked, f"is {numbers.size} numbers: say which, as .x or .0")


def _instant(asked: Measure, times: Array) -> float:
    at = float(asked.at or 0.0)
    slack = SAME_INSTANT * float(np.ptp(times))
    if not times[0] - slack <= at <= times[-1] + slack:
        raise _refuse(asked, f"at {at:.6g}: the run goes from {times[0]:.6g} to {times[-1]:.6g} s")
    return float(np.clip(at, times[0], times[-1]))


def _refuse(asked: Measure, why: str) -> UsageError:
    return UsageError(Problem("bad-option", f"--measure: {asked.path} {why}", hint=HINT))


def _is_number(word: str) -> bool:
    try:
        return bool(np.isfinite(float(word)))
    except ValueError:
        return False
