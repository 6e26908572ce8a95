"""How far runs of one motion are apart, seen at the same instants: their points, and the angles that they count.

Points of all bodies, by the scene's size; angles over many turns apart, for a small wheel's may err by far more than
its points. The estimated error is twice the largest distance of the first run from any other (estimate.py), with what
rounding makes of a place.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array, Indices
from heuncli.scene.shapes.by_component import largest

AT_FIRST = 32  # instants at which all points are looked at in any case
ROUNDED_UP = 1.0 + 1e-9  # more than rounding makes of a distance


def motion_error(marks: Marks, bodies: Table, count: int, size: float) -> Array:
    """Estimated error of any point, relative to the size, (n,); bodies: the answers' of so many runs."""
    r, R = (bodies[name].reshape(-1, count, *bodies[name].shape[1:]) for name in ("r", "R"))
    far = np.abs(r[:, 0]).max(axis=(1, 2)) / size
    one, other = np.triu_indices(count, 1)  # each of all pairs
    squares = marks.squares(r[:, other] - r[:, one], R[:, other] - R[:, one])
    apart = np.sqrt(squares.max(axis=(1, 2))) / size
    return known(2.0 * apart + tolerances.PLACE_ROUNDING * np.maximum(far, 1.0))


def bounded_motion_error(marks: Marks, several: Recovered, count: int, size: float) -> Array:
    """Bounds of that error (n,); it is the error itself where it is largest, and where it may pass CLAIMED.

    A point is no farther apart than its body's joint point, and the longest arm times what the body has turned. Two
    attitudes Q R and R an angle θ apart differ by |(Q - 1) R a| <= 2 sin(θ/2) |a|, and the squares of all nine elements
    add up to 8 sin²(θ/2). That takes a tenth of a look at all points, and leaves few instants to look at these.
    """
    n = len(several.times) // count
    r, R = (of_each_run(several.bodies[name], count).reshape(count, len(marks.reach), -1, n) for name in ("r", "R"))
    far, apart = largest(r[0]) / size, np.zeros(n)
    for k in range(count - 1):
        for other in range(k + 1, count):
            dr, dR = (x[other] - x[k] for x in (r, R))
            turned = np.sqrt(0.5 * (dR * dR).sum(axis=1)) + tolerances.SUM_ROUNDING
            off = np.sqrt((dr * dr).sum(axis=1)) + turned * marks.reach[:, None]
            np.maximum(apart, off.max(axis=0), out=apart)
    bound = ROUNDED_UP * (2.0 * (apart / size) + tolerances.PLACE_ROUNDING * np.maximum(far, 1.0))

    def error(which: Indices) -> Array:
        own = several.bodies[(count * which[:, None] + np.arange(count)).ravel()]
        return motion_error(marks, own, count, size)

    if len(bound) <= AT_FIRST or not np.isfinite(bound).all():
        return error(np.arange(len(bound)))
    first = np.argpartition(bound, -AT_FIRST)[-AT_FIRST:]
    exact = error(first)
    bound[first] = 0.0
    others = np.flatnonzero(bound >= min(float(exact.max()), tolerances.CLAIMED))
    if len(others):
        bound[others] = error(others)
    bound[first] = exact
    return bound


def of_each_run(values: Array, count: int) -> Array:
    """Values (c n, ...) of so many runs, instant by instant, as those of one run after the other, (c, ..., n)."""
    each = values.reshape(-1, count, *values.shape[1:])
    return np.ascontiguousarray(each.transpose(1, *range(2, each.ndim), 0))


def points_apart(marks: Marks, bodies: Table, count: int, size: float, first: int = 0) -> Array:
    """How far any point is, at most, in one of so many runs from where it is in a later one, by the size, (n,).

    first: the number of the one.
    """
    own = bodies[first::count]
    return np.asarray(np.max([marks.apart(own, bodies[k::count]) for k in range(first + 1, count)], axis=0) / size)


def angle_error(layout: Layout, several: Recovered, count: int) -> tuple[Array, float]:
    """Estimated error of the angles that are counted over turns [rad], (n,), and the largest of them, at least 1."""
    apart, largest = angles_apart(layout, several, count)
    for k in range(1, count - 1):
        apart = np.maximum(apart, angles_apart(layout, several, count, k)[0])
    return known(2.0 * apart + tolerances.PLACE_ROUNDING * largest), float(largest.max(initial=1.0))


def angles_apart(layout: Layout, several: Recovered, count: int, first: int = 0) -> tuple[Array, Array]:
    """How far any counted angle of one run is from that of a later one [rad], (n,); and its largest, at least 1, (n,).

    several: answers of so many runs, instant by instant; first: the number of the one.
    """
    turning = [n for n, freedom in enumerate(layout.freedoms) if freedom.quantity == "angle"]
    counted = [place for k, place in layout.counters.items() if layout.mechanism.joints[k].path is None]
    if not turning and not counted:
        n = len(several.times) // count
        return np.zeros(n), np.ones(n)
    angles = np.hstack([several.freedoms["q"][:, turning], several.states[:, counted]])
    own = angles[first::count]
    others = range(first + 1, count)
    apart = np.max([np.abs(own - angles[k::count]).max(axis=1, initial=0.0) for k in others], axis=0)
    return np.asarray(apart), np.abs(own).max(axis=1, initial=1.0)


def known(error: Array) -> Array:
    """The errors; what is no number is unknown."""
    return np.where(np.isfinite(error), error, tolerances.UNKNOWN)


class Marks:
    """Points by which the motion of the bodies is judged, tree order: named ones, centres, origins, and their extent.

    The extent is that of the body's ellipsoid of inertia: a turn about a line through the other points is seen, too, by
    as much as it moves the body's mass.
    """

    def __init__(self, layout: Layout) -> None:
        bodies = layout.mechanism.bodies
        mass, inertia = np.array([b.mass for b in bodies]), np.array([b.inertia for b in bodies])
        # second moments about the centre by the mass: squares of the semi-axes, and their directions as columns
        moments = 0.5 * np.trace(inertia, axis1=1, axis2=2)[:, None, None] * np.eye(3) - inertia
        squares, axes = np.linalg.eigh(moments / mass[:, None, None])
        reach = axes * np.sqrt(np.maximum(squares, 0.0))[:, None, :]
        owner, arms = [], []
        for i, body in enumerate(bodies):
            points = [body.center, np.zeros(3), *body.points.values(), *(body.center + reach[i].T)]
            owner += [layout.place[i]] * len(points)
            arms += [p - layout.reference[layout.place[i]] for p in points]
        self.owner, self.arms = np.array(owner), np.array(arms)
        self.reach = np.zeros(len(bodies))  # the longest arm of each body
        np.maximum.at(self.reach, self.owner, np.sqrt(np.sum(self.arms**2, axis=1)))

    def apart(self, a: Table, b: Table) -> Array:
        """Largest distance of any of the points between two sets of `Recovered.bodies`, (n_t,) [m]."""
        return np.asarray(np.sqrt(self.squares(b["r"] - a["r"], b["R"] - a["R"]).max(axis=1)))

    def squares(self, dr: Array, dR: Array) -> Array:
        """Squares of how far each point is apart, (..., m) [m²].

        dr (..., b, 3), dR (..., b, 3, 3): by how much the joint points and attitudes of two sets of bodies differ.
        """
        d = dr[..., self.owner, :] + (dR[..., self.owner, :, :] @ self.arms[:, :, None])[..., 0]
        each = d * d
        return np.asarray(each[..., 0] + each[..., 1] + each[..., 2])
