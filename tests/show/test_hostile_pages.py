"""Nothing that a spec says is read as a mark of a page: titles, file names, messages are data wherever they stand."""

from __future__ import annotations

import html
import json
from pathlib import Path

import pytest

from heuncli.base.text_safety import escape
from heuncli.output.web_page.moving_page import assemble_page
from heuncli.output.web_page.packing import encode_data
from tests.shared.command import TURNED, Heun
from tests.shared.moving_pages import PageElements, data_of, decoded

TITLES = [
    "</script><script>alert(1)</script>",
    "<img src=x onerror=alert(1)>",
    "</title><!--",
    "<!--<script>",
    "\"quotes\" and 'others' & &lt;marks&gt;",
    "{{script}} {{data}}",
    "\u202eright to left\u202c",
    "\U0001f680 lifts off",
    "two\u2028lines",
    "]]> $& \\u003c \\",
]


@pytest.mark.parametrize("title", TITLES)
def test_a_title_is_shown_and_never_interpreted(title: str) -> None:
    page = assemble_page(title, {"title": escape(title)})
    usual = PageElements(assemble_page("", {}))
    elements = PageElements(page)
    assert [tag for tag, _ in elements.found] == [tag for tag, _ in usual.found]
    assert elements.text("script")[1] == usual.text("script")[1]
    assert elements.text("title") == [escape(title)]
    assert data_of(page) == {"title": escape(title)}


@pytest.mark.parametrize("text", [*TITLES, "\ud800 half a pair"])
def test_data_are_ascii_without_marks(text: str) -> None:
    data = encode_data({text: [text]})
    assert data.isascii() and not set(data) & set("<>&")
    assert decoded(data) == {text: [text]}


def test_nan_is_no_data() -> None:
    with pytest.raises(ValueError, match="JSON"):
        encode_data({"a": float("nan")})


def test_a_spec_cannot_put_anything_into_its_page(heun: Heun, folder: Path) -> None:
    name = "<b>&'x'.yaml"
    title = TITLES[0]
    text = TURNED.replace("A bar hangs at rest", json.dumps(title)) + "analysis: {duration: 1, samples: 11}\n"
    (folder / name).write_text(text)
    done = heun("show", name, "-o", "out.html")
    assert done.returncode == 0, done.stderr
    page = (folder / "out.html").read_text(encoding="utf-8")
    assert title not in page and "<b>" not in page and html.escape(title) in page
    assert [tag for tag, _ in PageElements(page).found].count("script") == 2
    assert data_of(page)["title"] == title and data_of(page)["file"] == name
