"""What a client sees of a moving page first: the machine, its greatest loads; and the pictures and films of it."""

from __future__ import annotations

import base64
from collections.abc import Callable
from pathlib import Path

import pytest

from heuncli.app.cli.entry import enter
from tests.gallery.contents import PAGES, find_spec
from tests.shared.chromium import Chromium
from tests.shared.folders import SPECS
from tests.shared.moving_pages import data_of
from tests.shared.shown_numbers import FRAME, MOST_BYTES, SIZES, SUMMARY, choose, to_frame

Pages = Callable[..., Path]
GIF = """(async () => {
  const bytes = Uint8Array.from(atob("%s"), letter => letter.charCodeAt(0));
  const decoder = new ImageDecoder({data: bytes, type: "image/gif"});
  await decoder.tracks.ready;
  await decoder.completed;
  const {image} = await decoder.decode({frameIndex: decoder.tracks[0].frameCount - 1});
  return [decoder.tracks[0].frameCount, image.displayWidth, image.displayHeight];
})()"""


@pytest.mark.heavy
@pytest.mark.parametrize("spec", sorted({row.spec for row in PAGES} - {"crane_ropes"}))
@pytest.mark.third
def test_the_page_of_a_usual_machine_is_small(spec: str, page: Pages) -> None:
    assert page(find_spec(spec)).stat().st_size <= MOST_BYTES


def test_the_summary_tells_the_greatest_loads(browser: Chromium, page: Pages, tmp_path: Path) -> None:
    with browser.open(page(SPECS / "engine.yaml")) as tab:
        rows = {row[0]: row for row in tab.evaluate(SUMMARY)}
        assert len(rows) <= 12
        for joint in ("wrist", "main"):
            _, greatest, unit, _, _ = rows[f"{joint}, force"]
            wanted = measured(SPECS / "engine.yaml", f"max joints.{joint}.force", tmp_path / "x.txt")
            assert float(greatest) * SIZES.get(unit, 1.0) == pytest.approx(wanted, rel=5e-4)
        tab.evaluate("document.querySelector('#summary button').click()")
        tab.drawn()
        now = {row[0]: row for row in tab.evaluate(SUMMARY)}
        first = next(iter(now.values()))
        assert first[1] == first[4]  # at its instant it is what it is at most


def measured(spec: Path, measure: str, target: Path) -> float:
    """The number that heun run prints for a measure."""
    assert enter(("run", str(spec), "--measure", measure, "-q", "-o", str(target))) == 0
    return float(target.read_text().split()[0])


def test_it_begins_at_the_greatest_load_and_goes_back_there(browser: Chromium, page: Pages) -> None:
    path = page(SPECS / "engine.yaml")
    worst = data_of(path.read_text(encoding="utf-8"))["worst"]
    with browser.open(path) as tab:
        assert tab.evaluate(FRAME) == worst > 0
        to_frame(tab, 0)
        tab.click("#worst")
        assert tab.evaluate(FRAME) == worst


def test_a_phone_shows_machine_play_and_summary_first(browser: Chromium, page: Pages) -> None:
    with browser.open(page(SPECS / "engine.yaml"), width=420, height=900) as tab:
        bottoms = [top + height for _, top, _, height in map(tab.box, ("#machine", "#play", "#summary tbody tr"))]
        assert bottoms == sorted(bottoms) and bottoms[-1] < 900


def test_tabs_choose_the_tables(browser: Chromium, page: Pages) -> None:
    with browser.open(page(SPECS / "jib.yaml")) as tab:
        seen = {}
        for name in ("summary", "joints", "sections", "all"):
            tab.click(f"#tab-{name}")
            tables = "[...document.querySelectorAll('#summary, #numbers tbody')]"
            seen[name] = tab.evaluate(f"{tables}.filter(e => e.checkVisibility()).length")
        assert seen["summary"] == 1 and 0 < seen["joints"] < seen["all"] and 0 < seen["sections"] < seen["all"]


def test_curves_of_one_unit_are_added_and_taken_away(browser: Chromium, page: Pages) -> None:
    with browser.open(page(SPECS / "engine.yaml")) as tab:
        alone = tab.seen("#curve").png
        choose(tab, "more", "bore, force")
        both = tab.seen("#curve").png
        assert both != alone
        tab.evaluate("document.querySelector('#added button').click()")
        assert tab.seen("#curve").png == alone
        choose(tab, "across", "time")
        assert tab.seen("#curve").png != alone  # an angle of the crank is what it begins with


def test_a_picture_and_a_film_are_drawn(browser: Chromium, tmp_path: Path) -> None:
    spec = str(SPECS / "double.yaml")
    for name, words in (("x.png", ()), ("y.png", ("--at", "0.5")), ("x.gif", ())):
        assert enter(("show", spec, "-o", str(tmp_path / name), "-q", *words)) == 0
    drawn = [browser.seen((tmp_path / name).read_bytes()) for name in ("x.png", "y.png")]
    assert [seen.size for seen in drawn] == [[2000, 1400]] * 2 and drawn[0].png != drawn[1].png
    assert min(seen.colours for seen in drawn) > 50
    with browser.open(SPECS.parent / "README.md") as tab:
        frames, width, height = tab.evaluate(GIF % base64.b64encode((tmp_path / "x.gif").read_bytes()).decode())
        assert (width, height) == (800, 560) and frames == 40  # two seconds at 20 a second
