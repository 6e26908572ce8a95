"""On either side of each threshold: the verdict changes there, and with that threshold alone."""

from __future__ import annotations

import ast
import inspect
import re

import pytest

from heuncli.base import tolerances
from tests.honesty.boundaries.part import Row
from tests.honesty.boundaries.table import EXEMPT, PARTS, ROWS, WANTED


def names(rows: tuple[Row, ...]) -> list[str]:
    return [f"{row.name}-{i}" for i, row in enumerate(rows)]


def value(name: str) -> float:
    of_kernel = name.removeprefix("KERNEL.")
    found: float = tolerances.KERNEL[of_kernel] if of_kernel != name else getattr(tolerances, name)
    return found


@pytest.mark.parametrize("row", ROWS, ids=names(ROWS))
def test_the_verdict_changes_at_the_threshold(row: Row) -> None:
    limit = value(row.name)
    seen = [row.seen(factor * limit) for factor in row.factors]
    assert seen == [row.below if factor < 1.0 else row.above for factor in row.factors]


@pytest.mark.parametrize("row", ROWS, ids=names(ROWS))
def test_it_is_this_threshold_that_decides(row: Row, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten times as large, it takes what was three times above it to its other side."""
    limit = value(row.name)
    if row.name.startswith("KERNEL."):
        monkeypatch.setitem(tolerances.KERNEL, row.name.removeprefix("KERNEL."), 10.0 * limit)
    else:
        monkeypatch.setattr(tolerances, row.name, 10.0 * limit)
    assert row.seen(3.0 * limit) == row.below


def test_each_threshold_has_its_row() -> None:
    """A new one needs a row, or a reason why it decides no verdict."""
    known = [name for name in vars(tolerances) if name.isupper() and name != "KERNEL"]
    known += [f"KERNEL.{name}" for name in tolerances.KERNEL]
    with_row = {row.name for row in ROWS}
    assert not with_row & (EXEMPT.keys() | WANTED.keys())
    assert not EXEMPT.keys() & WANTED.keys()
    assert set(known) == with_row | EXEMPT.keys() | WANTED.keys()


def headings() -> dict[str, str]:
    """The heading in tolerances.py, as far as its colon, under which each threshold stands."""
    found, kernel, heading = {}, "", ""
    for line in inspect.getsource(tolerances).splitlines():
        if line.startswith("KERNEL"):
            kernel = heading = "kernel: "
        elif said := re.match(r" *# -- (.*?)(?:: .*)?$", line):
            heading = kernel + said[1]
        elif named := re.match(r'([A-Z0-9_]+) = |    "(\w+)": ', line):
            found[named[1] or f"KERNEL.{named[2]}"] = heading
    return found


def test_a_threshold_stands_in_the_part_of_its_heading() -> None:
    """So that its scene is found at once."""
    wanted = headings()
    assert {heading for part in PARTS for heading in part.headings} == set(wanted.values())
    for part in PARTS:
        names = {row.name for row in part.rows} | part.exempt.keys() | part.wanted.keys()
        assert names == {name for name, heading in wanted.items() if heading in part.headings}


def test_each_threshold_is_named_once() -> None:
    """A second one of the name would stand in for the first wherever that is used, and both rows would hold."""
    statements = ast.parse(inspect.getsource(tolerances)).body
    plain = [target for one in statements if isinstance(one, ast.Assign) for target in one.targets]
    names = [target.id for target in plain if isinstance(target, ast.Name)]
    table = next(one.value for one in statements if isinstance(one, ast.AnnAssign) and isinstance(one.value, ast.Dict))
    keys = [key.value for key in table.keys if isinstance(key, ast.Constant)]
    assert sorted(names) == sorted(set(names))
    assert sorted(keys) == sorted(tolerances.KERNEL)
