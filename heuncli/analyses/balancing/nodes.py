"""The places of a cycle at which numbers are known, and what follows from these of all of it: means, orders, values.

Even nodes, of what is smooth: Fourier's sums, which are exact for what waves so little. Nodes on pieces, of what jumps
or bends: Gauss's on each piece between breaks, Legendre's polynomials through them, and Fourier's integrals of these.
    F = Re sum a_k e^{ikφ},   a_k = 2/L ∫ F e^{-ikφ} dφ  (a_0: the mean),   k in whole numbers a cycle of length L
What the highest coefficients come to is what the numbers are off between the nodes, and by rounding.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property
from typing import Protocol

import numpy as np

from heuncli.analyses.balancing.legendre import MOST, fourier_integrals, integral_matrix, nodes, polynomials, transform
from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.results.results import Array, Indices

Course = Callable[[Array], Array]  # of places (m,) the numbers there, (m, ...)
QUARTER = 4  # the last so many-th part of the orders tells how far all are off
OF_TAIL = 4.0  # times the largest of these: as much as any order is off by noise and by what is not told
LOCATED = 1e-11  # of a cycle: how well it is known where a law jumps: an event is met to what its coordinates round
ROUNDED = tolerances.SUM_ROUNDING  # of a cycle: rounding of a place in it, and of coordinates that follow from it
NEXT_LENGTHS = 13  # digits to which lengths of pieces are the same


class NodeErrors(NamedTuple):
    """How far numbers are off, of the shape of one node's: any of their orders, their mean too, and any value."""

    order: Array
    value: Array


class CycleNodes(Protocol):
    """Places of a cycle of so many turns that begins at an angle [rad]; a place x runs from 0 to the cycle's length."""

    @property
    def turns(self) -> int: ...
    @property
    def begin(self) -> float: ...
    @property
    def angles(self) -> Array:
        """Those of the nodes, (n,)."""

    @property
    def weights(self) -> Array:
        """Of the nodes in a mean, (n,); they add up to 1."""

    @property
    def last_order(self) -> int | None:
        """The last that is told, a cycle; None: any is."""

    @property
    def grid(self) -> Array:
        """Places (m,), ascending, that show how the numbers run; both sides of breaks."""

    def amplitudes(self, values: Array, orders: Indices) -> Array:
        """Complex a_k (m, ...) of values (n, ...) at the nodes, of orders (m,) a cycle."""

    def errors(self, values: Array) -> NodeErrors:
        """How far values (n, ...) are off."""

    def course(self, values: Array) -> Course:
        """Values (n, ...) between the nodes, too."""

    def angle(self, x: float) -> float:
        """The angle of a place."""


@record
class EvenNodes:
    """So many equal angles over a cycle."""

    begin: float
    turns: int
    count: int

    @cached_property
    def angles(self) -> Array:
        """Those of the nodes, (n,)."""
        return np.asarray(self.begin + self.length * np.arange(self.count) / self.count)

    @property
    def length(self) -> float:
        """That of the cycle [rad]."""
        return 2.0 * math.pi * self.turns

    @property
    def weights(self) -> Array:
        """Of the nodes in a mean, (n,)."""
        return np.full(self.count, 1.0 / self.count)

    @property
    def last_order(self) -> int | None:
        """The last that is told, a cycle."""
        return self.count // 2

    @property
    def grid(self) -> Array:
        """Places (n + 1,), with the end of the cycle."""
        return np.asarray(self.length * np.arange(self.count + 1) / self.count)

    def amplitudes(self, values: Array, orders: Indices) -> Array:
        """Complex a_k (m, ...) of values (n, ...); 0 of orders above half the nodes."""
        found = np.fft.rfft(values, axis=0) / self.count
        found[1 : (self.count + 1) // 2] *= 2.0
        known = orders < len(found)
        own = np.zeros((len(orders), *values.shape[1:]), dtype=complex)
        own[known] = found[orders[known]]
        back = np.exp(-1j * orders / self.turns * self.begin)
        return np.asarray(own * back.reshape(-1, *[1] * (values.ndim - 1)))

    def errors(self, values: Array) -> NodeErrors:
        """By the highest quarter of the orders: what these are, others are off by."""
        n = self.count
        sizes = np.abs(np.fft.rfft(values, axis=0)) * 2.0 / n
        tail = OF_TAIL * sizes[len(sizes) - len(sizes) // QUARTER :].max(axis=0)
        rounding = 2.0 * tolerances.EPS * np.abs(values).max(axis=0)
        return NodeErrors(tail + rounding, math.sqrt(n) * tail + rounding)

    def course(self, values: Array) -> Course:
        """The wave of all orders through the values."""
        k = np.arange(self.count // 2 + 1)
        own = self.amplitudes(values, k).reshape(len(k), -1)

        def at(x: Array) -> Array:
            waves = np.exp(1j * np.outer(self.begin + x, k / self.turns))
            return np.asarray((waves @ own).real.reshape(len(x), *values.shape[1:]))

        return at

    def angle(self, x: float) -> float:
        """The angle of a place; the end of the cycle is its begin."""
        return self.begin + x if x < self.length else self.begin


@record
class PieceNodes:
    """Gauss's nodes on pieces between breaks.

    begins, ends (p,): places of the pieces, ascending; sizes (p,): of how many nodes each; sense: 1 where the angle
    grows with the place, -1 where it falls.
    """

    begin: float
    turns: int
    sense: float
    begins: Array
    ends: Array
    sizes: Indices

    @property
    def length(self) -> float:
        """That of the cycle [rad]."""
        return 2.0 * math.pi * self.turns

    @cached_property
    def places(self) -> Array:
        """Those of the nodes, (n,), ascending."""
        return np.concatenate([
            0.5 * (a + b) + 0.5 * (b - a) * nodes(int(n))[0]
            for a, b, n in zip(self.begins, self.ends, self.sizes, strict=True)
        ])  # fmt: skip

    @cached_property
    def angles(self) -> Array:
        """Those of the nodes, (n,)."""
        return np.asarray(self.begin + np.where(self.sense > 0.0, self.places, self.length - self.places))

    @cached_property
    def weights(self) -> Array:
        """Of the nodes in a mean, (n,)."""
        own = [0.5 * (b - a) * nodes(int(n))[1] for a, b, n in zip(self.begins, self.ends, self.sizes, strict=True)]
        found = np.concatenate(own)
        return np.asarray(found / found.sum())

    @property
    def last_order(self) -> int | None:
        """None: any order is told."""
        return None

    @cached_property
    def grid(self) -> Array:
        """Places of the nodes, with the two ends of each piece: the last place before it ends."""
        inner = np.split(self.places, np.cumsum(self.sizes)[:-1])
        last = np.nextafter(self.ends, -np.inf)
        every = np.concatenate([
            np.concatenate([[a], own, [b]]) for a, own, b in zip(self.begins, inner, last, strict=True)
        ])  # fmt: skip
        return np.asarray(every[np.append(True, np.diff(every) > 0.0)])

    def halved(self, times: int) -> PieceNodes:
        """The nodes of as many times halved pieces."""
        parts = 2**times
        share = np.arange(parts) / parts
        width = (self.ends - self.begins)[:, None]
        begins = (self.begins[:, None] + width * share).ravel()
        ends = np.append(begins[1:], self.ends[-1])
        return PieceNodes(self.begin, self.turns, self.sense, begins, ends, np.repeat(self.sizes, parts))

    def coefficients(self, values: Array) -> Array:
        """Those of Legendre's polynomials of values (n, ...) on each piece, (p, MOST, columns)."""
        flat = values.reshape(len(values), -1)
        found = np.zeros((len(self.begins), MOST, flat.shape[1]))
        first = np.cumsum(self.sizes) - self.sizes
        for n in np.unique(self.sizes):
            k = np.flatnonzero(self.sizes == n)
            rows = first[k][:, None] + np.arange(n)
            found[k] = np.einsum("cn,pnm->pcm", transform(int(n)), flat[rows])
        return found

    def amplitudes(self, values: Array, orders: Indices) -> Array:
        """Complex a_k (m, ...) of values (n, ...): the sum of each piece's integrals."""
        own = self.coefficients(values)
        half, middle = 0.5 * (self.ends - self.begins), 0.5 * (self.ends + self.begins)
        k = orders / self.turns
        total = np.zeros((len(orders), own.shape[2]), dtype=complex)
        digits = NEXT_LENGTHS - 1 - np.floor(np.log10(half)).astype(int)
        alike: dict[float, list[int]] = {}
        for i, (h, d) in enumerate(zip(half.tolist(), digits.tolist(), strict=True)):
            alike.setdefault(round(h, d), []).append(i)
        for some in alike.values():
            integrals = fourier_integrals(k * half[some[0]])
            for i in some:
                wave = half[i] * np.exp(-1j * k * middle[i])
                total += wave[:, None] * (integrals @ own[i])
        total = total * (np.where(orders == 0, 1.0, 2.0) / self.length)[:, None]
        total = total if self.sense > 0.0 else total.conj()
        back = np.exp(-1j * k * self.begin)
        return np.asarray((total * back[:, None]).reshape(len(orders), *values.shape[1:]))

    def tails(self, own: Array) -> Array:
        """How far numbers are off on each piece, (p, columns): as much as their two last coefficients (p, MOST, .)."""
        last = (self.sizes - 1)[:, None, None]
        return np.asarray((np.take_along_axis(np.abs(own), np.maximum(last - [[[0], [1]]], 0), axis=1)).sum(axis=1))

    def jumps(self, own: Array) -> Array:
        """By how much numbers jump at the begin of each piece, (p, columns); at the first from the end of the cycle."""
        sign = (-1.0) ** np.arange(MOST)
        at_begin, at_end = np.einsum("n,pnm->pm", sign, own), own.sum(axis=1)
        return np.asarray(np.abs(at_begin - np.roll(at_end, 1, axis=0)))

    def errors(self, values: Array) -> NodeErrors:
        """By the last coefficients of each piece, and by how well the places of jumps are known."""
        own = self.coefficients(values)
        tails, shares = self.tails(own), (self.ends - self.begins) / self.length
        rounding = 2.0 * tolerances.EPS * np.abs(values.reshape(len(values), -1)).max(axis=0)
        # what is steep counts by how well places are known that it hangs on
        way = np.abs(np.diff(values.reshape(len(values), -1), axis=0)).sum(axis=0)
        moved = ROUNDED * (1.0 + abs(self.begin) / self.length) * way
        order = 2.0 * (shares @ tails + LOCATED * self.jumps(own).sum(axis=0) + moved) + rounding
        wide = shares > tolerances.SIDE_BY_SIDE  # between the two sides of a jump nothing is told
        value = tails[wide].max(axis=0, initial=0.0) + rounding
        shape = values.shape[1:]
        return NodeErrors(order.reshape(shape), value.reshape(shape))

    def course(self, values: Array) -> Course:
        """The polynomials through the values."""
        own = self.coefficients(values)
        return lambda x: self.at(own, x).reshape(len(x), *values.shape[1:])

    def at(self, own: Array, x: Array) -> Array:
        """Polynomials of coefficients (p, MOST, columns) at places (m,), (m, columns)."""
        k = np.maximum(np.searchsorted(self.begins, x, side="right") - 1, 0)
        u = np.clip((2.0 * x - self.begins[k] - self.ends[k]) / (self.ends[k] - self.begins[k]), -1.0, 1.0)
        return np.asarray(np.einsum("mn,mnc->mc", polynomials(u, own.shape[1]), own[k]))

    def integrals(self, own: Array) -> Array:
        """Coefficients (p, MOST + 1, columns) of the integral from the begin of the cycle on, by places."""
        half = 0.5 * (self.ends - self.begins)
        found = np.einsum("kn,pnm->pkm", integral_matrix(), own) * half[:, None, None]
        whole = found.sum(axis=1)  # every polynomial is 1 at the end
        found[:, 0] += np.cumsum(whole, axis=0) - whole
        return np.asarray(found)

    def angle(self, x: float) -> float:
        """The angle of a place."""
        return self.begin + (x if self.sense > 0.0 or x == 0.0 else self.length - x)
