"""Tables in parts that fit a page."""

from __future__ import annotations

import pytest

from heuncli.base.spelling import wrap_text
from heuncli.output.documents.as_text import format_plain, split_to_width
from heuncli.output.documents.document import OutputColumn, OutputTable

WIDE = OutputTable(
    "JOINTS",
    (OutputColumn("joint", "text"), *(OutputColumn(f"F{i} [N]") for i in range(12))),
    tuple((name, *(f"{i}.5" for i in range(12))) for name in ("pivot", "elbow")),
    ("a note",),
)


VECTORS = OutputTable(
    "MASS EFFECT  what it is",
    (OutputColumn("", "text"), OutputColumn("", "text", is_shown_once=True),
     *(OutputColumn(name, vector=name[0]) for name in ("Fx", "Fy", "Fz", "Mx", "My"))),
    (("total", "a long note on it", "11111", "22222", "33333", "44444", "55555"),),
)  # fmt: skip


@pytest.mark.parametrize("width", [30, 60, 80, 500])
def test_every_part_fits_and_no_cell_is_lost(width: int) -> None:
    parts = split_to_width(WIDE, width)
    assert all(len(line) <= width for part in parts for line in format_plain(part, width).splitlines())
    assert [column.head for part in parts for column in part.columns[1:]] == [c.head for c in WIDE.columns[1:]]
    assert all(row[0] in ("pivot", "elbow") for part in parts for row in part.rows)
    assert [part.heading for part in parts] == ["JOINTS"] + ["JOINTS  continued"] * (len(parts) - 1)
    assert [part.notes for part in parts] == [()] * (len(parts) - 1) + [("a note",)]


def test_what_fits_is_left_alone_to_the_last_column() -> None:
    width = max(map(len, format_plain(WIDE).splitlines()))
    assert split_to_width(WIDE, width) == [WIDE]
    assert len(split_to_width(WIDE, width - 1)) == 2


def test_a_vector_is_not_parted_and_a_note_not_repeated() -> None:
    first, second = split_to_width(VECTORS, 56)
    assert [column.head for column in first.columns] == ["", "", "Fx", "Fy", "Fz"]
    assert [column.head for column in second.columns] == ["", "Mx", "My"]
    assert second.heading == "MASS EFFECT  continued"
    assert second.rows == (("total", "44444", "55555"),)


def test_a_vector_wider_than_a_page_is_parted_all_the_same() -> None:
    table = OutputTable(
        "", (OutputColumn("", "text"), *(OutputColumn("F" * 9, vector="F") for _ in range(3))), (("a", "1", "2", "3"),)
    )
    assert [len(part.columns) for part in split_to_width(table, 25)] == [3, 2]


def test_a_blow_is_named_again_with_what_goes_on() -> None:
    table = WIDE._replace(heading="IMPULSE at t = 0.1 s (ball)  JOINTS  what they are")
    assert split_to_width(table, 80)[1].heading == "IMPULSE at t = 0.1 s (ball)  JOINTS  continued"


@pytest.mark.parametrize("width", [20, 31, 32, 33, 200])
def test_long_texts_go_on_in_more_lines(width: int) -> None:
    text = "  what this is, in world axes, about O"
    lines = wrap_text(text, width)
    assert all(len(line) <= width for line in lines)
    assert " ".join(" ".join(lines).split()) == text.strip()
    assert all(line.startswith(" " * 6) for line in lines[1:])


def test_one_long_word_is_left_whole() -> None:
    assert wrap_text("a" * 30, 10) == ["a" * 30]
    assert wrap_text("b " + "a" * 30 + " c", 10) == ["b", "    " + "a" * 30, "    c"]
    assert wrap_text("any text at all", None) == ["any text at all"]


def test_a_line_ends_with_a_clause_and_not_within_brackets() -> None:
    text = "FOUNDATION  force and moment ON it, world axes, moment about A = (0, 0, 0) m"
    assert wrap_text(text, 70) == [text[:47], f"    {text[48:]}"]


def test_a_last_column_of_text_goes_on_in_lines_of_its_own() -> None:
    row = ("1", "a.angle 1, b.angle -1, guide.travel -0.5")
    table = OutputTable("MODES", (OutputColumn("mode"), OutputColumn("shape", "text")), (row,))
    (part,) = split_to_width(table, 40)
    assert format_plain(part, 40).splitlines() == [
        "MODES", "mode  shape", "   1  a.angle 1, b.angle -1,", "      guide.travel -0.5",
    ]  # fmt: skip
