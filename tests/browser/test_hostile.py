"""What a spec or a file is called is shown as it is written: nothing of it is ever run or read as marks."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from heuncli.app.cli.entry import enter
from tests.shared.chromium import Chromium, Tab
from tests.shared.command import TURNED

Pages = Callable[..., Path]
ATTACKS = [
    "<script>window.pwned=1</script>",
    "</script><script>window.pwned=2</script>",
    "</title></style><img src=x onerror=window.pwned=3>",
    "\"><svg onload='window.pwned=4'>",
    "{{data}} {{script}} ${window.pwned=5} &lt;b&gt; &amp;",
    "<!--<script>",
    "]]></svg><script>window.pwned=6</script>",
    "ünïcode 🜁 \u202eright to left\u202c עברית 'single' \"double\" `tick` \\ back",
]
INTRUDED = """(() => {
  document.body.append(Object.assign(document.createElement("script"), {textContent: "window.pwned = 7"}));
  document.body.insertAdjacentHTML("beforeend", "<img src='data:,x' onerror='window.pwned = 8'>");
  document.body.insertAdjacentHTML("beforeend", "<button onclick='window.pwned = 9'>x</button>");
  document.body.lastChild.click();
  try { eval("window.pwned = 10") } catch { }
})()"""


def spec_with(folder: Path, title: str, stem: str = "spec") -> Path:
    """A small moving spec of a title and a file's name."""
    path = folder / f"{stem}.yaml"
    text = (
        TURNED.replace("A bar hangs at rest", json.dumps(title, ensure_ascii=False))
        + "analysis: {duration: 1, samples: 11}\n"
    )
    path.write_text(text, encoding="utf-8")
    return path


def untouched(tab: Tab) -> bool:
    """Whether nothing was run or made of what was written."""
    marks = "document.querySelectorAll('img, svg, iframe, object, embed, b').length"
    return tab.evaluate(f"window.pwned === undefined && {marks} === 0") is True


@pytest.mark.parametrize("title", ATTACKS)
def test_a_title_is_text(title: str, browser: Chromium, page: Pages, tmp_path: Path) -> None:
    with browser.open(page(spec_with(tmp_path, title))) as tab:
        assert tab.faults == []
        assert untouched(tab)
        shown = title.replace("\u202e", "\\u202e").replace("\u202c", "\\u202c")  # what turns the reading is written out
        assert tab.evaluate("document.querySelector('#title').textContent") == shown
        assert tab.evaluate("document.title") == " ".join(shown.split())


@pytest.mark.parametrize("stem", ['"><img src=x onerror=window.pwned=1>', "<script>window.pwned=2<", "a'b`${1}&amp;\n"])
def test_the_name_of_a_file_is_text(stem: str, browser: Chromium, page: Pages, tmp_path: Path) -> None:
    with browser.open(page(spec_with(tmp_path, "a title", stem))) as tab:
        assert tab.faults == []
        assert untouched(tab)
        tab.evaluate("document.querySelector('#about').open = true")
        assert stem.strip() in tab.evaluate("document.body.innerText")


def test_what_gets_into_a_page_all_the_same_is_not_run(browser: Chromium, page: Pages, tmp_path: Path) -> None:
    """By the page's own policy: no script, no handler, no eval but what it came with."""
    with browser.open(page(spec_with(tmp_path, "a title"))) as tab:
        tab.evaluate(INTRUDED)
        tab.drawn()
        assert tab.evaluate("window.pwned") is None
        assert any("Content Security Policy" in fault for fault in tab.faults)


@pytest.mark.parametrize("title", ATTACKS)
def test_a_title_is_text_in_a_report(title: str, browser: Chromium, tmp_path: Path) -> None:
    spec, target = spec_with(tmp_path, title, '"><img src=x onerror=window.pwned=1>'), tmp_path / "report.html"
    words = ("--author", title, "--project", title, "--date", title)
    assert enter(("report", str(spec), "-o", str(target), "-q", *words)) == 0
    with browser.open(target) as tab:
        assert tab.faults == []
        assert tab.evaluate("window.pwned === undefined && !document.querySelector('script, img, iframe, b')")
        assert tab.evaluate("document.body.innerText").count("onerror=window.pwned=1") >= 1


@pytest.mark.parametrize("title", ATTACKS)
def test_a_picture_of_a_run_is_text_too(title: str, browser: Chromium, tmp_path: Path) -> None:
    spec, target = spec_with(tmp_path, title), tmp_path / "picture.svg"
    assert enter(("plot", str(spec), "joints.pivot.force", "-o", str(target))) == 0
    with browser.open(target) as tab:
        assert tab.faults == []
        assert tab.evaluate("window.pwned") is None
        assert tab.evaluate("document.querySelectorAll('script, image, foreignObject, a').length") == 0
        assert tab.evaluate("[...document.querySelectorAll('text')].map(e => e.textContent).join(' ')").strip()
