"""The browser of a session, begun by the first test that opens a page, and the pages; without a Chromium: skipped."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from heuncli.app.cli.entry import enter
from tests.shared.chromium import Chromium, found


@pytest.fixture(scope="session")
def browser() -> Iterator[Chromium]:
    """A headless Chromium, one a process of tests."""
    path = found()
    if path is None:
        pytest.skip("no Chromium on this machine: pages are not opened (Debian: apt-get install chromium)")
    chromium = Chromium(path)
    yield chromium
    chromium.close()


@pytest.fixture(scope="session")
def page(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """The page of heun show of a spec with some options, written once."""
    written: dict[tuple[str, ...], Path] = {}

    def of(spec: Path, *options: str) -> Path:
        key = (str(spec), *options)
        if key not in written:
            written[key] = tmp_path_factory.mktemp("page") / "machine.html"
            assert enter(("show", str(spec), "-o", str(written[key]), "-q", *options)) == 0
        return written[key]

    return of


@pytest.fixture(scope="session")
def results(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., dict[str, Any]]:
    """What heun run tells of a spec, as JSON."""

    def of(spec: Path, *options: str) -> dict[str, Any]:
        target = tmp_path_factory.mktemp("run") / "run.json"
        assert enter(("run", str(spec), "--format", "json", "-o", str(target), "-q", *options)) == 0
        told: dict[str, Any] = json.loads(target.read_text())
        return told

    return of
