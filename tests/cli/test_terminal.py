"""Tables fitted to the width of a terminal."""

from __future__ import annotations

import pytest

from heuncli.cli.terminal import write
from heuncli.report.table import Column, Table

WIDE = Table(
    "JOINTS",
    (Column("joint", "left"), *(Column(f"F{i} [N]") for i in range(12))),
    tuple((name, *(f"{i}.5" for i in range(12))) for name in ("pivot", "elbow")),
    ("a note",),
)


def test_no_color_is_honoured(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    assert "\x1b[1mJOINTS" in write([WIDE])[0]
    monkeypatch.setenv("NO_COLOR", "1")
    plainly = write([WIDE])[0]
    assert "\x1b[3" not in plainly
    assert "pivot" in plainly
