"""Numbers over a cycle on so many pieces that polynomials tell all of them: halved until their tails are rounding.

Breaks that are known end pieces. One that is not is closed in by halving, down to what is no length any more. Where
halving lowers a tail no further it is the rounding of the numbers themselves. Probes are places at which what was found
is held against the numbers themselves: where the two differ pieces end there, and are halved anew.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from heuncli.analyses.balancing.legendre import MOST
from heuncli.analyses.balancing.nodes import PieceNodes
from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.results.results import Array, Indices, Mask

Sample = Callable[[Array], Array]  # of ascending places (n,) the numbers there, (n, columns)

FEW = 8  # nodes of a short piece at first; of all others MOST
SHORT = 0.05  # of a turn
WIDEST = 0.125  # of a turn: a piece at first
NOISE = 1e-7  # of the largest: a tail of less that halving lowers by less than ...
FALLS = 0.25  # ... this is rounding of the numbers
NO_LENGTH = 64.0 * tolerances.EPS  # of the cycle, or of its angles: no node lies within
GRADE = 8.0  # times as long as the next one is a piece beside a place that is looked at anew
MOST_NODES = 400_000


class Resolved(NamedTuple):
    """Numbers at the nodes of pieces, (n, columns); settled: whether their tails are rounding everywhere."""

    nodes: PieceNodes
    values: Array
    settled: bool


class CyclePieces(NamedTuple):
    """Pieces (p,) with how many nodes each, and the largest tail of what they are parts of, of the columns' scales."""

    begins: Array
    ends: Array
    sizes: Array
    before: Array

    def some(self, which: Mask | Indices) -> CyclePieces:
        """Some of them."""
        return CyclePieces(*(x[which] for x in self))


class CycleResolver:
    """Finds pieces for numbers over a cycle; what was found is kept in `kept` and `values`."""

    def __init__(self, sample: Sample, cycle: PieceNodes, scales: Callable[[Array], Array]) -> None:
        """cycle: without pieces yet; scales: of values (n, columns) what tails are seen against, (columns,)."""
        self.sample, self.cycle, self.scales = sample, cycle, scales
        self.kept = CyclePieces(*(np.zeros(0) for _ in range(4)))
        self.values: list[Array] = []
        self.largest: Array | None = None
        self.settled, self.asked = True, 0
        self.least = NO_LENGTH * max(cycle.length, abs(cycle.begin) + cycle.length)

    def resolve(self, marks: Array) -> Resolved:
        """Pieces between marks, places of the cycle, until all are resolved."""
        ends = self.cycle.length
        inner = np.unique(np.concatenate([[0.0], marks[(marks > self.least) & (marks < ends - self.least)], [ends]]))
        inner = inner[np.append(True, np.diff(inner) > self.least)]
        inner[-1] = ends
        turn = ends / self.cycle.turns
        parts = np.maximum(np.ceil(np.diff(inner) / (WIDEST * turn) - 1e-9), 1.0).astype(int)
        places = np.concatenate([
            *(a + (b - a) * np.arange(n) / n for a, b, n in zip(inner[:-1], inner[1:], parts, strict=True)), [ends]
        ])  # fmt: skip
        sizes = np.where(np.diff(places) < SHORT * turn, FEW, MOST)
        self.refine(CyclePieces(places[:-1], places[1:], sizes, np.full(len(sizes), np.inf)))
        return self.found()

    def probed(self, probes: Array) -> Resolved:
        """The pieces, made anew about those of the probes at which they are not what the numbers are."""
        probes = np.unique(probes[(probes > self.least) & (probes < self.cycle.length - self.least)])
        found = self.found()
        if not len(probes):
            return found
        off = np.abs(self.sample(probes) - found.nodes.at(found.nodes.coefficients(found.values), probes)) / self.scale
        k = np.searchsorted(self.kept.begins, probes, side="right") - 1
        inner = np.minimum(probes - self.kept.begins[k], self.kept.ends[k] - probes) > GRADE * self.least
        off = np.where(inner, off.max(axis=1), 0.0)
        order = np.lexsort((off, k))
        worst = order[np.append(k[order][1:] != k[order][:-1], True)]  # of each piece
        wrong = worst[off[worst] > tolerances.CANCELS]
        if not len(wrong):
            return found
        self.cut(k[wrong], probes[wrong])
        return self.found()

    def cut(self, k: Indices, places: Array) -> None:
        """Make pieces anew about a place within each: they are the shorter the nearer they are to it, on both sides.

        What is there may be shorter than the distance of any nodes.
        """
        ends = []
        for i, place in zip(k.tolist(), places.tolist(), strict=True):
            a, b = float(self.kept.begins[i]), float(self.kept.ends[i])
            for width, side in ((place - a, -1.0), (b - place, 1.0)):
                levels = int(max(np.log(width / (GRADE * self.least)) / np.log(GRADE), 0.0))
                ends.append(place + side * width * GRADE ** -np.arange(levels + 1.0))
            ends.append(np.array([place]))
            ends[-3][0], ends[-2][0] = a, b
        marks = np.unique(np.concatenate(ends))
        again = np.zeros(len(self.kept.begins), dtype=bool)
        again[k] = True
        middle = 0.5 * (marks[1:] + marks[:-1])
        inside = again[np.searchsorted(self.kept.begins, middle, side="right") - 1]
        begins, behind = marks[:-1][inside], marks[1:][inside]
        self.values = [own for own, out in zip(self.values, again, strict=True) if not out]
        self.kept = self.kept.some(~again)
        self.refine(CyclePieces(begins, behind, np.full(len(begins), MOST), np.full(len(begins), np.inf)))

    def refine(self, pieces: CyclePieces) -> None:
        """Halve pieces until each is resolved, or has no length; these are put to those that were found."""
        while len(pieces.begins):
            pieces = pieces.some(np.argsort(pieces.begins))
            nodes = self.with_pieces(pieces)
            values = self.sample(nodes.places)
            self.asked += len(values)
            own = self.scales(values)
            self.largest = own if self.largest is None else np.maximum(self.largest, own)
            tails = (nodes.tails(nodes.coefficients(values)) / self.scale).max(axis=1)
            width = pieces.ends - pieces.begins
            noise = (tails <= NOISE) & (tails > FALLS * pieces.before)
            wide = width > 4.0 * self.least
            full = self.asked > MOST_NODES
            done = (tails <= tolerances.ORDERS_SETTLED) | noise | ~wide | full
            self.settled &= not (full and bool((tails > tolerances.CANCELS)[wide].any()))
            parts = np.split(values, np.cumsum(pieces.sizes)[:-1])
            self.keep(pieces.some(done), [part for part, own_done in zip(parts, done, strict=True) if own_done])
            pieces = divided(pieces._replace(before=tails).some(~done))

    def keep(self, pieces: CyclePieces, values: Sequence[Array]) -> None:
        """Put pieces to those that were found."""
        joined = CyclePieces(*(np.concatenate(both) for both in zip(self.kept, pieces, strict=True)))
        every = [*self.values, *values]
        order = np.argsort(joined.begins, kind="stable")
        self.kept, self.values = joined.some(order), [every[i] for i in order]

    @property
    def scale(self) -> Array:
        """What tails are seen against, (columns,)."""
        assert self.largest is not None
        return np.where(self.largest > 0.0, self.largest, 1.0)

    def with_pieces(self, pieces: CyclePieces) -> PieceNodes:
        """The cycle's nodes on pieces."""
        found: PieceNodes = replace(self.cycle, begins=pieces.begins, ends=pieces.ends, sizes=pieces.sizes.astype(int))
        return found

    def found(self) -> Resolved:
        """What was found so far."""
        return Resolved(self.with_pieces(self.kept), np.concatenate(self.values), self.settled)


def divided(pieces: CyclePieces) -> CyclePieces:
    """Short pieces with all their nodes, others in halves."""
    few = pieces.sizes < MOST
    more, wide = pieces.some(few), pieces.some(~few)
    middle = 0.5 * (wide.begins + wide.ends)
    parts = [
        more._replace(sizes=np.full_like(more.sizes, MOST), before=np.full_like(more.before, np.inf)),
        wide._replace(ends=middle), wide._replace(begins=middle),
    ]  # fmt: skip
    return CyclePieces(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def of_a_cycle(begin: float, turns: int, sense: float = 1.0) -> PieceNodes:
    """A cycle without pieces yet."""
    none = np.zeros(0)
    return PieceNodes(begin, turns, sense, none, none, none.astype(int))


def scales_of(parts: Sequence[int], rounding: Sequence[float]) -> Callable[[Array], Array]:
    """Scales of columns, so many side by side that are of one kind: the largest of the kind.

    rounding: of each kind what of its numbers is rounding of terms that they are sums of: no tail need be smaller.
    """
    floors = np.array(rounding) / tolerances.ORDERS_SETTLED

    def scales(values: Array) -> Array:
        ends = np.cumsum(parts)
        sizes = np.abs(values).max(axis=0, initial=0.0)
        return np.concatenate([
            np.full(n, max(float(sizes[end - n : end].max(initial=0.0)), floor))
            for n, end, floor in zip(parts, ends, floors.tolist(), strict=True)
        ])  # fmt: skip

    return scales
