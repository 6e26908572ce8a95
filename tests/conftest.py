"""What holds for all tests: which kernel is under test, and what the plain one is spared."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

from heuncli.kernel import choose
from heuncli.kernel.form import FOLDER, KERNEL, MODULES
from heuncli.nearest import begin_file

# Folders that judge numbers: the plain kernel gives the same bits, a hundred times slower (test_kernels_agree.py).
SPARED = {"closed_forms", "convergence", "honesty", "limits"}
SHARE = 4  # of every other family of cases so many, spread over it: enough to see what only plain Python does otherwise


def sources(name: str) -> set[Path]:
    """The files a kernel module is compiled from: its own, and the declarations it takes from its neighbours."""
    imports = re.compile(r"^from heuncli\.kernel\.(\w+) cimport", re.MULTILINE)
    found, new = {FOLDER / f"{name}.py"}, {FOLDER / f"{name}.pxd"}
    while new:
        found |= new
        neighbours = {near for path in new for near in imports.findall(path.read_text(encoding="utf-8"))}
        new = {FOLDER / f"{near}.pxd" for near in neighbours} - found
    return found


@pytest.fixture(autouse=True)
def suggestions() -> None:
    """Suggestions are limited file by file; a test that reads none is a file of its own."""
    begin_file()


def pytest_configure() -> None:
    """A compiled kernel older than its source would test yesterday's code."""
    if KERNEL == "pure":
        return
    for name in MODULES:
        built = Path(str(sys.modules[f"{choose.__package__}.{name}"].__file__)).stat().st_mtime
        if any(path.stat().st_mtime > built for path in sources(name)):
            raise pytest.UsageError(
                f"heuncli.kernel.{name} is compiled from older text: python -m heuncli.build, or HEUN_KERNEL=pure"
            )


def pytest_report_header() -> str:
    return f"heun: {KERNEL} kernel, {Path(FOLDER).parent}"


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if KERNEL == "compiled":
        return
    families: dict[str, list[pytest.Item]] = {}
    for item in items:
        if not item.get_closest_marker("heavy") and item.path.parent.name not in SPARED:
            families.setdefault(item.nodeid.split("[")[0], []).append(item)
    kept = {item for family in families.values() for item in family[:: max(1, -(-len(family) // SHARE))]}
    config.hook.pytest_deselected(items=[item for item in items if item not in kept])
    items[:] = [item for item in items if item in kept]
