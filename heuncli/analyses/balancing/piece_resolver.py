"""Resolve numbers over a cycle on pieces: halve each piece until the tail of its polynomial is rounding.

Known breaks end pieces. An unknown break is enclosed by halving, down to negligible length. If halving lowers a tail no
further, the tail is the rounding of the numbers themselves. Probes are places where the polynomials are compared with
the numbers; where they differ, pieces end there and are halved again.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from heuncli.analyses.balancing.cycle_nodes import PieceNodes
from heuncli.analyses.balancing.series import MAX_NODES
from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.results.results import Array, Indices, Mask

Sample = Callable[[Array], Array]  # maps ascending places (n,) to numbers (n, columns)

FIRST_NODES = 8  # nodes of a short piece at first; other pieces have MAX_NODES
SHORT_PIECE = 0.05  # of a turn
MAX_PIECE = 0.125  # of a turn: longest piece at first
# share of the tail of the piece before it was halved: a tail that halving lowers to no less is rounding of the numbers
MIN_TAIL_REDUCTION = 0.25
GRADING = 8.0  # ratio of the lengths of adjacent pieces towards a place that is resolved again
MAX_EVALUATIONS = 400_000
MIN_LENGTHS = 4.0  # negligible lengths: a piece that is no longer than these is not halved
PART_ROUNDING = 1e-9  # of MAX_PIECE: a piece longer by no more than this is not divided


class ResolvedNumbers(NamedTuple):
    """Numbers at the nodes of pieces, (n, columns).

    is_resolved: whether their tails are rounding everywhere
    """

    nodes: PieceNodes
    values: Array
    is_resolved: bool


class CyclePieces(NamedTuple):
    """Pieces of a cycle, (p,) each.

    sizes: numbers of nodes
    parent_tails: largest relative tail of the piece that each is a half of; infinite if it is none
    """

    begins: Array
    ends: Array
    sizes: Array
    parent_tails: Array

    def select(self, which: Mask | Indices) -> CyclePieces:
        """Return the selected pieces."""
        return CyclePieces(*(x[which] for x in self))


class CycleResolver:
    """Finds pieces for numbers over a cycle.

    resolved, values: resolved pieces so far, ascending, and the numbers at the nodes of each
    largest: largest scales of the columns so far
    is_resolved: whether no piece was left as it was because of MAX_EVALUATIONS
    min_length [rad]: length below which pieces are negligible
    """

    def __init__(self, sample: Sample, cycle: PieceNodes, scales: Callable[[Array], Array]) -> None:
        """cycle: without pieces yet
        scales: function of values (n, columns) that returns the scale of the tails, (columns,)
        """
        self.sample, self.cycle, self.scales = sample, cycle, scales
        self.resolved = CyclePieces(*(np.zeros(0) for _ in range(4)))
        self.values: list[Array] = []
        self.largest: Array | None = None
        self.is_resolved, self.evaluations = True, 0
        self.min_length = tolerances.SHORTEST_PIECE * max(cycle.length, abs(cycle.begin) + cycle.length)

    def resolve(self, marks: Array) -> ResolvedNumbers:
        """Divide the cycle at the marks (places) and refine the pieces until all are resolved."""
        length = self.cycle.length
        inner_marks = marks[(marks > self.min_length) & (marks < length - self.min_length)]
        breaks = np.unique(np.concatenate([[0.0], inner_marks, [length]]))
        breaks = breaks[np.append(True, np.diff(breaks) > self.min_length)]
        breaks[-1] = length
        turn = length / self.cycle.turns
        counts = np.maximum(np.ceil(np.diff(breaks) / (MAX_PIECE * turn) - PART_ROUNDING), 1.0).astype(int)
        places = np.concatenate([
            *(a + (b - a) * np.arange(n) / n for a, b, n in zip(breaks[:-1], breaks[1:], counts, strict=True)),
            [length],
        ])  # fmt: skip
        sizes = np.where(np.diff(places) < SHORT_PIECE * turn, FIRST_NODES, MAX_NODES)
        self.refine(CyclePieces(places[:-1], places[1:], sizes, np.full(len(sizes), np.inf)))
        return self.collect_numbers()

    def probe(self, probes: Array) -> ResolvedNumbers:
        """Compare the pieces with the numbers at the probes and refine again where they differ; return all numbers."""
        probes = np.unique(probes[(probes > self.min_length) & (probes < self.cycle.length - self.min_length)])
        if len(probes):
            k = np.searchsorted(self.resolved.begins, probes, side="right") - 1
            wrong = self.find_wrong_probes(probes, k)
            if len(wrong):
                self.regrade(k[wrong], probes[wrong])
        return self.collect_numbers()

    def find_wrong_probes(self, probes: Array, k: Indices) -> Indices:
        """Return the indices of the worst probe of each piece on which polynomials and numbers differ.

        k: the piece of each probe
        """
        nodes, values, _ = self.collect_numbers()
        interpolated = nodes.evaluate(nodes.compute_coefficients(values), probes)
        deviations = np.abs(self.sample(probes) - interpolated) / self.scale
        distance_to_ends = np.minimum(probes - self.resolved.begins[k], self.resolved.ends[k] - probes)
        deviations = np.where(distance_to_ends > GRADING * self.min_length, deviations.max(axis=1), 0.0)
        order = np.lexsort((deviations, k))
        is_last_of_piece = np.append(k[order][1:] != k[order][:-1], True)
        worst = order[is_last_of_piece]
        return np.asarray(worst[deviations[worst] > tolerances.CANCELS])

    def regrade(self, k: Indices, places: Array) -> None:
        """Replace pieces by ones that shorten toward a place within each, on both sides.

        Details there may be shorter than the distance of any nodes.
        """
        all_marks = []
        for i, place in zip(k.tolist(), places.tolist(), strict=True):
            begin, end = float(self.resolved.begins[i]), float(self.resolved.ends[i])
            all_marks += [self.grade(place, begin), self.grade(place, end), np.array([place])]
        marks = np.unique(np.concatenate(all_marks))
        is_replaced = np.zeros(len(self.resolved.begins), dtype=bool)
        is_replaced[k] = True
        middles = 0.5 * (marks[1:] + marks[:-1])
        is_inside = is_replaced[np.searchsorted(self.resolved.begins, middles, side="right") - 1]
        begins, ends = marks[:-1][is_inside], marks[1:][is_inside]
        self.values = [numbers for numbers, out in zip(self.values, is_replaced, strict=True) if not out]
        self.resolved = self.resolved.select(~is_replaced)
        self.refine(CyclePieces(begins, ends, np.full(len(begins), MAX_NODES), np.full(len(begins), np.inf)))

    def grade(self, place: float, end: float) -> Array:
        """Return marks from one end of a piece toward a place, each GRADING times closer to it than the one before."""
        width, side = abs(end - place), -1.0 if end < place else 1.0
        levels = int(max(np.log(width / (GRADING * self.min_length)) / np.log(GRADING), 0.0))
        marks = place + side * width * GRADING ** -np.arange(levels + 1.0)
        marks[0] = end
        return np.asarray(marks)

    def refine(self, pieces: CyclePieces) -> None:
        """Halve pieces until each is resolved or has negligible length; then store them."""
        while len(pieces.begins):
            pieces = pieces.select(np.argsort(pieces.begins))
            nodes = self.make_nodes(pieces)
            values = self.sample(nodes.places)
            self.evaluations += len(values)
            scales = self.scales(values)
            self.largest = scales if self.largest is None else np.maximum(self.largest, scales)
            tails = (nodes.estimate_tails(nodes.compute_coefficients(values)) / self.scale).max(axis=1)
            width = pieces.ends - pieces.begins
            is_noise = (tails <= tolerances.RESOLVED_TO_NOISE) & (tails > MIN_TAIL_REDUCTION * pieces.parent_tails)
            is_wide = width > MIN_LENGTHS * self.min_length
            is_exhausted = self.evaluations > MAX_EVALUATIONS
            is_done = (tails <= tolerances.ORDERS_SETTLED) | is_noise | ~is_wide | is_exhausted
            self.is_resolved &= not (is_exhausted and bool((tails > tolerances.CANCELS)[is_wide].any()))
            values_by_piece = np.split(values, np.cumsum(pieces.sizes)[:-1])
            done_values = [numbers for numbers, done in zip(values_by_piece, is_done, strict=True) if done]
            self.store(pieces.select(is_done), done_values)
            pieces = divide_pieces(pieces._replace(parent_tails=tails).select(~is_done))

    def store(self, pieces: CyclePieces, values: Sequence[Array]) -> None:
        """Add pieces to the resolved ones."""
        all_pieces = CyclePieces(*(np.concatenate(both) for both in zip(self.resolved, pieces, strict=True)))
        all_values = [*self.values, *values]
        order = np.argsort(all_pieces.begins, kind="stable")
        self.resolved, self.values = all_pieces.select(order), [all_values[i] for i in order]

    @property
    def scale(self) -> Array:
        """Scales of the tails, (columns,)."""
        assert self.largest is not None
        return np.where(self.largest > 0.0, self.largest, 1.0)

    def make_nodes(self, pieces: CyclePieces) -> PieceNodes:
        """Return the cycle's nodes on these pieces."""
        nodes: PieceNodes = replace(self.cycle, begins=pieces.begins, ends=pieces.ends, sizes=pieces.sizes.astype(int))
        return nodes

    def collect_numbers(self) -> ResolvedNumbers:
        """Return all numbers resolved so far."""
        return ResolvedNumbers(self.make_nodes(self.resolved), np.concatenate(self.values), self.is_resolved)


def divide_pieces(pieces: CyclePieces) -> CyclePieces:
    """Return the next pieces: short ones with the full number of nodes, others halved."""
    is_coarse = pieces.sizes < MAX_NODES
    coarse, wide = pieces.select(is_coarse), pieces.select(~is_coarse)
    middle = 0.5 * (wide.begins + wide.ends)
    parts = [
        coarse._replace(
            sizes=np.full_like(coarse.sizes, MAX_NODES), parent_tails=np.full_like(coarse.parent_tails, np.inf)
        ),
        wide._replace(ends=middle),
        wide._replace(begins=middle),
    ]
    return CyclePieces(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def make_empty_nodes(begin: float, turns: int, direction: float = 1.0) -> PieceNodes:
    """Return the nodes of a cycle that has no pieces yet."""
    empty = np.zeros(0)
    return PieceNodes(begin, turns, direction, empty, empty, empty.astype(int))


def make_scales(group_sizes: Sequence[int], rounding: Sequence[float]) -> Callable[[Array], Array]:
    """Return a function that computes the scale of each column: the largest value of its kind.

    group_sizes: numbers of adjacent columns that are of one kind
    rounding: rounding level of each kind; no tail need be smaller
    """
    floors = np.array(rounding) / tolerances.ORDERS_SETTLED

    def compute_scales(values: Array) -> Array:
        """Return the scale of each column: the largest value of its group, at least the group's floor."""
        ends = np.cumsum(group_sizes)
        sizes = np.abs(values).max(axis=0, initial=0.0)
        return np.concatenate([
            np.full(n, max(float(sizes[end - n : end].max(initial=0.0)), floor))
            for n, end, floor in zip(group_sizes, ends, floors.tolist(), strict=True)
        ])  # fmt: skip

    return compute_scales
