"""One document, written as text, Markdown, HTML, JSON and CSV."""

from __future__ import annotations

import json

from heuncli.output.documents.as_data import render_csv, render_json
from heuncli.output.documents.as_html import render_html
from heuncli.output.documents.as_markdown import render_markdown
from heuncli.output.documents.as_text import TextStyle, render_text
from heuncli.output.documents.document import (
    Chapter,
    Facts,
    Listing,
    NumberCell,
    OutputColumn,
    OutputDocument,
    OutputTable,
    Sentence,
    TextCell,
    Verbatim,
    make_number_cells,
)
from heuncli.study.quantities.digits import choose_style

TABLE = OutputTable(
    "BODIES  each with its <mass>",
    (OutputColumn("body", "path"), OutputColumn("mass", unit="kg"), OutputColumn("at", "instant", "s", key="time")),
    [
        "a title",
        ("bar", NumberCell(1.23456789, 1e-3), 0.25),
        (TextCell("rod", is_governing=True), NumberCell(2.5), None),
    ],
    ("a note",),
)
DOCUMENT = OutputDocument("Two bars", [("run", "one instant")], [TABLE, Sentence("done", "good"), Verbatim("heun run")])


def test_as_text_numbers_have_the_digits_that_their_errors_leave() -> None:
    lines = render_text(DOCUMENT).splitlines()
    assert lines[0].split()[2:] == ["Two", "bars"] and lines[1:4] == [
        "run   one instant",
        "",
        "BODIES  each with its <mass>",
    ]
    assert [line.split() for line in lines[4:]] == [
        ["body", "mass", "[kg]", "at", "[s]"], ["a", "title"], ["bar", "1.235", "0.25"], ["rod", "2.5"], ["a", "note"],
        [], ["done"], ["heun", "run"],
    ]  # fmt: skip


def test_as_markdown_and_html_no_text_is_markup() -> None:
    text = render_markdown(DOCUMENT)
    assert text.startswith("## Two bars\n\n- heun: ") and "\n\n### BODIES\n\neach with its \\<mass>\n\n" in text
    assert "| bar | 1.235 | 0.25 |" in text and "| **rod** | 2.5 |  |" in text and "**✓** done" in text
    page = render_html(DOCUMENT)
    assert "<small>each with its &lt;mass&gt;</small>" in page and "<td>1.235</td>" in page
    assert "<strong>rod</strong>" in page and "<pre>heun run</pre>" in page and "<nav" not in page


def test_as_data_numbers_have_all_their_digits() -> None:
    assert json.loads(render_json(DOCUMENT))["bodies"] == [
        {"body": "bar", "mass": 1.23456789, "mass_error": 1e-3, "time": 0.25},
        {"body": "rod", "mass": 2.5, "time": None},
    ]
    assert render_csv(DOCUMENT) == "body,mass,time\nbar,1.23456789,0.25\nrod,2.5,\n"


def test_its_own_data_replace_those_of_the_tables() -> None:
    records = OutputTable("", (OutputColumn("x"),), [(1.5,)])
    own = DOCUMENT._replace(make_block=lambda: {"x": 1}, make_records=lambda: records)
    assert json.loads(render_json(own)) == {"x": 1} and render_csv(own) == "x\n1.5\n"


def test_chapters_are_numbered() -> None:
    inner = Chapter("inner", "Inner", [Sentence("deep")])
    chapters = [
        Chapter("one", "First", [Facts([("a", "b")]), inner]), Chapter("two", "Second", [Listing("All", ["x", "y"])]),
    ]  # fmt: skip
    document = OutputDocument("Report", parts=chapters, level=1)
    assert "## 2 Second\n\n**All**\n\n- x\n- y\n" in render_markdown(document)
    assert "### 1.1 Inner\n\ndeep\n" in render_markdown(document)
    assert '<section id="inner"><h3>1.1&ensp;Inner</h3>' in render_html(document)
    assert "First\n\na  b\n\nInner\n\ndeep\n\nSecond\n\nAll\n  - x\n  - y\n" in render_text(document)


def test_a_terminal_has_codes_around_headings_and_titles_alone() -> None:
    text = render_text(DOCUMENT, TextStyle(80, ("<", "[", ">")))
    assert "<BODIES  each with its <mass>>\n" in text and "\n[a title>\n" in text and text.count(">") == 3


def test_numbers_of_a_family_lose_the_zeros_that_they_share() -> None:
    cells = make_number_cells([1.5, -20.0, 0.0], choose_style(20.0, 0.0))
    assert [cell.text for cell in cells] == ["1.5", "-20.0", "0"] and [cell.value for cell in cells] == [
        1.5,
        -20.0,
        0.0,
    ]
