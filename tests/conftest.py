"""What holds for all tests: which kernel is under test, and what the plain one is spared."""

from __future__ import annotations

from pathlib import Path

import pytest

from heuncli.kernel.choose import COMPILED_MODULES, FOLDER, KERNEL


def pytest_configure() -> None:
    """A compiled kernel older than its source would test yesterday's code."""
    if KERNEL == "pure":
        return
    for name in COMPILED_MODULES:
        sources = [p for p in (FOLDER / f"{name}.py", FOLDER / f"{name}.pxd") if p.exists()]
        built = max(p.stat().st_mtime for p in FOLDER.glob(f"{name}.*") if p not in sources)
        if any(p.stat().st_mtime > built for p in sources):
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
