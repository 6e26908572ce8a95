"""The page of heun show as a person uses it, from its file: played, dragged, by keys, in the dark, on a phone."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest

from tests.shared.chromium import Chromium
from tests.shared.folders import SPECS
from tests.shared.shown_numbers import FRAME, choose, frames, numbers, to_frame

Pages = Callable[..., Path]
OUTSIDE = """[...document.querySelectorAll("button, input, select, canvas")].filter(e => e.offsetParent).filter(e => {
  const {left, right} = e.getBoundingClientRect();
  return left < 0 || right > innerWidth + 0.5;
}).map(e => e.id)"""
TOO_WIDE = """[...document.querySelectorAll("#numbers td, #numbers th")]
  .filter(e => e.scrollWidth > e.clientWidth && !e.querySelector(".hidden")).map(e => e.textContent)"""
LONGEST = """document.querySelectorAll("#numbers td[data-path], #numbers td.unit").forEach(
  e => { e.textContent = e.className ? "kN\\u00b7mm\\u00b7s" : "\\u22121.234e\\u221212"; })"""
ROLLER = SPECS.parent / "tests/closed_forms/elements/roller.yaml"  # a joint `curve`, whose path is on the ground
KEEP_FRAMES = f"""(window.seen = [],
  new MutationObserver(() => seen.push({FRAME})).observe(document.documentElement, {{attributes: true}}))"""
OPERATED = {"button", "checkbox", "combobox", "slider", "application", "DisclosureTriangle", "region"}


@pytest.fixture
def double(page: Pages) -> Path:
    """Two bars on ball joints."""
    return page(SPECS / "double.yaml")


def test_it_plays_and_halts(browser: Chromium, double: Path) -> None:
    with browser.open(double) as tab:
        to_frame(tab, 0)
        before = numbers(tab)
        tab.click("#play")
        tab.until(f"{FRAME} > 8")
        assert tab.evaluate("document.querySelector('#play').getAttribute('aria-pressed')") == "true"
        tab.click("#play")
        halted = tab.evaluate(FRAME)
        assert numbers(tab) != before
        tab.drawn()
        assert tab.evaluate(FRAME) == halted
        assert tab.evaluate("Number(document.querySelector('#time').value)") == halted
        assert tab.faults == []


def test_it_plays_to_the_end_and_begins_anew_or_stays_there(browser: Chromium, double: Path) -> None:
    with browser.open(double) as tab:
        for repeats in (True, False):
            tab.evaluate(f"document.querySelector('#repeat').checked !== {str(repeats).lower()} && repeat.click()")
            last = len(frames(double)) - 1
            to_frame(tab, last - 5)
            tab.click("#play")
            tab.until(f"{FRAME} < 100" if repeats else f"{FRAME} === {last}")
        assert tab.evaluate("document.querySelector('#play').getAttribute('aria-pressed')") == "false"


def test_the_slider_is_dragged(browser: Chromium, double: Path) -> None:
    with browser.open(double) as tab:
        left, top, width, height = tab.box("#time")
        middle = top + height / 2
        tab.drag((left + 8, middle), (left + 0.3 * width, middle), (left + 0.75 * width, middle))
        assert tab.evaluate(FRAME) == pytest.approx(0.75 * len(frames(double)), abs=6)  # the knob has a width
        shown = float(tab.evaluate("document.querySelector('#instant').dataset.value"))
        assert shown == frames(double)[tab.evaluate(FRAME)]
        assert tab.evaluate("document.querySelector('#numbers').dataset.frame") == str(tab.evaluate(FRAME))


def test_keys_go_through_the_frames(browser: Chromium, double: Path) -> None:
    with browser.open(double) as tab:
        n = len(frames(double))
        for key, frame in (("End", n - 1), (",", n - 2), (",", n - 3), (".", n - 2), ("Home", 0), (",", 0), (".", 1)):
            tab.press(key)
            assert tab.evaluate(FRAME) == frame, key
        tab.press(" ")
        tab.until(f"{FRAME} > 5")
        tab.press(" ")
        halted = tab.evaluate(FRAME)
        tab.evaluate("document.querySelector('#time').focus()")
        tab.press("ArrowRight")
        assert tab.evaluate(FRAME) == halted + 1
        tab.evaluate("document.querySelector('#play').focus()")
        tab.press(" ")  # a button's own key: once, not twice
        assert tab.evaluate("document.querySelector('#play').getAttribute('aria-pressed')") == "true"


def test_every_control_is_reached_by_the_tabulator_and_has_a_name(browser: Chromium, page: Pages) -> None:
    with browser.open(page(SPECS / "jib.yaml")) as tab:
        controls = [control for control in tab.controls() if control.role not in ("RootWebArea", "option")]
        assert {control.role for control in controls} <= OPERATED
        assert len(controls) > 15
        assert [control for control in controls if not control.name.strip()] == []
        named = [control.name for control in controls]
        assert len(set(named)) == len(named)
        reached = set()
        for _ in range(len(controls) + 3):
            tab.press("Tab")
            reached.add(tab.evaluate("document.activeElement.id || document.activeElement.tagName"))
        assert {
            "machine",
            "play",
            "time",
            "speed",
            "section",
            "load",
            "path",
            "more",
            "tab-summary",
            "tab-all",
        } <= reached


def test_the_machine_is_turned_shifted_and_shown_as_at_the_start(browser: Chromium, double: Path) -> None:
    with browser.open(double) as tab:
        left, top, width, height = tab.box("#machine")
        a, b = (left + width / 2, top + height / 2), (left + width / 2 + 60, top + height / 2 + 30)
        pictures = [tab.seen("#machine").png]
        for change in (
            lambda: tab.drag(a, b),
            lambda: tab.drag(a, b, shift=True),
            lambda: tab.scroll("#machine", -240),
            lambda: tab.click("#view-x"),
            lambda: tab.click("#view-y"),
            lambda: tab.click("#closer"),
        ):
            change()
            pictures.append(tab.seen("#machine").png)
        assert len(set(pictures)) == len(pictures)
        tab.evaluate("document.querySelector('#machine').focus()")
        for key in ("ArrowLeft", "+"):
            tab.press(key)
            pictures.append(tab.seen("#machine").png)
        assert len(set(pictures)) == len(pictures)
        tab.press("0")
        tab.evaluate("document.activeElement.blur()")
        assert tab.seen("#machine").png == pictures[0]


def test_the_cursor_of_the_curve_is_tied_to_the_slider(browser: Chromium, double: Path) -> None:
    with browser.open(double) as tab:
        to_frame(tab, 0)
        at_start = tab.seen("#curve").png
        to_frame(tab, 120)
        later = tab.seen("#curve").png
        assert later != at_start
        path = tab.evaluate("document.querySelector('#path').value")
        assert path.startswith("joints.") and path.endswith(".force")
        tab.click("#highest")
        force = [numbers(tab)[path].value]
        for frame in range(0, len(frames(double)), 10):
            to_frame(tab, frame)
            force.append(numbers(tab)[path].value)
        assert max(force) == force[0]
        left, top, width, height = tab.box("#curve")
        tab.drag((left + width / 2, top + height / 2))
        assert 60 < tab.evaluate(FRAME) < 120


@pytest.mark.parametrize("dark", [False, True])
def test_there_is_something_to_be_seen(dark: bool, browser: Chromium, page: Pages) -> None:
    with browser.open(page(SPECS / "jib.yaml"), width=1200, height=900, dark=dark) as tab:
        seen = tab.seen()
        assert (max(seen.ground) < 64) if dark else (min(seen.ground) > 230)
        for drawing in ("#machine", "#curve"):
            seen = tab.seen(drawing)
            left, top, right, bottom = seen.box
            wide, high = seen.size
            assert seen.colours > 20, drawing
            assert right - left > 0.4 * wide and bottom - top > 0.4 * high, drawing
        assert tab.faults == []


@pytest.mark.parametrize("name", ["double", "engine", "crane", "swing"])
def test_no_number_reaches_into_the_next(name: str, browser: Chromium, page: Pages) -> None:
    for width in (360, 1000, 1200):
        with browser.open(page(SPECS / f"{name}.yaml"), width=width, height=900) as tab:
            tab.click("#tab-all")
            for key in ("Home", "End"):
                tab.press(key)
                assert tab.evaluate(TOO_WIDE) == []
            tab.evaluate(LONGEST)
            assert tab.evaluate(TOO_WIDE) == []


def test_a_phone_shows_all_of_it_without_scrolling_sideways(browser: Chromium, page: Pages) -> None:
    for width in (320, 390):
        with browser.open(page(SPECS / "jib.yaml"), width=width, height=844) as tab:
            assert tab.evaluate("document.documentElement.scrollWidth") <= width
            assert tab.evaluate(OUTSIDE) == []
            assert tab.evaluate("document.querySelector('#machine').clientHeight") > 200
            left, top, _, _ = tab.box("#play")
            assert left >= 0
            assert top >= 0


def test_a_load_is_drawn_on_the_bar(browser: Chromium, page: Pages) -> None:
    with browser.open(page(SPECS / "jib.yaml")) as tab:
        choose(tab, "section", "along")
        assert tab.evaluate("document.querySelector('#load').value") == ""  # nothing hides the machine at the start
        pictures = {}
        for load in ("none", "M1", "N"):
            choose(tab, "load", load)
            pictures[load] = tab.seen("#machine")
        assert len({seen.png for seen in pictures.values()}) == 3
        assert pictures["M1"].marked > pictures["none"].marked
        to_frame(tab, 60)
        choose(tab, "load", "M1")
        assert tab.seen("#machine").png != pictures["M1"].png


def test_arrows_are_drawn_or_not_and_grow(browser: Chromium, double: Path) -> None:
    with browser.open(double) as tab:
        tab.click("#highest")
        arrows = tab.seen("#machine")
        tab.evaluate("document.querySelector('#size').focus()")
        tab.press("End")
        assert tab.seen("#machine").png != arrows.png
        choose(tab, "reactions", "none")
        assert tab.seen("#machine").marked < arrows.marked


@pytest.mark.parametrize("spec", [SPECS / "double.yaml", ROLLER], ids=["ball", "curve"])
def test_paths_of_joints_are_drawn(spec: Path, browser: Chromium, page: Pages) -> None:
    with browser.open(page(spec)) as tab:
        without = tab.seen("#machine")
        tab.click("#paths")
        assert tab.seen("#machine").png != without.png
        shown = tab.evaluate(FRAME)
        to_frame(tab, shown - 5 if shown > 5 else shown + 5)
        assert tab.faults == []


def test_one_instant_has_nothing_to_play(browser: Chromium, page: Pages) -> None:
    with browser.open(page(SPECS / "crankshaft.yaml")) as tab:
        assert not tab.evaluate("document.querySelector('#play').checkVisibility()")
        assert not tab.evaluate("document.querySelector('#curve').checkVisibility()")
        tab.press(" ")
        tab.press("End")
        assert tab.seen("#machine").colours > 20
        assert len(numbers(tab)) > 5
        assert tab.faults == []


def test_without_scripts_it_says_so(browser: Chromium, double: Path) -> None:
    tab = browser.tab()
    tab.go(double.resolve().as_uri(), scripts=False)
    assert "needs JavaScript" in tab.evaluate("document.body.innerText")
    browser.send("Target.closeTarget", targetId=tab.target)


def test_where_motion_is_to_be_reduced_stills_follow_each_other(browser: Chromium, double: Path) -> None:
    with browser.open(double) as tab:
        tab.send("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "reduce"}])
        to_frame(tab, 0)
        tab.evaluate(KEEP_FRAMES)
        tab.click("#play")
        tab.until("new Set(seen).size > 2")
        stills = list(dict.fromkeys(tab.evaluate("seen")))
        assert all(later - earlier > 10 for earlier, later in pairwise(stills)), stills
