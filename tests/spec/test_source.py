"""YAML text -> data and places: strict, and every accident told where it is."""

from __future__ import annotations

import hashlib
import io
import re
import sys
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from heuncli.base.errors import SpecError
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.source import SMALLEST_SPEC, SourceFile, parse_plain_scalar, parse_source, read_source


def codes(text: str) -> list[tuple[str, int, int]]:
    """Codes, lines and columns of all that is wrong with a text."""
    try:
        problems = parse_source("f", text, "").problems
    except SpecError as error:
        problems = error.problems
    return [(p.code, p.location.line, p.location.column) for p in problems if p.location]


@pytest.mark.parametrize(("word", "value"), [
    ("1e-3", 1e-3), ("1e3", 1000.0), ("1.", 1.0), (".5", 0.5), ("-1.5E+2", -150.0), ("12", 12), ("012", 12), ("+7", 7),
    ("on", "on"), ("yes", "yes"), ("no", "no"), ("1:30", "1:30"), ("1_000", "1_000"), ("0x1F", 31), ("0o17", 15),
    ("true", True), ("False", False), ("null", None), ("~", None), ("", None), ("NULL", None), ("nan", "nan"),
    ("inf", "inf"), (".inf", float("inf")), ("-.Inf", float("-inf")), ("1.2.3", "1.2.3"), ("2001-01-01", "2001-01-01"),
    ("1e", "1e"), ("e3", "e3"), ("-", "-"), ("٣", "٣"), ("12345678901234567890", 12345678901234567890.0),
])  # fmt: skip
def test_scalars_are_those_of_yaml_1_2(word: str, value: object) -> None:
    found = parse_plain_scalar(word)
    assert found == value
    assert type(found) is type(value)


def test_quotes_make_text() -> None:
    assert parse_source("f", "{a: '1', b: \"true\", c: 1}", "").data == {"a": "1", "b": "true", "c": 1}


def test_everything_has_its_place() -> None:
    source = parse_source("f", "a: 1\nb:\n  c: [10, {d: 20}]\n  'e': x\n", "")
    assert source.data == {"a": 1, "b": {"c": [10, {"d": 20}], "e": "x"}}

    def at(*path: Any, key: bool = False) -> tuple[int, int]:
        place = source.location(path, key)
        return place.line, place.column

    assert at("a") == (1, 4)
    assert at("a", key=True) == (1, 1)
    assert at("b", "c", 0) == (3, 7)
    assert at("b", "c", 1, "d") == (3, 15)
    assert at("b", "c", 1, "d", key=True) == (3, 12)
    assert at("b", "e") == (4, 8)
    assert at("b", "nowhere", "at all") == (3, 3)
    assert source.location(("b", "c", 1, "d")).path == "b.c.1.d"


@pytest.mark.parametrize(("text", "expected"), [
    ("", [("empty", 1, 1)]),
    ("# only a comment\n", [("empty", 1, 1)]),
    ("null", [("empty", 1, 1)]),
    ("a: 1\na: 2\na: 3\n", [("duplicate-key", 2, 1), ("duplicate-key", 3, 1)]),
    ("a: {b: 1, b: {c: 2, c: 3}}\n", [("duplicate-key", 1, 11), ("duplicate-key", 1, 21)]),
    ("a: &x 1\nb: *x\n", [("alias", 1, 4), ("alias", 2, 4)]),
    ("a: &x {b: 1}\n<<: *x\n", [("alias", 1, 4), ("alias", 2, 1), ("alias", 2, 5)]),
    ("a: !!float 1\nb: !mine {}\nc: !<tag:x> []\n", [("tag", 1, 4), ("tag", 2, 4), ("tag", 3, 4)]),
    ("a: &x 1\n{*x : 2}: 3\n", [("alias", 1, 4), ("not-yaml", 2, 1)]),
    ("{a: 1, *x, *x : 2}\n", [("alias", 1, 8), ("alias", 1, 12)]),
    ("a: 1\n---\na: 2\n", [("several-documents", 2, 1)]),
    ("? {a: 1}\n: 2\n", [("not-yaml", 1, 3)]),
    ("a: [1, 2\nb: 3\n", [("not-yaml", 1, 4)]),
    ("\ta: 1\n", [("not-yaml", 1, 1)]),
    ("a: b: c\n", [("not-yaml", 1, 5)]),
    ("a: 1\nb\nc: 2\n", [("not-yaml", 3, 1)]),
    ("a: 'open\n", [("not-yaml", 1, 4)]),
    ("a: @x\n", [("not-yaml", 1, 4)]),
    ("a: \x00\n", [("bad-character", 1, 4)]),
    ("ab: \u2028\n", [("bad-character", 1, 5)]),
    ("ä: 1\nb: \x85\n", [("bad-character", 2, 4)]),
    ("a: \x07\n", [("bad-character", 1, 4)]),
    ("a: \ufeff\n", [("bad-character", 1, 4)]),
    ("a: 1\nb: \ud800\n", [("bad-character", 2, 4)]),
    ("[" * 100_000, [("too-deep", 1, 65)]),
    ("{a: " * 100_000, [("too-deep", 1, 257)]),
    ("a: &x 1\nb: [", [("alias", 1, 4), ("not-yaml", 2, 4)]),
])  # fmt: skip
def test_accidents(text: str, expected: list[tuple[str, int, int]]) -> None:
    assert codes(text) == expected


def test_the_first_of_two_equal_keys_stands() -> None:
    source = parse_source("f", "a: {b: 1}\na: {b: [2, 3]}\n", "")
    assert source.data == {"a": {"b": 1}}
    assert source.location(("a", "b")).line == 1


def test_hints_for_usual_accidents() -> None:
    def hint(text: str) -> str:
        with pytest.raises(SpecError) as caught:
            parse_source("f", text, "")
        return caught.value.problems[-1].hint or ""

    assert "spaces" in hint("a:\n\tb: 1\n")
    assert "quotes" in hint("title: a: b\n")
    assert "close it with ']'" in hint("a: [1, 2\nb: 3\n")
    assert "comma" in hint("a: {b: 1 c: 2}\n") and "comma" in hint("a: [1, , 2]\n")
    assert "quotes" in hint("a: @b\n") and "backslash" in hint('a: "\\*"\n')
    assert "indentation" in hint("a:\n  b: 1\n c: 1\n")
    assert "colon" in hint("a: 1\nb\nc: 2\n")


def test_files(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    path.write_bytes(b"\xef\xbb\xbfa: \xc3\xa4\n")
    source = read_source(str(path), None)
    assert source.data == {"a": "ä"}
    assert source.location(("a",)).line == 1
    assert source.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()


@pytest.mark.parametrize(("content", "code", "line", "column"), [
    (b"a: 1\nb: \xe4\n", "not-utf8", 2, 4),
    ("a: 1\n".encode("utf-16"), "not-utf8", 1, 1),
])  # fmt: skip
def test_other_encodings(tmp_path: Path, content: bytes, code: str, line: int, column: int) -> None:
    path = tmp_path / "a.yaml"
    path.write_bytes(content)
    with pytest.raises(SpecError) as caught:
        read_source(str(path), None)
    (problem,) = caught.value.problems
    assert problem.location is not None
    assert (problem.code, problem.location.line, problem.location.column) == (code, line, column)


def test_what_cannot_be_read(tmp_path: Path) -> None:
    cases = ((tmp_path / "none.yaml", "file not found"), (tmp_path, "folder"), (Path("a\0b"), "cannot be the name"))
    for path, words in cases:
        with pytest.raises(SpecError) as caught:
            read_source(str(path), None)
        (problem,) = caught.value.problems
        assert problem.code == "unreadable"
        assert words in problem.message
        assert caught.value.exit_code == 2


def test_too_much_is_refused_unread() -> None:
    with pytest.raises(SpecError) as caught:
        parse_source("f", "a" * 64_000_001, "")
    assert caught.value.problems[0].code == "too-large"


def test_standard_input(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"a: 1\n")))
    source = read_source("-", None)
    assert (source.file, source.data) == ("<stdin>", {"a": 1})


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_lines_count_the_same_however_they_end(end: str) -> None:
    r"""A \r alone ends a line to YAML: places are those, and what looks for an open bracket comes to the file's end."""
    twice = ("a: 1", "b: {x: 1, x: 2}", "a: 2", "")
    assert codes(end.join(twice)) == [("duplicate-key", 2, 11), ("duplicate-key", 3, 1)]
    assert codes(end.join(("# " + "a" * 30, "a: 1", "b: 1", "  c: 2", "d: 3"))) == [("not-yaml", 4, 4)]
    assert codes(end.join(("a: 1", "b: [1", "d: 3"))) == [("not-yaml", 2, 4)]


@pytest.mark.heavy
@given(st.text(alphabet=st.sampled_from("ab:-[]{}'\"#&*!|>%@`,? \n\r\t0.1é\u2028\x00~<"), max_size=60))
@settings(max_examples=400, deadline=None, derandomize=True)
def test_any_text_is_a_source_or_an_error(text: str) -> None:
    try:
        source = parse_source("f", text, "")
    except SpecError as error:
        problems = error.problems
    else:
        assert isinstance(source, SourceFile)
        problems = source.problems
    lines = re.split("\r\n?|\n", text)
    for problem in problems:
        assert problem.location is not None
        assert 1 <= problem.location.line <= len(lines) + 1
        assert problem.location.column >= 1


def test_the_hint_for_an_empty_file_is_a_scene() -> None:
    with pytest.raises(SpecError) as caught:
        load("x.yaml", text="# nothing yet\n")
    assert SMALLEST_SPEC in (caught.value.problems[0].hint or "")
    assert list(load("x.yaml", text=SMALLEST_SPEC).bodies) == ["ball"]
