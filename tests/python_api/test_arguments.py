"""Arguments of the wrong kind: each is refused by its name, with an error of heun's own."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import heuncli
from heuncli.base.errors import HeunError, SpecError, UsageError
from tests.shared.command import HANGING

WRONG: dict[str, list[Any]] = {
    "a string": [3, 2.5, ["a"], b"x", {"a": 1}, True],
    "a string or a list of strings": [3, [1, 2], b"x", {"a": "b"}, ["joints", 2], iter(["joints"])],
    "a number": ["1", [1.0], {"a": 1}, True, np.array([1.0]), 1j],
    "a number or an array of numbers": ["1", {"a": 1}, [[1, 2], [3]], ["x"], [None], True, 1j],
    "True or False": ["yes", 1, 0.0, None, [True]],
    "a mapping": ["a=1", 3, [("a", 1)]],
    "a whole number": [1.5, "3", True],
    "a file name": [3, b"x.json", ["x.json"]],
    "a number or a string": [[1.0], True, {"a": 1}],
}
SOLVING = {
    "text": "a string", "case": "a string", "set": "a mapping", "only": "a string or a list of strings",
    "at": "a number or an array of numbers", "tolerance": "a number", "method": "a string", "step": "a number",
    "least_norm": "True or False", "reduce": "True or False", "by_cause": "True or False", "axes": "a string",
    "time_limit": "a number",
}  # fmt: skip


def refusals(call: Callable[[Any], object], name: str, kind: str) -> None:
    for value in WRONG[kind]:
        with pytest.raises(UsageError) as caught:
            call(value)
        (problem,) = caught.value.problems
        assert (problem.code, problem.message.split(":")[0]) == ("bad-option", name), value
        assert kind in problem.message, value
        assert problem.hint


@pytest.mark.parametrize("name", SOLVING)
def test_of_solving(name: str) -> None:
    given = {} if name == "text" else {"text": HANGING}
    refusals(lambda value: heuncli.solve(**given, **{name: value}), name, SOLVING[name])
    if name not in ("case",):
        refusals(lambda value: heuncli.solve_cases(**given, **{name: value}), name, SOLVING[name])


REPORTING = {
    "output": "a file name", "text": "a string", "format": "a string", "case": "a string or a list of strings",
    "set": "a mapping", "units": "a string", "chapters": "a string or a list of strings", "paper": "a string",
    "landscape": "True or False", "decimal_comma": "True or False", "author": "a string", "logo": "a file name",
    "tolerance": "a number", "least_norm": "True or False", "time_limit": "a number",
}  # fmt: skip


@pytest.mark.parametrize("name", REPORTING)
def test_of_a_report(name: str) -> None:
    given = {"text": HANGING, "output": "x.html"}
    refusals(lambda value: heuncli.report(None, **given | {name: value}), name, REPORTING[name])


def test_all_of_a_call_are_named_at_once() -> None:
    with pytest.raises(UsageError) as caught:
        heuncli.solve(text=HANGING, case=3, tolerance="small", at="now")  # type: ignore[arg-type]
    assert [problem.message.split(":")[0] for problem in caught.value.problems] == ["case", "at", "tolerance"]


@pytest.mark.parametrize("spec", [3, 2.5, ["a.yaml"], b"a.yaml", True, object()])
def test_of_a_spec(spec: Any) -> None:
    for call in (heuncli.solve, heuncli.solve_cases, heuncli.validate):
        with pytest.raises(HeunError, match="spec"):
            call(spec)


def test_of_a_solved_scene() -> None:
    study = heuncli.solve(text=HANGING)
    path = next(iter(study))
    calls: list[tuple[Callable[[Any], object], str, str]] = [
        (study.paths, "under", "a string"),
        (study.measure, "words", "a string"),
        (study.at, "times", "a number or an array of numbers"),
        (study[path].at, "times", "a number or an array of numbers"),
        (lambda value: study.collective(value), "path", "a string"),
        (lambda value: study.collective(path, slopes=value), "slopes", "a number or an array of numbers"),
        (lambda value: study.collective(path, bins=value), "bins", "a whole number"),
        (lambda value: study.collective(path, repeat=value), "repeat", "a whole number"),
        (lambda value: study.collective(path, cycles=value), "cycles", "a number"),
        (lambda value: study.collective(path, closed=value), "closed", "True or False"),
        (lambda value: study.load_cases(value, 0), "body", "a string"),
        (lambda value: study.load_cases("bar", value), "at", "a number or a string"),
        (lambda value: study.tables(units=value), "units", "a string"),
        (lambda value: study.tables(only=value), "only", "a string or a list of strings"),
        (lambda value: study.frame(units=value), "units", "True or False"),
        (lambda value: study.plot(path, over=value), "over", "a string"),
        (lambda value: study.plot(path, units=value), "units", "a string"),
        (lambda value: study.save(value), "file", "a file name"),
        (lambda value: study.plot(path).save(value), "file", "a file name"),
    ]
    for call, name, kind in calls:
        refusals(call, name, kind)
    for value in (3, None, ["a"], b"x"):
        with pytest.raises(HeunError):
            study[value]  # type: ignore[index]
    with pytest.raises(UsageError, match="paths"):
        study.plot(path, 3)  # type: ignore[arg-type]
    with pytest.raises(UsageError, match="paths"):
        study.frame(3)  # type: ignore[arg-type]


def test_solve_cases_suggests_none_of_what_it_lacks() -> None:
    text = HANGING + "cases: {a: {set: {m: 2}}}\n"
    with pytest.raises(SpecError) as raised:
        heuncli.solve_cases(text=text, cas="a")
    assert "option case" not in str(raised.value)
