"""Whatever a spec, its file or the command line says is shown as it is: no tag, no link, no emphasis comes of it."""

from __future__ import annotations

import re
from pathlib import Path

from markdown_it import MarkdownIt

from heuncli.base.text_safety import escape
from tests.shared.command import TURNED, Heun
from tests.shared.page_reader import OURS, PageReader

HOSTILE = (
    "</title></style><script>alert(1)</script><img src=x onerror=alert(1)> & &lt; \" ' ]]> --> `x` **b** _i_ | "
    "[a](javascript:alert(1)) ![a](http://x.y/z) <a href='javascript:1'> # \\ ``` $x$ ~~s~~ "
    "https://x.y WWW.x.y \u202e\u0627\u0644 \U0001f600"
)
SPEC = TURNED.replace("A bar hangs at rest", '"TITLE"') + (
    "tables: {law: {file: 'FILE', x: a, y: b}}\n"
    "forces: {push: {type: force, on: bar.top, vector: ['table(law, t)', 0, 0]}}\n"
    "analysis: {duration: 0.1, samples: 3}\n"
    'cases: {one: {title: "TITLE", set: {m: 2}}}\n'
    "# </ol></code><script>alert(2)</script> ```` <!-- \n"
)
HEAD = re.compile(r'@top-left \{ content: "(?:[A-Za-z0-9]|\\[0-9a-f]{6})+"; ')
MARKDOWN = {"h1", "h2", "h3", "p", "ul", "li", "strong", "table", "thead", "tbody", "tr", "th", "td", "pre", "code"}
CSV = "a,b\n0,0\n1,1\n"


def written(heun: Heun, folder: Path, form: str) -> str:
    """The report of a spec that is hostile wherever it may be."""
    name = "<b>&'\"`|*_[x](y).csv".replace("'", "")
    (folder / name).write_text(CSV)
    title = HOSTILE.replace("\\", "\\\\").replace('"', '\\"')
    path = folder / "<img src=x onerror=alert(3)> & `*_.yaml"
    path.write_text(SPEC.replace("TITLE", title).replace("FILE", name))
    words = [word for option in ("--date", "--author", "--project") for word in (option, HOSTILE)]
    done = heun("report", path.name, "-o", "-", "--format", form, "--set", "m=2+0*1", *words,
                "--chapters", "loads,model,accuracy,spec")  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_page_shows_and_never_interprets(heun: Heun, folder: Path) -> None:
    page = written(heun, folder, "html")
    read = PageReader(page)
    assert read.tags <= OURS
    assert not read.links
    assert read.by_tag["h1"] == [escape(HOSTILE)]
    assert read.by_tag["title"][0] == escape(HOSTILE)
    assert sum(escape(HOSTILE) in text for text in read.by_tag["dd"]) == 3  # author, date, and the case's title
    assert escape(HOSTILE) in read.by_tag["span"]  # the project
    assert HEAD.search(page) is not None  # at the head of pages: in letters, digits and escapes of CSS
    assert any("onerror=alert(3)" in text for text in read.by_tag["dd"])
    assert any("alert(2)" in text for text in read.by_tag["code"])


def test_markdown_shows_and_never_interprets(heun: Heun, folder: Path) -> None:
    text = written(heun, folder, "md")
    page = MarkdownIt("commonmark", {"html": True}).enable(["table", "strikethrough"]).render(text)
    read = PageReader(page)
    assert read.tags <= {
        "h1",
        "h2",
        "h3",
        "p",
        "ul",
        "li",
        "strong",
        "table",
        "thead",
        "tbody",
        "tr",
        "th",
        "td",
        "pre",
        "code",
    }
    assert not read.links
    # some readers of markdown make links of addresses
    assert not re.search(r"(?i)(?<!\\)://|www\.", text.partition("## 1 ")[0])
    assert read.by_tag["h1"] == [escape(HOSTILE).replace("  ", " ")]
    assert sum(escape(HOSTILE) in text for text in read.by_tag["li"]) >= 3  # author, date, and the case's title
    assert any("alert(2)" in text for text in read.by_tag["code"])
    assert all(row and len(row) == len(read.rows[0]) for row in read.rows[:3])


def test_a_report_asks_for_nothing_from_elsewhere(heun: Heun) -> None:
    page = heun("report", "swinging.yaml", "-o", "-").stdout
    assert "default-src 'none'" in page.replace("&#39;", "'")
    assert "url(" not in page and "@import" not in page
    assert page.replace("http://www.w3.org/2000/svg", "").count("http:") == 0
