"""The work of a cycle's loads and its reduced inertia along the cycle, and the rates of a machine that they determine.

The curve holds W and ε as polynomials on the cycle's pieces. Extremes of rate and energy are found between neighbouring
places: the cubic through their values and slopes tells where one lies, the polynomials refine it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from heuncli.analyses.balancing.cycle_nodes import PieceNodes
from heuncli.analyses.balancing.loaded_scene import CycleNumbers
from heuncli.analyses.balancing.series import evaluate_legendre
from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.results.results import Array, Indices

MIN_INTERVALS_PER_TURN = 1080  # intervals per turn, at least; on each, extremes are those of a cubic
MIN_INTERVALS_PER_PIECE = 8
HALVINGS = 2  # of pieces, for the time of a cycle: its integrand is steep where the rate nearly vanishes
MAX_CHORD_STEPS = 200  # of the method of chords
NEWTON_STEPS = 4  # towards the extreme of a cubic
REFINEMENT_STEPS = 3  # from there towards the extreme of the function itself


@record
class WorkCurve:
    """Work, reduced inertia and their derivatives along a cycle, piece after piece with both ends of each, (m,).

    x (m,): places in the cycle
    W, k, eps, half_slope (m,): work [J], its slope, reduced inertia ε [kg m2] and ½ε' there
    weights, W_nodes, eps_nodes (n,): quadrature nodes for the time of a cycle; the weights add up to 1
    steady [kg m2]: inertia of the bodies whose part of it is constant
    interpolate: function that gives W, k, ε and ½ε' at any places
    """

    x: Array
    W: Array
    k: Array
    eps: Array
    half_slope: Array
    weights: Array
    W_nodes: Array
    eps_nodes: Array
    steady: float
    interpolate: Callable[[Array], tuple[Array, Array, Array, Array]]

    def compute_rates(self, E0: float, J: float) -> Array:
        """Return ω along the cycle [rad/s], (m,); 0 where the energy does not suffice.

        E0 [J]: energy at the begin of the cycle
        J [kg m2]: inertia of the flywheel
        """
        return np.asarray(np.sqrt(2.0 * np.maximum(E0 + self.W, 0.0) / (self.eps + J)))

    def compute_mean_rate(self, E0: float, J: float) -> float:
        """Return the mean rate: the angle of the cycle divided by its time."""
        w = np.sqrt(2.0 * np.maximum(E0 + self.W_nodes, 0.0) / (self.eps_nodes + J))
        with np.errstate(divide="ignore"):
            return float(1.0 / (self.weights @ (1.0 / w)))

    def find_initial_energy(self, mean: float, J: float) -> float:
        """Return the initial energy E0 that gives this mean rate."""
        low = -float(self.W.min())
        high = float(np.ptp(self.W)) + (float(self.eps.max()) + J) * mean**2 + low
        return find_root(lambda E0: self.compute_mean_rate(E0, J) - mean, low, high)

    def find_rate_extremes(self, mean: float, J: float) -> tuple[float, float]:
        """Return the slowest and the fastest rate at a given mean rate."""
        E0 = self.find_initial_energy(mean, J)
        w = self.compute_rates(E0, J)
        if w.min() == 0.0:
            return 0.0, float(w.max())

        def evaluate_rate(x: Array) -> tuple[Array, Array]:
            """Return the speed at x and its slope."""
            W, k, eps, half = self.interpolate(x)
            rates = np.sqrt(2.0 * np.maximum(E0 + W, 0.0) / (eps + J))
            with np.errstate(divide="ignore", invalid="ignore"):
                return rates, (k - half * rates * rates) / (rates * (eps + J))

        return find_extremes(self.x, w, (self.k - self.half_slope * w * w) / (w * (self.eps + J)), evaluate_rate)

    def find_energy_range(self, mean: float) -> float:
        """Return ΔE [J], the range of the energy exchanged by work and inertia at a constant rate."""

        def evaluate_energy(x: Array) -> tuple[Array, Array]:
            """Return the energy that work and inertia exchange up to x, and its slope."""
            W, k, eps, half = self.interpolate(x)
            return W - 0.5 * eps * mean**2, k - half * mean**2

        energy = self.W - 0.5 * self.eps * mean**2
        low, high = find_extremes(self.x, energy, self.k - self.half_slope * mean**2, evaluate_energy)
        return high - low

    def compute_unevenness(self, mean: float, J: float) -> float:
        """Return δ with a flywheel of inertia J at a mean rate."""
        slowest, fastest = self.find_rate_extremes(mean, J)
        return (fastest - slowest) / mean


def find_extremes(
    x: Array, values: Array, slopes: Array, evaluate: Callable[[Array], tuple[Array, Array]]
) -> tuple[float, float]:
    """Find the smallest and the largest value of a function from its values and slopes at places (m,).

    Where the cubic through two neighbours has an extreme, `evaluate` (value and slope) refines it.
    """
    steps = np.maximum(np.diff(x), 0.0)
    p, q = steps * slopes[:-1], steps * slopes[1:]
    has_extreme = p * q < 0.0
    a, b, p, q = values[:-1][has_extreme], values[1:][has_extreme], p[has_extreme], q[has_extreme]
    begin, step = x[:-1][has_extreme], steps[has_extreme]
    # the cubic a + p s + c2 s² + c3 s³, s from 0 to 1 between neighbours
    c2, c3 = 3.0 * (b - a) - 2.0 * p - q, 2.0 * (a - b) + p + q
    s = p / (p - q)
    samples = [values]
    with np.errstate(divide="ignore", invalid="ignore"):
        for _ in range(NEWTON_STEPS):
            s = clip_fractions(s - (p + s * (2.0 * c2 + 3.0 * c3 * s)) / (2.0 * c2 + 6.0 * c3 * s), s)
        for _ in range(REFINEMENT_STEPS if len(s) else 0):
            value, slope = evaluate(begin + s * step)
            samples.append(value)
            s = clip_fractions(s - step * slope / (2.0 * c2 + 6.0 * c3 * s), s)
    all_values = np.concatenate(samples)
    return float(all_values.min()), float(all_values.max())


def clip_fractions(s: Array, previous: Array) -> Array:
    """Clip fractions to [0, 1]; replace those that are not finite by the previous ones."""
    return np.asarray(np.clip(np.where(np.isfinite(s), s, previous), 0.0, 1.0))


def find_root(f: Callable[[float], float], low: float, high: float) -> float:
    """Find the zero of a function with opposite signs at two places by the method of chords (Illinois)."""
    kept, latest = low, high  # the zero lies between them
    f_kept, f_latest = f(kept), f(latest)
    for _ in range(MAX_CHORD_STEPS):
        x = (kept * f_latest - latest * f_kept) / (f_latest - f_kept)
        f_x = f(x)
        if f_x == 0.0 or abs(latest - kept) <= 4.0 * tolerances.EPS * abs(latest):
            return x
        if f_x * f_latest < 0.0:
            kept, f_kept = latest, f_latest
        else:
            f_kept *= 0.5  # else the kept place would stay for ever
        if abs(x - latest) <= 2.0 * tolerances.EPS * abs(x):
            return x
        latest, f_latest = x, f_x
    return latest


class WorkErrors(NamedTuple):
    """Errors of the constant torque [N m], the work [J] and the reduced inertia [kg m2]."""

    constant_torque: float
    work: float
    inertia: float


class ClosedWork(NamedTuple):
    """The work curve of a cycle, closed by a constant torque [N m], which is 0 if the loads balance; their errors."""

    curve: WorkCurve
    constant_torque: float
    errors: WorkErrors


def choose_constant_torque(mean_torque: float, mean_magnitude: float) -> float:
    """Return the constant torque [N m] that closes a cycle; 0 if its loads balance to the digits of their data.

    mean_magnitude: mean of |torque|
    """
    return 0.0 if abs(mean_torque) <= tolerances.NO_NET_WORK * mean_magnitude else -mean_torque


def make_work_curve(numbers: CycleNumbers, body_count: int) -> ClosedWork:
    """Make the work curve of a cycle and find the constant torque that closes it.

    numbers: power of each load at unit rate; of each body its reduced inertia and half the slope of that
    """
    nodes, values = numbers.nodes, numbers.values
    body_eps, body_slopes = values[:, -2 * body_count : -body_count], values[:, -body_count:]
    k, eps, slope = values[:, : -2 * body_count].sum(axis=1), body_eps.sum(axis=1), body_slopes.sum(axis=1)
    mean_torque, mean_magnitude = float(nodes.weights @ k), float(nodes.weights @ np.abs(k))
    columns = np.stack([k - mean_torque, eps, slope], axis=1)
    coefficients = nodes.compute_coefficients(columns)
    work = nodes.integrate(coefficients[:, :, :1])
    piece, share = divide_pieces(nodes)
    P = evaluate_legendre(2.0 * share - 1.0, coefficients.shape[1] + 1)
    W = np.einsum("mn,mn->m", P, work[piece][:, :, 0])
    interpolated = np.einsum("mn,mnc->mc", P[:, :-1], coefficients[piece])
    finer = nodes.halve_pieces(HALVINGS)
    is_constant = np.ptp(body_eps, axis=0) <= tolerances.SAME_VALUE * body_eps.max()
    curve = WorkCurve(
        x=nodes.begins[piece] + share * (nodes.ends - nodes.begins)[piece],
        W=W,
        k=interpolated[:, 0],
        eps=interpolated[:, 1],
        half_slope=interpolated[:, 2],
        weights=finer.weights,
        W_nodes=nodes.evaluate(work, finer.places)[:, 0],
        eps_nodes=nodes.evaluate(coefficients, finer.places)[:, 1],
        steady=float(body_eps[0, is_constant].sum()),
        interpolate=lambda x: (nodes.evaluate(work, x)[:, 0], *nodes.evaluate(coefficients, x).T),
    )
    errors = nodes.estimate_errors(columns)
    torque_error, inertia_error = float(errors.order[0]), float(errors.value[1])
    rounding = tolerances.SUM_ROUNDING * float(np.abs(W).max())
    work_errors = WorkErrors(torque_error, 0.5 * nodes.length * torque_error + rounding, inertia_error)
    return ClosedWork(curve, choose_constant_torque(mean_torque, mean_magnitude), work_errors)


def divide_pieces(nodes: PieceNodes) -> tuple[Indices, Array]:
    """Divide each piece of a cycle into equal intervals: return the piece of their ends, both ends of a piece included,
    and the share of the piece before them, (m,) each.
    """
    counts = np.maximum(
        np.ceil((nodes.ends - nodes.begins) * MIN_INTERVALS_PER_TURN * nodes.turns / nodes.length),
        MIN_INTERVALS_PER_PIECE,
    )
    piece = np.repeat(np.arange(len(counts)), counts.astype(int) + 1)
    return piece, np.concatenate([np.arange(n + 1) / n for n in counts])
