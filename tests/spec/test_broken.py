"""specs/broken: one file an error code, each found at the place that its first line names."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from heuncli.base.errors import HeunError
from heuncli.scene.file_format.load import load
from heuncli.study.workflow import solve
from tests.shared.broken import FILES, cured, head, is_in_words
from tests.shared.folders import ROOT

WITHOUT_A_FILE = {
    "unreadable": "there is no file",
    "too-large": "64 MB",
    "too-many-jumps": "found when the run is prepared",
    "outside-folder": "a file outside the folder of the spec",
    "missing-extra": "an extra that is not installed",
}


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_each_is_violation_where_it_stands(path: Path) -> None:
    kind, code, line, column, _, name, value = head(path).groups()
    assert path.stem == code
    overrides = {name: value} if name else {}
    if kind == "warning":
        problems = load(path, overrides=overrides).warnings
    else:
        with pytest.raises(HeunError) as caught:
            solve(load(path, overrides=overrides))
        problems = caught.value.problems
    assert code in {p.code for p in problems}
    assert [str(p) for p in problems if not p.hint or not p.location] == []
    assert {p.code for p in problems} <= {code, "not-yet"}
    if line is not None:
        places = [(p.location.line, p.location.column) for p in problems if p.code == code and p.location is not None]
        assert (int(line), int(column)) in places


def codes_in(path: Path) -> set[str]:
    """The error codes that a module of the spec gives."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Call) and node.args:
            name = getattr(node.func, "id", getattr(node.func, "attr", ""))
            if name in ("Finding", "Problem", "problem", "rule", "report"):
                found |= texts(node.args[0])
        elif (
            isinstance(node, ast.Tuple) and len(node.elts) == 2 and is_violation(node.elts[1])
        ):  # a code and a Violation
            found |= texts(node.elts[0])
        elif isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "TYPES":
            found |= {code for row in ast.walk(node.value) if isinstance(row, ast.Tuple) for code in texts(row.elts[0])}
    return found


def texts(node: ast.expr) -> set[str]:
    return {node.value} if isinstance(node, ast.Constant) and isinstance(node.value, str) else set()


def is_violation(node: ast.expr) -> bool:
    return isinstance(node, ast.Call) and getattr(node.func, "id", "") in ("Violation", "wrong_form")


def test_every_code_has_its_file() -> None:
    read = (
        path
        for room in ("file_format", "expressions", "meshes")
        for path in (ROOT / "heuncli" / "scene" / room).rglob("*.py")
    )
    codes = {code for path in read for code in codes_in(path)}
    assert {"unknown-joint-type", "missing-key", "not-yet", "alias", "first-axis"} <= codes
    assert codes - {path.stem for path in FILES} == set(WITHOUT_A_FILE)


def test_every_file_says_what_to_see() -> None:
    assert len(FILES) > 70
    assert all(len(head(path)[5]) > 5 for path in FILES)


@pytest.mark.heavy
@pytest.mark.parametrize("path", [path for path in FILES if not is_in_words(path)], ids=lambda path: path.stem)
@pytest.mark.third
def test_each_is_mended_by_its_cure(path: Path) -> None:
    """Read and solved without an error or a warning."""
    spec = load(str(path), cured(path))
    solve(spec)
    assert spec.warnings == ()


def test_few_cures_are_told_in_words_alone() -> None:
    assert {path.stem for path in FILES if is_in_words(path)} == {
        "empty", "not-a-scene", "not-utf8", "several-documents", "too-deep",
    }  # fmt: skip
