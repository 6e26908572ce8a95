"""What holds for all tests: which kernel is under test, and what the plain one is spared."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from heuncli.kernel import choose
from heuncli.kernel.form import FOLDER, KERNEL, MODULES


def sources(name: str) -> set[Path]:
    """The files a kernel module is compiled from: its own, and the declarations it takes from its neighbours."""
    own = {path for path in (FOLDER / f"{name}.py", FOLDER / f"{name}.pxd") if path.exists()}
    imports = re.compile(r"from (?:cython\.cimports\.)?heuncli\.kernel\.(\w+) ")
    neighbours = {name for path in own for name in imports.findall(path.read_text(encoding="utf-8"))}
    return own | {path for path in (FOLDER / f"{neighbour}.pxd" for neighbour in neighbours) if path.exists()}


def pytest_configure() -> None:
    """A compiled kernel older than its source would test yesterday's code."""
    if KERNEL == "pure":
        return
    for name in MODULES:
        built = Path(getattr(choose, name).__file__).stat().st_mtime
        if any(path.stat().st_mtime > built for path in sources(name)):
            raise pytest.UsageError(
                f"heuncli.kernel.{name} is compiled from older text: python -m heuncli.build, or HEUN_KERNEL=pure"
            )


def pytest_report_header() -> str:
    return f"heun: {KERNEL} kernel, {Path(FOLDER).parent}"


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if KERNEL == "compiled":
        return
    heavy = [item for item in items if item.get_closest_marker("heavy")]
    if heavy:
        config.hook.pytest_deselected(items=heavy)
        items[:] = [item for item in items if not item.get_closest_marker("heavy")]
