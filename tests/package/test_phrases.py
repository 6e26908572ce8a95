"""No output speaks the private dialect of former versions: old_phrases.txt lists what no text for users may say."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from heuncli.app.cli.entry import enter
from tests.shared.folders import ROOT, SPECS

PHRASES = (Path(__file__).parent / "old_phrases.txt").read_text(encoding="utf-8").splitlines()
PATTERN = re.compile("|".join(f"(?:{phrase})" for phrase in PHRASES))
PACKAGE = ROOT / "heuncli"
ANY_VALUE = "5"  # stands for what an f-string inserts
TEXTS = [
    ROOT / "README.md",
    *sorted(SPECS.glob("*.yaml")),
    *(path for ending in ("md", "yaml", "js", "txt") for path in sorted(PACKAGE.rglob(f"*.{ending}"))),
]
SHOWN = ("run", "model")
MODELS = ("double", "flat_four_bar", "planetary", "slider_crank_pins", "table", "struck_door", "hoist_stop")


def iter_sentences(source: str) -> Iterator[tuple[int, str]]:
    """Yield the strings of a module, without docstrings, with their lines; f-strings whole."""
    tree = ast.parse(source)
    skipped = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            skipped.update(map(id, node.values))
            parts = (str(part.value) if isinstance(part, ast.Constant) else ANY_VALUE for part in node.values)
            yield node.lineno, "".join(parts)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in skipped:
            yield node.lineno, node.value


@pytest.mark.heavy  # a text, which is that of both kernels
def test_the_sentences_of_the_package() -> None:
    found = [
        f"{path.relative_to(ROOT)}:{line}: {old[0]}"
        for path in sorted(PACKAGE.rglob("*.py"))
        for line, text in iter_sentences(path.read_text(encoding="utf-8"))
        if (old := PATTERN.search(text))
    ]
    assert not found, "\n".join(found)


@pytest.mark.parametrize("path", TEXTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_the_texts_of_the_package(path: Path) -> None:
    found = [old[0] for old in PATTERN.finditer(path.read_text(encoding="utf-8"))]
    assert not found, found


@pytest.mark.parametrize("name", MODELS)
def test_the_output_for_a_spec(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    for command in SHOWN:
        assert enter([command, str(SPECS / f"{name}.yaml")]) == 0
    shown = capsys.readouterr()
    assert not (found := PATTERN.search(shown.out + shown.err)), found
