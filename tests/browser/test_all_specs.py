"""Every worked example as a moving page: opened without a fault, its machine seen, its numbers finite."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.shared.chromium import Chromium
from tests.shared.folders import SPECS

NO_NUMBER = re.compile(r"\b(NaN|nan|Infinity|undefined|null|\[object)")


@pytest.mark.parametrize("name", sorted(path.stem for path in SPECS.glob("*.yaml")))
@pytest.mark.sixth
def test_it_opens_and_shows_its_machine(name: str, browser: Chromium, page: Callable[..., Path]) -> None:
    with browser.open(page(SPECS / f"{name}.yaml"), width=800, height=600) as tab:
        for key in ("Home", "End"):
            tab.press(key)
            assert not NO_NUMBER.search(tab.evaluate("document.body.innerText"))
        seen = tab.seen("#machine")
        left, top, right, bottom = seen.box
        assert seen.colours > 8
        assert right - left > 200
        assert bottom - top > 200
        assert tab.faults == []
