"""Reports on paper, as Chromium lays them out: first page filled, no narrow tables, no figure split, no overflow."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import NamedTuple

import pytest

from heuncli.app.cli.entry import enter
from tests.gallery.contents import REPORTS, find_spec
from tests.shared.chromium import Chromium, Tab

SHEETS = {"suspension": 5, "press": 5, "gearbox": 6, "v_engine": 6, "crane_ropes": 3, "axle_loads": 3}  # at most
SLOW = ("suspension", "gearbox", "crane_ropes", "v_engine")
PAGE = re.compile(rb"/Type\s*/Page\b")
PRINTED = (210 - 32, 297 - 34)  # A4 without its margins [mm]
PIXEL = 96 / 25.4  # pixels a millimetre
LEAST_FILLED = 0.75  # of the first page
LEAST_WIDTH, LONG = 0.5, 8  # of a table with more rows
BOXES = """(() => {
  const box = e => (b => [b.left, b.top + scrollY, b.right, b.bottom + scrollY])(e.getBoundingClientRect());
  const width = document.querySelector("main").getBoundingClientRect().width;
  return {width, lead: box(document.querySelector("header"))[3],
    tables: [...document.querySelectorAll("table")].map(t => [
      (t.closest(".columns") ?? t).getBoundingClientRect().width / width, t.rows.length]),
    overflow: [...document.querySelectorAll("table")].filter(t => t.getBoundingClientRect().width > width + 1).length,
    heights: [...document.querySelectorAll("figure")].map(f => f.getBoundingClientRect().height)};
})()"""


class Report(NamedTuple):
    """A report of the gallery: its name and its file."""

    name: str
    path: Path


@pytest.fixture(
    scope="module",
    params=[pytest.param(row, marks=[pytest.mark.heavy] * (row.spec in SLOW), id=row.spec) for row in REPORTS],
)
def report(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Report:
    """One of the six reports of the gallery."""
    row = request.param
    target = tmp_path_factory.mktemp("report") / f"{row.spec}.html"
    assert enter(("report", str(find_spec(row.spec)), *shlex.split(row.words), "-o", str(target), "-q")) in (0, 1)
    return Report(row.spec, target)


def print_on_paper(tab: Tab) -> None:
    """Lay a page out as wide as the printed part of a sheet."""
    tab.send("Emulation.setEmulatedMedia", media="print")
    tab.sized(round(PRINTED[0] * PIXEL), round(PRINTED[1] * PIXEL))


@pytest.mark.third
def test_sheets_and_boxes(browser: Chromium, report: Report) -> None:
    with browser.open(report.path) as tab:
        assert tab.faults == []
        assert len(PAGE.findall(tab.pdf())) <= SHEETS[report.name]
        print_on_paper(tab)
        seen = tab.evaluate(BOXES)
        height = PRINTED[1] * PIXEL
        assert max(seen["heights"]) < height  # none needs more than a sheet; break-inside keeps it whole
        assert seen["overflow"] == 0
        assert [row for row in seen["tables"] if row[0] < LEAST_WIDTH - 0.03 and row[1] > LONG + 1] == []


@pytest.mark.third
def test_the_first_page_is_filled(browser: Chromium, report: Report) -> None:
    """What follows the first page's own parts begins on it, unless these fill three quarters of it."""
    with browser.open(report.path) as tab:
        print_on_paper(tab)
        height = PRINTED[1] * PIXEL
        blocks = tab.evaluate(
            """[...document.querySelectorAll("header > *, section > h2, section > div, section > p, figure")]
               .map(e => (b => [b.top + scrollY, b.bottom + scrollY])(e.getBoundingClientRect()))"""
        )
        on_first = [bottom for _, bottom in blocks if bottom <= height]
        assert max(on_first) > LEAST_FILLED * height


def test_it_is_printed_by_the_command(browser: Chromium, tmp_path: Path) -> None:
    """`-o x.pdf` finds the Chromium of this machine: Letter, with title and revision on later pages."""
    target = tmp_path / "report.pdf"
    spec = str(find_spec("press"))
    words = ("--units", "kN,mm", "--paper", "letter", "--revision", "B", "--decimal-comma")
    assert enter(("report", spec, "-o", str(target), "-q", *words)) == 0
    written = target.read_bytes()
    assert written.startswith(b"%PDF") and 3 <= len(PAGE.findall(written)) <= 6
    assert re.search(rb"/MediaBox\s*\[0 0 612 792\]", written)
