"""The packages of which every value has a type: nothing in them is `Any`."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import heuncli

ROOT = Path(heuncli.__file__).parent
TYPED = (
    "multibody/mechanism", "multibody/assembly", "multibody/reduction", "multibody/tree", "loads/kinetostatics",
    "loads/redundancy", "loads/equilibrium", "scene/shapes",
)  # fmt: skip
TABLES = "tables.py"  # whose rows are of the structs of the kernel, of any type


def without_type(text: str) -> list[int]:
    """The lines that say `Any`, imported or through its module."""
    named = (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Name | ast.Attribute | ast.alias))
    return [node.lineno for node in named if "Any" in (getattr(node, key, "") for key in ("id", "attr", "name"))]


@pytest.mark.parametrize("package", TYPED)
def test_every_value_has_a_type(package: str) -> None:
    files = sorted((ROOT / package).rglob("*.py"))
    assert len(files) > 2
    found = {path.name: lines for path in files if (lines := without_type(path.read_text(encoding="utf-8")))}
    assert found.keys() <= {TABLES}


def test_what_has_none_would_be_seen() -> None:
    assert without_type("from typing import Any\nimport typing\nx: Any\ny: typing.Any\n") == [1, 3, 4]
