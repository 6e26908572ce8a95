"""Compare two runs of one motion: at which instants, by which distance, and with which impulses in common.

The distance is that of points and of counted angles. The points are those of all bodies, relative to the scene's size.
Angles over many turns are compared separately, because a small wheel's angle may err by far more than its points. The
estimated error is twice the largest distance of the first run from any other (estimate.py), plus the rounding error of
a position.

An estimate must hold for every instant of the run, requested or not. So the runs are compared at the requested
instants, at the ends of steps, and within steps where the method's interpolation errs most: up to fifty times the error
at the ends.

Each run reaches an impulse that both share at a slightly different instant.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record, replace
from heuncli.kernel.choose import components
from heuncli.motion.integration.contacts.impulses import ImpulseEvent
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.response import as_numbers
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array, Indices, Mask

# Distance

FULL_CHECKS = 32  # instants at which all points are always compared: mostly those that the bound leaves open
ROUNDING_MARGIN = 1.0 + 1e-9  # more than the rounding of a distance


def find_motion_error(marks: MotionPoints, bodies: Table, count: int, size: float) -> Array:
    """Estimate the error of any point relative to the size, (n,); bodies: results of `count` runs."""
    r, R = (bodies[name].reshape(-1, count, *bodies[name].shape[1:]) for name in ("r", "R"))
    extent = np.abs(r[:, 0]).max(axis=(1, 2)) / size
    one, other = pair_runs(count)
    squares = marks.compute_squared_distances(r[:, other] - r[:, one], R[:, other] - R[:, one])
    distance = np.sqrt(squares.max(axis=(1, 2))) / size
    return replace_nan_errors(2.0 * distance + tolerances.PLACE_ROUNDING * np.maximum(extent, 1.0))


@cache
def pair_runs(count: int) -> tuple[Indices, Indices]:
    """Return all pairs of some runs."""
    return np.triu_indices(count, 1)


def bound_motion_error(marks: MotionPoints, evaluation: Evaluation, count: int, size: float) -> Array:
    """Bound that error (n,). The bound equals the error where it is largest and where it may exceed CLAIMED.

    A point is no farther away than its body's joint point plus the longest arm times the body's rotation. Two attitudes
    Q R and R an angle θ apart differ by |(Q - 1) R a| <= 2 sin(θ/2) |a|, and the squares of all nine elements add up to
    8 sin²(θ/2). This takes a tenth of the time of a comparison of all points, and leaves few instants for such a
    comparison.
    """
    distance, extent = np.empty((2, len(evaluation.times) // count))
    numbers = as_numbers(evaluation.bodies).reshape(-1)
    components.bound_differences(numbers, count, marks.reach, tolerances.SUM_ROUNDING, distance, extent)
    extent = extent / size
    bound = ROUNDING_MARGIN * (2.0 * (distance / size) + tolerances.PLACE_ROUNDING * np.maximum(extent, 1.0))

    def find_exact_error(which: Indices) -> Array:
        bodies = evaluation.bodies.take((count * which[:, None] + np.arange(count)).ravel(), axis=0)
        return find_motion_error(marks, bodies, count, size)

    if len(bound) <= FULL_CHECKS or not np.isfinite(bound).all():
        return find_exact_error(np.arange(len(bound)))
    first = np.argpartition(bound, -FULL_CHECKS)[-FULL_CHECKS:]
    exact = find_exact_error(first)
    bound[first] = 0.0
    others = np.flatnonzero(bound >= min(float(exact.max()), tolerances.CLAIMED))
    if len(others):
        bound[others] = find_exact_error(others)
    bound[first] = exact
    return bound


def find_point_distance(marks: MotionPoints, bodies: Table, count: int, size: float, first: int = 0) -> Array:
    """Return the largest distance of any point between run number `first` and a later one, relative to the size,
    (n,).
    """
    first_bodies = bodies[first::count]
    return np.asarray(
        np.max([marks.find_max_distance(first_bodies, bodies[k::count]) for k in range(first + 1, count)], axis=0)
        / size
    )


def find_angle_error(layout: Layout, evaluation: Evaluation, count: int) -> tuple[Array, float]:
    """Estimate the error of the angles that are counted over turns [rad], (n,), and return the largest of them, at
    least 1.
    """
    difference, largest = find_angle_difference(layout, evaluation, count)
    for k in range(1, count - 1):
        difference = np.maximum(difference, find_angle_difference(layout, evaluation, count, k)[0])
    return replace_nan_errors(2.0 * difference + tolerances.PLACE_ROUNDING * largest), float(largest.max(initial=1.0))


def find_angle_difference(layout: Layout, evaluation: Evaluation, count: int, first: int = 0) -> tuple[Array, Array]:
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
        squares, axes = np.linalg.eigh(moments / np.where(mass > 0.0, mass, 1.0)[:, None, None])
        reach = axes * np.sqrt(np.maximum(squares, 0.0))[:, None, :]
        owner, arms = [], []
        for i, body in enumerate(bodies):
            points = [body.center, np.zeros(3), *body.points.values(), *(body.center + reach[i].T)]
            owner += [layout.place[i]] * len(points)
            arms += [p - layout.reference[layout.place[i]] for p in points]
        self.owner, self.arms = np.array(owner), np.array(arms)
        self.reach = np.zeros(len(bodies))  # the longest arm of each body
        np.maximum.at(self.reach, self.owner, np.sqrt(np.sum(self.arms**2, axis=1)))

    def find_max_distance(self, a: Table, b: Table) -> Array:
        """Return the largest distance of any of the points between two tables `Evaluation.bodies`, (n_t,) [m]."""
        return np.asarray(np.sqrt(self.compute_squared_distances(b["r"] - a["r"], b["R"] - a["R"]).max(axis=1)))

    def compute_squared_distances(self, dr: Array, dR: Array) -> Array:
        """Return the squared distance of each point, (..., m) [m²].

        dr (..., b, 3), dR (..., b, 3, 3): differences of the joint points and attitudes of two sets of bodies
        """
        d = dr[..., self.owner, :] + (dR[..., self.owner, :, :] @ self.arms[:, :, None])[..., 0]
        each = d * d
        return np.asarray(each[..., 0] + each[..., 1] + each[..., 2])


# Instants

MAX_ENDS = 2_000  # ends of steps compared, evenly spaced in a longer run; the horizon is then refined
MAX_BODY_STEPS = 2_000  # bodies times steps up to which all steps are sampled
MAX_DETERMINED_INSTANTS = 64  # requested instants compared for a drive-determined run
BLOCKS, BLOCK = 8, 16  # else so many groups of so many steps, spread over the run


@record
class JoinedStates:
    """A run's states at instants (n,), most of which the run holds itself; they are copied only when read.

    run_states, others (., n_state): the two sources
    place (n,): index of each instant, counted through both sources
    """

    run_states: Array
    others: Array
    place: Indices

    def __getitem__(self, instants: slice | Mask) -> Array:
        place, run_count = self.place[instants], len(self.run_states)
        states, is_other = self.run_states.take(place, axis=0, mode="clip"), place >= run_count
        states[is_other] = self.others.take(place[is_other] - run_count, axis=0)
        return states

    def select(self, instants: slice | Mask) -> JoinedStates:
        """Select the states at some instants, without copying them."""
        return replace(self, place=self.place[instants])


@record
class ComparisonInstants:
    """Instants (n,) of a run, ascending, and its states there; is_requested (n,): which of them are reported."""

    times: Array
    states: JoinedStates
    is_requested: Mask


def choose_instants(runner: Runner, run: Trajectory) -> ComparisonInstants:
    """Choose all instants at which a run is compared: requested ones, ends of steps, and some within the steps.

    A determined motion is solved at each instant independently. It errs by rounding alone, most where the closures are
    nearest to a singular position, and there its steps end most closely. So the ends of its steps and some of the
    requested instants suffice.
    """
    selection = slice(None, None, -(-len(run.times) // MAX_DETERMINED_INSTANTS) if run.method.is_determined else 1)
    requested, requested_states = run.times[selection], run.states[selection]
    bounds = np.concatenate([[0.0], run.ends])
    requested_per_step = np.diff(np.searchsorted(requested, bounds)) if len(run.ends) else np.zeros(0, dtype=np.intp)
    ends, states = find_step_ends(runner, run, requested_per_step)
    inner = (
        np.zeros(0)
        if run.method.is_determined
        else choose_inner_instants(bounds, len(runner.layout.place), run.method.sample_fractions)
    )
    times = np.concatenate([requested, ends, inner])
    others = np.concatenate([states, runner.resample(run, inner)])
    order = np.argsort(times, kind="stable")  # of equal instants the asked one comes first
    times = times[order]
    is_used = np.concatenate([[True], times[1:] != times[:-1]]) & (times <= run.times[-1])
    return ComparisonInstants(
        times[is_used], JoinedStates(requested_states, others, order[is_used]), (order < len(requested))[is_used]
    )


def find_step_ends(runner: Runner, run: Trajectory, requested_per_step: Indices) -> tuple[Array, Array]:
    """Return the ends of steps with fewer than two requested instants, and the states there, as far as they are
    stored.
    """
    n = runner.integrated_scene.layout.n_state  # a record begins with the state
    selected = np.flatnonzero(np.append(0, requested_per_step)[run.records.steps] < 2)
    selected = selected[:: -(-len(selected) // MAX_ENDS)]
    times = np.append(0.0, run.ends)[run.records.steps[selected]]
    return times, runner.integrated_scene.embed(times, run.records.records[selected, :n])


def choose_inner_instants(bounds: Array, bodies: int, fractions: tuple[float, ...]) -> Array:
    """Return instants at these fractions of the steps, (n,) ascending; of a long run only in some groups of steps.

    They are needed however many instants are requested, because those may miss the places where a step errs most.
    """
    count = len(bounds) - 1
    steps = np.arange(count)
    if count * bodies > MAX_BODY_STEPS and count > BLOCKS * BLOCK:
        first = np.linspace(0, count - BLOCK, BLOCKS).astype(int)
        steps = (first[:, None] + np.arange(BLOCK)).ravel()
    inner: Array = bounds[steps, None] + np.diff(bounds)[steps, None] * np.array(fractions)
    return inner.ravel()


def find_ends_between(
    runner: Runner, runs: Sequence[Trajectory], begin: float, end: float
) -> tuple[Array, list[Array]]:
    """Return the ends of the first run's steps between two instants, and the states of all runs there."""
    last = min(run.end_time for run in runs)
    ends = runs[0].ends[(runs[0].ends > begin) & (runs[0].ends < end) & (runs[0].ends <= last)]
    ends = ends[:: max(1, -(-len(ends) // MAX_ENDS))]
    return ends, [runner.resample(run, ends) for run in runs]


def interleave(times: Array, states: Sequence[Array]) -> tuple[Array, Array]:
    """Repeat each instant for each run, with the states of all runs (n, n_state) there, one after the other.

    So all runs are evaluated with the same choice of closure rows, which is continued from one state to the next. Else
    what redundant joints leave indeterminate would differ by more than an error.
    """
    return np.repeat(times, len(states)), np.stack(states, axis=1).reshape(len(states) * len(times), -1)


# Matching impulses


def match_impulses(impulses: Sequence[ImpulseEvent], others: Sequence[ImpulseEvent]) -> list[tuple[int, int]]:
    """Return index pairs of impulses that two runs share: each is the other's nearest, with a name in common.

    Rounding may add a contact to an impulse, such as a rope that hardly takes part. It is still the same impulse.
    """
    if not impulses or not others:
        return []
    times, other_times = (np.array([jump.time for jump in jumps]) for jumps in (impulses, others))
    forward, backward = find_nearest(times, other_times), find_nearest(other_times, times)
    pairs = [(i, int(k)) for i, k in enumerate(forward) if backward[k] == i]
    return [(i, k) for i, k in pairs if set(impulses[i].names) & set(others[k].names)]


def find_nearest(times: Array, sorted_times: Array) -> Indices:
    """Return for each instant the index of the nearest among sorted instants."""
    next_index = np.clip(np.searchsorted(sorted_times, times), 1, max(len(sorted_times) - 1, 1))
    is_before = np.abs(times - sorted_times[next_index - 1]) <= np.abs(
        sorted_times[np.minimum(next_index, len(sorted_times) - 1)] - times
    )
    return np.where(is_before, next_index - 1, np.minimum(next_index, len(sorted_times) - 1))


def is_between_impulses(runs: Sequence[Trajectory], times: Array) -> Mask:
    """Return which instants lie between the first run's impulse and another run's same one, (n,).

    One run reaches the impulse later by the error of the motion. In between, the velocities differ by the jump, which
    is no error of either run.
    """
    inside = np.zeros(len(times), dtype=bool)
    impulses = runs[0].impulse_events
    for other in runs[1:]:
        for i, k in match_impulses(impulses, other.impulse_events):
            first, last = sorted((impulses[i].time, other.impulse_events[k].time))
            if first < last:
                inside |= (times >= first) & (times <= last)
    return inside
