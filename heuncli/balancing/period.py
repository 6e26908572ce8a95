"""`--period T`: orders of time, of a motion that comes back with a period where no angle tells its cycle.

    F(t) = sum F_k cos(2π k t/T - phase_k),     M(t) likewise,     over the last T of the motion
Force and moment of the masses ON the foundation. Whether they come back is seen by the period before: what the
two differ by is told, and no order below it.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli import tolerances
from heuncli.balancing.asked import BalanceOptions
from heuncli.balancing.cycle import QUARTER, Cycle, at_unit_rate
from heuncli.balancing.effects import MassEffects, mass_effects
from heuncli.balancing.harmonics import tail
from heuncli.balancing.results import BalanceResults, Period
from heuncli.balancing.rows import CycleTurning
from heuncli.balancing.told import told
from heuncli.errors import Problem, SolveError
from heuncli.integration.evaluator import Recovered
from heuncli.kinetostatics.bodies import BodyStates, body_states
from heuncli.records import fields, replace
from heuncli.results import Array, Indices
from heuncli.spec.models import Spec
from heuncli.study.ask.study import Study
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve

SAMPLES = 1024  # a period; kinks of contacts are seen at these
CODE = "no-period"


def over_period(spec: Spec, seconds: float, asked: BalanceOptions, about: Array) -> BalanceResults:
    """The orders of time. Raises SolveError where there is no motion of two periods, or it does not come back."""
    study = moved(spec, seconds)
    rate = 2.0 * math.pi / seconds
    before, last = (mass_effects(cycle, about) for cycle in cycles(study, seconds, rate))
    scale = rate**2
    off = difference(before, last)
    if off > tolerances.COMES_BACK:
        message = f"--period {seconds:g} s: the last period and the one before differ by {off:.1g} of the largest"
        hint = "another period; or a longer motion, until it has settled: --set analysis.duration=..."
        raise SolveError(Problem(CODE, message, hint=hint))
    least = {name: scale * off * size for name, size in sizes(last).items()} | {"torque": math.inf}
    highest = max(tail(own, QUARTER, last.terms[name]) for name, own in of_kinds(last).items())
    found = told(spec, "time", CycleTurning(1, None, rate), last, about, asked, least)
    return replace(
        found,
        settled=highest <= max(off, tolerances.ORDERS_SETTLED),
        period=Period(seconds, off),
        orders={name: rows for name, rows in found.orders.items() if name != "torque"},
        words={name: words for name, words in found.words.items() if name != "torque"},
        mean={name: value for name, value in found.mean.items() if name != "torque"},
        residual={name: own for name, own in found.residual.items() if name != "torque"},
    )


def moved(spec: Spec, seconds: float) -> Study:
    """The motion, answered at equal instants of its last two periods. Raises SolveError."""
    analysis = spec.analysis
    if analysis.type != "motion" or analysis.duration is None:
        message = f"--period is of a motion, and this analysis is none (type: {analysis.type})"
        raise SolveError(Problem(CODE, message, hint="give analysis.duration"))
    if analysis.duration < 2.0 * seconds:
        message = f"--period {seconds:g} s: the motion takes {analysis.duration:g} s, less than two of them"
        raise SolveError(Problem(CODE, message, hint=f"--set analysis.duration={2.0 * seconds:g}, or more"))
    times = instants(analysis.duration, seconds)
    study = solve(spec._replace(analysis=analysis._replace(times=(0.0, *times.tolist())), sections={}), Options())
    end = float(study.history.recovered.times[-1])
    if end < analysis.duration:
        message = f"--period {seconds:g} s: the motion ends at t = {end:g} s"
        raise SolveError(Problem(CODE, message, hint="leave out what ends it"))
    blows = [blow for blow in study.history.blows if blow.time >= times[0]]
    if blows:
        message = f"--period {seconds:g} s: something strikes at t = {blows[-1].time:g} s: a blow has no orders"
        raise SolveError(Problem(CODE, message, hint="soften it by a spring; or leave it out"))
    return study


def instants(duration: float, seconds: float) -> Array:
    """Of the last two periods, with the end of the second (2 n + 1,)."""
    return duration - seconds * np.arange(2 * SAMPLES, -1, -1) / SAMPLES


def cycles(study: Study, seconds: float, rate: float) -> list[Cycle]:
    """The last period but one, and the last, as cycles of the angle 2π t/T."""
    scene, found = study.setup.scene, study.history.recovered
    times = instants(float(found.times[-1]), seconds)
    states = at_unit_rate(body_states(scene.layout, found.at(rows_at(found, times))), rate)
    return [
        Cycle(scene.mechanism, 1, rate * times[part], of(states, part), scene.layout.size)
        for part in (slice(0, SAMPLES), slice(SAMPLES, 2 * SAMPLES))
    ]


def rows_at(found: Recovered, times: Array) -> Indices:
    """Which of the answered instants are these; events and blows have added others."""
    return np.asarray(np.abs(found.times[None, :] - times[:, None]).argmin(axis=1))


def of(states: BodyStates, part: slice) -> BodyStates:
    """Some of the instants."""
    return BodyStates(**{name: values[part] for name, values in fields(states).items()})


def of_kinds(effects: MassEffects) -> dict[str, Array]:
    """Force and moment at unit rate, (n, bodies, 3)."""
    return {"force": effects.force, "moment": effects.moment}


def sizes(effects: MassEffects) -> dict[str, float]:
    """The largest of force and moment, at unit rate."""
    return {name: float(np.abs(own.sum(axis=1)).max()) for name, own in of_kinds(effects).items()}


def difference(before: MassEffects, last: MassEffects) -> float:
    """By how much two periods differ, of the largest of force and of moment; 0 where there is neither."""
    one, two, largest = of_kinds(before), of_kinds(last), sizes(last)
    rounding = {name: tolerances.SUM_ROUNDING * last.terms[name] for name in largest}
    return max(
        float(np.abs(two[name].sum(axis=1) - one[name].sum(axis=1)).max()) / size if size > rounding[name] else 0.0
        for name, size in largest.items()
    )
