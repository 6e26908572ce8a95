"""What importing the numeric part drags in, seen in a fresh process: a linter does not see all of it."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

import heuncli

ROOT = Path(heuncli.__file__).parent
UNWANTED = ("yaml", "pydantic", "rich", "typer", "scipy")
NUMERIC = (
    "base",
    "kernel",
    "results",
    "scene/expressions",
    "scene/shapes",
    "multibody",
    "motion",
    "loads",
    "study",
)


def modules(name: str) -> list[str]:
    """All modules of the package."""
    files = (path for path in sorted((ROOT / name).rglob("*.py")) if path.stem != "__init__")
    return [".".join(("heuncli", *path.relative_to(ROOT).with_suffix("").parts)) for path in files]


def imported(names: list[str]) -> set[str]:
    """Top-level packages in a fresh process after importing these modules."""
    code = f"import {', '.join(names)}, sys; print(*sorted({{m.partition('.')[0] for m in sys.modules}}))"
    path = os.pathsep.join([str(ROOT.parent), os.environ.get("PYTHONPATH", "")])
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env={**os.environ, "PYTHONPATH": path}
    )
    return set(run.stdout.split())


@pytest.mark.parametrize("name", NUMERIC)
@pytest.mark.third
def test_the_numeric_part_stands_alone(name: str) -> None:
    found = modules(name)
    assert found
    assert not imported(found) & set(UNWANTED)


def test_the_kernel_needs_no_numpy() -> None:
    assert "numpy" not in imported(["heuncli.kernel.choose"])


def test_a_leak_would_be_seen() -> None:
    assert "yaml" in imported(["yaml"])


def test_package_inits_load_nothing() -> None:
    """A docstring at most; the one of heuncli itself, where the users' names stand, loads nothing (test_startup.py)."""
    inits = [path for path in ROOT.rglob("__init__.py") if path.parent != ROOT]
    assert len(inits) > 5
    loading = [path for path in inits for node in ast.parse(path.read_text()).body if not isinstance(node, ast.Expr)]
    assert loading == []
