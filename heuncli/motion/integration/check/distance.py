"""Measure the distance between runs of one motion at the same instants: of their points, and of the angles that they
count.

The points are those of all bodies, relative to the scene's size. Angles over many turns are compared separately,
because a small wheel's angle may err by far more than its points. The estimated error is twice the largest distance of
the first run from any other (estimate.py), plus the rounding error of a position.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array, Indices
from heuncli.scene.shapes.by_component import largest_magnitude

FULL_CHECKS = 32  # instants at which all points are always compared
ROUNDING_MARGIN = 1.0 + 1e-9  # more than the rounding of a distance


def motion_error(marks: MotionPoints, bodies: Table, count: int, size: float) -> Array:
    """Estimate the error of any point relative to the size, (n,); bodies: results of `count` runs."""
    r, R = (bodies[name].reshape(-1, count, *bodies[name].shape[1:]) for name in ("r", "R"))
    extent = np.abs(r[:, 0]).max(axis=(1, 2)) / size
    one, other = np.triu_indices(count, 1)  # all pairs of runs
    squares = marks.squared_distances(r[:, other] - r[:, one], R[:, other] - R[:, one])
    distance = np.sqrt(squares.max(axis=(1, 2))) / size
    return replace_nan_errors(2.0 * distance + tolerances.PLACE_ROUNDING * np.maximum(extent, 1.0))


def bounded_motion_error(marks: MotionPoints, evaluation: Evaluation, count: int, size: float) -> Array:
    """Bound that error (n,). The bound equals the error where it is largest and where it may exceed CLAIMED.

    A point is no farther away than its body's joint point plus the longest arm times the body's rotation. Two attitudes
    Q R and R an angle θ apart differ by |(Q - 1) R a| <= 2 sin(θ/2) |a|, and the squares of all nine elements add up to
    8 sin²(θ/2). This takes a tenth of the time of a comparison of all points, and leaves few instants for such a
    comparison.
    """
    n = len(evaluation.times) // count
    r, R = (group_by_run(evaluation.bodies[name], count).reshape(count, len(marks.reach), -1, n) for name in ("r", "R"))
    extent, distance = largest_magnitude(r[0]) / size, np.zeros(n)
    for k in range(count - 1):
        for other in range(k + 1, count):
            dr, dR = (x[other] - x[k] for x in (r, R))
            turned = np.sqrt(0.5 * (dR * dR).sum(axis=1)) + tolerances.SUM_ROUNDING
            point_distance = np.sqrt((dr * dr).sum(axis=1)) + turned * marks.reach[:, None]
            np.maximum(distance, point_distance.max(axis=0), out=distance)
    bound = ROUNDING_MARGIN * (2.0 * (distance / size) + tolerances.PLACE_ROUNDING * np.maximum(extent, 1.0))

    def exact_error(which: Indices) -> Array:
        bodies = evaluation.bodies[(count * which[:, None] + np.arange(count)).ravel()]
        return motion_error(marks, bodies, count, size)

    if len(bound) <= FULL_CHECKS or not np.isfinite(bound).all():
        return exact_error(np.arange(len(bound)))
    first = np.argpartition(bound, -FULL_CHECKS)[-FULL_CHECKS:]
    exact = exact_error(first)
    bound[first] = 0.0
    others = np.flatnonzero(bound >= min(float(exact.max()), tolerances.CLAIMED))
    if len(others):
        bound[others] = exact_error(others)
    bound[first] = exact
    return bound


def group_by_run(values: Array, count: int) -> Array:
    """Regroup values (c n, ...) of `count` runs, stored instant by instant, run after run, (c, ..., n)."""
    each = values.reshape(-1, count, *values.shape[1:])
    return np.ascontiguousarray(each.transpose(1, *range(2, each.ndim), 0))


def point_distance(marks: MotionPoints, bodies: Table, count: int, size: float, first: int = 0) -> Array:
    """Return the largest distance of any point between run number `first` and a later one, relative to the size,
    (n,).
    """
    first_bodies = bodies[first::count]
    return np.asarray(
        np.max([marks.max_distance(first_bodies, bodies[k::count]) for k in range(first + 1, count)], axis=0) / size
    )


def angle_error(layout: Layout, evaluation: Evaluation, count: int) -> tuple[Array, float]:
    """Estimate the error of the angles that are counted over turns [rad], (n,), and return the largest of them, at
    least 1.
    """
    difference, largest = angle_difference(layout, evaluation, count)
    for k in range(1, count - 1):
        difference = np.maximum(difference, angle_difference(layout, evaluation, count, k)[0])
    return replace_nan_errors(2.0 * difference + tolerances.PLACE_ROUNDING * largest), float(largest.max(initial=1.0))


def angle_difference(layout: Layout, evaluation: Evaluation, count: int, first: int = 0) -> tuple[Array, Array]:
    """Return the largest difference of any counted angle between run `first` and a later one [rad], (n,), and the
    largest angle, at least 1, (n,).

    evaluation: results of `count` runs, instant by instant
    """
    turning = [n for n, freedom in enumerate(layout.freedoms) if freedom.quantity == "angle"]
    counted = [place for k, place in layout.counters.items() if layout.mechanism.joints[k].path is None]
    if not turning and not counted:
        n = len(evaluation.times) // count
        return np.zeros(n), np.ones(n)
    angles = np.hstack([evaluation.freedoms["q"][:, turning], evaluation.states[:, counted]])
    first_angles = angles[first::count]
    others = range(first + 1, count)
    difference = np.max([np.abs(first_angles - angles[k::count]).max(axis=1, initial=0.0) for k in others], axis=0)
    return np.asarray(difference), np.abs(first_angles).max(axis=1, initial=1.0)


def replace_nan_errors(error: Array) -> Array:
    """Replace errors that are not finite by UNKNOWN."""
    return np.where(np.isfinite(error), error, tolerances.UNKNOWN)


class MotionPoints:
    """Points by which the motion of bodies is compared, in tree order: named points, centres, origins and extent
    points.

    The extent points are the axes' ends of the body's ellipsoid of inertia. So a rotation about a line through the
    other points counts too, by as much as it moves the body's mass.
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

    def max_distance(self, a: Table, b: Table) -> Array:
        """Return the largest distance of any of the points between two tables `Evaluation.bodies`, (n_t,) [m]."""
        return np.asarray(np.sqrt(self.squared_distances(b["r"] - a["r"], b["R"] - a["R"]).max(axis=1)))

    def squared_distances(self, dr: Array, dR: Array) -> Array:
        """Return the squared distance of each point, (..., m) [m²].

        dr (..., b, 3), dR (..., b, 3, 3): differences of the joint points and attitudes of two sets of bodies
        """
        d = dr[..., self.owner, :] + (dR[..., self.owner, :, :] @ self.arms[:, :, None])[..., 0]
        each = d * d
        return np.asarray(each[..., 0] + each[..., 1] + each[..., 2])
