"""What is said does not change from run to run: no set, whose order does, is written out."""

from __future__ import annotations

import ast
from collections.abc import Iterator

import pytest

from heuncli.base.spelling import list_words, suggest
from tests.shared.folders import ROOT


def sets_in(tree: ast.Module) -> set[str]:
    """The names of a module that are sets."""
    found = set()
    for node in tree.body:
        if isinstance(node, ast.Assign | ast.AnnAssign):
            is_call = isinstance(node.value, ast.Call) and getattr(node.value.func, "id", "") in ("frozenset", "set")
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            if is_call or isinstance(node.value, ast.Set):
                found |= {target.id for target in targets if isinstance(target, ast.Name)}
    return found


def written_out(tree: ast.Module, sets: set[str]) -> Iterator[int]:
    """The lines on which one of the sets becomes a series: a tuple, a list, arguments, a joined text."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Tuple | ast.List):
            series = node.elts
        elif isinstance(node, ast.Call):
            joins = isinstance(node.func, ast.Attribute) and node.func.attr == "join"
            series = [ast.Starred(arg) for arg in node.args] if joins else node.args
        else:
            continue
        for one in series:
            if isinstance(one, ast.Starred) and getattr(one.value, "id", "") in sets:
                yield node.lineno


@pytest.mark.heavy  # texts, which are those of both kernels
def test_no_set_of_a_module_is_written_out() -> None:
    found = []
    for path in (ROOT / "heuncli").rglob("*.py"):
        tree = ast.parse(path.read_text())
        if sets := sets_in(tree):
            found += [f"{path.name}:{line}" for line in written_out(tree, sets)]
    assert found == []


def test_the_look_finds_what_it_looks_for() -> None:
    tree = ast.parse("A = frozenset({'a'})\nf('b', *A)\nB = ('b', *A)\nC = {*A}\n', '.join(A)\n")
    assert sorted(written_out(tree, sets_in(tree))) == [2, 3, 5]


def test_hints_list_sets_by_the_alphabet() -> None:
    words = {f"{letter}{letter}" for letter in "qwertzuiopas"}
    assert list_words(words) == ", ".join(sorted(words))
    assert suggest("xxxxxxxx", frozenset(words), "words") == f"known words: {', '.join(sorted(words))}"
