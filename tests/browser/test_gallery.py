"""The checks of pages in a browser find planted faults; faults that are gone from pages and reports stay away."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.gallery.__main__ import draw_page, draw_report
from tests.gallery.checks import find_in_document, keep_canvas_words
from tests.gallery.contents import PAGES, REPORTS, Page, Report
from tests.gallery.mended import MENDED, SLOW
from tests.shared.chromium import Chromium, Tab

HEAD = '<!doctype html><meta charset="utf-8"><style>body{margin:0;font:16px sans-serif}p{position:absolute}</style>'
SOUND = f"{HEAD}<p style='top:10px'>Main bearing</p><p style='top:60px'>24.56 kN</p>"
CANVAS = """<canvas id="view" width="300" height="100"></canvas><script>
const pen = document.querySelector("canvas").getContext("2d");
function draw(...labels) { pen.clearRect(0, 0, 300, 100); for (const [words, x] of labels) pen.fillText(words, x, 50); }
draw(["old", 20]);
</script>"""
TABLE = "<table style='width:{}'>" + "<tr><td>1<td>2" * 9 + "</table>"


def opened(browser: Chromium, folder: Path, text: str) -> Tab:
    """A page of that text, whose canvases keep their words."""
    file = folder / "x.html"
    file.write_text(text)
    tab = browser.tab(width=400, height=300)
    keep_canvas_words(tab)
    tab.go(file.resolve().as_uri())
    return tab


def kinds(tab: Tab) -> list[str]:
    return [finding.kind for finding in find_in_document(tab)]


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        ("", []), ("<p style='top:14px'>Guide</p>", ["overlap"]),
        ("<p style='top:90px'>joints.main.force</p>", ["path"]),
        ("<p style='top:120px;width:700px'>wide</p>", ["outside"]),
        (TABLE.format("35%"), ["narrow"]), (TABLE.format("90%"), []),
    ],
)  # fmt: skip
def test_planted_faults_of_a_page_are_found(more: str, expected: list[str], browser: Chromium, tmp_path: Path) -> None:
    if more.startswith("<table"):
        assert kinds(opened(browser, tmp_path, HEAD + more)) == expected
    else:
        assert kinds(opened(browser, tmp_path, SOUND + more)) == expected


def test_labels_of_a_canvas_are_those_since_it_was_cleared(browser: Chromium, tmp_path: Path) -> None:
    tab = opened(browser, tmp_path, HEAD + CANVAS)
    tab.evaluate("draw(['main 23 kN', 20], ['big 14 kN', 150])")
    assert kinds(tab) == []
    tab.evaluate("draw(['main 23 kN', 20], ['big 14 kN', 40], ['far', 295])")
    assert kinds(tab) == ["overlap", "outside"]


HELD_PAGES = [row for row in PAGES if any("page" in held for held in MENDED.values()) and row.spec not in SLOW]
HELD_REPORTS = [row for row in REPORTS if any("report" in held for held in MENDED.values()) and row.spec not in SLOW]


@pytest.mark.heavy
@pytest.mark.parametrize("row", HELD_PAGES, ids=lambda row: row.name)
@pytest.mark.third
def test_faults_that_were_mended_stay_away_from_pages(row: Page, browser: Chromium, tmp_path: Path) -> None:
    held = {fault for fault, where in MENDED.items() if "page" in where}
    assert [str(f) for f in draw_page(row, tmp_path, browser).findings if f.kind in held] == []


@pytest.mark.heavy
@pytest.mark.parametrize("row", HELD_REPORTS, ids=lambda row: row.name)
@pytest.mark.third
def test_faults_that_were_mended_stay_away_from_reports(row: Report, browser: Chromium, tmp_path: Path) -> None:
    held = {fault for fault, where in MENDED.items() if "report" in where}
    assert [str(f) for f in draw_report(row, tmp_path, browser).findings if f.kind in held] == []
