"""Pictures in the cells of a terminal: braille or letters, colours or none, their width; curves are told apart."""

from __future__ import annotations

import re

import numpy as np
import pytest

from heuncli.output.drawing.canvas import BRAILLE, TerminalStyle, make_terminal_style
from heuncli.output.drawing.figure import Figure, Panel, Scaling, Spot, Trace
from heuncli.output.drawing.letters import draw_text
from tests.shared.command import Heun

CODE = re.compile(r"\x1b\[[\d;]*m")


def waves(count: int) -> Figure:
    """Some curves in a panel."""
    t = np.linspace(0.0, 1.0, 200)
    names = [(f"wave {k}", k) for k in range(count)]
    traces = tuple(Trace(name, t, np.sin(6.0 * t + k), k) for name, k in names)
    panel = Panel(Scaling("t [s]", 0.0, 1.0), Scaling("force [N]", -1.2, 1.2), traces)
    return Figure("Waves", ["of some runs"], [panel], names)


def has_braille(text: str) -> bool:
    return any(BRAILLE < ord(c) < BRAILLE + 256 for c in text)


@pytest.mark.parametrize("width", [40, 80, 200])
@pytest.mark.parametrize("colours", [False, True])
@pytest.mark.parametrize("braille", [False, True])
def test_no_line_is_wider_than_it_is_asked(width: int, *, colours: bool, braille: bool) -> None:
    lines = CODE.sub("", draw_text(waves(7), TerminalStyle(width, braille, colours))).splitlines()
    assert max(map(len, lines)) <= width and max(map(len, lines)) >= 0.9 * width


@pytest.mark.parametrize("braille", [False, True])
def test_without_colours_every_curve_carries_its_letter(*, braille: bool) -> None:
    text = draw_text(waves(4), TerminalStyle(100, braille, has_colours=False))
    legend, panel = text.split("force [N]")
    assert "\x1b" not in text and has_braille(panel) == braille
    for letter, k in zip("abcd", range(4), strict=True):
        assert f"{letter} wave {k}" in legend and letter in panel.split("t [s]")[0]


def test_one_curve_alone_needs_no_letter() -> None:
    panel = draw_text(waves(1), TerminalStyle(100, True, has_colours=False)).split("force [N]")[1]
    assert not re.search(r"[a-z]", panel.split("t [s]")[0])


def test_colours_are_closed_on_every_line() -> None:
    for line in draw_text(waves(3), TerminalStyle(100, True, has_colours=True)).splitlines():
        codes = CODE.findall(line)
        assert not codes or codes[-1] == "\x1b[0m"


def test_a_curve_passes_where_its_numbers_are() -> None:
    rows, columns = 12, 60
    t = np.array([0.0, 0.5, 1.0])
    panel = Panel(Scaling("", 0.0, 1.0), Scaling("", 0.0, 1.0), (Trace("rise", t, t),))
    lines = draw_text(Figure("", [], [panel]), TerminalStyle(columns + 12, False, has_colours=False)).splitlines()
    field = [line[12:] for line in lines if "|" in line]
    assert len(field) == rows
    for row, line in enumerate(field):
        at = [k for k, c in enumerate(line) if c == "a"]
        middle = (rows - 1 - row) / (rows - 1) * (columns - 1)
        assert at and abs(np.mean(at) - middle) <= 0.6 * columns / rows


def test_points_that_stand_alone_are_seen() -> None:
    y = np.array([np.nan, 0.5, np.nan])
    panel = Panel(Scaling("", 0.0, 1.0), Scaling("", 0.1, 1.0), (Trace("lone", np.array([0.0, 0.5, 1.0]), y),))
    assert has_braille(draw_text(Figure("", [], [panel]), TerminalStyle(60, True, has_colours=False)))


def test_wide_letters_take_two_cells() -> None:
    spot = Spot(0.0, 0.5, "漢字 5 N")
    panel = Panel(Scaling("", 0.0, 1.0), Scaling("", 0.1, 1.0), (spot,))
    (line,) = [
        line
        for line in draw_text(Figure("", [], [panel]), TerminalStyle(60, True, has_colours=False)).splitlines()
        if "漢字" in line
    ]
    assert "漢字 5 N" in line


@pytest.mark.parametrize(
    ("encoding", "braille"), [("utf-8", True), (None, True), ("ascii", False), ("latin-1", False), ("nonsense", False)]
)
def test_braille_needs_an_encoding_that_has_it(encoding: str | None, *, braille: bool) -> None:
    assert make_terminal_style(80, encoding, has_colours=False).has_braille is braille


def test_what_is_read_by_programs_has_no_codes_and_a_fixed_width(heun: Heun) -> None:
    text = heun("plot", "swinging.yaml", "joints.pivot.force", "joints.pivot.force.z").stdout
    assert "\x1b" not in text and has_braille(text) and max(map(len, text.splitlines())) <= 100
    narrow = heun("plot", "swinging.yaml", "joints.pivot.force", "--width", "50").stdout
    assert max(map(len, narrow.splitlines())) <= 50
