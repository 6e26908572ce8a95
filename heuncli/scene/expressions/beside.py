"""Rollers beside paths: where the centre of one runs, how far it gets from there, and whether it can follow at all.

    p = r + R n,  n = N × r'/|r'|,  p' = (1 - k) r',  k = κ R,  κ = N · (r' × r'')/|r'|³    N normal to the path's plane
    k' = R (a' - 3 a r'·r''/|r'|²)/|r'|³,  a = N · (r' × r''),  a' = N · (r' × r''')
Where k = 1 the path curves as the roller does, and beyond the roller would touch elsewhere: 1 - k > 0 is asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from heuncli.base import tolerances
from heuncli.results.results import Array

EVEN = 0.1  # of |r'|: by how much it may change in a stretch of which bounds are told
HALVED = 40  # times at most
LOOKS, MOST = 8, 1000  # places in a piece that are looked at; in all, about
NEARER = 1e-6  # of the radius: rounding


class RolledPath(Protocol):
    """What is asked of a path (paths.py) beside which a roller runs."""

    @property
    def knots(self) -> Array: ...
    @property
    def coefficients(self) -> Array: ...
    @property
    def radius(self) -> float: ...
    @property
    def normal(self) -> Array: ...
    @property
    def track_greatest(self) -> tuple[float, float, float]: ...
    def track(self, s: Array | float) -> tuple[Array, Array, Array, Array]: ...


def left(normal: Array, slope: Array) -> Array:
    """The unit vector n to the left of a path that goes on along slopes (..., 3), seen so that N points here."""
    across = np.cross(normal, slope)
    return np.asarray(across / np.sqrt(np.sum(slope * slope, axis=-1))[..., None])


def centre(R: float, N: Array, track: tuple[Array, Array, Array, Array]) -> tuple[Array, Array, Array, Array]:
    """Place of the centre and its derivatives p', p'', p''' by those of the path, (..., 3) each."""
    r, slope, bend, twist = track
    b, b1 = np.sum(slope * slope, axis=-1), 2.0 * np.sum(slope * bend, axis=-1)
    b2 = 2.0 * np.sum(bend * bend + slope * twist, axis=-1)
    a, a1, a2 = (np.cross(one, other) @ N for one, other in ((slope, bend), (slope, twist), (bend, twist)))
    c = R / (b * np.sqrt(b))
    along = (1.0 - c * a)[..., None]
    along1 = (-c * (a1 - 1.5 * a * b1 / b))[..., None]
    along2 = (-c * (a2 - 3.0 * a1 * b1 / b - 1.5 * a * b2 / b + 3.75 * a * b1 * b1 / (b * b)))[..., None]
    bent = along * bend + along1 * slope
    return r + R * left(N, slope), along * slope, bent, along * twist + 2.0 * along1 * bend + along2 * slope


def bounds(path: RolledPath) -> tuple[float, float]:
    """Bounds of |p'| and |p''| over all of the path, by stretches in which |r'| is nearly even."""
    middle, half = stretches(path)
    _, slope, bend, twist = (np.sqrt(np.sum(x * x, axis=-1)) for x in path.track(middle))
    B = bend + twist * half
    low, high = slope - B * half, slope + B * half
    k = path.radius * B / low**2
    k1 = path.radius * (twist / low**2 + 3.0 * B * B / low**3)
    return float(np.max((1.0 + k) * high)), float(np.max((1.0 + k) * B + k1 * high))


def meets(path: RolledPath) -> tuple[float, float] | None:
    """Where a roller would meet another part of its path than it touches, and which; None if it does nowhere.

    Of places looked at the one that is deepest in the roller, by more than rounding.
    """
    knots = path.knots
    many = max(1, min(LOOKS, MOST // len(knots)))
    inner = knots[:-1, None] + np.diff(knots)[:, None] * np.arange(many) / many
    s = np.append(inner.ravel(), knots[-1])
    track = path.track(s)
    C, r = centre(path.radius, path.normal, track)[0], track[0]
    C, r = C - r[0], r - r[0]
    squares = np.sum(C * C, axis=1)[:, None] - 2.0 * (C @ r.T) + np.sum(r * r, axis=1)
    i, k = np.unravel_index(np.argmin(squares), squares.shape)
    if squares[i, k] < (path.radius * (1.0 - NEARER)) ** 2:
        return float(s[i]), float(s[k])
    return None


def stretches(path: RolledPath) -> tuple[Array, Array]:
    """Middles and half lengths of stretches that cover the path, each within a piece."""
    middle, half = 0.5 * (path.knots[1:] + path.knots[:-1]), 0.5 * np.diff(path.knots)
    done: list[tuple[Array, Array]] = []
    for _ in range(HALVED):
        _, slope, bend, twist = (np.sqrt(np.sum(x * x, axis=-1)) for x in path.track(middle))
        even = (bend + twist * half) * half <= EVEN * slope
        done.append((middle[even], half[even]))
        middle, half = middle[~even], 0.5 * half[~even]
        if not len(middle):
            break
        middle, half = np.concatenate([middle - half, middle + half]), np.concatenate([half, half])
    else:
        raise AssertionError("a path that stands still")  # which its rule refuses
    return np.concatenate([m for m, _ in done]), np.concatenate([h for _, h in done])


def tightest(path: RolledPath) -> tuple[float, float]:
    """Where κ R is largest on the path, and how large: at an end of a piece, or where k' = 0, of degree 5 in it."""
    s = np.concatenate([path.knots, *(turns(path, i) for i in range(len(path.coefficients)))])
    _, slope, bend, _ = path.track(s)
    k = path.radius * (np.cross(slope, bend) @ path.normal) / np.sum(slope * slope, axis=-1) ** 1.5
    i = int(np.argmax(k))
    return float(s[i]), float(k[i])


def turns(path: RolledPath, i: int) -> Array:
    """The parameters within a piece at which the path's curvature is extreme."""
    length = float(path.knots[i + 1] - path.knots[i])
    c = path.coefficients[i] * (length ** np.arange(4.0))[:, None]  # over 0 to 1
    slope = [np.array([3.0 * c3, 2.0 * c2, c1]) for c1, c2, c3 in c[1:].T]
    bend = [np.polyder(x) for x in slope]
    a: Array = np.zeros(1)
    for j, n in enumerate(path.normal):
        k, m = (j + 1) % 3, (j + 2) % 3
        a = np.polyadd(a, n * np.polysub(np.polymul(slope[k], bend[m]), np.polymul(slope[m], bend[k])))
    b: Array = np.sum([np.convolve(x, x) for x in slope], axis=0)
    half: Array = np.sum([np.convolve(x, x1) for x, x1 in zip(slope, bend, strict=True)], axis=0)
    found = np.roots(np.polysub(np.polymul(np.polyder(a), b), 3.0 * np.polymul(a, half)))
    inside = found[(found.real > 0.0) & (found.real < 1.0)].real  # a pair that rounding made is looked at, too
    return np.asarray(path.knots[i] + length * inside)


def leaves_plane(path: RolledPath, normal: Sequence[float]) -> bool:
    """Whether a path goes on anywhere out of the plane across a normal (3,), of any length."""
    N = np.asarray(normal, dtype=float)
    steps = np.diff(path.knots)[:, None] ** np.arange(3.0) * np.array([1.0, 2.0, 3.0])
    out = np.abs(path.coefficients[:, 1:] @ N) * steps
    return bool(np.max(out) > tolerances.TYPED_AXES * path.track_greatest[1] * np.sqrt(N @ N))


def flat(coefficients: Array, N: Array) -> Array:
    """The pieces of a path without what leaves the plane across N in which it begins."""
    begun = np.zeros_like(coefficients)
    begun[:, 0] = coefficients[0, 0]
    away = coefficients - begun
    return np.asarray(begun + away - (away @ N)[..., None] * N)
