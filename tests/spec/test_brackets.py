"""Brackets and quotes that do not match are told where they stand, not where a parser notices."""

from __future__ import annotations

import pytest

from heuncli.base.errors import Problem, SpecError
from heuncli.scene.file_format.source import parse_source
from tests.shared.folders import SPECS

TEXT = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  bar:
    mass: 1
    center: [0.5, 0, 0]
    points: {a: [0, 0, 0], b: [1, 0, 0]}
joints:
  pivot: {type: pin, from: ground.O, to: bar.a, axis: [0, 0, 1]}
forces:
  push: {type: force, on: bar.b, vector: [0, 0, "10*t"]}
analysis: {duration: 1, samples: 3}
"""


def problems(text: str) -> list[Problem]:
    with pytest.raises(SpecError) as raised:
        parse_source("f", text, "")
    return list(raised.value.problems)


def places(text: str) -> list[tuple[int, int]]:
    found = problems(text)
    assert {p.code for p in found} == {"not-yaml"}
    assert all(p.hint for p in found)
    return [(p.location.line, p.location.column) for p in found if p.location]


UNCLOSED, CROSSED, EXTRA, BEHIND = "is not closed", "is needed to close", "without an opening", "after the closing"


@pytest.mark.parametrize(("old", "new", "line", "column", "words"), [
    ("-9.81]", "-9.81", 2, 10, UNCLOSED),
    ("-9.81]", "-9.81)", 2, 10, UNCLOSED),
    ("-9.81]", "-9.81 # ]", 2, 10, UNCLOSED),
    ("-9.81]", "-9.81}", 2, 22, CROSSED),
    ("-9.81]", "-9.81]]", 2, 23, EXTRA),
    ("-9.81]", "-9.81] m/s^2", 2, 24, BEHIND),
    ("-9.81]", "-9.81]'", 2, 23, BEHIND),
    ("[0, 0, -9.81]", "[0,\n  0,\n  -9.81", 2, 10, UNCLOSED),
    ("[0, 0, -9.81]", "\n  - 0\n  - [0\n  - 1", 4, 5, UNCLOSED),
    ("[0, 0, 0]}}", "[0, 0, 0]}", 3, 9, UNCLOSED),
    ("[0, 0, 0]}}", "[0, 0, 0]", 3, 18, "inside 1 more open bracket, is not closed before line 4"),
    ("[0, 0, 0]}}", "[0, 0, 0", 3, 22, "inside 2 more open brackets, is not closed before line 4"),
    ("[0, 0, 0]}}", "[0, 0, 0]]}", 3, 31, CROSSED),
    ("[0, 0, 0]}}", "[0, 0, 0]}}}", 3, 33, EXTRA),
    ("{points: {O: [0, 0, 0]}}", "{\n points: {\n  O: [0, 0, 0]\n }\n", 3, 9, UNCLOSED),
    ("[0.5, 0, 0]", "[0.5, 0, 0", 7, 13, UNCLOSED),
    ("mass: 1", "[mass: 1", 6, 5, UNCLOSED),
    ("mass: 1", "mass: '1", 6, 11, UNCLOSED),
    ("mass: 1", 'mass: "1', 6, 11, UNCLOSED),
    ("b: [1, 0, 0]}", "b: [1, 0, 0}", 8, 39, CROSSED),
    ("b: [1, 0, 0]}", "b: [1, 0, 0]", 8, 13, UNCLOSED),
    ("axis: [0, 0, 1]}", "axis: [0, 0, 1]  # spin}", 10, 10, UNCLOSED),
    ("axis: [0, 0, 1]}", "axis: [0, 0, 1],", 10, 10, UNCLOSED),
    ('"10*t"', '"10*t', 12, 49, UNCLOSED),
    ('"10*t"', "'10*t", 12, 49, UNCLOSED),
    ("samples: 3}", "samples: 3", 13, 11, UNCLOSED),
    ("samples: 3}", "samples: [3", 13, 34, UNCLOSED),
    ("heun: 1", "heun: 1\ntitle: [draft] of it", 2, 16, BEHIND),
    ("heun: 1", "heun: 1\ntitle: 'Tom's bar'", 2, 13, BEHIND),
    ("heun: 1", "heun: 1\ntitle: 'a ] and {' # [\nx: |\n  { [ '\ny: it's [\nz: [1", 6, 4, UNCLOSED),
])  # fmt: skip
def test_told_where_it_stands(old: str, new: str, line: int, column: int, words: str) -> None:
    text = TEXT.replace(old, new, 1)
    (problem,) = problems(text)
    assert places(text) == [(line, column)]
    assert words in problem.message


def test_the_hint_closes_all() -> None:
    assert problems(TEXT.replace("[0, 0, 0]}}", "[0, 0, 0", 1))[0].hint == "close it with ']}}'"


def test_all_at_once() -> None:
    """And none of what a line with a wrong bracket seems to say."""
    text = TEXT.replace("-9.81]", "-9.81").replace("[0.5, 0, 0]", "{0, 0, 0]").replace("samples: 3}", "samples: 3")
    assert places(text) == [(2, 10), (7, 21), (13, 11)]


@pytest.mark.parametrize("text", [
    "a: [1,\n2]\nb: {c: 1,\nd: 2}\n",  # keys and values of a bracket at the margin
    "{a: 1,\nb: [2],\nc: {d: 'it''s'}}\n",
    "a: {\nb: 1,\nc: 2\n}\n",
    'a: "one\n  b: two"\n',
])  # fmt: skip
def test_what_is_yaml_is_no_mismatch(text: str) -> None:
    """Behind it a true mistake is told in its own place."""
    parse_source("f", text, "")
    if not text.startswith("{"):
        assert places(f"{text}z: [1\n") == [(text.count("\n") + 1, 4)]


@pytest.mark.parametrize("name", ["double", "engine", "crane"])
def test_one_bracket_wrong_anywhere(name: str) -> None:
    """Every bracket of a spec left out, doubled, or of the other kind: if that is no YAML, its own line is told."""
    text = (SPECS / f"{name}.yaml").read_text()
    other = dict(zip("[]{}", "{}[]", strict=True))
    begin = 0
    for number, line in enumerate(text.splitlines(keepends=True), 1):
        code = line.split("#")[0]
        for k in (k for k, c in enumerate(code) if c in other):
            at, c = begin + k, line[k]
            for new in ("", other[c], c + c):
                try:
                    parse_source("f", text[:at] + new + text[at + 1 :], "")
                except SpecError as error:
                    assert [p.location and p.location.line for p in error.problems] == [number]
        begin += len(line)
