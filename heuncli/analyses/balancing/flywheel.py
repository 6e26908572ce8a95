"""How uniformly a machine runs under its own loads, and the flywheel that reduces its unevenness.
    ½ (ε(φ) + J) ω² = E0 + W(φ),   W = ∫ k dφ,   k the power of the loads and the weight at unit rate
    δ = (ω_max - ω_min)/ω_m,       ω_m = angle of the cycle / its time
ε is the machine's own reduced inertia, which varies with φ. W must be periodic, so a constant torque is added if the
loads do net work over the cycle. E0 follows from ω_m, and J from δ, each by bracketing. The textbook's J is ΔE/(δ ω_m²)
minus the inertia that turns uniformly with the shaft, where ΔE is the range of W - ½ ε ω_m², the work of loads and
inertia in the turning-moment diagram at a constant rate.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from heuncli.analyses.balancing.cycle import Cycle, compute_mass_effects
from heuncli.analyses.balancing.cycle_plan import CyclePlan
from heuncli.analyses.balancing.loaded_scene import (
    CycleNumbers,
    LoadedScene,
    estimate_power_rounding,
    make_loaded_scene,
    sum_load_powers,
)
from heuncli.analyses.balancing.results import BalanceResults, Flywheel, FlywheelRequest
from heuncli.analyses.balancing.series import evaluate_legendre
from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record, replace
from heuncli.multibody.mechanism.loads import Load
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.recovery import Recovery

MIN_INTERVALS_PER_TURN = 1080  # intervals per turn, at least; on each, extremes are those of a cubic
MIN_INTERVALS_PER_PIECE = 8  # of a piece
HALVINGS = 2  # of pieces, for the time of a cycle: its integrand is steep where the rate nearly vanishes
RATES = frozenset({"rate", "speed", "vx", "vy", "vz"})
MAX_CHORD_STEPS = 200
NEWTON_STEPS, REFINEMENT_STEPS = 4, 3


@record
class WorkCurve:
    """Work, reduced inertia and their derivatives along a cycle, piece after piece with both ends of each, (m,).

    x (m,): places in the cycle
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
        """Return ω along the cycle [rad/s], (m,); 0 where the energy does not suffice."""
        return np.asarray(np.sqrt(2.0 * np.maximum(E0 + self.W, 0.0) / (self.eps + J)))

    def mean_rate(self, E0: float, J: float) -> float:
        """Return the mean rate: the angle of the cycle divided by its time."""
        w = np.sqrt(2.0 * np.maximum(E0 + self.W_nodes, 0.0) / (self.eps_nodes + J))
        with np.errstate(divide="ignore"):
            return float(1.0 / (self.weights @ (1.0 / w)))

    def find_initial_energy(self, mean: float, J: float) -> float:
        """Return the initial energy E0 that gives this mean rate."""
        low = -float(self.W.min())
        high = float(np.ptp(self.W)) + (float(self.eps.max()) + J) * mean**2 + low
        return find_root(lambda E0: self.mean_rate(E0, J) - mean, low, high)

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
    fl, fh = f(low), f(high)
    for _ in range(MAX_CHORD_STEPS):
        x = (low * fh - high * fl) / (fh - fl)
        fx = f(x)
        if fx == 0.0 or abs(high - low) <= 4.0 * tolerances.EPS * abs(high):
            return x
        if fx * fh < 0.0:
            low, fl = high, fh
        else:
            fl *= 0.5
        if abs(x - high) <= 2.0 * tolerances.EPS * abs(x):
            return x
        high, fh = x, fx
    return high


def find_flywheel(scene: LoadedScene, joint: str, mean: float, delta: float) -> Flywheel:
    """Find the flywheel on the cycle's shaft for the unevenness `delta`.

    scene: with its loads, at unit rate

    Raises SolveError [no-flywheel] for loads that the pose does not determine.
    """
    require_position_loads(scene.setup.scene.mechanism)
    numbers = compute_wheel_numbers(scene)
    course, constant_torque, work_errors = make_work_curve(numbers, len(scene.setup.scene.mechanism.bodies))
    energy, mean_inertia = course.find_energy_range(mean), float(course.weights @ course.eps_nodes)
    present = course.compute_unevenness(mean, 0.0)
    added = find_added_inertia(course, mean, delta, energy) if present > delta else 0.0
    slowest, fastest = course.find_rate_extremes(mean, added)
    E0 = course.find_initial_energy(mean, added)
    start = float(course.compute_rates(E0, added)[0])
    textbook = energy / (delta * mean**2) - course.steady
    errors = estimate_errors(work_errors, mean, delta, energy, mean_inertia + added, present)
    return Flywheel(
        joint,
        delta,
        present,
        mean,
        energy,
        mean_inertia,
        added,
        textbook,
        constant_torque,
        start,
        fastest,
        slowest,
        errors,
        numbers.notes,
    )


def find_added_inertia(course: WorkCurve, mean: float, delta: float, energy: float) -> float:
    """Find the inertia J of the flywheel that a machine with a larger unevenness needs [kg m2].

    energy [J]: ΔE

    Raises SolveError [no-flywheel] if it is too large for a number.
    """
    upper_inertia = energy / (delta * mean**2) + float(course.eps.max())
    while math.isfinite(upper_inertia) and course.compute_unevenness(mean, upper_inertia) > delta:
        upper_inertia *= 2.0
    if not math.isfinite(upper_inertia):
        message = f"no flywheel has a speed fluctuation of {delta:g} at a mean speed of {mean:.3g} rad/s"
        raise SolveError(Problem("no-flywheel", message, hint="choose a higher --rate"))
    return find_root(lambda J: delta - course.compute_unevenness(mean, J), 0.0, upper_inertia)


def require_resolved_unevenness(delta: float) -> None:
    """Raise SolveError [no-flywheel] for an unevenness that rounding of the rates hides."""
    if delta < tolerances.EVEN_RATE:
        message = f"--flywheel {delta:g}: so small a speed fluctuation is hidden by the rounding of the speeds"
        raise SolveError(Problem("no-flywheel", message, hint=f"at least {tolerances.EVEN_RATE:g}"))


class WorkErrors(NamedTuple):
    """Errors of the constant torque, the work and the reduced inertia."""

    constant_torque: float
    work: float
    inertia: float


def estimate_errors(
    work_errors: WorkErrors, mean: float, delta: float, energy: float, inertia: float, present: float
) -> dict[str, float]:
    """Estimate the errors of a flywheel's results from ΔE = ∫k - ½ ε ω² and J + ε = ΔE/(δ ω²), to which all are
    proportional. That of J is at least the rounding of δ, a difference of two rates.
    """
    energy_error = 2.0 * (work_errors.work + 0.5 * work_errors.inertia * mean**2)
    relative_error = energy_error / energy if energy > 0.0 else 0.0
    rate_error = energy_error / (inertia * mean) if inertia > 0.0 else 0.0
    return {
        "energy": energy_error,
        "even": work_errors.constant_torque,
        "own": work_errors.inertia,
        "present": present * relative_error,
        "added": inertia * max(relative_error, tolerances.EPS / delta) + work_errors.inertia,
        "textbook": energy_error / (delta * mean**2) + work_errors.inertia,
        "start": rate_error,
        "fastest": rate_error,
        "slowest": rate_error,
    }


def compute_wheel_numbers(scene: LoadedScene) -> CycleNumbers:
    """Compute the power of loads and weight, the bodies' reduced inertia and half its derivative over the cycle."""
    mechanism, size = scene.setup.scene.mechanism, scene.setup.scene.layout.size

    def compute_columns(recovery: Recovery) -> Array:
        """Compute the columns that the interpolation needs: power of the loads, inertia and half its slope."""
        effects = compute_mass_effects(Cycle(mechanism, scene.followed_run.cycle, recovery.states, size), np.zeros(3))
        return np.concatenate([sum_load_powers(recovery), effects.eps, effects.half_slope], axis=1)

    bodies, first = len(mechanism.bodies), scene.recover_samples()
    effects = compute_mass_effects(Cycle(mechanism, scene.followed_run.cycle, first.states, size), np.zeros(3))
    inertia_rounding = tolerances.SUM_ROUNDING * effects.terms["torque"]
    parts = [compute_columns(first).shape[1] - 2 * bodies, bodies, bodies]
    return scene.resolve_numbers(
        compute_columns, parts, [estimate_power_rounding(first), inertia_rounding, inertia_rounding]
    )


def choose_constant_torque(mean_torque: float, mean_magnitude: float) -> float:
    """Return the constant torque [N m] that closes a cycle; 0 if its loads balance to the digits of their data.

    mean_magnitude: mean of |torque|
    """
    return 0.0 if abs(mean_torque) <= tolerances.NO_NET_WORK * mean_magnitude else -mean_torque


def make_work_curve(numbers: CycleNumbers, bodies: int) -> tuple[WorkCurve, float, WorkErrors]:
    """Return the work curve of a cycle, the constant torque [N m] that closes it (0 if below rounding of the data), and
    its errors.
    """
    nodes, values = numbers.nodes, numbers.values
    body_eps, body_slopes = values[:, -2 * bodies : -bodies], values[:, -bodies:]
    k, eps, slope = values[:, : -2 * bodies].sum(axis=1), body_eps.sum(axis=1), body_slopes.sum(axis=1)
    mean_torque, mean_magnitude = float(nodes.weights @ k), float(nodes.weights @ np.abs(k))
    constant_torque = choose_constant_torque(mean_torque, mean_magnitude)
    columns = np.stack([k - mean_torque, eps, slope], axis=1)
    coefficients = nodes.compute_coefficients(columns)
    work = nodes.integrate(coefficients[:, :, :1])
    parts = np.maximum(
        np.ceil((nodes.ends - nodes.begins) * MIN_INTERVALS_PER_TURN * nodes.turns / nodes.length),
        MIN_INTERVALS_PER_PIECE,
    )
    piece = np.repeat(np.arange(len(parts)), parts.astype(int) + 1)
    share = np.concatenate([np.arange(n + 1) / n for n in parts])
    x = nodes.begins[piece] + share * (nodes.ends - nodes.begins)[piece]
    P = evaluate_legendre(2.0 * share - 1.0, coefficients.shape[1] + 1)
    W = np.einsum("mn,mn->m", P, work[piece][:, :, 0])
    interpolated = np.einsum("mn,mnc->mc", P[:, :-1], coefficients[piece])
    finer = nodes.halve_pieces(HALVINGS)
    errors = nodes.estimate_errors(columns)
    rounding = tolerances.SUM_ROUNDING * float(np.abs(W).max())
    work_errors = WorkErrors(
        float(errors.order[0]), 0.5 * nodes.length * float(errors.order[0]) + rounding, float(errors.value[1])
    )
    is_constant = np.ptp(body_eps, axis=0) <= tolerances.SAME_VALUE * body_eps.max()
    curve = WorkCurve(
        x,
        W,
        interpolated[:, 0],
        interpolated[:, 1],
        interpolated[:, 2],
        finer.weights,
        nodes.evaluate(work, finer.places)[:, 0],
        nodes.evaluate(coefficients, finer.places)[:, 1],
        float(body_eps[0, is_constant].sum()),
        lambda at: (nodes.evaluate(work, at)[:, 0], *nodes.evaluate(coefficients, at).T),
    )
    return curve, constant_torque, work_errors


def require_position_loads(mechanism: Mechanism) -> None:
    """Raise SolveError [no-flywheel] for loads that depend on rates or time: the angle does not determine their
    work.
    """
    found = dict.fromkeys((load.path, why) for load in mechanism.loads for why in iter_dependence_reasons(load))
    hint = "leave it out of the model, or run the motion with the flywheel in it"
    if found:
        raise SolveError(*(
            Problem("no-flywheel", f"{name} {why}: the angle does not determine its work over a cycle", hint=hint,
                    entry_path=name)
            for name, why in found
        ))  # fmt: skip


def iter_dependence_reasons(load: Load) -> Iterator[str]:
    """Yield the reasons why the pose does not determine the work of a load; none if it does."""
    if load.row.opposed_motion is not None:
        yield f"depends on {load.row.opposed_motion}"
    if load.row.has_potential and load.is_damped:
        yield "has damping"
    if any(value.time_dependent for value in load.values):
        yield "depends on t"
    if any(quantity in RATES for value in load.values for _, quantity in value.uses):
        yield "depends on a rate"


def add_flywheel(
    results: BalanceResults, spec: Spec, scene: PreparedScene, plan: CyclePlan, request: FlywheelRequest
) -> BalanceResults:
    """Return the results with the requested flywheel. Raises SolveError [no-flywheel]."""
    wheel = find_requested_flywheel(spec, scene, plan, request)
    notes = (*results.notes, *describe_flywheel(wheel), *wheel.notes)
    return replace(results, flywheel=wheel, notes=tuple(dict.fromkeys(notes)))


def find_requested_flywheel(spec: Spec, scene: PreparedScene, plan: CyclePlan, request: FlywheelRequest) -> Flywheel:
    """Find the flywheel on the cycle's shaft. Raises SolveError [no-flywheel]."""
    if request.joint not in ("", plan.joint):
        message = f"--flywheel {request.joint}: a flywheel is sized only for the shaft of the cycle, {plan.joint}"
        raise SolveError(
            Problem("no-flywheel", message, hint=f"--cycle {request.joint}, or --flywheel {plan.joint}=1%")
        )
    if plan.in_time:
        message = "no flywheel for a model with several drives: they prescribe every speed"
        raise SolveError(Problem("no-flywheel", message, hint="leave out the drives that the flywheel is to replace"))
    if plan.rate is None:
        message = "the mean speed of the machine is not known"
        raise SolveError(Problem("no-flywheel", message, hint="for example --rate 1500rpm"))
    require_resolved_unevenness(request.delta)
    require_position_loads(scene.mechanism)
    loaded_scene = make_loaded_scene(spec, scene, scene.mechanism, replace(plan, rate=1.0), 1.0)
    return find_flywheel(loaded_scene, plan.joint, abs(plan.rate), request.delta)


def describe_flywheel(wheel: Flywheel) -> tuple[str, ...]:
    """Return the notes on a flywheel."""
    notes = []
    if wheel.even:
        notes.append(
            f"the loads do net work over the cycle: the flywheel is sized with a constant torque of "
            f"{wheel.even:.6g} N·m on {wheel.joint} that balances it"
        )
    if wheel.added == 0.0:
        notes.append(f"no flywheel needed: the speed fluctuation is {wheel.present:.4g} without one")
    return tuple(notes)
