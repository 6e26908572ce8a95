"""Compute the path of a roller's centre along a guide path, its bounds, and whether the roller can follow at all.

    p = r + R n,  n = N × r'/|r'|,  p' = (1 - k) r',  k = κ R,  κ = N · (r' × r'')/|r'|³    N normal to the path's plane
    k' = R (a' - 3 a r'·r''/|r'|²)/|r'|³,  a = N · (r' × r''),  a' = N · (r' × r''')
Where k = 1 the path curves as the roller does; beyond that the roller would touch elsewhere. So 1 - k > 0 is required.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from heuncli.base import tolerances
from heuncli.results.results import Array

MAX_SLOPE_CHANGE = 0.1  # of |r'|: its largest change in an interval for which bounds are computed
MAX_HALVINGS = 40  # most halvings of an interval
SAMPLES_PER_PIECE, MAX_SAMPLES = 8, 1000  # samples of each piece; about the most in all
RELATIVE_ROUNDING = 1e-6  # of the radius; less is rounding


class RollerPath(Protocol):
    """The part of a path (paths.py) that the functions here use."""

    @property
    def knots(self) -> Array: ...
    @property
    def coefficients(self) -> Array: ...
    @property
    def radius(self) -> float: ...
    @property
    def normal(self) -> Array: ...
    @property
    def track_bounds(self) -> tuple[float, float, float]: ...
    def evaluate_track(self, s: Array | float) -> tuple[Array, Array, Array, Array]: ...


def left_normal(normal: Array, slope: Array) -> Array:
    """Return the unit vector n to the left of a path with slopes (..., 3), seen from the side to which N points."""
    vector = np.cross(normal, slope)
    return np.asarray(vector / np.sqrt(np.sum(slope * slope, axis=-1))[..., None])


def roller_centre(R: float, N: Array, track: tuple[Array, Array, Array, Array]) -> tuple[Array, Array, Array, Array]:
    """Compute the place of the roller's centre and its derivatives p', p'', p''' from those of the path, (..., 3)
    each.
    """
    r, slope, second, third = track
    b, b1 = np.sum(slope * slope, axis=-1), 2.0 * np.sum(slope * second, axis=-1)
    b2 = 2.0 * np.sum(second * second + slope * third, axis=-1)
    a, a1, a2 = (np.cross(one, other) @ N for one, other in ((slope, second), (slope, third), (second, third)))
    c = R / (b * np.sqrt(b))
    along = (1.0 - c * a)[..., None]
    along1 = (-c * (a1 - 1.5 * a * b1 / b))[..., None]
    along2 = (-c * (a2 - 3.0 * a1 * b1 / b - 1.5 * a * b2 / b + 3.75 * a * b1 * b1 / (b * b)))[..., None]
    second_of_centre = along * second + along1 * slope
    return (
        r + R * left_normal(N, slope),
        along * slope,
        second_of_centre,
        along * third + 2.0 * along1 * second + along2 * slope,
    )


def bound_derivatives(path: RollerPath) -> tuple[float, float]:
    """Compute bounds of |p'| and |p''| over the whole path, by intervals in which |r'| is nearly constant."""
    middle, half_length = split_into_even_intervals(path)
    _, slope, second, third = (np.sqrt(np.sum(x * x, axis=-1)) for x in path.evaluate_track(middle))
    B = second + third * half_length
    low, high = slope - B * half_length, slope + B * half_length
    k = path.radius * B / low**2
    k1 = path.radius * (third / low**2 + 3.0 * B * B / low**3)
    return float(np.max((1.0 + k) * high)), float(np.max((1.0 + k) * B + k1 * high))


def find_interference(path: RollerPath) -> tuple[float, float] | None:
    """Find where a roller would hit another part of its path than the one it touches, and which part; None if nowhere.

    Of the sampled places, it is the one deepest inside the roller, by more than rounding.
    """
    knots = path.knots
    count = max(1, min(SAMPLES_PER_PIECE, MAX_SAMPLES // len(knots)))
    samples = knots[:-1, None] + np.diff(knots)[:, None] * np.arange(count) / count
    s = np.append(samples.ravel(), knots[-1])
    track = path.evaluate_track(s)
    C, r = roller_centre(path.radius, path.normal, track)[0], track[0]
    C, r = C - r[0], r - r[0]
    squares = np.sum(C * C, axis=1)[:, None] - 2.0 * (C @ r.T) + np.sum(r * r, axis=1)
    i, k = np.unravel_index(np.argmin(squares), squares.shape)
    if squares[i, k] < (path.radius * (1.0 - RELATIVE_ROUNDING)) ** 2:
        return float(s[i]), float(s[k])
    return None


def split_into_even_intervals(path: RollerPath) -> tuple[Array, Array]:
    """Return middles and half lengths of intervals that cover the path, each within a piece and with nearly constant
    |r'|.
    """
    middle, half_length = 0.5 * (path.knots[1:] + path.knots[:-1]), 0.5 * np.diff(path.knots)
    done: list[tuple[Array, Array]] = []
    for _ in range(MAX_HALVINGS):
        _, slope, second, third = (np.sqrt(np.sum(x * x, axis=-1)) for x in path.evaluate_track(middle))
        is_even = (second + third * half_length) * half_length <= MAX_SLOPE_CHANGE * slope
        done.append((middle[is_even], half_length[is_even]))
        middle, half_length = middle[~is_even], 0.5 * half_length[~is_even]
        if not len(middle):
            break
        middle, half_length = (
            np.concatenate([middle - half_length, middle + half_length]),
            np.concatenate([half_length, half_length]),
        )
    else:
        raise AssertionError("a path of zero length")  # validation refuses such paths
    return np.concatenate([m for m, _ in done]), np.concatenate([h for _, h in done])


def find_max_curvature(path: RollerPath) -> tuple[float, float]:
    """Find where κ R is largest on the path, and its value: at an end of a piece, or where k' = 0, of degree 5 within
    one.
    """
    s = np.concatenate([path.knots, *(curvature_extremes(path, i) for i in range(len(path.coefficients)))])
    _, slope, second, _ = path.evaluate_track(s)
    k = path.radius * (np.cross(slope, second) @ path.normal) / np.sum(slope * slope, axis=-1) ** 1.5
    i = int(np.argmax(k))
    return float(s[i]), float(k[i])


def curvature_extremes(path: RollerPath, i: int) -> Array:
    """Return the parameters within a piece at which the path's curvature is extreme."""
    length = float(path.knots[i + 1] - path.knots[i])
    c = path.coefficients[i] * (length ** np.arange(4.0))[:, None]  # as functions of 0 to 1
    slope = [np.array([3.0 * c3, 2.0 * c2, c1]) for c1, c2, c3 in c[1:].T]
    second = [np.polyder(x) for x in slope]
    a: Array = np.zeros(1)
    for j, n in enumerate(path.normal):
        k, m = (j + 1) % 3, (j + 2) % 3
        a = np.polyadd(a, n * np.polysub(np.polymul(slope[k], second[m]), np.polymul(slope[m], second[k])))
    b: Array = np.sum([np.convolve(x, x) for x in slope], axis=0)
    half_slope: Array = np.sum([np.convolve(x, x1) for x, x1 in zip(slope, second, strict=True)], axis=0)
    roots = np.roots(np.polysub(np.polymul(np.polyder(a), b), 3.0 * np.polymul(a, half_slope)))
    inside = roots[(roots.real > 0.0) & (roots.real < 1.0)].real  # a complex pair may be a double root
    return np.asarray(path.knots[i] + length * inside)


def leaves_plane(path: RollerPath, normal: Sequence[float]) -> bool:
    """Return whether a path leaves the plane across a normal (3,) of any length, by more than typed digits."""
    N = np.asarray(normal, dtype=float)
    steps = np.diff(path.knots)[:, None] ** np.arange(3.0) * np.array([1.0, 2.0, 3.0])
    deviation = np.abs(path.coefficients[:, 1:] @ N) * steps
    return bool(np.max(deviation) > tolerances.TYPED_AXES * path.track_bounds[1] * np.sqrt(N @ N))


def project_to_plane(coefficients: Array, N: Array) -> Array:
    """Return the pieces of a path projected onto the plane across N through its start."""
    start = np.zeros_like(coefficients)
    start[:, 0] = coefficients[0, 0]
    displacement = coefficients - start
    return np.asarray(start + displacement - (displacement @ N)[..., None] * N)
