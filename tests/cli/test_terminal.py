"""Tables fitted to the width of a terminal."""

from __future__ import annotations

import pytest

from heuncli.cli.terminal import fit, write
from heuncli.report.table import Column, Table, plain

WIDE = Table(
    "JOINTS",
    (Column("joint", "left"), *(Column(f"F{i} [N]") for i in range(12))),
    tuple((name, *(f"{i}.5" for i in range(12))) for name in ("pivot", "elbow")),
    ("a note",),
)


@pytest.mark.parametrize("width", [30, 60, 80, 500])
def test_every_part_fits_and_no_cell_is_lost(width: int) -> None:
    parts = fit(WIDE, width)
    assert all(len(line) <= width for part in parts for line in plain(part).splitlines())
    assert [column.head for part in parts for column in part.columns[1:]] == [c.head for c in WIDE.columns[1:]]
    assert all(row[0] in ("pivot", "elbow") for part in parts for row in part.rows)
    assert [part.heading for part in parts] == ["JOINTS"] + [""] * (len(parts) - 1)
    assert [part.notes for part in parts] == [()] * (len(parts) - 1) + [("a note",)]


def test_what_fits_is_left_alone() -> None:
    assert fit(WIDE, 500) == [WIDE]


def test_no_color_is_honoured(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    assert "\x1b[1mJOINTS" in write([WIDE])[0]
    monkeypatch.setenv("NO_COLOR", "1")
    plainly = write([WIDE])[0]
    assert "\x1b[3" not in plainly
    assert "pivot" in plainly
