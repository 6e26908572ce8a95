"""Select the rows of a series of cuts that a path means: `M2@0.28`, `M2@end`, `M2.7`, `M2@0.28:before`.

A position is a distance from the series' first point, by default in metres, or one of its ends; it follows the quantity
or its component. A number is the index of a requested cut, from 0. Where a load acts in the plane of a cut there are
two rows for it: then the side must be given, unless both rows have the same value.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base import units as u
from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.path_words import INDEX_WORD, POSITION_WORD
from heuncli.results.results import SIDE_SIGNS, Array, Indices
from heuncli.results.results_schema import parse_index

ACCEPTED = (
    "a position is @0.28 (metres), @280mm, @start or @end; a cut is its number from 0; both accept :before or :beyond"
)


class CutSelector(NamedTuple):
    """The cut that a path selects: by distance s [m], by `start` or `end`, or by its index; and the side if it is
    given.
    """

    s: float | None
    end: str | None
    cut: int | None
    side: str | None


def parse_cut(word: str) -> CutSelector:
    """Parse a word such as `@0.28`, `@end:before`, `7`, `7:before`. Raises Finding if it is no such word."""
    index_match, position_match = INDEX_WORD.match(word), POSITION_WORD.fullmatch(word)
    cut = parse_index(word if index_match is None else index_match["cut"])
    match = index_match if position_match is None else position_match
    side = None if match is None else match["side"]
    if (cut is None and position_match is None) or (side not in SIDE_SIGNS):
        raise cut_error(f"'{word}' is not a position along a series of cuts", ACCEPTED)
    if position_match is None:
        return CutSelector(None, None, cut, side)
    position = position_match["at"].lower()
    if position in ("start", "end"):
        if position_match["unit"]:
            raise cut_error(f"'{word}' is not a position along a series of cuts", ACCEPTED)
        return CutSelector(None, position, None, side)
    return CutSelector(float(position) * _unit_in_metres(word, position_match["unit"]), None, None, side)


def _unit_in_metres(word: str, unit: str) -> float:
    """Return the size of a unit of length [m]. Raises Finding."""
    if not unit:
        return 1.0
    try:
        size, dimension = u.parse_unit(unit)
    except Finding:
        raise cut_error(f"'{word}': '{unit}' is not a unit", ACCEPTED) from None
    if dimension != u.LENGTH:
        raise cut_error(f"'{word}': {unit} is {u.describe(dimension)}, not a length", ACCEPTED)
    return size


def cut_error(message: str, hint: str) -> Finding:
    """Make the error for a word that selects no cut, with a hint what to write."""
    return Finding("unknown-path", message, hint)


def cut_indices(s: Array) -> Indices:
    """Return the index of the requested cut of each row, from 0; s: their distances, twice where a cut has two rows."""
    return np.cumsum(np.diff(s, prepend=s[:1]) != 0.0)


def cut_distances(first: Sequence[float], last: Sequence[float], count: int) -> Array:
    """Return the distances [m] of the cuts of a series, evenly spaced from its first point to its last."""
    return np.linspace(0.0, float(np.linalg.norm(np.subtract(last, first))), count)


def find_cut_rows(word: str, s: Array, sides: Sequence[str | None] | None) -> list[int]:
    """Return the rows that a word selects: one, or the two of a cut if the side is not given.

    s: the distances of the rows
    sides: just before or beyond a load; None where no load acts

    Raises Finding.
    """
    selector, numbers = parse_cut(word), cut_indices(s)
    cut = _find_cut(word, selector, s[np.searchsorted(numbers, np.arange(numbers[-1] + 1))])
    rows = np.flatnonzero(numbers == cut).tolist()
    if selector.side is None or sides is None or sides[rows[0]] is None:
        return rows
    matching = [row for row in rows if sides[row] == selector.side]
    if not matching:
        side = sides[rows[0]]
        message = f"'{word}': the series {'begins' if cut == 0 else 'ends'} there, with the cut just {side} the load"
        raise cut_error(message, f"{word.partition(':')[0]}:{side}, or leave the side out")
    return matching


def _find_cut(word: str, selector: CutSelector, s: Array) -> int:
    """Return the index of the requested cut, at distances s, that is meant."""
    last = len(s) - 1
    if selector.cut is not None:
        if selector.cut > last:
            raise cut_error(
                f"'{word}': the series has {last + 1} cuts, 0 to {last}", f"cuts are counted from 0: {last}"
            )
        return selector.cut
    if selector.end is not None or selector.s is None:
        return 0 if selector.end == "start" else last
    cut = int(np.argmin(np.abs(s - selector.s)))
    if abs(s[cut] - selector.s) <= tolerances.SAME_CUT * s[-1]:
        return cut
    if selector.s > s[-1]:
        raise cut_error(f"'{word}': the run is {s[-1]:.10g} m long", "@end is its last cut")
    above = int(np.searchsorted(s, selector.s))
    near = f"@{s[above - 1]:.10g} and @{s[above]:.10g}"
    message = f"'{word}': no cut was requested there; the nearest are at {near} (no results between them)"
    raise cut_error(message, f"use one of them, or a count other than {len(s)}")


def find_cut_row(word: str, s: Array, sides: Sequence[str | None], values: Array) -> int:
    """Return the row that a word selects, if values (..., rows) has one value there. Raises Finding."""
    rows = find_cut_rows(word, s, sides)
    if len(rows) == 1:
        return rows[0]
    before, beyond = (np.nan_to_num(values[..., row], nan=np.inf) for row in rows)
    scale = float(np.max(np.abs(values), initial=0.0, where=np.isfinite(values)))
    is_known = np.isfinite(before) & np.isfinite(beyond)
    difference = np.abs(before - beyond, where=is_known, out=np.zeros_like(before))
    if (np.isfinite(before) == np.isfinite(beyond)).all() and (difference <= tolerances.WRITTEN * scale).all():
        return rows[0]
    message = f"'{word}': a load acts in the plane of this cut, so the values on its two sides differ"
    raise cut_error(message, f"{word}:before or {word}:beyond")
