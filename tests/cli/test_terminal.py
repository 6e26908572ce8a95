"""Tables fitted to the width of a terminal."""

from __future__ import annotations

import subprocess
import sys

import pytest

from heuncli.app.cli.documents import make_terminal_style
from heuncli.app.cli.terminal import MIN_WIDTH
from heuncli.output.documents.as_text import render_text
from heuncli.output.documents.document import OutputColumn, OutputDocument, OutputTable
from tests.shared.command import Heun
from tests.shared.shell import ENVIRONMENT

WIDE = OutputDocument(
    parts=[
        OutputTable(
            "JOINTS",
            (OutputColumn("joint", "text"), *(OutputColumn(f"F{i} [N]") for i in range(12))),
            tuple((name, *(f"{i}.5" for i in range(12))) for name in ("pivot", "elbow")),
            ("a note",),
        )
    ]
)


def test_no_color_is_honoured(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    assert "\x1b[1mJOINTS" in render_text(WIDE, make_terminal_style())
    monkeypatch.setenv("NO_COLOR", "1")
    plainly = render_text(WIDE, make_terminal_style())
    assert "\x1b[3" not in plainly
    assert "pivot" in plainly


@pytest.mark.parametrize("setting", [{"NO_COLOR": "1"}, {"TERM": "dumb"}, {"TERM": ""}])
def test_no_escape_code_where_none_is_wanted(setting: dict[str, str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TERM", "xterm")
    for name, value in setting.items():
        monkeypatch.setenv(name, value)
    assert "\x1b" not in render_text(WIDE, make_terminal_style())


# Not in this process, whose own tests are told in lines of that width.
OF_ANY_WIDTH = """\
import os
from heuncli.app.cli.documents import make_terminal_style
from heuncli.app.cli.terminal import find_width
from heuncli.output.documents.as_text import render_text
from heuncli.output.documents.document import OutputColumn, OutputDocument, OutputTable
columns = (OutputColumn("joint", "text"), OutputColumn("F [N]"))
wide = OutputDocument(parts=[OutputTable("JOINTS", columns, (("pivot", "1.5"),))])
for columns in ("0", "1", "-5", "x", "9" * 30):
    os.environ["COLUMNS"] = columns
    print("pivot" in render_text(wide, make_terminal_style()), find_width())
"""


def test_whatever_the_width_is_said_to_be() -> None:
    line = [sys.executable, "-c", OF_ANY_WIDTH]
    done = subprocess.run(line, capture_output=True, text=True, check=True, stdin=subprocess.DEVNULL, env=ENVIRONMENT)
    found = [line.split() for line in done.stdout.splitlines()]
    assert len(found) == 5
    assert all(shown == "True" and int(columns) >= MIN_WIDTH for shown, columns in found)


def test_a_usage_error_stays_off_standard_output(heun: Heun, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where standard error is closed typer wrote it to the other."""
    monkeypatch.setattr(sys, "stderr", None)
    assert heun("run", "hanging.yaml", "--nosuch")[:2] == (2, "")
