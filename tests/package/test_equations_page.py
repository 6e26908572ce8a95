"""The index of equations cannot lie: every function, result, key, command and test that a row names is there."""

from __future__ import annotations

import ast
import re
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import NamedTuple

import pytest

from heuncli.app.cli.registry import find_command
from heuncli.app.commands.lagrange.forms import ALWAYS, KEYS
from heuncli.results.path_words import find_quantity
from tests.shared.cited_texts import PACKAGE, TESTS, equations, scopes, texts, tree
from tests.shared.folders import ROOT

pytestmark = pytest.mark.heavy  # texts alone, which are those of both kernels

NUMBER = re.compile(r"\((1[6-9]|[2-5]\d|6[01])\)")  # of an equation of the paper
IDENTITIES = frozenset({19, *range(22, 29), 41})  # no function computes them alone
JSON_KEYS = {"lagrange": {*ALWAYS, *(key for keys in KEYS.values() for key in keys)}}  # behind commands


class Row(NamedTuple):
    """A row of the index: its numbers, how it is seen, what stands in place of code, functions, tests (path, name)."""

    numbers: tuple[int, ...]
    seen: str
    instead: str
    code: tuple[tuple[Path, str], ...]
    tests: tuple[tuple[Path, str], ...]


def named(cell: str, base: Path) -> tuple[tuple[Path, str], ...]:
    """What is cited as `path: name`."""
    return tuple((base / path, name) for path, name in re.findall(r"`([\w./]+): (\w+)`", cell))


@cache
def index() -> tuple[Row, ...]:
    rows = []
    for equation, _, seen, code, tests in (row for group in equations().values() for row in group):
        numbers = tuple(int(n) for n in NUMBER.findall(equation))
        instead, *_ = code.split(",") if not code.startswith("`") else [""]
        rows.append(Row(numbers, seen, instead, named(code, PACKAGE), named(tests, TESTS)))
    return tuple(rows)


ROWS = pytest.mark.parametrize("row", index(), ids=lambda row: "-".join(map(str, row.numbers)))


@cache
def functions(path: Path) -> frozenset[str]:
    return frozenset(node.name for node in scopes(tree(path)) if isinstance(node, ast.FunctionDef))


def test_every_number_of_the_paper_has_one_row() -> None:
    assert sorted(n for row in index() for n in row.numbers) == list(range(16, 62))


@ROWS
def test_its_functions_are_there(row: Row) -> None:
    """Modules of the package are imported; those of the kernel, which are reached by its door alone, are read."""
    assert (row.instead == "identity") == (set(row.numbers) <= IDENTITIES)
    assert row.code or row.instead
    for path, name in row.code:
        assert path.exists() and name in functions(path), f"{path.relative_to(ROOT)}: {name}"
        if path.parent.name != "kernel":
            import_module(".".join(path.relative_to(ROOT).with_suffix("").parts))


@ROWS
def test_its_tests_are_there(row: Row) -> None:
    assert row.tests and all(name.startswith("test_") for _, name in row.tests)
    for path, name in row.tests:
        assert path.exists() and name in functions(path), f"{path.relative_to(ROOT)}: {name}"


@ROWS
def test_a_user_sees_it(row: Row) -> None:
    """Results have a row in the schema, commands are registered, keys behind them are those of their JSON."""
    words = re.findall(r"`([^`]+)`", row.seen)
    assert words
    command = ""
    for word in words:
        if word.startswith("heun "):
            command = word.removeprefix("heun ")
            assert find_command(command) is not None, word
        elif "." in word:
            command = ""
            assert find_quantity(word.split(".")) is not None, word
        else:
            assert word in JSON_KEYS[command], word


def test_every_number_cited_in_the_code_leads_there() -> None:
    """A function or module that says which equation it is stands in that equation's row."""
    places = {n: {path for path, _ in row.code} for row in index() for n in row.numbers}
    strays = {
        f"{text.place}: ({n})"
        for text in texts() if PACKAGE in text.path.parents
        for n in NUMBER.findall(text.text) if text.path not in places[int(n)]
    }  # fmt: skip
    assert not strays
