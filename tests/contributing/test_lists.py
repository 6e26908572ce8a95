"""The page on contributing: each of its lists has a test that adds what it is about, and names what exists."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.contributing.addition import cited
from tests.shared.folders import ROOT
from tests.shared.manual import headings

LISTS = headings("contributing")[1:]


@pytest.mark.parametrize("heading", LISTS)
def test_what_a_list_names_exists(heading: str) -> None:
    for name in cited(heading):
        assert (ROOT / name).exists(), name


def test_each_list_has_a_test_and_names_it() -> None:
    tests = {path.name for path in Path(__file__).parent.glob("test_*.py")} - {Path(__file__).name}
    named = [name.rpartition("/")[2] for heading in LISTS for name in cited(heading) if "contributing/test" in name]
    assert len(named) == len(LISTS)
    assert set(named) == tests
