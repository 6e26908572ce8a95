"""From a validated spec to its results: the one place that sees both the spec and the kernel.

Impure: looks at the clock; a Study keeps a runner, so that further instants of the same run are cheap.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from heuncli.expressions.programs import across
from heuncli.integration.runner import Recovered, Runner, in_time, stops
from heuncli.integration.singular import passages
from heuncli.integration.solvable import refuse
from heuncli.kernel.choose import KERNEL
from heuncli.redundancy.count import model_of
from heuncli.results import Array, Block, Results
from heuncli.study.checked import Checked, checked_run
from heuncli.study.extremes import distinct
from heuncli.study.recover import compose
from heuncli.tree.prepare import prepare
from heuncli.version import VERSION

if TYPE_CHECKING:
    from heuncli.redundancy.resolve import Decided

BLOCKS = frozenset({"motion", "points", "foundation", "joints", "sections", "forces", "energy"})
SEARCH_PER_STEP = 4  # instants looked at in each step of the integrator when extremes are searched
MOST_SEARCHED = 20_000
UNBALANCED = 1e-6  # of a body's largest load: rounding stays far below, near a singular pose, too


@dataclass(frozen=True)
class Options:
    """What a command asks beside the spec. wanted: report blocks, None for all."""

    tolerance: float | None = None
    method: str | None = None
    wanted: frozenset[str] | None = None
    time_limit: float | None = None
    least_norm: bool = False
    reduce: bool = True
    load_seconds: float = 0.0  # what reading the spec took, for the block `work`


class Study:
    """A solved scene: `results` at the asked instants, `resample` for any others of the same run."""

    def __init__(self, spec: Any, options: Options) -> None:
        begun = time.perf_counter()
        deadline = time.monotonic() + options.time_limit if options.time_limit else None
        self.spec, self.options = spec, options
        self.scene = prepare(spec)
        self.runner = Runner(self.scene.layout)
        self.moving = spec.analysis.type == "motion"
        self.model = model_of(self.scene, self.runner, "DOP853" if self.moving else "none")
        self.seconds = dict.fromkeys(("load", "build", "integrate", "check"), 0.0)
        self.seconds |= {"load": options.load_seconds, "build": time.perf_counter() - begun}
        self.times = np.array(spec.analysis.times, dtype=float)
        self.halts: list[float] = []
        self.checked: Checked | None = None
        states, at = self.scene.layout.y0[None, :], self.times[:1]
        if self.moving:
            refuse(self.scene, self.runner.recovered(np.zeros(1), states))  # before a long run, not after it
            self.checked = self._run(deadline)
            states, at = self.checked.run.states, self.checked.run.times
            self.times = at
        in_time(deadline, "before the loads were found")
        begun = time.perf_counter()
        self.found = self._recovered(at, states)
        self.results = self._results(self.found)
        self.results.work["seconds"]["recover"] = time.perf_counter() - begun

    def _run(self, deadline: float | None) -> Checked:
        self.halts = stops(self.scene.mechanism, 0.0, float(self.times[-1]))
        tolerance = self.options.tolerance if self.options.tolerance is not None else self.spec.analysis.tolerance
        self.tolerance = tolerance
        checked = checked_run(self.runner, self.times, tolerance, self.halts, deadline)
        self.seconds |= {"integrate": checked.run.seconds, "check": checked.check_seconds}
        if checked.lost_seconds:
            self.seconds["lost"] = checked.lost_seconds
        return checked

    @cached_property
    def search_times(self) -> Array:
        """Instants close enough to bracket every extreme: the asked ones and some within each step, (n,) ascending."""
        if self.checked is None:
            return self.times[:1]
        marks = np.concatenate([[0.0], self.checked.run.ends])
        per_step = max(1, min(SEARCH_PER_STEP, MOST_SEARCHED // max(len(marks), 1)))
        inner = (marks[:-1, None] + np.diff(marks)[:, None] * (np.arange(per_step) / per_step)).ravel()
        # a jump has a value on either side of it
        grid = np.concatenate([inner, [t for pair in across(self.halts) if pair[0] > 0.0 for t in pair]])
        grid = grid[(grid > self.times[0]) & (grid < self.times[-1])]
        return distinct(np.concatenate([self.times, grid]))

    @cached_property
    def passages(self) -> list[float]:
        """Instants of singular poses that the run came through [s]."""
        return passages(self.runner, self.checked.run) if self.checked is not None else []

    def resample(self, times: Array) -> Results:
        """The same run at other instants within it (ascending)."""
        if self.checked is None:
            return self.results
        times = np.asarray(times, dtype=float)
        return self._results(self._recovered(times, self.runner.within(self.checked.run, times)))

    def _recovered(self, times: Array, states: Array) -> Recovered:
        """What the sweep knows; at a jump and at what holds at one instant alone, what comes after it."""
        later = times.copy()
        for before, after in across(self.halts):
            later[(times > before) & (times < after)] = after
        return replace(self.runner.recovered(later, states), times=times)

    def _results(self, found: Recovered) -> Results:
        wanted = BLOCKS if self.options.wanted is None else self.options.wanted
        about = self.spec.foundation.about
        about = np.array(about if about is not None else (0.0, 0.0, 0.0))
        composed = compose(self.scene, self.runner, found, about, wanted, self.options.least_norm)
        checked, joints = self.checked, composed.blocks.get("joints", {})
        estimate = {"motion": 0.0, "reactions": 0.0}
        if checked is not None:
            estimate = {"motion": float(checked.motion.max(initial=0.0)), "reactions": checked.reactions}
        gap = checked.run.gap if checked is not None else self.scene.start.gap
        accuracy = composed.accuracy | {
            "constraint_gap": max(composed.accuracy["constraint_gap"], gap),
            "horizon": checked.horizon if checked is not None else None, "estimate": estimate,
        }  # fmt: skip
        return Results(
            title=self.spec.title, spec={"path": self.spec.path, "sha256": self.spec.sha256}, version=VERSION,
            model=self.model | ({"split": "; ".join(composed.split)} if composed.split else {}),
            status=self._status(), time=found.times, **composed.blocks,
            certain_sums=composed.sums, accuracy=accuracy, work=self._work(),
            warnings=(
                *unbalanced(accuracy["balance_residual"]), *self._warnings(joints),
                *self._singular(composed.decided, found.times),
            ),
        )  # fmt: skip

    def _status(self) -> Block:
        if self.checked is None:
            return {"code": "completed", "message": "one instant, nothing integrated"}
        run = self.checked.run
        if run.stopped is not None:
            why = f"at t = {run.times[-1]:.6g} s the rod {run.stopped} would have to push (tension_only)"
            return {"code": "stopped", "message": why}
        return {"code": "completed", "message": f"{run.steps} steps to t = {run.times[-1]:.6g} s"}

    def _singular(self, decided: Decided | None, times: Array) -> list[str]:
        return decided.singular(times, self.model["redundant"]) if decided is not None else []

    def _warnings(self, joints: Block) -> tuple[str, ...]:
        found = [w for c in self.scene.cuts for w in c.warnings]
        if self.checked is not None and (worst := float(self.checked.motion.max(initial=0.0))) > self.tolerance:
            missed = f"the tolerance {self.tolerance:.3g} was not reached"
            found.append(f"{missed}: the motion is estimated to {worst:.2g} of the scene's size")
        if self.passages:
            told = ", ".join(f"{t:.6g}" for t in self.passages[:5]) + (" ..." if len(self.passages) > 5 else "")
            sure = self.checked is not None and self.checked.horizon is None
            goes = "this one goes on smoothly" if sure else "rounding decides which is followed"
            branch = f"another motion branches off there, {goes}"
            found.append(f"passes through a singular pose at t = {told} s: {branch}")
        if self.checked is None:
            ropes = [j.name for j in self.scene.mechanism.joints if j.tension_only and j.name in joints]
            pushing = [name for name in ropes if joints[name]["tension"][0] < 0.0]
            found += [f"the rod {name} would have to push (tension_only)" for name in pushing]
        if self.checked is not None and self.checked.run.stopped is not None:
            found.append(f"stopped before the end: {self._status()['message']}")
        return tuple(found)

    def _work(self) -> Block:
        run = self.checked.run if self.checked else None
        return {
            "kernel": KERNEL, "steps": run.steps if run else 0, "evaluations": run.evaluations if run else 0,
            "seconds": dict(self.seconds),
        }  # fmt: skip


def unbalanced(residual: float) -> list[str]:
    """A sentence where the numbers do not fulfil d'Alembert's principle."""
    wrong = f"the forces balance to {residual:.1g} of the largest only: the loads are not to be trusted"
    return [wrong] if residual > UNBALANCED else []


@dataclass(frozen=True)
class Described:
    """What `heun model` tells."""

    model: Block


def describe(spec: Any) -> Described:
    """The scene assembled, nothing integrated."""
    from heuncli.redundancy.advice import advice  # runs give none

    scene = prepare(spec)
    model = model_of(scene, Runner(scene.layout), "DOP853" if spec.analysis.type == "motion" else "none")
    model["notes"] += advice(scene, model)
    return Described(model)


def solve(spec: Any, options: Options | None = None) -> Study:
    """Solve a spec. Raises SpecError, SolveError, LimitError."""
    return Study(spec, options if options is not None else Options())
