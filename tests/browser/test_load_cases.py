"""Several load cases on one page: another is shown without loading the page anew; the envelope names the worst."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from heuncli.app.cli.entry import enter
from tests.gallery.contents import find_spec
from tests.shared.chromium import Chromium, Tab
from tests.shared.folders import SPECS
from tests.shared.shown_numbers import FRAME, MOST_BYTES, SIZES, SUMMARY, choose, numbers, to_frame

Pages = Callable[..., Path]
GOVERNING = "[...document.querySelectorAll('#governing button')].map(e => e.textContent)"
INSTANT = "document.querySelector('#instant').textContent"
SHOWN = "document.querySelector('#case').selectedOptions[0].textContent"
MOVE_CUT = """(cut => (cut.value = "3", cut.dispatchEvent(new Event("input", {bubbles: true}))))(
  document.querySelector("#cut"))"""
CUT_PLACE = "document.querySelector('#place').textContent"
KEPT = "['path', 'bodies', 'load', 'cut', 'speed'].map(id => document.getElementById(id).value)"


def measured(spec: Path, measure: str, target: Path, *options: str) -> float:
    """The number that heun run prints for a measure."""
    assert enter(("run", str(spec), "--measure", measure, "-q", "-o", str(target), *options)) == 0
    return float(target.read_text().split()[0])


def value_of(text: str) -> float:
    """The number of "greatest 33.04 kN: full load", in SI."""
    found = re.match(r"\w+ (\S+) ?(\S*):", text)
    assert found is not None
    return float(found[1].replace("−", "-")) * SIZES.get(found[2], 1.0)


def test_another_load_case_is_shown_without_loading_the_page(browser: Chromium, page: Pages) -> None:
    path = page(find_spec("v_engine"), "--case", "all")
    assert path.stat().st_size <= MOST_BYTES
    with browser.open(path) as tab:
        tab.evaluate("window.isHere = true")
        first, place = tab.evaluate(SUMMARY), tab.evaluate(INSTANT)
        tab.click("#view-x")
        choose(tab, "path", "main, force")
        choose(tab, "bodies", "wireframe")
        choose(tab, "load", "N")
        tab.evaluate(MOVE_CUT)
        tab.drawn()
        seen, kept = tab.seen("#machine").png, tab.evaluate(KEPT)
        cut_place = tab.evaluate(CUT_PLACE)
        assert kept[3] == "3"
        choose(tab, "case", "overspeed")
        tab.drawn()
        assert tab.evaluate("window.isHere") and tab.evaluate(KEPT) == kept
        assert tab.evaluate(CUT_PLACE) == cut_place
        assert "overspeed" in tab.evaluate("document.title")
        assert tab.evaluate(SUMMARY) != first and tab.seen("#machine").png != seen
        angle = [float(re.search(r"([\d.]+)°", text)[1]) for text in (place, tab.evaluate(INSTANT))]  # type: ignore[index]
        assert angle[1] == pytest.approx(angle[0], abs=1.5)  # the same angle of the crank, which turns faster here
        to_frame(tab, 0)
        tab.press("End")  # the keys of the case before are no longer heard
        tab.press(",")
        last = int(tab.evaluate("document.querySelector('#time').max"))
        assert tab.evaluate(FRAME) == last - 1
        choose(tab, "case", "full load")
        tab.drawn()
        assert tab.evaluate(SUMMARY)[0][:3] == first[0][:3]
        assert tab.faults == []


def test_the_worst_of_all_load_cases_is_named_and_gone_to(browser: Chromium, page: Pages, tmp_path: Path) -> None:
    spec = find_spec("v_engine")
    with browser.open(page(spec, "--case", "all")) as tab:
        for joint, case in (("small1", "full load"), ("bore1", "overspeed")):
            choose(tab, "path", f"{joint}, force")
            measure = f"max joints.{joint}.force"
            wanted = [
                measured(spec, measure, tmp_path / "x.txt", "--case", name) for name in ("full_load", "overspeed")
            ]
            greatest = tab.evaluate(GOVERNING)[0]
            assert greatest.endswith(f": {case}") and value_of(greatest) == pytest.approx(max(wanted), rel=5e-4)
            tab.click("#governing button")
            tab.drawn()
            assert tab.evaluate(SHOWN) == case
            assert numbers(tab)[f"joints.{joint}.force"].value == pytest.approx(max(wanted), rel=1e-6)
        assert tab.faults == []


def test_the_envelope_is_drawn_or_not(browser: Chromium, page: Pages) -> None:
    with browser.open(page(find_spec("v_engine"), "--case", "all")) as tab:
        drawn = tab.seen("#curve")
        tab.click("#band")
        assert tab.seen("#curve").marked < drawn.marked
        assert not tab.evaluate("document.querySelector('#governing').checkVisibility()")
        choose(tab, "case", "overspeed")
        tab.drawn()
        assert not tab.evaluate("document.querySelector('#band').checked")


def test_it_plays_on_in_another_load_case(browser: Chromium, page: Pages) -> None:
    with browser.open(page(find_spec("v_engine"), "--case", "all")) as tab:
        to_frame(tab, 0)
        tab.click("#play")
        tab.until(f"{FRAME} > 3")
        choose(tab, "case", "overspeed")
        before = tab.evaluate(FRAME)
        tab.until(f"{FRAME} > {before + 3}")
        assert tab.evaluate("document.querySelector('#play').textContent") == "Pause"


def controls_of_cases(tab: Tab) -> list[bool]:
    """Whether the controls of load cases are seen: the list, the envelope."""
    return [tab.evaluate(f"document.querySelector('#{each}').checkVisibility()") for each in ("case", "bandlabel")]


def test_what_is_of_load_cases_shows_where_there_are_some(browser: Chromium, page: Pages) -> None:
    cases = [
        (page(SPECS / "engine.yaml"), [False, False]),
        (page(SPECS / "axle_loads.yaml", "--case", "all"), [True, False]),  # of one instant, without curves
        (page(find_spec("v_engine"), "--case", "all"), [True, True]),
    ]
    for path, wanted in cases:
        with browser.open(path) as tab:
            assert controls_of_cases(tab) == wanted
            assert tab.faults == []


@pytest.mark.parametrize(
    ("address", "case", "frame"),
    [("case=-1", 0, None), ("case=0.5&frame=1.5", 1, 2), ("case=99&frame=-3", -1, 0)],
)
def test_an_address_names_a_case_and_frame_that_exist(
    address: str, case: int, frame: int | None, browser: Chromium, page: Pages
) -> None:
    tab = browser.tab()
    tab.go(page(find_spec("v_engine"), "--case", "all").resolve().as_uri() + f"#{address}")
    tab.drawn()
    chosen, count = tab.evaluate(
        "[Number(document.querySelector('#case').value), document.querySelector('#case').length]"
    )
    assert chosen == case % count
    assert frame is None or tab.evaluate(FRAME) == frame
    assert tab.evaluate("document.querySelector('#instant').dataset.value") != "undefined"
    assert tab.faults == []
    browser.send("Target.closeTarget", targetId=tab.target)
