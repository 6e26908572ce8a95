"""Nodes of a cycle, and what their values imply for the whole cycle: means, orders, interpolated values.

Equally spaced nodes serve smooth quantities: Fourier sums are exact up to a finite order. For quantities with jumps or
kinks there are Gauss nodes on each piece between breaks, with Legendre polynomials through them and the Fourier
integrals of these.
    F = Re sum a_k e^{ikφ},   a_k = 2/L ∫ F e^{-ikφ} dφ  (a_0: the mean),   k in whole numbers a cycle of length L
The size of the highest coefficients estimates the error between the nodes, and by rounding.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property
from typing import Protocol

import numpy as np

from heuncli.analyses.balancing.series import (
    MAX_NODES,
    compute_coefficient_matrix,
    compute_fourier_integrals,
    compute_gauss_nodes,
    compute_integral_matrix,
    evaluate_legendre,
)
from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.results.results import Array, Indices

Interpolant = Callable[[Array], Array]  # maps places (m,) to numbers (m, ...)
TAIL_FRACTION = 4  # the highest 1/TAIL_FRACTION of the orders estimates the error of all
TAIL_FACTOR = 4.0  # times the largest of these: error of any order by noise and by higher orders
# error of the place of a jump, relative to a cycle: an event is located to the rounding of its coordinates
JUMP_PLACE_ERROR = 1e-11
# rounding of a place, relative to its cycle, and of coordinates that follow from it
PLACE_ROUNDING = tolerances.SUM_ROUNDING
LENGTH_DIGITS = 13  # digits to which lengths of pieces are compared


class NodeErrors(NamedTuple):
    """Errors of numbers, shaped like one node's values.

    order: error of any order, and of the mean
    value: error of any value
    """

    order: Array
    value: Array


class CycleNodes(Protocol):
    """Nodes of a cycle of several turns that begins at an angle [rad]; a place x runs from 0 to the cycle's length."""

    @property
    def turns(self) -> int: ...
    @property
    def begin(self) -> float: ...
    @property
    def angles(self) -> Array:
        """Angles of the nodes, (n,)."""

    @property
    def weights(self) -> Array:
        """Quadrature weights of the nodes for a mean, (n,); they add up to 1."""

    @property
    def last_order(self) -> int | None:
        """The highest order per cycle that the nodes resolve; None if there is no limit."""

    @property
    def grid(self) -> Array:
        """Ascending places (m,) dense enough to show the numbers, with both sides of breaks."""

    def compute_amplitudes(self, values: Array, orders: Indices) -> Array:
        """Return the complex a_k (m, ...) of node values (n, ...), for orders (m,) per cycle."""

    def estimate_errors(self, values: Array) -> NodeErrors:
        """Estimate the errors of values (n, ...)."""

    def interpolate(self, values: Array) -> Interpolant:
        """Return the interpolant of node values (n, ...)."""

    def compute_angle(self, x: float) -> float:
        """Return the angle of a place."""


@record
class EvenNodes:
    """Equally spaced angles over a cycle."""

    begin: float
    turns: int
    count: int

    @cached_property
    def angles(self) -> Array:
        """Angles of the nodes, (n,)."""
        return np.asarray(self.begin + self.length * np.arange(self.count) / self.count)

    @property
    def length(self) -> float:
        """Length of the cycle [rad]."""
        return 2.0 * math.pi * self.turns

    @property
    def weights(self) -> Array:
        """Quadrature weights of the nodes for a mean, (n,)."""
        return np.full(self.count, 1.0 / self.count)

    @property
    def last_order(self) -> int | None:
        """The highest order per cycle that the nodes resolve."""
        return self.count // 2

    @property
    def grid(self) -> Array:
        """Places of the nodes and the end of the cycle, (n + 1,)."""
        return np.asarray(self.length * np.arange(self.count + 1) / self.count)

    def compute_amplitudes(self, values: Array, orders: Indices) -> Array:
        """Return the complex a_k (m, ...) of node values (n, ...); 0 for orders above half the number of nodes."""
        spectrum = np.fft.rfft(values, axis=0) / self.count
        spectrum[1 : (self.count + 1) // 2] *= 2.0
        known = orders < len(spectrum)
        amplitudes = np.zeros((len(orders), *values.shape[1:]), dtype=complex)
        amplitudes[known] = spectrum[orders[known]]
        shift = np.exp(-1j * orders / self.turns * self.begin)
        return np.asarray(amplitudes * shift.reshape(-1, *[1] * (values.ndim - 1)))

    def estimate_errors(self, values: Array) -> NodeErrors:
        """Estimate the errors from the highest quarter of the orders: their size bounds the error of the others."""
        n = self.count
        sizes = np.abs(np.fft.rfft(values, axis=0)) * 2.0 / n
        tail = TAIL_FACTOR * sizes[len(sizes) - len(sizes) // TAIL_FRACTION :].max(axis=0)
        rounding = 2.0 * tolerances.EPS * np.abs(values).max(axis=0)
        return NodeErrors(tail + rounding, math.sqrt(n) * tail + rounding)

    def interpolate(self, values: Array) -> Interpolant:
        """Return the trigonometric interpolant of the values."""
        k = np.arange(self.count // 2 + 1)
        amplitudes = self.compute_amplitudes(values, k).reshape(len(k), -1)

        def evaluate(x: Array) -> Array:
            """Evaluate the Fourier series at distances x from the begin of the cycle."""
            waves = np.exp(1j * np.outer(self.begin + x, k / self.turns))
            return np.asarray((waves @ amplitudes).real.reshape(len(x), *values.shape[1:]))

        return evaluate

    def compute_angle(self, x: float) -> float:
        """Return the angle of a place; the end of the cycle has the angle of its beginning."""
        return self.begin + x if x < self.length else self.begin


@record
class PieceNodes:
    """Gauss nodes on pieces between breaks.

    begins, ends (p,): places of the pieces, ascending
    sizes (p,): number of nodes of each piece
    direction: 1 if the angle grows with the place, -1 if it falls
    """

    begin: float
    turns: int
    direction: float
    begins: Array
    ends: Array
    sizes: Indices

    @property
    def length(self) -> float:
        """Length of the cycle [rad]."""
        return 2.0 * math.pi * self.turns

    @cached_property
    def places(self) -> Array:
        """Places of the nodes, (n,), ascending."""
        return np.concatenate([
            0.5 * (a + b) + 0.5 * (b - a) * compute_gauss_nodes(int(n))[0]
            for a, b, n in zip(self.begins, self.ends, self.sizes, strict=True)
        ])  # fmt: skip

    @cached_property
    def angles(self) -> Array:
        """Angles of the nodes, (n,)."""
        return np.asarray(self.begin + np.where(self.direction > 0.0, self.places, self.length - self.places))

    @cached_property
    def weights(self) -> Array:
        """Quadrature weights of the nodes for a mean, (n,)."""
        piece_weights = [
            0.5 * (b - a) * compute_gauss_nodes(int(n))[1]
            for a, b, n in zip(self.begins, self.ends, self.sizes, strict=True)
        ]
        weights = np.concatenate(piece_weights)
        return np.asarray(weights / weights.sum())

    @property
    def last_order(self) -> int | None:
        """None: any order can be computed."""
        return None

    @cached_property
    def grid(self) -> Array:
        """Places of the nodes with the two ends of each piece; the end is the last number below it."""
        inner = np.split(self.places, np.cumsum(self.sizes)[:-1])
        last = np.nextafter(self.ends, -np.inf)
        grid = np.concatenate([
            np.concatenate([[a], places, [b]]) for a, places, b in zip(self.begins, inner, last, strict=True)
        ])  # fmt: skip
        return np.asarray(grid[np.append(True, np.diff(grid) > 0.0)])

    def halve_pieces(self, times: int) -> PieceNodes:
        """Return the nodes of the pieces after halving them `times` times."""
        parts = 2**times
        share = np.arange(parts) / parts
        width = (self.ends - self.begins)[:, None]
        begins = (self.begins[:, None] + width * share).ravel()
        ends = np.append(begins[1:], self.ends[-1])
        return PieceNodes(self.begin, self.turns, self.direction, begins, ends, np.repeat(self.sizes, parts))

    def compute_coefficients(self, values: Array) -> Array:
        """Return the Legendre coefficients of values (n, ...) on each piece, (p, MAX_NODES, columns)."""
        flat = values.reshape(len(values), -1)
        coefficients = np.zeros((len(self.begins), MAX_NODES, flat.shape[1]))
        first = np.cumsum(self.sizes) - self.sizes
        for n in np.unique(self.sizes):
            k = np.flatnonzero(self.sizes == n)
            rows = first[k][:, None] + np.arange(n)
            coefficients[k] = np.einsum("cn,pnm->pcm", compute_coefficient_matrix(int(n)), flat[rows])
        return coefficients

    def compute_amplitudes(self, values: Array, orders: Indices) -> Array:
        """Return the complex a_k (m, ...) of values (n, ...) as the sum of the Fourier integrals of the pieces."""
        coefficients = self.compute_coefficients(values)
        half, middle = 0.5 * (self.ends - self.begins), 0.5 * (self.ends + self.begins)
        k = orders / self.turns
        total = np.zeros((len(orders), coefficients.shape[2]), dtype=complex)
        digits = LENGTH_DIGITS - 1 - np.floor(np.log10(half)).astype(int)
        pieces_by_length: dict[float, list[int]] = {}
        for i, (h, d) in enumerate(zip(half.tolist(), digits.tolist(), strict=True)):
            pieces_by_length.setdefault(round(h, d), []).append(i)
        for pieces in pieces_by_length.values():
            integrals = compute_fourier_integrals(k * half[pieces[0]])
            for i in pieces:
                wave = half[i] * np.exp(-1j * k * middle[i])
                total += wave[:, None] * (integrals @ coefficients[i])
        total = total * (np.where(orders == 0, 1.0, 2.0) / self.length)[:, None]
        total = total if self.direction > 0.0 else total.conj()
        shift = np.exp(-1j * k * self.begin)
        return np.asarray((total * shift[:, None]).reshape(len(orders), *values.shape[1:]))

    def estimate_tails(self, coefficients: Array) -> Array:
        """Estimate the error on each piece, (p, columns), as the size of its two last coefficients (p, MAX_NODES,
        .).
        """
        last = (self.sizes - 1)[:, None, None]
        return np.asarray(
            (np.take_along_axis(np.abs(coefficients), np.maximum(last - [[[0], [1]]], 0), axis=1)).sum(axis=1)
        )

    def compute_jumps(self, coefficients: Array) -> Array:
        """Return the jump at the beginning of each piece, (p, columns); at the first from the end of the cycle."""
        sign = (-1.0) ** np.arange(MAX_NODES)
        at_begin, at_end = np.einsum("n,pnm->pm", sign, coefficients), coefficients.sum(axis=1)
        return np.asarray(np.abs(at_begin - np.roll(at_end, 1, axis=0)))

    def estimate_errors(self, values: Array) -> NodeErrors:
        """Estimate the errors from the last coefficients of each piece, and from the uncertainty of the places of
        jumps.
        """
        coefficients = self.compute_coefficients(values)
        tails, shares = self.estimate_tails(coefficients), (self.ends - self.begins) / self.length
        rounding = 2.0 * tolerances.EPS * np.abs(values.reshape(len(values), -1)).max(axis=0)
        # the rounding of places matters where values are steep
        variation = np.abs(np.diff(values.reshape(len(values), -1), axis=0)).sum(axis=0)
        place_error = PLACE_ROUNDING * (1.0 + abs(self.begin) / self.length) * variation
        order = (
            2.0 * (shares @ tails + JUMP_PLACE_ERROR * self.compute_jumps(coefficients).sum(axis=0) + place_error)
            + rounding
        )
        wide = shares > tolerances.SIDE_BY_SIDE  # nothing is evaluated between the two sides of a jump
        value = tails[wide].max(axis=0, initial=0.0) + rounding
        shape = values.shape[1:]
        return NodeErrors(order.reshape(shape), value.reshape(shape))

    def interpolate(self, values: Array) -> Interpolant:
        """Return the piecewise polynomial interpolant of the values."""
        coefficients = self.compute_coefficients(values)
        return lambda x: self.evaluate(coefficients, x).reshape(len(x), *values.shape[1:])

    def evaluate(self, coefficients: Array, x: Array) -> Array:
        """Evaluate polynomials with coefficients (p, MAX_NODES, columns) at places (m,), (m, columns)."""
        k = np.maximum(np.searchsorted(self.begins, x, side="right") - 1, 0)
        u = np.clip((2.0 * x - self.begins[k] - self.ends[k]) / (self.ends[k] - self.begins[k]), -1.0, 1.0)
        return np.asarray(np.einsum("mn,mnc->mc", evaluate_legendre(u, coefficients.shape[1]), coefficients[k]))

    def integrate(self, coefficients: Array) -> Array:
        """Return the coefficients (p, MAX_NODES + 1, columns) of the integral from the beginning of the cycle."""
        half = 0.5 * (self.ends - self.begins)
        integral = np.einsum("kn,pnm->pkm", compute_integral_matrix(), coefficients) * half[:, None, None]
        piece_integrals = integral.sum(axis=1)  # every polynomial is 1 at the end
        integral[:, 0] += np.cumsum(piece_integrals, axis=0) - piece_integrals
        return np.asarray(integral)

    def compute_angle(self, x: float) -> float:
        """Return the angle of a place."""
        return self.begin + (x if self.direction > 0.0 or x == 0.0 else self.length - x)
