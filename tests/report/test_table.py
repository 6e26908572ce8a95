"""Aligned text and markdown."""

from __future__ import annotations

import pytest

from heuncli.output.tables.text_table import TextColumn, TextTable, format_markdown, format_plain

TABLE = TextTable(
    "HEADING  what it is",
    (TextColumn("", "left"), TextColumn("F [N]"), TextColumn("note", "left")),
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
    table = TextTable("JOINTS", (TextColumn("", "left"),), ("pin  a pin", "  open: Fx"))
    assert format_plain(table).splitlines() == ["JOINTS", "pin  a pin", "  open: Fx"]


def test_no_line_ends_in_blanks() -> None:
    assert all(line == line.rstrip() for line in format_plain(TABLE).splitlines())


def test_markdown_has_as_many_cells_in_every_row() -> None:
    rows = [line for line in format_markdown(TABLE).splitlines() if line.startswith("|")]
    assert {row.replace("\\|", "").count("|") for row in rows} == {4}
    assert "| **pivot  ball** |  |  |" in rows
    assert rows[1] == "| --- | ---: | --- |"


@pytest.mark.parametrize("write", [format_plain, format_markdown])
def test_a_table_may_be_notes_alone(write: object) -> None:
    assert write(TextTable("SUMS", notes=("a + b = 1 N",))).split() == ["###"] * (write is format_markdown) + [
        "SUMS",
        "a",
        "+",
        "b",
        "=",
        "1",
        "N",
    ]  # type: ignore[operator]
