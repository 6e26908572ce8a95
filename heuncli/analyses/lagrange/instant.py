"""The instant that is looked at: the scene there as it is, and the same state of the scene without drives."""

from __future__ import annotations

import numpy as np

from heuncli.analyses.lagrange.freed import FreedScene, freed
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record
from heuncli.motion.integration.evaluator import Recovered
from heuncli.motion.linearisation.linearise import Linearised, linearised
from heuncli.multibody.tree.held_speeds import holds_speed
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.recovery import Recovery, recover
from heuncli.study.model.options import Options
from heuncli.study.model.setup import Setup, set_up
from heuncli.study.workflow import solve


@record
class Instant:
    """A scene at an instant.

    words: when, for a heading; setup, there: the scene as it is, answered; freed: without drives; state, holding, here,
    found: its state, which contacts are closed, its answers and its linear equations.
    """

    words: str
    t: float
    setup: Setup
    there: Recovered
    freed: FreedScene
    state: Array
    holding: Array
    here: Recovered
    found: Linearised

    @property
    def recovery(self) -> Recovery:
        """What follows from the answers of the scene as it is."""
        return recover(self.setup, self.there, False)


def instant_of(spec: Spec, at: float | None, time_limit: float | None) -> Instant:
    """The start of a state or motion, a pose at rest, or an instant of a motion."""
    kind = spec.analysis.type
    if at is not None and kind == "motion" and at > 0.0:
        setup, there = moved_to(spec, at, time_limit)
        words, t = f"at t = {at:.6g} s", at
    else:
        if kind != "rest":
            t = float(spec.analysis.times[0]) if kind == "state" else 0.0
            spec = spec._replace(
                analysis=spec.analysis._replace(type="state", times=(t,), duration=None, conditions=())
            )
        setup = set_up(spec, reduce=False)
        t = float(spec.analysis.times[0]) if kind == "state" else 0.0
        runner, layout = setup.runner, setup.scene.layout
        there = runner.recovered(np.array([t]), layout.y0[None, :])
        words = "at the rest pose" if kind == "rest" else f"at t = {t:.6g} s"
    require_poses(setup)
    scene = freed(setup.scene)
    state, holding = scene.states(there)[0], scene.holding(there.holding[0])
    here = scene.runner.recovered(np.array([t]), state[None, :], holding=holding)
    return Instant(
        words,
        t,
        setup,
        there,
        scene,
        here.states[0],
        holding,
        here,
        linearised(scene.layout, t, here.states[0], holding),
    )


def require_poses(setup: Setup) -> None:
    """Raise SolveError [no-coordinate] where wheels hold speeds in space: no coordinates have these for their rates."""
    layout = setup.scene.layout
    if layout.mechanism.planar or not holds_speed(layout).any():
        return
    message = "what rolls has more poses than speeds: no coordinates have its speeds as their rates"
    hint = "heun run tells its motion and loads, heun modes its small motions; in the plane wheels roll along lines"
    raise SolveError(Problem("no-coordinate", message, hint=hint))


def moved_to(spec: Spec, at: float, time_limit: float | None) -> tuple[Setup, Recovered]:
    """A motion up to an instant, and its answers there. Raises SolveError where it does not come so far."""
    analysis = spec.analysis._replace(times=(0.0, at), duration=at)
    study = solve(spec._replace(analysis=analysis), Options(time_limit=time_limit, reduce=False))
    there = study.history.recovered
    if float(there.times[-1]) < at:
        message = f"--at {at:g}: the motion ends at t = {there.times[-1]:.6g} s"
        raise SolveError(Problem("bad-option", message, hint="ask for an earlier instant"))
    return study.setup, there.at(np.array([len(there.times) - 1]))
