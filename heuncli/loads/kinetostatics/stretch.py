"""The whole stretch of a run of cuts, between its cuts too: where its loads are largest.

Between the corners of a run (joints, forces, point masses, changes of shape; on either side of each) the loads are
smooth in s, the way along it: of prisms and rods polynomials of degree 3, of cones and balls of degree 5 or 6. So they
are known between two corners by their values at nine nodes, x_j = −cos(πj/8) (Lobatto), whose polynomial

    Σ_k c_k T_k(x),   c = V⁻¹ q,   V_jk = T_k(x_j) = cos(k arccos x_j)

takes the values q. Where the shape's own inertia is no such polynomial, as of what is cut askew, the pieces are halved
until it is. A joint or load whose point moves over the body is a corner that moves: then the nodes move with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.cuts import BEFORE, BEYOND, Cuts
from heuncli.results.results import Array, Indices, Mask, Place

if TYPE_CHECKING:
    from heuncli.loads.kinetostatics.sections import Attachment

DEGREE = 8
NODES = -np.cos(np.pi * np.arange(DEGREE + 1) / DEGREE)
SIDES = np.array([BEYOND, *[0.0] * (DEGREE - 1), BEFORE])
FINE = -np.cos(np.pi * np.arange(4 * DEGREE + 1) / (4 * DEGREE))  # where the polynomial is looked at first
HALVINGS = 4
SHORT = 64.0  # times what counts as in a plane: the first node of a longer piece is 0.038 of it from the corner
ONE_PLACE = 0.25  # of it: corners so close are one, as all that acts there counts as in the plane of the first
NEWTON = 3  # steps to the summit of a polynomial of degree 8, from a 32nd of its length: 1e-2, 1e-4, 1e-8, rounding


def chebyshev(x: Array) -> Array:
    """T_0(x) to T_8(x), on a new last axis."""
    return np.cos(np.arange(DEGREE + 1) * np.arccos(np.clip(x, -1.0, 1.0))[..., None])


TO_COEFFICIENTS = np.linalg.inv(chebyshev(NODES))
TO_FINE = (chebyshev(FINE) @ TO_COEFFICIENTS).T


def _derivative() -> Array:
    """Coefficients of the derivative of each T_k, in columns."""
    D = np.zeros((DEGREE + 1, DEGREE + 1))
    for k in range(1, DEGREE + 1):
        D[k - 1 :: -2, k] = 2.0 * k
        if k % 2:
            D[0, k] = k
    return D


DERIVATIVE = _derivative()


@record
class Stretch:
    """A run of cuts with its corners.

    asked: its cuts; corners (m,): where along n the loads or the shape change, its ends first and last; jumps (m,):
    whether the loads may jump there.
    """

    asked: Cuts
    corners: Array
    jumps: Mask

    @property
    def name(self) -> str:
        """Of the section."""
        return self.asked.name

    @property
    def body(self) -> int:
        """The body that is cut."""
        return self.asked.body

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is worth saying about its cuts."""
        return self.asked.warnings

    @property
    def without_stresses(self) -> Stretch:
        """The stretch with cuts that have no properties, so that no stresses are told."""
        return replace(self, asked=self.asked.without_stresses)

    def height(self, s: Array) -> Array:
        """Along n, from the body's origin."""
        return np.asarray(float(self.asked.points[0] @ self.asked.n) + s)

    def laid_for(self, on: Sequence[Attachment]) -> Cuts:
        """The cuts at the nodes of all pieces, which move where a load does: s (k,), or (n_t, k)."""
        moving = [a.at @ self.asked.n for a in on if a.at.ndim == 2]
        if not moving:
            return self.fixed
        heights = np.clip(np.stack(moving, axis=1), self.corners[0], self.corners[-1])
        corners = np.broadcast_to(self.corners, (len(heights), len(self.corners)))
        return self.at_nodes(np.sort(np.concatenate([corners, heights], axis=1), axis=1))

    @cached_property
    def fixed(self) -> Cuts:
        """The cuts at the nodes where nothing moves over the body."""
        return self.at_nodes(self.corners)

    def at_nodes(self, corners: Array) -> Cuts:
        """The cuts at the nodes between corners, (m,) or (n_t, m).

        Of corners that lie so close that the nodes between count as in the plane of the one or the other (two loads of
        nearly the same place, or what moves over the body), all of these are put to one place where nothing is: of so
        short a piece nothing is told.
        """
        a, b = corners[..., :-1, None], corners[..., 1:, None]
        heights = np.where(NODES < 0.0, a + 0.5 * (b - a) * (NODES + 1.0), b - 0.5 * (b - a) * (1.0 - NODES))
        short = b - a <= SHORT * self.asked.near
        if short.any():
            heights = np.where(short, in_longest(corners)[..., None, None], heights)
        heights = heights.reshape(*corners.shape[:-1], -1)
        return laid(self.asked, heights - self.height(np.zeros(1)), np.tile(SIDES, corners.shape[-1] - 1))

    def place(self, s: float, side: float) -> Place:
        """A place for a reader, by its distance and the side on which it lies where a piece ends; else 0."""
        asked, d = self.asked, float(self.height(np.array(s)))
        assert asked.s is not None
        near = max(4.0 * asked.near, tolerances.IN_PLANE * float(asked.s[-1]))
        corner = np.flatnonzero(np.abs(self.corners - d) <= near)
        # the end of a piece that is none of the corners is one that moves
        jumps = side != 0.0 and (len(corner) == 0 or bool(self.jumps[corner].any()))
        side = side if jumps else 0.0
        close = np.abs(asked.s - s) <= tolerances.SAME_CUT * asked.s[-1]
        same = np.flatnonzero(close & (asked.side * side >= 0.0))
        return Place(s, {BEFORE: "before", BEYOND: "beyond"}.get(side), int(same[0]) if len(same) else None)


def in_longest(corners: Array) -> Array:
    """The middle of the longest piece between corners (m,) or (n_t, m), () or (n_t,)."""
    k = np.argmax(np.diff(corners), axis=-1)[..., None]
    ends = np.take_along_axis(corners, k, axis=-1) + np.take_along_axis(corners, k + 1, axis=-1)
    return np.asarray(0.5 * ends[..., 0])


def laid(asked: Cuts, s: Array, side: Array) -> Cuts:
    """Other cuts along a run, at distances (k,) or (n_t, k) with sides (k,)."""
    form, n = asked.form, asked.n
    assert form is not None
    points = asked.points[0] + s[..., None] * n
    d, sides = (points @ n).ravel(), np.broadcast_to(side, s.shape).ravel()
    pieces = form.pieces(n, d, sides).reshape(*s.shape, 4, 4)
    centroids = None
    if asked.centroids is not None and (asked.about == "centroid" or asked.properties is not None):
        centroids = form.cross_sections(n, d, np.where(sides == 0.0, BEFORE, sides)).centroid.reshape(*s.shape, 3)
        centroids = np.where(np.isfinite(centroids), centroids, points)  # between shapes there is none
    return replace(asked, points=points, s=s, side=side, pieces=pieces, centroids=centroids)


def stretch_of(asked: Cuts, attached: Sequence[Array], lines: Sequence[Array] = (), *, halved: int = 0) -> Stretch:
    """The whole stretch of a run; attached: where loads and joints act on the body; halved: each piece, so often.

    lines: the two ends (2, 3) of each distributed load, where loads bend but do not jump, if the line is not in a cut.
    """
    form, n = asked.form, asked.n
    assert form is not None and asked.s is not None
    low = float(asked.points[0] @ n)
    high = low + float(asked.s[-1])
    ends = np.array(lines).reshape(-1, 2, 3) @ n
    flat = np.abs(ends[:, 1] - ends[:, 0]) <= 4.0 * asked.near
    acting = np.concatenate([[point @ n for point in attached], ends[flat].mean(axis=1)])
    inside = np.concatenate([acting, ends[~flat].ravel(), form.corners(n)])
    inside = np.sort(inside[(inside > low + asked.near) & (inside < high - asked.near)])
    corners = np.concatenate([[low], inside, [high]])
    corners = corners[np.append(True, np.diff(corners) > ONE_PLACE * asked.near)]
    corners[-1] = high
    for turn in range(HALVINGS):
        a, b = corners[:-1], corners[1:]
        askew = np.full(len(a), True) if turn < halved else ~_fits(asked, a, b)
        if not askew.any():
            break
        corners = np.sort(np.concatenate([corners, 0.5 * (a + b)[askew]]))
    jumps = np.min(np.abs(corners[:, None] - np.append(acting, np.inf)), axis=1) <= 4.0 * asked.near
    return Stretch(asked, corners, jumps | form.masses_in_plane(n, corners) | form.rods_in_plane(n, corners))


def _fits(asked: Cuts, a: Array, b: Array) -> Mask:
    """Whether the inertia of what lies beyond is the polynomial of its nodes, between each two heights."""
    form, n = asked.form, asked.n
    assert form is not None
    checked = np.array([-0.93, -0.45, 0.1, 0.62, 0.97])
    at = np.concatenate([NODES, checked])
    d = 0.5 * (a + b)[:, None] + 0.5 * (b - a)[:, None] * at
    sides = np.broadcast_to(np.append(SIDES, np.zeros(len(checked))), d.shape)
    P = form.pieces(n, d.ravel(), sides.ravel()).reshape(*d.shape, 16)
    expected = np.einsum("cj,pje->pce", chebyshev(checked) @ TO_COEFFICIENTS, P[:, : len(NODES)])
    scale = np.abs(P).max(axis=(0, 1))
    off = np.abs(expected - P[:, len(NODES) :]) / np.where(scale > 0.0, scale, 1.0)
    return np.asarray(off.max(axis=(1, 2)) <= tolerances.QUADRATURE * 1e3)


class Summits(NamedTuple):
    """The highest value along a stretch at each instant (n_t,): its height, piece, and place in the piece, -1 to 1."""

    height: Array
    piece: Indices
    at: Array


def summits(values: Array) -> tuple[Summits, Summits]:
    """The lowest and the highest along a stretch of what takes these values at its nodes, (n_t, 9 m).

    The lowest is told as a height, with its sign turned. Where any of the values is nan, they are.
    """
    q = values.reshape(len(values), -1, DEGREE + 1)
    unknown = np.asarray(np.isnan(values).any(axis=1))
    q = np.where(unknown[:, None, None], 0.0, q) if unknown.any() else q
    fine = (q @ TO_FINE).reshape(len(q), -1)
    found = [highest(side * q, np.argmax(side * fine, axis=1)) for side in (-1.0, 1.0)]
    low, high = (one._replace(height=np.where(unknown, np.nan, one.height)) for one in found)
    return low, high


def highest(q: Array, top: Indices) -> Summits:
    """The highest of the polynomials that take the heights q at the nodes of pieces, from their highest of FINE on."""
    piece, place = np.divmod(top, len(FINE))
    c = q[np.arange(len(q)), piece] @ TO_COEFFICIENTS.T
    first, second = c @ DERIVATIVE.T, c @ (DERIVATIVE @ DERIVATIVE).T
    low, high = FINE[np.maximum(place - 1, 0)], FINE[np.minimum(place + 1, len(FINE) - 1)]
    start = x = FINE[place]
    for _ in range(NEWTON):
        T = chebyshev(x)
        slope, bend = np.sum(T * first, axis=1), np.sum(T * second, axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            x = np.clip(np.where(bend < 0.0, x - slope / bend, x), low, high)
    before, after = (np.sum(chebyshev(at) * c, axis=1) for at in (start, x))
    better = after > before
    return Summits(np.where(better, after, before), piece, np.where(better, x, start))
