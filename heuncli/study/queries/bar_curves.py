"""Section loads along a bar as curves: at one instant, and their bounds over a run, with loads that move over it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from itertools import pairwise

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.kinetostatics.stretch import DEGREE, SIDES, TO_COEFFICIENTS, chebyshev_polynomials
from heuncli.results.results import BEFORE, BEYOND, Array, Block, Mask
from heuncli.results.results_schema import RESULTANTS

N_PLACES, MIN_PLACES = 240, 8  # places along a bar, 3 pixels apart; minimum between two corners
SAME_MAGNITUDE = 1e-6  # relative difference of magnitudes that look equal in a figure


class BarAttachment(NamedTuple):
    """What acts on a bar at a place s [m], and its name.

    kind: joint, support or clamp (joints on the ground), force, impulse, stop, rope, gear, mass
    """

    s: float
    kind: str
    name: str


class Extreme(NamedTuple):
    """The lowest or highest value of a quantity along a bar, with its place s [m] and instant [s]."""

    value: float
    s: float
    time: float


BarExtremes = Mapping[str, tuple[Extreme, Extreme]]  # lowest and highest, by quantities


class BarLine(NamedTuple):
    """A quantity along a bar at one instant.

    s: places (k,), twice where the quantity jumps
    values: (k,), nan where it is open
    """

    time: float
    s: Array
    values: Array
    low: Extreme
    high: Extreme


class BarRange(NamedTuple):
    """The lowest and highest values of a quantity over a run, at each place along a bar (k,), and of all places.

    at_lowest, at_highest: the quantity along the bar at the instants of the extremes
    """

    s: Array
    low: Array
    high: Array
    lowest: Extreme
    highest: Extreme
    at_lowest: BarLine
    at_highest: BarLine

    @property
    def main_line(self) -> BarLine:
        """The line at the instant of the largest magnitude; of two equal ones the first."""
        low, high = abs(self.lowest.value), abs(self.highest.value)
        if abs(high - low) <= SAME_MAGNITUDE * max(high, low):
            return min(self.at_lowest, self.at_highest, key=lambda line: line.time)
        return self.at_lowest if low > high else self.at_highest


class MovingEdges(NamedTuple):
    """Places of the loads that move over a bar, (n_t, m), and the quantities immediately beside them, (6, n_t, m).

    side (m,): on which side of the load
    fixed_places: of the loads that could move but stay at their places, such as of gears on a shaft
    """

    s: Array
    values: Array
    side: Array
    fixed_places: tuple[float, ...] = ()

    @classmethod
    def from_section(cls, section: Block, tolerance: float) -> MovingEdges | None:
        """Collect the ends of the pieces that move over a bar by more than a tolerance; None if none could move."""
        if section["s"].ndim == 1:
            return None
        ends = [..., [0, DEGREE]]
        s = section["s"].reshape(len(section["s"]), -1, DEGREE + 1)[*ends]
        values = np.stack([section[name].reshape(*s.shape[:2], DEGREE + 1)[*ends] for name in RESULTANTS])
        s = np.where(s[..., 1:] > s[..., :1], s, np.nan)  # a load at a corner has no values beside it
        is_known = np.isfinite(s)
        lowest, highest = np.min(np.where(is_known, s, np.inf), axis=0), np.max(np.where(is_known, s, -np.inf), axis=0)
        moves, is_fixed = highest > lowest + tolerance, np.isfinite(lowest) & (highest <= lowest + tolerance)
        sides = np.broadcast_to(SIDES[[0, DEGREE]], s.shape[1:])[moves]
        return cls(s[:, moves], values[:, :, moves], sides, tuple(lowest[is_fixed].tolist()))

    @property
    def end_places(self) -> list[float]:
        """The first and last place of all moving loads, and the places of those that stay."""
        moving = [float(f(self.s)) for f in (np.nanmin, np.nanmax)] if self.s.size else []
        return [*moving, *self.fixed_places]

    def find_passes(self, places: Array, tolerance: float) -> Mask:
        """Return whether a load passes places (k,), or comes near them, between neighbouring instants, (n_t - 1, k).

        tolerance: the distance that is near
        """
        has_passed = np.zeros((len(self.s) - 1, len(places)), dtype=bool)
        for s in self.s.T:
            low, high = np.minimum(s[:-1], s[1:]), np.maximum(s[:-1], s[1:])
            has_passed |= (low[:, None] - tolerance <= places) & (places <= high[:, None] + tolerance)
        return has_passed

    def widen_bounds(self, places: Array, side: Array, low: Array, high: Array) -> None:
        """Widen bounds (6, k) at places (k,), in place, by the values on both sides of a moving load there."""
        a, b = self.s[:-1], self.s[1:]
        first = np.searchsorted(places, np.minimum(a, b), side="left")
        last = np.searchsorted(places, np.maximum(a, b), side="right")
        for k, j in zip(*np.nonzero((last > first) & (a != b)), strict=True):
            indices = np.arange(first[k, j], last[k, j])
            indices = indices[side[indices] != -self.side[j]]
            share = (places[indices] - a[k, j]) / (b[k, j] - a[k, j])
            values_there = (
                self.values[:, k, j, None] + share * (self.values[:, k + 1, j] - self.values[:, k, j])[:, None]
            )
            low[:, indices], high[:, indices] = (
                np.fmin(low[:, indices], values_there),
                np.fmax(high[:, indices], values_there),
            )


def find_corners(nodes: Array, tolerance: float) -> Array:
    """Return the places where the pieces of a run with nodes (9 m,) begin, and where the last ends; without short
    pieces.
    """
    pieces = nodes.reshape(-1, DEGREE + 1)
    pieces = pieces[pieces[:, -1] - pieces[:, 0] > tolerance]
    return np.append(pieces[:, 0], pieces[-1, -1])


def make_interpolation(nodes: Array, s: Array, side: Array) -> Array:
    """Return the matrix (9 m, k) that interpolates values at the nodes (9 m,) to places (k,) on their sides."""
    pieces = nodes.reshape(-1, DEGREE + 1)
    is_long = np.flatnonzero(pieces[:, -1] > pieces[:, 0])  # the others are too short for results
    corners = np.append(pieces[is_long, 0], pieces[is_long[-1], -1])
    first, last = (np.searchsorted(corners[1:-1], s, side=side_name) for side_name in ("right", "left"))
    piece = np.where(side == BEFORE, last, first)
    a, b = corners[piece], corners[piece + 1]
    rows = chebyshev_polynomials((2.0 * s - a - b) / (b - a)) @ TO_COEFFICIENTS
    matrix = np.zeros((len(nodes), len(s)))
    for k in range(DEGREE + 1):
        matrix[(DEGREE + 1) * is_long[piece] + k, np.arange(len(s))] = rows[:, k]
    return matrix


def make_places(corners: Array, tolerance: float, extra_places: Iterable[float] = ()) -> tuple[Array, Array]:
    """Return places along a bar with corners (m,), and their sides: both sides of each corner, close places between,
    extra ones.

    tolerance: corners that are no farther apart count as one
    """
    length = float(corners[-1] - corners[0])
    s, side = list[Array](), list[Array]()
    for a, b in pairwise(corners.tolist()):
        if b - a <= tolerance:
            continue
        count = max(MIN_PLACES, math.ceil(N_PLACES * (b - a) / length))
        inner_places = [a + (b - a) * k / count for k in range(1, count)] + [
            x for x in extra_places if a + tolerance < x < b - tolerance
        ]
        s.append(np.array([a, *sorted(inner_places), b]))
        side.append(np.array([BEYOND, *[0.0] * len(inner_places), BEFORE]))
    return np.concatenate(s), np.concatenate(side)


def find_line_extreme(s: Array, heights: Array, side: float, time: float) -> Extreme:
    """Return the lowest (side -1, heights with their sign changed) or highest of the known values along a bar."""
    if np.isnan(heights).all():
        return Extreme(math.nan, math.nan, time)
    k = int(np.nanargmax(heights))
    return Extreme(side * float(heights[k]), float(s[k]), time)
