"""Text in markdown is text: read back by a parser, nothing of it is markup."""

from __future__ import annotations

import json
import random
import re
from pathlib import Path

from markdown_it import MarkdownIt

from heuncli.output.documents.as_markdown import escape_line, escape_markdown, fence_text
from tests.shared.command import HANGING, Heun

HOSTILE = "![x](http://x.y) <img src=x onerror=alert(1)> [a](javascript:alert(1)) *b* `c` | # & www.x.y ~~d~~"
PIECES = [
    "[",
    "]",
    "(x)",
    "!",
    "*",
    "_",
    "`",
    "<b>",
    "|",
    "#",
    "~~",
    "&amp;",
    "$",
    "\\",
    "- ",
    "1. ",
    "> ",
    "=",
    ":",
    "a",
    " ",
]


def parse(text: str) -> str:
    return str(MarkdownIt("commonmark", {"html": True}).enable(["table", "strikethrough"]).render(text))


def shown(page: str) -> str:
    text = re.sub("<[^>]*>", "", page)
    for code, letter in (("&lt;", "<"), ("&gt;", ">"), ("&quot;", '"'), ("&amp;", "&")):
        text = text.replace(code, letter)
    return text


def test_random_text_is_shown_as_it_is() -> None:
    draw = random.Random(7)
    for _ in range(150):
        text = "".join(draw.choices(PIECES, k=draw.randint(1, 9)))
        page = parse(escape_line(text))
        assert set(re.findall("</?[a-z0-9]+", page)) <= {"<p", "</p"}, (text, page)
        assert shown(page).strip() == text.strip()
        (cell,) = re.findall("<td>(.*?)</td>", parse(f"| a |\n| --- |\n| x{escape_markdown(text)} |"))
        assert shown(cell) == f"x{text}".strip()


def test_a_fence_holds_what_it_is_around() -> None:
    page = parse(fence_text("```\n# x\n````"))
    assert page == '<pre><code class="language-text">```\n# x\n````\n</code></pre>\n'


def test_no_command_writes_markup_of_a_spec(heun: Heun, folder: Path) -> None:
    spec = f"title: {json.dumps(HOSTILE)}\n" + re.sub("title:.*\n", "", HANGING)
    (folder / "<b>`*x*.yaml").write_text(spec + "expect: [{of: joints.pivot.force.z, is: 1}]\n")
    (folder / "other.yaml").write_text(spec.replace("m: 1.0", "m: 2.0"))
    commands = (
        ("run", "other.yaml"), ("run", "other.yaml", "--all"), ("check", "<b>`*x*.yaml"),
        ("diff", "other.yaml", "<b>`*x*.yaml"),
    )  # fmt: skip
    for words in commands:
        page = parse(heun(*words, "--format", "markdown").stdout)
        tags = set(re.findall("<([a-z0-9]+)", page))
        assert tags <= {"h2", "h3", "p", "ul", "li", "table", "thead", "tbody", "tr", "th", "td", "strong"}, (
            words,
            tags,
        )
        assert "".join(re.findall("<strong>(.*?)</strong>", page)).count("<") == 0
