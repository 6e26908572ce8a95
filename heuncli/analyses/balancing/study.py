"""Balance a scene over a cycle: orders of the mass effects, counterweights that reduce them, and a flywheel."""

from __future__ import annotations

import math

import numpy as np

from heuncli.analyses.balancing.cycle import (
    Cycle,
    MassEffects,
    compute_mass_effects,
    find_cycle_axis,
    make_followed_scene,
    scale_to_unit_rate,
)
from heuncli.analyses.balancing.cycle_nodes import PieceNodes
from heuncli.analyses.balancing.cycle_plan import CyclePlan, describe_cam_assumptions, plan_cycle
from heuncli.analyses.balancing.orders import CycleRotation, magnitudes
from heuncli.analyses.balancing.piece_resolver import CycleResolver, make_empty_nodes, make_scales
from heuncli.analyses.balancing.results import DEFAULT_OPTIONS, BalanceOptions, BalanceResults, Period
from heuncli.analyses.balancing.sampling import compute_vector_magnitudes, is_requested, make_results, sample_cycle
from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.bodies import make_body_states
from heuncli.multibody.coupled_start.prepare_coupled import prepare_coupled
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.options import Options
from heuncli.study.model.setup import attach_locations, build_with_cuts
from heuncli.study.queries.measure_uncertainty import find_search_error
from heuncli.study.queries.study import Study
from heuncli.study.solve.history import resample
from heuncli.study.workflow import solve


def balance(spec: Spec, options: BalanceOptions = DEFAULT_OPTIONS) -> BalanceResults:
    """Return the balance of a spec. Raises SpecError; SolveError [no-cycle] if it has no cycle."""
    with attach_locations(spec):
        return compute_balance(spec, options)


def compute_balance(spec: Spec, options: BalanceOptions) -> BalanceResults:
    """Return the balance of a spec. Errors name bodies, joints and sections, but not their location in the file."""
    reference_point = options.about if options.about is not None else np.array(spec.foundation.about or (0.0, 0.0, 0.0))
    if options.period is not None:
        return balance_over_period(spec, options.period, options, reference_point)
    scene = assemble_scene(spec)
    plan = plan_cycle(scene, options.cycle, options.turns, options.rate)
    followed_scene = make_followed_scene(scene, plan)
    cycle, is_resolved = sample_cycle(followed_scene, reference_point)
    effects = compute_mass_effects(cycle, reference_point)
    rotation = CycleRotation(plan.turns, find_cycle_axis(cycle, plan.joint), plan.rate)
    results = replace(
        make_results(spec, plan.coordinate, rotation, effects, reference_point, options), is_resolved=is_resolved
    )
    results = replace(results, notes=(*results.notes, *describe_cam_assumptions(scene.mechanism)))
    results = add_load_torque(results, spec, scene, plan, options)
    if options.weights:
        from heuncli.analyses.balancing.counterweights import find_counterbalance  # where they are asked for

        counterbalance = find_counterbalance(spec, scene, plan, cycle, reference_point, options)
        results = replace(
            results, counterbalance=counterbalance, notes=tuple(dict.fromkeys((*results.notes, *counterbalance.notes)))
        )
    if options.flywheel is not None:
        from heuncli.analyses.balancing.flywheel import add_flywheel  # where one is asked for

        results = add_flywheel(results, spec, scene, plan, options.flywheel)
    return results


def add_load_torque(
    results: BalanceResults, spec: Spec, scene: PreparedScene, plan: CyclePlan, options: BalanceOptions
) -> BalanceResults:
    """Add the orders of the torque that loads exert on the shaft, if loads act on it."""
    if not scene.mechanism.loads and not scene.mechanism.gravity.any():
        return results
    from heuncli.analyses.balancing.loaded_scene import compute_load_torque  # with all that solves loads

    torque = compute_load_torque(spec, scene, plan, options.orders)
    results = replace(results, notes=(*results.notes, *torque.notes))
    if not torque.rows:
        return results
    rows = tuple(row for row in torque.rows if options.orders is None or is_requested(row.order, options.orders))
    means, errors = {**results.mean, "load": torque.mean}, {**results.mean_error, "load": torque.error}
    return replace(results, orders={**results.orders, "load": rows}, mean=means, mean_error=errors)


def assemble_scene(spec: Spec) -> PreparedScene:
    """Assemble the scene in the pose of its first instant, without its sections."""
    mechanism, _ = build_with_cuts(spec._replace(sections={}))
    t = spec.analysis.times[0] if spec.analysis.type == "state" and spec.analysis.times else 0.0
    return prepare_coupled(mechanism, t)


PROBLEM_CODE = "no-period"
KINDS = ("force", "moment")
FIRST_SAMPLES = 8  # instants for the size of the terms of force and moment


@record
class TwoPeriods:
    """The last two periods of a motion.

    begin [s]: start of the last period
    reference_point (3,): where moments are taken
    """

    study: Study
    seconds: float
    begin: float
    reference_point: Array

    @property
    def rate(self) -> float:
        """Rate of the angle 2π t/T [rad/s]."""
        return 2.0 * math.pi / self.seconds

    @property
    def cycle(self) -> PieceNodes:
        """The period as a cycle of that angle, not yet divided into pieces."""
        return make_empty_nodes(self.rate * self.begin, 1)

    def compute_effects(self, nodes: PieceNodes, x: Array, previous_period: bool = False) -> MassEffects:
        """Return the mass effects at ascending places of the period (n,).

        previous_period: in the period before the last
        """
        scene, history = self.study.setup.scene, self.study.history
        times = self.begin + x / self.rate - (self.seconds if previous_period else 0.0)
        times = np.clip(times, 0.0, float(history.times[-1]))
        states = make_body_states(scene.layout, resample(self.study.setup.runner, history, times))
        return compute_mass_effects(
            Cycle(scene.mechanism, nodes, scale_to_unit_rate(states, self.rate), scene.layout.size),
            self.reference_point,
        )

    def find_places(self, times: Array) -> Array:
        """Return the ascending places of times (n,) in both periods."""
        last = times[times > self.begin]
        previous = times[(times > self.begin - self.seconds) & (times < self.begin)] + self.seconds
        return np.asarray(np.unique((np.concatenate([last, previous]) - self.begin) * self.rate))

    def make_nodes(self) -> tuple[PieceNodes, bool]:
        """Return nodes on pieces that resolve both periods, and whether they do."""

        def sample(x: Array) -> Array:
            """Return the effects at places, with both limits where they jump."""
            both = [self.compute_effects(self.cycle, x, before) for before in (False, True)]
            return np.concatenate([own.reshape(len(x), -1) for two in both for own in sum_bodies(two).values()], axis=1)

        terms = self.compute_effects(self.cycle, np.linspace(0.0, self.cycle.length, FIRST_SAMPLES)).terms
        rounding = [tolerances.SUM_ROUNDING * terms[name] for name in KINDS]
        resolver = CycleResolver(sample, self.cycle, make_scales([3, 3, 3, 3], [*rounding, *rounding]))
        resolver.resolve(self.find_places(np.array(self.study.history.jumps)))
        resolver.probe(self.find_places(self.study.find_close_times()[0]))
        resolved = resolver.collect_numbers()
        return resolved.nodes, resolved.is_resolved


def balance_over_period(spec: Spec, seconds: float, options: BalanceOptions, reference_point: Array) -> BalanceResults:
    """Compute the orders in time. Raises SolveError [no-period] if the motion is too short or does not repeat."""
    study = solve_motion(spec, seconds)
    periods = TwoPeriods(study, seconds, float(study.history.times[-1]) - seconds, reference_point)
    nodes, settled = periods.make_nodes()
    last, previous = (periods.compute_effects(nodes, nodes.places, is_previous) for is_previous in (False, True))
    previous_sums, last_sums = sum_bodies(previous), sum_bodies(last)
    differences = {
        name: compute_difference(nodes, previous_sums[name], last_sums[name], last.terms[name]) for name in KINDS
    }
    largest_difference = max(residual.relative for residual in differences.values())
    if largest_difference > tolerances.SAME_PERIOD:
        message = f"--period {seconds:g} s: the last two periods differ by {largest_difference:.1g} of the mean"
        hint = "another period; or a longer motion that has settled: --set analysis.duration=..."
        raise SolveError(Problem(PROBLEM_CODE, message, hint=hint))
    scale = periods.rate**2
    found = {name: find_search_error(study, ("foundation", "mass_effect", name)) for name in KINDS}
    stated_errors = {name: np.nan_to_num(error) for name, error in found.items()}
    noise = {name: scale * differences[name].orders + float(stated_errors[name]) for name in KINDS}
    results = make_results(
        spec, "time", CycleRotation(1, None, periods.rate), last, reference_point, options, noise | {"torque": math.inf}
    )
    return replace(
        results,
        is_resolved=settled,
        period=Period(seconds, largest_difference),
        orders={name: rows for name, rows in results.orders.items() if name != "torque"},
        summaries={name: words for name, words in results.summaries.items() if name != "torque"},
        mean={name: value for name, value in results.mean.items() if name != "torque"},
        mean_error={name: value for name, value in results.mean_error.items() if name != "torque"},
        residual={
            name: replace(residual, error=residual.error + scale * differences[name.partition("_")[0]].peak)
            for name, residual in results.residual.items()
            if name != "torque"
        },
    )


def solve_motion(spec: Spec, seconds: float) -> Study:
    """Return the motion of at least two periods. Raises SolveError [no-period]."""
    analysis = spec.analysis
    if analysis.type != "motion" or analysis.duration is None:
        message = f"--period needs a motion, this analysis has type: {analysis.type}"
        raise SolveError(Problem(PROBLEM_CODE, message, hint="give analysis.duration"))
    if analysis.duration < 2.0 * seconds:
        message = f"--period {seconds:g} s: the motion lasts {analysis.duration:g} s, less than two periods"
        raise SolveError(Problem(PROBLEM_CODE, message, hint=f"--set analysis.duration={2.0 * seconds:g}, or more"))
    begin = analysis.duration - 2.0 * seconds
    times = sorted({0.0, max(begin, 0.0), analysis.duration - seconds, analysis.duration})
    study = solve(spec._replace(analysis=analysis._replace(times=tuple(times)), sections={}), Options())
    end = float(study.history.times[-1])
    if end < analysis.duration:
        message = f"--period {seconds:g} s: the motion ends at t = {end:g} s"
        raise SolveError(Problem(PROBLEM_CODE, message, hint="remove what ends it"))
    horizon = study.results.horizon
    if horizon is not None:
        message = f"--period {seconds:g} s: this motion is not reliable from t = {horizon:.4g} s on"
        raise SolveError(Problem(PROBLEM_CODE, message, hint="a smaller analysis.tolerance, or a shorter motion"))
    blows = [blow for blow in study.history.impulses if blow.time >= begin]
    if blows:
        message = f"--period {seconds:g} s: impulse or impact at t = {blows[-1].time:g} s: it has no orders"
        raise SolveError(Problem(PROBLEM_CODE, message, hint="soften it with a spring, or leave it out"))
    return study


def sum_bodies(effects: MassEffects) -> dict[str, Array]:
    """Return force and moment at unit rate, (n, 3)."""
    return {"force": effects.force.sum(axis=1), "moment": effects.moment.sum(axis=1)}


@record
class PeriodDifference:
    """Difference of two periods: relative to the mean magnitude, bound for any order, and of the peaks."""

    relative: float
    orders: float
    peak: float


def compute_difference(nodes: PieceNodes, previous: Array, last: Array, terms: float) -> PeriodDifference:
    """Return the difference of vectors (n, 3) in two periods; zero if there is only rounding of their terms."""
    mean = float(nodes.weights @ magnitudes(last))
    if mean <= tolerances.SUM_ROUNDING * terms:
        return PeriodDifference(0.0, 0.0, 0.0)
    mean_difference = float(nodes.weights @ magnitudes(last - previous))
    peaks = compute_vector_magnitudes({"last": last, "before": previous}, nodes)
    return PeriodDifference(
        mean_difference / mean, 2.0 * mean_difference, abs(peaks["last"].peak - peaks["before"].peak)
    )
