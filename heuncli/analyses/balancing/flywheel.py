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
from collections.abc import Iterator

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
from heuncli.analyses.balancing.work_curve import WorkCurve, WorkErrors, find_root, make_work_curve
from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import replace
from heuncli.multibody.mechanism.loads import Load
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.recovery import Recovery

RATES = frozenset({"rate", "speed", "vx", "vy", "vz"})  # quantities of expressions that are rates


def find_flywheel(scene: LoadedScene, joint: str, mean: float, delta: float) -> Flywheel:
    """Find the flywheel on the cycle's shaft for the unevenness `delta`.

    scene: with its loads, at unit rate

    Raises SolveError [no-flywheel] for loads that the pose does not determine.
    """
    require_position_loads(scene.setup.scene.mechanism)
    numbers = compute_wheel_numbers(scene)
    curve, constant_torque, work_errors = make_work_curve(numbers, len(scene.setup.scene.mechanism.bodies))
    energy, mean_inertia = curve.find_energy_range(mean), float(curve.weights @ curve.eps_nodes)
    present = curve.compute_unevenness(mean, 0.0)
    added = find_added_inertia(curve, mean, delta, energy) if present > delta else 0.0
    slowest, fastest = curve.find_rate_extremes(mean, added)
    E0 = curve.find_initial_energy(mean, added)
    return Flywheel(
        joint=joint,
        delta=delta,
        present=present,  # unevenness without a flywheel
        mean_rate=mean,
        energy=energy,
        own=mean_inertia,  # mean inertia of the machine itself
        added=added,
        textbook=energy / (delta * mean**2) - curve.steady,
        even=constant_torque,  # added so that the cycle closes
        start=float(curve.compute_rates(E0, added)[0]),
        fastest=fastest,
        slowest=slowest,
        error=estimate_errors(work_errors, mean, delta, energy, mean_inertia + added, present),
        notes=numbers.notes,
    )


def find_added_inertia(curve: WorkCurve, mean: float, delta: float, energy: float) -> float:
    """Find the inertia J of the flywheel that a machine with a larger unevenness needs [kg m2].

    energy [J]: ΔE

    Raises SolveError [no-flywheel] if it is too large for a number.
    """
    upper_inertia = energy / (delta * mean**2) + float(curve.eps.max())
    while math.isfinite(upper_inertia) and curve.compute_unevenness(mean, upper_inertia) > delta:
        upper_inertia *= 2.0
    if not math.isfinite(upper_inertia):
        message = f"no flywheel has a speed fluctuation of {delta:g} at a mean speed of {mean:.3g} rad/s"
        raise SolveError(Problem("no-flywheel", message, hint="choose a higher --rate"))
    return find_root(lambda J: delta - curve.compute_unevenness(mean, J), 0.0, upper_inertia)


def require_resolved_unevenness(delta: float) -> None:
    """Raise SolveError [no-flywheel] for an unevenness that rounding of the rates hides."""
    if delta < tolerances.EVEN_RATE:
        message = f"--flywheel {delta:g}: so small a speed fluctuation is hidden by the rounding of the speeds"
        raise SolveError(Problem("no-flywheel", message, hint=f"at least {tolerances.EVEN_RATE:g}"))


def estimate_errors(
    work_errors: WorkErrors, mean: float, delta: float, energy: float, inertia: float, present: float
) -> dict[str, float]:
    """Estimate the errors of a flywheel's results by propagating that of ΔE = ∫k - ½ ε ω² through
    J + ε = ΔE/(δ ω²). That of J is at least the rounding of δ, a difference of two rates.
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
    # Columns of powers; the last 2 x bodies are inertia and half its slope.
    parts = [compute_columns(first).shape[1] - 2 * bodies, bodies, bodies]
    return scene.resolve_numbers(
        compute_columns, parts, [estimate_power_rounding(first), inertia_rounding, inertia_rounding]
    )


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
