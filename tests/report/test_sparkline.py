"""Numbers as a row of letters."""

from __future__ import annotations

import numpy as np

from heuncli.output.documents.as_text import (
    ASCII_CHARACTERS,
    BLOCK_CHARACTERS,
    choose_characters,
    draw_histogram,
    draw_sparkline,
)


def test_each_number_has_its_height() -> None:
    assert draw_sparkline(list(range(8)), 40, (0.0, 7.0)) == BLOCK_CHARACTERS
    assert draw_sparkline([0.0, 7.0, 3.5], 40, (0.0, 7.0)) == "▁█▅"
    assert draw_sparkline([-3.0, -1.0], 40, (-3.0, 5.0)) == "▁▃"  # on the scale of others


def test_what_is_not_known_is_a_point_and_what_does_not_vary_is_low() -> None:
    assert draw_sparkline([1.0, np.nan, 2.0], 40, (1.0, 2.0)) == "▁·█"
    assert draw_sparkline([2.0, 2.0, np.nan], 40, (2.0, 2.0)) == "▁▁·"
    assert draw_sparkline([np.nan], 40, (0.0, 0.0), ASCII_CHARACTERS) == " "


def test_of_neighbours_the_greatest_stands() -> None:
    values = np.zeros(1000)
    values[[0, 517]] = -5.0, 1.0
    line = draw_sparkline(values, 40, (-5.0, 1.0))
    assert len(line) == 40 and line[517 * 40 // 1000] == "█" and line.count("█") == 1
    values[25:50] = np.nan
    assert draw_sparkline(values, 40, (-5.0, 1.0))[1] == "·"


def test_a_histogram_counts() -> None:
    values = np.array([0.0, 0.1, 0.1, 0.1, 0.9, np.nan])
    assert draw_histogram(values, (0.0, 1.0), 4) == "█  ▃"
    assert draw_histogram(np.array([2.0, 2.0]), (2.0, 2.0), 8) == "█"
    assert draw_histogram(np.array([np.nan]), (0.0, 0.0), 8) == ""


def test_a_terminal_gets_letters_that_it_has() -> None:
    assert choose_characters(None) == choose_characters("utf-8") == choose_characters("UTF-8") == BLOCK_CHARACTERS
    assert (
        choose_characters("ascii")
        == choose_characters("latin-1")
        == choose_characters("no such encoding")
        == ASCII_CHARACTERS
    )
    assert draw_sparkline([0.0, 1.0], 9, (0.0, 1.0), ASCII_CHARACTERS) == "_#"
