"""Numbers as a row of letters."""

from __future__ import annotations

import numpy as np

from heuncli.output.tables.sparkline import BLOCKS, PLAIN, histogram, letters, sparkline


def test_each_number_has_its_height() -> None:
    assert sparkline(list(range(8)), 40, (0.0, 7.0)) == BLOCKS
    assert sparkline([0.0, 7.0, 3.5], 40, (0.0, 7.0)) == "▁█▅"
    assert sparkline([-3.0, -1.0], 40, (-3.0, 5.0)) == "▁▃"  # on the scale of others


def test_what_is_not_known_is_a_point_and_what_does_not_vary_is_low() -> None:
    assert sparkline([1.0, np.nan, 2.0], 40, (1.0, 2.0)) == "▁·█"
    assert sparkline([2.0, 2.0, np.nan], 40, (2.0, 2.0)) == "▁▁·"
    assert sparkline([np.nan], 40, (0.0, 0.0), PLAIN) == " "


def test_of_neighbours_the_greatest_stands() -> None:
    values = np.zeros(1000)
    values[[0, 517]] = -5.0, 1.0
    line = sparkline(values, 40, (-5.0, 1.0))
    assert len(line) == 40 and line[517 * 40 // 1000] == "█" and line.count("█") == 1
    values[25:50] = np.nan
    assert sparkline(values, 40, (-5.0, 1.0))[1] == "·"


def test_a_histogram_counts() -> None:
    values = np.array([0.0, 0.1, 0.1, 0.1, 0.9, np.nan])
    assert histogram(values, (0.0, 1.0), 4) == "█  ▃"
    assert histogram(np.array([2.0, 2.0]), (2.0, 2.0), 8) == "█"
    assert histogram(np.array([np.nan]), (0.0, 0.0), 8) == ""


def test_a_terminal_gets_letters_that_it_has() -> None:
    assert letters(None) == letters("utf-8") == letters("UTF-8") == BLOCKS
    assert letters("ascii") == letters("latin-1") == letters("no such encoding") == PLAIN
    assert sparkline([0.0, 1.0], 9, (0.0, 1.0), PLAIN) == "_#"
