"""A series of cuts as a continuous stretch, to find where its loads are largest, between its cuts too.

Between the corners of a stretch (joints, forces, point masses, changes of shape; on either side of each) the loads are
smooth in s, the distance along it: for prisms and rods polynomials of degree 3, for cones and balls of degree 5 or 6.
So between two corners they follow from their values at nine nodes, x_j = −cos(πj/8) (Lobatto), whose polynomial

    Σ_k c_k T_k(x),   c = V⁻¹ q,   V_jk = T_k(x_j) = cos(k arccos x_j)

takes the values q. Where the shape's own inertia is no such polynomial, as for an oblique cut, the pieces are halved
until it is. A joint or load whose point moves over the body is a moving corner: then the nodes move with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.cuts import SEPARATE, Cuts, LoadAtPoint
from heuncli.results.results import BEFORE, BEYOND, SIDE_WORDS, Array, CutPosition, Indices, Mask

DEGREE = 8
NODES = -np.cos(np.pi * np.arange(DEGREE + 1) / DEGREE)
SIDES = np.array([BEYOND, *[0.0] * (DEGREE - 1), BEFORE])
FINE = -np.cos(np.pi * np.arange(4 * DEGREE + 1) / (4 * DEGREE))  # where the polynomial is sampled first
MAX_PIECE_HALVINGS = 4
SHORT_PIECE = 64.0  # times the plane tolerance: the first node of a longer piece is 0.038 of its length from the corner
# times the plane tolerance: closer corners are one, because all there lies in the plane of the first
CORNER_DISTANCE = 0.25
# steps to the summit of a polynomial of degree 8, from a 32nd of its length: 1e-2, 1e-4, 1e-8, rounding
NEWTON_STEPS = 3

MAX_SUMMIT_RISE = 0.25  # of a bend, from a sample to its summit: twice what a parabola rises


def chebyshev_polynomials(x: Array) -> Array:
    """Return T_0(x) to T_8(x), on a new last axis."""
    return np.cos(np.arange(DEGREE + 1) * np.arccos(np.clip(x, -1.0, 1.0))[..., None])


TO_COEFFICIENTS = np.linalg.inv(chebyshev_polynomials(NODES))
TO_FINE = (chebyshev_polynomials(FINE) @ TO_COEFFICIENTS).T


def _derivative_matrix() -> Array:
    """Return the coefficients of the derivative of each T_k, in columns."""
    D = np.zeros((DEGREE + 1, DEGREE + 1))
    for k in range(1, DEGREE + 1):
        D[k - 1 :: -2, k] = 2.0 * k
        if k % 2:
            D[0, k] = k
    return D


DERIVATIVE = _derivative_matrix()


@record
class Stretch:
    """A series of cuts with its corners.

    cuts: its cuts
    corners (m,): heights along n where the loads or the shape change, its ends first and last
    jumps (m,): whether the loads may jump there
    """

    cuts: Cuts
    corners: Array
    jumps: Mask

    @property
    def name(self) -> str:
        """Name of the section."""
        return self.cuts.name

    @property
    def body(self) -> int:
        """Number of the body that is cut."""
        return self.cuts.body

    @property
    def warnings(self) -> tuple[str, ...]:
        """The warnings on its cuts."""
        return self.cuts.warnings

    @property
    def for_impulse(self) -> Stretch:
        """The stretch with cuts without properties, so that no stresses are reported."""
        return replace(self, cuts=self.cuts.for_impulse)

    def find_height(self, s: Array) -> Array:
        """Return the height along n, from the body's origin."""
        return np.asarray(float(self.cuts.points[0] @ self.cuts.n) + s)

    def place_for_loads(self, attached_loads: Sequence[LoadAtPoint]) -> Cuts:
        """Return the cuts at the nodes of all pieces, s (k,), or (n_t, k) with loads that move over the body."""
        moving = [a.point @ self.cuts.n for a in attached_loads if a.point.ndim == 2]
        if not moving:
            return self.fixed_cuts
        heights = np.clip(np.stack(moving, axis=1), self.corners[0], self.corners[-1])
        rounding = tolerances.SUM_ROUNDING * np.abs(self.corners).max()
        if len(heights) and np.ptp(heights, axis=0).max() <= rounding:
            return self.make_node_cuts(self.add_corners(heights[0]))
        corners = np.broadcast_to(self.corners, (len(heights), len(self.corners)))
        return self.make_node_cuts(np.sort(np.concatenate([corners, heights], axis=1), axis=1))

    @cached_property
    def fixed_cuts(self) -> Cuts:
        """The cuts at the nodes where nothing moves over the body."""
        return self.make_node_cuts(self.corners)

    def add_corners(self, heights: Array) -> Array:
        """Return the corners (m,), with those of loads that stay at heights, as of gears on a turning shaft."""
        closest = CORNER_DISTANCE * self.cuts.plane_tolerance
        is_new = np.abs(heights[:, None] - self.corners).min(axis=1) > closest
        added = np.sort(heights[is_new])
        return np.sort(np.append(self.corners, added[np.append(True, np.diff(added) > closest)[: len(added)]]))

    def make_node_cuts(self, corners: Array) -> Cuts:
        """Make the cuts at the nodes between corners, (m,) or (n_t, m).

        Corners may lie so close that the nodes between them count as in the plane of one of them (two loads at nearly
        the same place, or one that moves over the body). Then all these nodes are put to one place where nothing is: so
        short a piece gives no results.
        """
        a, b = corners[..., :-1, None], corners[..., 1:, None]
        heights = np.where(NODES < 0.0, a + 0.5 * (b - a) * (NODES + 1.0), b - 0.5 * (b - a) * (1.0 - NODES))
        is_short = b - a <= SHORT_PIECE * self.cuts.plane_tolerance
        if is_short.any():
            heights = np.where(is_short, find_middle_of_longest(corners)[..., None, None], heights)
        heights = heights.reshape(*corners.shape[:-1], -1)
        return make_cuts_at(self.cuts, heights - self.find_height(np.zeros(1)), np.tile(SIDES, corners.shape[-1] - 1))

    def make_place(self, s: float, side: float) -> CutPosition:
        """Return a place for the output, from its distance and the side on which it lies where a piece ends, else 0."""
        own_cuts, d = self.cuts, float(self.find_height(np.array(s)))
        assert own_cuts.s is not None
        tolerance = max(SEPARATE * own_cuts.plane_tolerance, tolerances.IN_PLANE * float(own_cuts.s[-1]))
        corner = np.flatnonzero(np.abs(self.corners - d) <= tolerance)
        # the end of a piece that is not a corner is a moving one
        jumps = side != 0.0 and (len(corner) == 0 or bool(self.jumps[corner].any()))
        side = side if jumps else 0.0
        is_close = np.abs(own_cuts.s - s) <= tolerances.SAME_CUT * own_cuts.s[-1]
        matching = np.flatnonzero(is_close & (own_cuts.side * side >= 0.0))
        return CutPosition(s, SIDE_WORDS[side], int(matching[0]) if len(matching) else None)


def find_middle_of_longest(corners: Array) -> Array:
    """Return the middle of the longest piece between corners (m,) or (n_t, m), () or (n_t,)."""
    k = np.argmax(np.diff(corners), axis=-1)[..., None]
    ends = np.take_along_axis(corners, k, axis=-1) + np.take_along_axis(corners, k + 1, axis=-1)
    return np.asarray(0.5 * ends[..., 0])


def make_cuts_at(cuts: Cuts, s: Array, side: Array) -> Cuts:
    """Make other cuts along the line of a series, at distances (k,) or (n_t, k) with sides (k,)."""
    form, n = cuts.form, cuts.n
    assert form is not None
    points = cuts.points[0] + s[..., None] * n
    d, sides = (points @ n).ravel(), np.broadcast_to(side, s.shape).ravel()
    pieces = form.piece_inertias(n, d, sides).reshape(*s.shape, 4, 4)
    centroids = None
    if cuts.centroids is not None and (cuts.moment_reference == "centroid" or cuts.properties is not None):
        centroids = form.cross_sections(n, d, np.where(sides == 0.0, BEFORE, sides)).centroid.reshape(*s.shape, 3)
        centroids = np.where(np.isfinite(centroids), centroids, points)  # between shapes there is none
    return replace(cuts, points=points, s=s, side=side, pieces=pieces, centroids=centroids)


def make_stretch(cuts: Cuts, points: Sequence[Array], lines: Sequence[Array] = (), *, min_halvings: int = 0) -> Stretch:
    """Make the stretch of a series of cuts.

    points: where loads and joints act on the body
    lines: the two ends (2, 3) of each distributed load, where loads bend but do not jump, unless the line is in a cut
    min_halvings: halve each piece at least so often
    """
    form, n = cuts.form, cuts.n
    assert form is not None and cuts.s is not None
    low = float(cuts.points[0] @ n)
    high = low + float(cuts.s[-1])
    ends = np.array(lines).reshape(-1, 2, 3) @ n
    is_in_plane = np.abs(ends[:, 1] - ends[:, 0]) <= SEPARATE * cuts.plane_tolerance
    acting = np.concatenate([[point @ n for point in points], ends[is_in_plane].mean(axis=1)])
    inside = np.concatenate([acting, ends[~is_in_plane].ravel(), form.corners(n)])
    inside = np.sort(inside[(inside > low + cuts.plane_tolerance) & (inside < high - cuts.plane_tolerance)])
    corners = np.concatenate([[low], inside, [high]])
    corners = corners[np.append(True, np.diff(corners) > CORNER_DISTANCE * cuts.plane_tolerance)]
    corners[-1] = high
    for round_number in range(MAX_PIECE_HALVINGS):
        a, b = corners[:-1], corners[1:]
        needs_halving = np.full(len(a), True) if round_number < min_halvings else ~_is_polynomial(cuts, a, b)
        if not needs_halving.any():
            break
        corners = np.sort(np.concatenate([corners, 0.5 * (a + b)[needs_halving]]))
    jumps = np.min(np.abs(corners[:, None] - np.append(acting, np.inf)), axis=1) <= SEPARATE * cuts.plane_tolerance
    return Stretch(cuts, corners, jumps | form.has_mass_in_plane(n, corners) | form.has_rod_in_plane(n, corners))


def _is_polynomial(cuts: Cuts, a: Array, b: Array) -> Mask:
    """Return whether the inertia of what lies beyond is the polynomial of its nodes, between each two heights."""
    form, n = cuts.form, cuts.n
    assert form is not None
    checked = np.array([-0.93, -0.45, 0.1, 0.62, 0.97])
    samples = np.concatenate([NODES, checked])
    d = 0.5 * (a + b)[:, None] + 0.5 * (b - a)[:, None] * samples
    sides = np.broadcast_to(np.append(SIDES, np.zeros(len(checked))), d.shape)
    P = form.piece_inertias(n, d.ravel(), sides.ravel()).reshape(*d.shape, 16)
    expected = np.einsum("cj,pje->pce", chebyshev_polynomials(checked) @ TO_COEFFICIENTS, P[:, : len(NODES)])
    scale = np.abs(P).max(axis=(0, 1))
    errors = np.abs(expected - P[:, len(NODES) :]) / np.where(scale > 0.0, scale, 1.0)
    return np.asarray(errors.max(axis=(1, 2)) <= tolerances.QUADRATURE * 1e3)


class Summits(NamedTuple):
    """The highest values of pieces (n,): their heights, and positions in the pieces, -1 to 1."""

    height: Array
    position: Array


class StretchPeaks(NamedTuple):
    """The highest value along a stretch at each instant (n_t,): its height, piece, and position in the piece, -1 to
    1.
    """

    height: Array
    piece: Indices
    position: Array


def find_peaks(values: Array) -> tuple[StretchPeaks, StretchPeaks]:
    """Return the lowest and the highest value along a stretch from the values at its nodes, (n_t, 9 m).

    The lowest is given as a height, with its sign reversed. The results are nan where any of the values is.
    """
    q = values.reshape(len(values), -1, DEGREE + 1)
    is_unknown = np.asarray(np.isnan(values).any(axis=1))
    q = np.where(is_unknown[:, None, None], 0.0, q) if is_unknown.any() else q
    fine = q @ TO_FINE
    low, high = (find_highest_of_pieces(side * q, side * fine) for side in (-1.0, 1.0))
    low, high = (one._replace(height=np.where(is_unknown, np.nan, one.height)) for one in (low, high))
    return low, high


def find_highest_of_pieces(q: Array, fine: Array) -> StretchPeaks:
    """Find the highest value along all pieces, from the heights at their nodes, (n_t, m, 9), and at FINE, (n_t, m, 33).

    A sample is below its summit by κ/8 at most, κ being the bend of the parabola through it and its neighbours, at
    equal steps of arccos x. Each piece that may so reach the highest sample is followed to its summit: chosen by
    samples alone, the piece changes by rounding where two have equal ones, and with it the value. Of summits that are
    equal but for rounding, that with the highest sample is returned.
    """
    instants, last = np.arange(len(fine)), fine.shape[2] - 1
    place = np.argmax(fine, axis=2)[..., None]
    before, after = np.abs(place - 1), last - np.abs(last - place - 1)
    tops, a, b = (np.take_along_axis(fine, k, axis=2)[..., 0] for k in (place, before, after))
    highest = np.argmax(tops, axis=1)
    may_be_higher = tops + MAX_SUMMIT_RISE * (2.0 * tops - a - b) > tops[instants, highest][:, None]
    may_be_higher[instants, highest] = True
    instant, piece = np.nonzero(may_be_higher)
    summit = find_highest(q[instant, piece], place[instant, piece, 0])
    margin = np.where(piece == highest[instant], 0.0, tolerances.SUM_ROUNDING * np.abs(summit.height))
    order = np.lexsort((margin - summit.height, instant)) if len(instant) > len(instants) else instants
    first = order[np.searchsorted(instant[order], instants)]
    return StretchPeaks(summit.height[first], piece[first], summit.position[first])


def find_highest(q: Array, place: Indices) -> Summits:
    """Find the highest values of polynomials, (n,), near places of FINE, from the heights at their nodes, (n, 9)."""
    c = q @ TO_COEFFICIENTS.T
    first, second = c @ DERIVATIVE.T, c @ (DERIVATIVE @ DERIVATIVE).T
    low, high = FINE[np.maximum(place - 1, 0)], FINE[np.minimum(place + 1, len(FINE) - 1)]
    start = x = FINE[place]
    for _ in range(NEWTON_STEPS):
        T = chebyshev_polynomials(x)
        slope, bend = np.sum(T * first, axis=1), np.sum(T * second, axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            x = np.clip(np.where(bend < 0.0, x - slope / bend, x), low, high)
    before, after = (np.sum(chebyshev_polynomials(position) * c, axis=1) for position in (start, x))
    is_better = after > before
    return Summits(np.where(is_better, after, before), np.where(is_better, x, start))
