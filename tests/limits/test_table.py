"""The table of the manual's page on limits has the rows that are tested, and each of its tests is there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.limits.table import LIMITS
from tests.shared.manual import TEXTS, tables_below

TESTS = Path(__file__).parents[1]


def test_the_table_has_the_rows_that_are_tested() -> None:
    (table,) = tables_below(TEXTS["limits"], "Where methods fail")
    rows = re.findall(r"^\| ([^|]+?) \|", table, re.MULTILINE)
    assert rows == ["method", *LIMITS]


@pytest.mark.parametrize("row", LIMITS)
def test_its_tests_are_there(row: str) -> None:
    for file, names in LIMITS[row].items():
        text = (TESTS / file).read_text()
        for name in names:
            assert re.search(rf"^def test_{name}\(", text, re.MULTILINE), f"{file}: {name}"
    assert any(file.startswith("limits/") for file in LIMITS[row])
