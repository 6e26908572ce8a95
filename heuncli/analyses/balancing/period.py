"""`--period T`: orders of time, of a motion that comes back with a period where no angle tells its cycle.

    F(t) = sum F_k cos(2π k t/T - phase_k),     M(t) likewise,     over the last T of the motion
Force and moment of the masses ON the foundation, on pieces between what jumps in the last period or in the one before,
which is looked at beside it, T earlier: what the two differ by in the mean is told, and no order below it,
    |a_k - a_k'| <= 2/T ∫ |F(t) - F(t - T)| dt
so that a jump which comes a moment earlier counts by that moment.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.analyses.balancing.asked import BalanceOptions
from heuncli.analyses.balancing.cycle import Cycle, at_unit_rate
from heuncli.analyses.balancing.effects import MassEffects, mass_effects
from heuncli.analyses.balancing.nodes import PieceNodes
from heuncli.analyses.balancing.over_cycle import of_vectors
from heuncli.analyses.balancing.resolved import CycleResolver, of_a_cycle, scales_of
from heuncli.analyses.balancing.results import BalanceResults, Period
from heuncli.analyses.balancing.rows import CycleTurning, lengths
from heuncli.analyses.balancing.told import told
from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.bodies import body_states
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.ask.measure import stated_error
from heuncli.study.ask.study import Study
from heuncli.study.model.options import Options
from heuncli.study.solve.history import resample
from heuncli.study.workflow import solve

CODE = "no-period"
KINDS = ("force", "moment")
FEW = 8  # instants by which it is told what the terms are that force and moment are sums of


@record
class TwoPeriods:
    """The last period of a motion and the one before; begin [s]: of the last; about (3,): where moments are taken."""

    study: Study
    seconds: float
    begin: float
    about: Array

    @property
    def rate(self) -> float:
        """The angle 2π t/T by the time [rad/s]."""
        return 2.0 * math.pi / self.seconds

    @property
    def cycle(self) -> PieceNodes:
        """The period as a cycle of that angle, without pieces yet."""
        return of_a_cycle(self.rate * self.begin, 1)

    def effects(self, nodes: PieceNodes, x: Array, before: bool = False) -> MassEffects:
        """At places of the period (n,), ascending; before: of the period before."""
        scene, history = self.study.setup.scene, self.study.history
        times = self.begin + x / self.rate - (self.seconds if before else 0.0)
        times = np.clip(times, 0.0, float(history.times[-1]))
        states = body_states(scene.layout, resample(self.study.setup.runner, history, times))
        return mass_effects(
            Cycle(scene.mechanism, nodes, at_unit_rate(states, self.rate), scene.layout.size), self.about
        )

    def places(self, times: Array) -> Array:
        """The places of instants (n,) of both periods, ascending."""
        last = times[times > self.begin]
        before = times[(times > self.begin - self.seconds) & (times < self.begin)] + self.seconds
        return np.asarray(np.unique((np.concatenate([last, before]) - self.begin) * self.rate))

    def nodes(self) -> tuple[PieceNodes, bool]:
        """Nodes on pieces that tell both periods, and whether they do."""

        def sample(x: Array) -> Array:
            both = [self.effects(self.cycle, x, before) for before in (False, True)]
            return np.concatenate([own.reshape(len(x), -1) for two in both for own in sums(two).values()], axis=1)

        terms = self.effects(self.cycle, np.linspace(0.0, self.cycle.length, FEW)).terms
        rounding = [tolerances.SUM_ROUNDING * terms[name] for name in KINDS]
        resolver = CycleResolver(sample, self.cycle, scales_of([3, 3, 3, 3], [*rounding, *rounding]))
        resolver.resolve(self.places(np.array(self.study.history.jumps)))
        resolver.probed(self.places(self.study.close_times()[0]))
        found = resolver.found()
        return found.nodes, found.settled


def over_period(spec: Spec, seconds: float, asked: BalanceOptions, about: Array) -> BalanceResults:
    """The orders of time. Raises SolveError where there is no motion of two periods, or it does not come back."""
    study = moved(spec, seconds)
    both = TwoPeriods(study, seconds, float(study.history.times[-1]) - seconds, about)
    nodes, settled = both.nodes()
    last, before = (both.effects(nodes, nodes.places, which) for which in (False, True))
    one, two = sums(before), sums(last)
    off = {name: difference(nodes, one[name], two[name], last.terms[name]) for name in KINDS}
    most = max(own.part for own in off.values())
    if most > tolerances.COMES_BACK:
        message = f"--period {seconds:g} s: the last period and the one before differ by {most:.1g} of the mean"
        hint = "another period; or a longer motion, until it has settled: --set analysis.duration=..."
        raise SolveError(Problem(CODE, message, hint=hint))
    scale = both.rate**2
    stated = {name: np.nan_to_num(stated_error(study, ("foundation", "mass_effect", name))) for name in KINDS}
    noise = {name: scale * off[name].orders + float(stated[name]) for name in KINDS}
    found = told(spec, "time", CycleTurning(1, None, both.rate), last, about, asked, noise | {"torque": math.inf})
    return replace(
        found,
        settled=settled,
        period=Period(seconds, most),
        orders={name: rows for name, rows in found.orders.items() if name != "torque"},
        words={name: words for name, words in found.words.items() if name != "torque"},
        mean={name: value for name, value in found.mean.items() if name != "torque"},
        mean_error={name: value for name, value in found.mean_error.items() if name != "torque"},
        residual={
            name: replace(own, error=own.error + scale * off[name.partition("_")[0]].peak)
            for name, own in found.residual.items()
            if name != "torque"
        },
    )


def moved(spec: Spec, seconds: float) -> Study:
    """The motion of at least two periods. Raises SolveError."""
    analysis = spec.analysis
    if analysis.type != "motion" or analysis.duration is None:
        message = f"--period is of a motion, and this analysis is none (type: {analysis.type})"
        raise SolveError(Problem(CODE, message, hint="give analysis.duration"))
    if analysis.duration < 2.0 * seconds:
        message = f"--period {seconds:g} s: the motion takes {analysis.duration:g} s, less than two of them"
        raise SolveError(Problem(CODE, message, hint=f"--set analysis.duration={2.0 * seconds:g}, or more"))
    begin = analysis.duration - 2.0 * seconds
    times = sorted({0.0, max(begin, 0.0), analysis.duration - seconds, analysis.duration})
    study = solve(spec._replace(analysis=analysis._replace(times=tuple(times)), sections={}), Options())
    end = float(study.history.times[-1])
    if end < analysis.duration:
        message = f"--period {seconds:g} s: the motion ends at t = {end:g} s"
        raise SolveError(Problem(CODE, message, hint="leave out what ends it"))
    horizon = study.results.horizon
    if horizon is not None:
        message = f"--period {seconds:g} s: from t = {horizon:.4g} s on nothing is claimed of this motion"
        raise SolveError(Problem(CODE, message, hint="a smaller analysis.tolerance, or a shorter motion"))
    blows = [blow for blow in study.history.blows if blow.time >= begin]
    if blows:
        message = f"--period {seconds:g} s: something strikes at t = {blows[-1].time:g} s: a blow has no orders"
        raise SolveError(Problem(CODE, message, hint="soften it by a spring; or leave it out"))
    return study


def sums(effects: MassEffects) -> dict[str, Array]:
    """Force and moment at unit rate, (n, 3)."""
    return {"force": effects.force.sum(axis=1), "moment": effects.moment.sum(axis=1)}


@record
class PeriodDifference:
    """What two periods differ by: part of the mean magnitude, what orders may, and what the largest does."""

    part: float
    orders: float
    peak: float


def difference(nodes: PieceNodes, before: Array, last: Array, terms: float) -> PeriodDifference:
    """Of vectors (n, 3) in two periods; none where there is nothing but rounding of their terms."""
    mean = float(nodes.weights @ lengths(last))
    if mean <= tolerances.SUM_ROUNDING * terms:
        return PeriodDifference(0.0, 0.0, 0.0)
    apart = float(nodes.weights @ lengths(last - before))
    tops = of_vectors({"last": last, "before": before}, nodes)
    return PeriodDifference(apart / mean, 2.0 * apart, abs(tops["last"].peak - tops["before"].peak))
