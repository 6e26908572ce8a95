"""A pendulum and a free top over many periods: energy, momentum and phase by every method of fixed and adaptive steps.

`python -m tests.bench long [--periods N] [--only NAME ...]`. All take the same evaluations a period: of fixed steps
their length is chosen, of adaptive ones the tolerance. Against closed forms (manual/theory.md, "Closed cases" 1),
which the state after each whole period repeats: so the phase is counted on from period to period, and how far it is off
is certain.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.special import ellipk, ellipkinc

from heuncli.base.errors import HeunError, LimitError, SolveError
from heuncli.base.method_rows import METHODS
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.integration.methods.method import Method, load_method_by_name
from heuncli.motion.integration.run.request import MotionTask
from heuncli.motion.integration.run.runner import Runner
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from tests.bench.chart import chart

LISTED = [row.name for row in METHODS if row.kind != "SciPy"]
EVALUATIONS = 240  # a period: 20 steps of DOP853, 60 of RK4
TRIED = 20  # periods in which the pace is found
BELOW = 0.7  # of the longest step that is solved over these: over all of them the motion comes to others, too
LOST = 0.1  # of the energy: what is off by more swings by another law, and its phase tells nothing

PENDULUM = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies: {bob: {mass: 1, center: [0, 0, -1], inertia: [0, 0, 0], points: {top: [0, 0, 0]}}}
joints: {pivot: {type: pin, from: ground.O, to: bob.top, axis: [0, 1, 0], initial: {angle: 90 deg, rate: 0}}}
analysis: {duration: 1}
"""
TOP = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  top:
    mass: 1
    center: [0, 0, 0]
    inertia: [1, 2, 3]
    points: {c: [0, 0, 0]}
    angular_velocity: {vector: [0.9, 0, 1.1], frame: body}
joints: {pivot: {type: ball, from: ground.O, to: top.c}}
analysis: {duration: 1}
"""
TOP_MODULUS = 0.2231404958677686  # m of manual/theory.md, "Closed cases" 1
INERTIA = np.array([1.0, 2.0, 3.0])


class Known(NamedTuple):
    """A motion in closed form: its period [s]; of answers (n_t,) energy and momentum off, and the phase [periods]."""

    text: str
    period: float
    off: Callable[[Evaluation], tuple[Array, Array]]
    phase: Callable[[Evaluation], Array]


def pendulum_angle(found: Evaluation) -> tuple[Array, Array]:
    """Angle and rate about y."""
    R = found.bodies["R"][:, 0]
    return np.arctan2(R[:, 0, 2], R[:, 0, 0]), found.bodies["omega"][:, 0, 1]


def pendulum_off(found: Evaluation) -> tuple[Array, Array]:
    """Energy off the start's, of what it swings through; a pendulum keeps no momentum."""
    angle, rate = pendulum_angle(found)
    return np.abs(0.5 * rate**2 - 9.81 * np.cos(angle)) / 9.81, np.zeros(len(angle))


def pendulum_phase(found: Evaluation) -> Array:
    """sin(a/2) = k sn u, a' = 2 w k cn u with k = sin 45 deg; u/4K is the phase."""
    angle, rate = pendulum_angle(found)
    k = math.sqrt(0.5)
    amplitude = np.arctan2(np.sin(angle / 2) / k, rate / (2.0 * math.sqrt(9.81) * k))
    return np.asarray(ellipkinc(amplitude, 0.5) / (4.0 * ellipk(0.5)))


def body_rates(found: Evaluation) -> Array:
    """Angular velocity in body axes, (n_t, 3)."""
    return np.asarray(np.einsum("tji,tj->ti", found.bodies["R"][:, 0], found.bodies["omega"][:, 0]))


def top_off(found: Evaluation) -> tuple[Array, Array]:
    """Energy and moment of momentum off the start's, of their size."""
    spin = body_rates(found)
    energy = 0.5 * np.sum(INERTIA * spin**2, axis=1)
    momentum = np.einsum("tij,tj->ti", found.bodies["R"][:, 0], INERTIA * spin)
    at_start = INERTIA * np.array([0.9, 0.0, 1.1])
    off = np.linalg.norm(momentum - at_start, axis=1) / np.linalg.norm(at_start)
    return np.abs(energy / 2.22 - 1.0), off


def top_phase(found: Evaluation) -> Array:
    """The rates are (.9 cn u, .9 sn u, 1.1 dn u); u/4K is the phase."""
    spin = body_rates(found)
    amplitude = np.arctan2(spin[:, 1], spin[:, 0])
    return np.asarray(ellipkinc(amplitude, TOP_MODULUS) / (4.0 * ellipk(TOP_MODULUS)))


KNOWN = {
    "pendulum from 90 deg": Known(PENDULUM, 2.367841947576237, pendulum_off, pendulum_phase),
    "free top": Known(TOP, 6.078117841793404, top_off, top_phase),
}


class Errors(NamedTuple):
    """After each of the periods, (n,): energy, momentum and phase off; seconds and evaluations a period it took."""

    energy: Array
    momentum: Array
    phase: Array
    seconds: float
    evaluations: float


def runner_of(known: Known) -> Runner:
    return set_up(load("scene.yaml", known.text)).runner


def errors(known: Known, runner: Runner, method: Method, local: float, periods: int) -> Errors:
    """A run over whole periods."""
    times = known.period * np.arange(periods + 1)
    begun = time.process_time()
    run = runner.run(MotionTask(times, local, method=method))
    seconds = time.process_time() - begun
    found = runner.evaluate(run.times, run.states)
    energy, momentum = known.off(found)
    phase = np.unwrap(known.phase(found), period=1.0)
    return Errors(energy[1:], momentum[1:], np.abs(phase[1:] - phase[0]), seconds / periods, run.evaluations / periods)


def pace(known: Known, runner: Runner, method: Method, evaluations: float) -> float:
    """The step, or the local tolerance, with which a method takes so many evaluations a period.

    Of a method that takes more at any step that it bears, a step below the longest of these.
    """
    least, most = (known.period / 1e4, known.period) if method.has_fixed_step else (1e-14, 0.3)
    low, high = math.log(least), math.log(most)
    best = (math.inf, high)
    for _ in range(14):
        middle = 0.5 * (low + high)
        try:
            taken = errors(known, runner, method, math.exp(middle), TRIED).evaluations
        except SolveError:  # too long a step
            high = middle
            continue
        except LimitError:
            low = middle
            continue
        best = min(best, (max(taken, evaluations), middle))
        low, high = (middle, high) if taken > evaluations else (low, middle)
    return math.exp(best[1]) * (1.0 if best[0] == evaluations else BELOW)


def as_long(known: Known, runner: Runner, method: Method, local: float, periods: int) -> Errors:
    """A run over so many periods, or a tenth of them where it would take more steps than a run may."""
    try:
        return errors(known, runner, method, local, periods)
    except LimitError:
        return errors(known, runner, method, local, periods // 10)


def long(periods: int, only: Sequence[str] = ()) -> None:
    """Print the tables, and the phase as a chart; only: of methods whose names hold one of these."""
    for name, known in KNOWN.items():
        runner = runner_of(known)
        decades = [10**k for k in range(int(math.log10(periods)) + 1)]
        print(f"\n{name}, {periods:,} periods, {EVALUATIONS} evaluations a period; phase off, in periods, after")
        print(f"{'':19}" + "".join(f"{n:>9,}" for n in decades) + "   energy  moment'm     local   evals  us a period")
        letters: dict[str, list[tuple[float, float]]] = {}
        for letter, method in zip("abcdefghijklmnop", map(load_method_by_name, LISTED), strict=False):
            if only and not any(part in method.name for part in only):
                continue
            local = pace(known, runner, method, EVALUATIONS)
            try:
                found = as_long(known, runner, method, local, periods)
            except HeunError as error:
                problem = error.problems[0]
                print(f"{letter} {method.name:17}{problem.code}: {problem.message[:90]}", flush=True)
                continue
            held = [n for n in decades if n <= len(found.phase) and found.energy[:n].max() < LOST]
            shown = [float(found.phase[:n].max()) for n in held]
            letters[letter] = [(n, max(off, 1e-14)) for n, off in zip(held, shown, strict=True)]
            cells = [f"{off:.0e}" for off in shown] + ["lost"] * (len(decades) - len(shown))
            print(
                f"{letter} {method.name:17}"
                + "".join(f"{cell:>9}" for cell in cells)
                + f"{found.energy.max():9.0e} {found.momentum.max():9.0e} {local:9.1e} {found.evaluations:7.0f}"
                f" {1e6 * found.seconds:12.0f}",
                flush=True,
            )
        print(chart({letter: own for letter, own in letters.items() if own}, tuple(decades), "periods", "per."))
