"""The rows of a run of cuts that a place in a path means: `M2@0.28`, `M2@end`, `M2.7`, `M2@0.28:before`.

A place is a distance from the run's first point, by default in metres, or one of its ends; it stands behind the
quantity or its component. A number counts the cuts that were asked for, from 0. Where something acts in the plane of
a cut there are two rows for it: there the side has to be named, unless both rows say the same.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base import units as u
from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Indices
from heuncli.results.results_schema import counted
from heuncli.results.run_places import COUNTED, MARKED

SIDES = ("before", "beyond")
ACCEPTED = "a place is @0.28 (metres), @280mm, @start or @end, a cut its number from 0; either with :before or :beyond"


class CutPlace(NamedTuple):
    """What a path says of a place: distance s [m], `start` or `end`, or the number of the cut; the side if it does."""

    s: float | None
    end: str | None
    cut: int | None
    side: str | None


def place_of(word: str) -> CutPlace:
    """What a word says: `@0.28`, `@end:before`, `7`, `7:before`. Raises Finding where it is no such word."""
    numbered, found = COUNTED.match(word), MARKED.fullmatch(word)
    cut = counted(word if numbered is None else numbered["cut"])
    named = numbered if found is None else found
    side = None if named is None else named["side"]
    if (cut is None and found is None) or (side is not None and side not in SIDES):
        raise no_place(f"'{word}' is no place along a run of cuts", ACCEPTED)
    if found is None:
        return CutPlace(None, None, cut, side)
    at = found["at"].lower()
    if at in ("start", "end"):
        if found["unit"]:
            raise no_place(f"'{word}' is no place along a run of cuts", ACCEPTED)
        return CutPlace(None, at, None, side)
    return CutPlace(float(at) * _metres(word, found["unit"]), None, None, side)


def _metres(word: str, unit: str) -> float:
    if not unit:
        return 1.0
    try:
        size, dimension = u.parse_unit(unit)
    except Finding:
        raise no_place(f"'{word}': '{unit}' is not a unit", ACCEPTED) from None
    if dimension != u.parse_unit("m")[1]:
        raise no_place(f"'{word}': {unit} is {u.describe(dimension)}, not a length", ACCEPTED)
    return size


def no_place(message: str, hint: str) -> Finding:
    """What is wrong with a word for a place, and what to write."""
    return Finding("unknown-path", message, hint)


def cut_numbers(s: Array) -> Indices:
    """Which of the asked cuts each row is of, from 0; s: their distances, twice where a cut has two rows."""
    return np.cumsum(np.diff(s, prepend=s[:1]) != 0.0)


def asked_distances(first: Sequence[float], last: Sequence[float], count: int) -> Array:
    """The distances [m] of the cuts of a run, evenly spaced from its first point to its last."""
    return np.linspace(0.0, float(np.linalg.norm(np.subtract(last, first))), count)


def rows_at(word: str, s: Array, sides: Sequence[str | None] | None) -> list[int]:
    """The rows that a word of a path means: one, or the two of a cut whose side it does not name.

    s: the distances of the rows; sides: what they are just before or beyond, None before the run. Raises Finding.
    """
    place, numbers = place_of(word), cut_numbers(s)
    cut = _cut_at(word, place, s[np.searchsorted(numbers, np.arange(numbers[-1] + 1))])
    rows = np.flatnonzero(numbers == cut).tolist()
    if place.side is None or sides is None or sides[rows[0]] is None:
        return rows
    own = [row for row in rows if sides[row] == place.side]
    if not own:
        there = sides[rows[0]]
        message = f"'{word}': the run {'begins' if cut == 0 else 'ends'} there, with the cut just {there} what acts"
        raise no_place(message, f"{word.partition(':')[0]}:{there}, or leave the side out")
    return own


def _cut_at(word: str, place: CutPlace, s: Array) -> int:
    """Which of the asked cuts at distances s is meant."""
    last = len(s) - 1
    if place.cut is not None:
        if place.cut > last:
            raise no_place(f"'{word}': the run has {last + 1} cuts, 0 to {last}", f"they count from 0: {last}")
        return place.cut
    if place.end is not None or place.s is None:
        return 0 if place.end == "start" else last
    cut = int(np.argmin(np.abs(s - place.s)))
    if abs(s[cut] - place.s) <= tolerances.SAME_CUT * s[-1]:
        return cut
    if place.s > s[-1]:
        raise no_place(f"'{word}': the run is {s[-1]:.10g} m long", "@end is its last cut")
    above = int(np.searchsorted(s, place.s))
    near = f"@{s[above - 1]:.10g} and @{s[above]:.10g}"
    message = f"'{word}': no cut was asked for there; the nearest are at {near} (nothing is told between them)"
    raise no_place(message, f"take one of them, or another count than {len(s)}")


def row_at(word: str, s: Array, sides: Sequence[str | None], values: Array) -> int:
    """The row that a word of a path means, where values (..., rows) has one number there. Raises Finding."""
    rows = rows_at(word, s, sides)
    if len(rows) == 1:
        return rows[0]
    before, beyond = (np.nan_to_num(values[..., row], nan=np.inf) for row in rows)
    scale = float(np.max(np.abs(values), initial=0.0, where=np.isfinite(values)))
    known = np.isfinite(before) & np.isfinite(beyond)
    apart = np.abs(before - beyond, where=known, out=np.zeros_like(before))
    if (np.isfinite(before) == np.isfinite(beyond)).all() and (apart <= tolerances.WRITTEN * scale).all():
        return rows[0]
    message = f"'{word}': something acts in the plane of this cut, on whose two sides the values differ"
    raise no_place(message, f"{word}:before or {word}:beyond")
