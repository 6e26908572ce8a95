"""The browser of a session, begun by the first test that opens a page; without a Chromium these tests are skipped."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

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
