"""`--measure`: one number of a run, such as `max abs sections.middle.M1` or `at 0.5 energy.kinetic`."""

from __future__ import annotations

import math

from heuncli.cli.entry import UsageError
from heuncli.errors import Problem
from heuncli.report.export import dump
from heuncli.report.numbers import OPEN
from heuncli.study.measure import Measure, NotOneNumber, value
from heuncli.study.solve import Study

FORMS = "expected [max | min | max abs | first | final | at T] PATH"
HINT = "such as --measure 'max abs sections.middle.M1'"


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


def write(asked: Measure, study: Study, form: str) -> str:
    """The number as text, all its digits; as JSON with its instant."""
    try:
        number, at = value(asked, study)
    except NotOneNumber as error:
        raise UsageError(Problem("bad-option", f"--measure: {error.problems[0].message}", hint=HINT)) from None
    if form == "json":
        return dump({"measure": f"{asked.how} {asked.path}".strip(), "value": number, "at": at})
    return f"{OPEN if math.isnan(number) else repr(number)}\n"


def _is_number(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False
