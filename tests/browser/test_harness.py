"""What the tests of pages rely on: the browser tells errors, requests, dialogs, keys, the mouse, names, what is seen.

A page of the test's own has each of the faults that the others assert that there are none of.
"""

from __future__ import annotations

import re
from pathlib import Path

from tests.shared.chromium import Chromium, Control

PAGE = """<!doctype html><meta charset="utf-8"><title>A page</title>
<style>body {{ margin: 0; background: #fff }} @media (prefers-color-scheme: dark) {{ body {{ background: #123456 }} }}
#field {{ position: absolute; left: 100px; top: 50px; width: 40px; height: 30px; background: #d55e00 }}
input {{ position: absolute; left: 0; top: 200px; width: 300px }} h2 {{ break-before: page }}</style>
<div id="field"></div>
<label>time <input id="slider" type="range" min="0" max="100" value="0"></label>
<button id="play" aria-label="play">▶</button><button id="dumb"></button>
<h2>Second</h2><h2>Third</h2>
<script>
window.keys = [];
addEventListener("keydown", e => keys.push(e.key));
document.querySelector("#play").addEventListener("click", () => {{ window.clicked = 1 }});
{script}
</script>"""


def written(folder: Path, script: str = "") -> Path:
    """A page with a script."""
    path = folder / "page.html"
    path.write_text(PAGE.format(script=script), encoding="utf-8")
    return path


def test_a_sound_page_has_no_faults(browser: Chromium, tmp_path: Path) -> None:
    with browser.open(written(tmp_path)) as tab:
        assert tab.faults == []


def test_each_fault_is_told(browser: Chromium, tmp_path: Path) -> None:
    for script, told in (
        ('throw new Error("lost")', "thrown: Error: lost"),
        ('console.error("bad", 3)', "console: ['bad', 3]"),
        ('fetch("https://example.invalid/x.js")', "asked for: https://example.invalid/x.js"),
        ('document.body.append(Object.assign(new Image(), {src: "nothing.png"}))', "log: Failed to load resource"),
        ('Promise.reject(new Error("unheard"))', "thrown: Error: unheard"),
    ):
        with browser.open(written(tmp_path, script)) as tab:
            tab.drawn()
            assert any(fault.startswith(told) for fault in tab.faults), (script, tab.faults)


def test_keys_and_the_mouse_reach_the_page(browser: Chromium, tmp_path: Path) -> None:
    with browser.open(written(tmp_path)) as tab:
        tab.click("#play")
        assert tab.evaluate("window.clicked") == 1
        for key in ("a", "ArrowRight", " "):
            tab.press(key)
        assert tab.evaluate("keys") == ["a", "ArrowRight", " "]
        left, top, width, height = tab.box("#slider")
        middle = top + height / 2
        tab.drag((left + 8, middle), (left + width / 4, middle), (left + width / 2, middle))
        assert abs(tab.evaluate("Number(slider.value)") - 50) <= 1


def test_what_is_seen_is_counted(browser: Chromium, tmp_path: Path) -> None:
    with browser.open(written(tmp_path), width=400, height=190) as tab:
        tab.evaluate("document.querySelectorAll('button, h2').forEach(e => e.remove()), slider.remove()")
        tab.evaluate("document.querySelector('label').remove()")
        seen = tab.seen()
        assert (seen.box, seen.marked, seen.colours) == ([100, 50, 140, 80], 40 * 30, 2)
        assert seen.ground == [255, 255, 255]
    with browser.open(written(tmp_path), dark=True) as tab:
        assert tab.seen().ground == [0x12, 0x34, 0x56]


def test_controls_are_told_with_their_names(browser: Chromium, tmp_path: Path) -> None:
    with browser.open(written(tmp_path)) as tab:
        told = [control for control in tab.controls() if control.role != "RootWebArea"]
        assert sorted(told) == [Control("button", ""), Control("button", "play"), Control("slider", "time")]


def test_pages_are_printed(browser: Chromium, tmp_path: Path) -> None:
    with browser.open(written(tmp_path)) as tab:
        assert len(re.findall(rb"/Type\s*/Page\b", tab.pdf())) == 3
