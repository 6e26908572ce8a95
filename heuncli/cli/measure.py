"""`--measure`: one number of a run, such as `max abs sections.middle.M1` or `at 0.5 energy.kinetic`."""

from __future__ import annotations

import math

from heuncli.cli.entry import UsageError
from heuncli.errors import Problem
from heuncli.report.export import dump
from heuncli.report.numbers import OPEN, UNKNOWN
from heuncli.study.measure import NOT_CLAIMED, Measure, NotOneNumber, lost_from, value
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
    """The number as text, all its digits; as JSON with its instant. What is not known beyond the horizon is `?`."""
    try:
        number, at, place = value(asked, study)
        horizon = lost_from(asked, study)
    except NotOneNumber as error:
        raise UsageError(Problem("bad-option", f"--measure: {error.problems[0].message}", hint=HINT)) from None
    if form == "json":
        block = {"measure": f"{asked.how} {asked.path}".strip(), "value": number, "at": at}
        if horizon is not None:
            block |= {"value": None, "at": None, "horizon": horizon}
        elif place is not None and not math.isnan(number):
            block |= place._asdict()
        return dump(block)
    if horizon is not None:
        return f"{UNKNOWN}\n"
    if math.isnan(number):
        return f"{UNKNOWN if at in study.unknown else OPEN}\n"
    return f"{number!r}\n"


def warning(asked: Measure, study: Study) -> list[str]:
    """Why there is `?` in place of the number."""
    horizon = lost_from(asked, study)
    return [] if horizon is None else [f"{asked.path} is not known: {NOT_CLAIMED.format(horizon)}"]


def _is_number(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False
