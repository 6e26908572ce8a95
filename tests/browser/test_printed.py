"""Reports and pictures in a browser: opened without a fault, printed on A4 in pages, their text selected as text."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from heuncli.app.cli.entry import enter
from tests.shared.chromium import Chromium
from tests.shared.folders import SPECS

PAGE = re.compile(rb"/Type\s*/Page\b")
SHEET = re.compile(rb"/MediaBox\s*\[0 0 ([\d.]+) ([\d.]+)\]")
SELECTED = """(getSelection().selectAllChildren(document.documentElement), getSelection().toString())"""
IN_PRINT = "[...document.querySelectorAll('{}')].map(e => getComputedStyle(e).{})"


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of the crane's jib."""
    target = tmp_path_factory.mktemp("report") / "report.html"
    assert enter(("report", str(SPECS / "jib.yaml"), "-o", str(target), "-q")) == 0
    return target


def test_a_report_is_printed_in_pages(browser: Chromium, report: Path) -> None:
    with browser.open(report) as tab:
        assert tab.faults == []
        printed = tab.pdf()
        assert 2 <= len(PAGE.findall(printed)) <= 6
        for wide, high in SHEET.findall(printed):
            assert (float(wide), float(high)) == pytest.approx((595.3, 841.9), abs=1.0)  # A4, in points
        tab.send("Emulation.setEmulatedMedia", media="print")
        assert set(tab.evaluate(IN_PRINT.format("thead", "display"))) == {"table-header-group"}  # repeated on each page
        assert set(tab.evaluate(IN_PRINT.format("h2", "breakAfter"))) == {"avoid"}
        assert set(tab.evaluate(IN_PRINT.format("figure", "breakInside"))) == {"avoid"}


@pytest.mark.parametrize(("width", "dark"), [(1000, False), (1000, True), (360, False)])
def test_a_report_is_read_on_any_screen(width: int, dark: bool, browser: Chromium, report: Path) -> None:
    with browser.open(report, width=width, height=900, dark=dark) as tab:
        assert tab.evaluate("document.documentElement.scrollWidth") <= width
        seen = tab.seen()
        assert seen.colours > 20
        assert tab.faults == []
        selected = tab.evaluate(SELECTED)
        for words in ("A slewing crane jib", "slew", "root", "SUMMARY", "Accuracy of the results"):
            assert words in selected, words


PICTURES = [
    ("engine", ("joints.main.force", "joints.big.force"), ("Main, force", "Big, force", "t [s]")),
    ("jib", ("sections.along",), ("along", "Bending moment M1", "s [m]")),
    ("engine", ("polar", "joints.main"), ("Main, force", "z 90°", "20 kN")),
    ("crane", ("scene",), ("tower", "jib", "load")),
]


@pytest.mark.parametrize(
    ("spec", "words", "told"), PICTURES, ids=lambda part: part if isinstance(part, str) else "-".join(part)
)
def test_a_picture_is_opened_and_its_text_selected(
    spec: str, words: tuple[str, ...], told: tuple[str, ...], browser: Chromium, tmp_path: Path
) -> None:
    target = tmp_path / "picture.svg"
    assert enter(("plot", str(SPECS / f"{spec}.yaml"), *words, "-o", str(target))) == 0
    with browser.open(target) as tab:
        selected = tab.evaluate(SELECTED)
        assert [words for words in told if words not in selected] == []
        left, top, right, bottom = tab.seen().box
        assert right - left > 400
        assert bottom - top > 150
        assert tab.faults == []
