"""Aligned text and markdown."""

from __future__ import annotations

from heuncli.output.documents.as_markdown import render_table
from heuncli.output.documents.as_text import format_plain
from heuncli.output.documents.document import OutputColumn, OutputTable

TABLE = OutputTable(
    "HEADING  what it is",
    (OutputColumn("", "text"), OutputColumn("F [N]"), OutputColumn("note", "text")),
    ("pivot  ball", ("Fx", "-12.5", "a"), ("Fy", "3", ""), ("|F|", "1.25e-07", ""), ("open", "open", "b")),
    ("a note",),
)


def test_points_stand_under_each_other() -> None:
    lines = format_plain(TABLE).splitlines()
    assert lines == [
        "HEADING  what it is",
        "             F [N]  note",
        "pivot  ball",
        "  Fx    -12.5       a",
        "  Fy      3",
        "  |F|     1.25e-07",
        "  open        open  b",
        "  a note",
    ]


def test_heads_that_are_all_blank_take_no_line() -> None:
    table = OutputTable("JOINTS", (OutputColumn("", "text"),), ("pin  a pin", "  open: Fx"))
    assert format_plain(table).splitlines() == ["JOINTS", "pin  a pin", "  open: Fx"]


def test_no_line_ends_in_blanks() -> None:
    assert all(line == line.rstrip() for line in format_plain(TABLE).splitlines())


def test_markdown_has_as_many_cells_in_every_row() -> None:
    rows = [line for line in render_table(TABLE).splitlines() if line.startswith("|")]
    assert {row.replace("\\|", "").count("|") for row in rows} == {4}
    assert "| **pivot  ball** |  |  |" in rows
    assert rows[1] == "| --- | ---: | --- |"


def test_a_table_may_be_notes_alone() -> None:
    table = OutputTable("SUMS", notes=("a + b = 1 N",))
    assert format_plain(table) == "SUMS\na + b = 1 N\n"
    assert render_table(table) == "### SUMS\n\n- a + b = 1 N"
