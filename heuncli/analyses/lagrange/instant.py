"""The instant of a Lagrange analysis: the scene as it is there, and the same state of the scene without drives."""

from __future__ import annotations

import numpy as np

from heuncli.analyses.lagrange.freed_scene import FreedScene, free_drives
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.linearisation.linearise import LinearisedEquations, linearise
from heuncli.multibody.tree.layout import find_speed_rows
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.recovery import Recovery, recover
from heuncli.study.model.options import Options
from heuncli.study.model.setup import Setup, set_up
from heuncli.study.workflow import solve


@record
class Instant:
    """A scene at an instant.

    heading: when it is
    setup, driven_recovered: the scene as it is, with its solution
    freed_scene: the scene without drives
    state, holding, freed_recovered, linear_equations: its state, closed contacts, solution and linearised equations
    """

    heading: str
    t: float
    setup: Setup
    driven_recovered: Evaluation
    freed_scene: FreedScene
    state: Array
    holding: Array
    freed_recovered: Evaluation
    linear_equations: LinearisedEquations

    @property
    def recovery(self) -> Recovery:
        """Results of the scene as it is."""
        return recover(self.setup, self.driven_recovered, False)


def make_instant(spec: Spec, time: float | None, time_limit: float | None) -> Instant:
    """Return the start of a state or motion, an equilibrium, or an instant of a motion."""
    kind = spec.analysis.type
    if time is not None and kind == "motion" and time > 0.0:
        setup, recovered = solve_until(spec, time, time_limit)
        heading, t = f"at t = {time:.6g} s", time
    else:
        if kind != "rest":
            t = float(spec.analysis.times[0]) if kind == "state" else 0.0
            spec = spec._replace(
                analysis=spec.analysis._replace(type="state", times=(t,), duration=None, conditions=())
            )
        setup = set_up(spec, reduce=False)
        t = float(spec.analysis.times[0]) if kind == "state" else 0.0
        runner, layout = setup.runner, setup.scene.layout
        recovered = runner.evaluate(np.array([t]), layout.y0[None, :])
        heading = "at the rest position" if kind == "rest" else f"at t = {t:.6g} s"
    require_holonomic(setup)
    scene = free_drives(setup.scene)
    state, holding = scene.convert_states(recovered)[0], scene.convert_holding(recovered.holding[0])
    freed_recovered = scene.runner.evaluate(np.array([t]), state[None, :], holding=holding)
    return Instant(
        heading,
        t,
        setup,
        recovered,
        scene,
        freed_recovered.states[0],
        holding,
        freed_recovered,
        linearise(scene.layout, t, freed_recovered.states[0], holding),
    )


def require_holonomic(setup: Setup) -> None:
    """Raise SolveError [no-coordinate] if wheels roll in space: their speeds are not rates of any coordinates."""
    layout = setup.scene.layout
    if layout.mechanism.planar or not find_speed_rows(layout).any():
        return
    message = "rolling contact is nonholonomic: no coordinates have its speeds as their rates"
    hint = "heun run gives motion and loads, heun modes small motions; in a planar model wheels roll along lines"
    raise SolveError(Problem("no-coordinate", message, hint=hint))


def solve_until(spec: Spec, time: float, time_limit: float | None) -> tuple[Setup, Evaluation]:
    """Solve a motion up to a time and return its results there. Raises SolveError [bad-option] if it ends before."""
    analysis = spec.analysis._replace(times=(0.0, time), duration=time)
    study = solve(spec._replace(analysis=analysis), Options(time_limit=time_limit, reduce=False))
    recovered = study.history.solutions
    if float(recovered.times[-1]) < time:
        message = f"--at {time:g}: the motion ends at t = {recovered.times[-1]:.6g} s"
        raise SolveError(Problem("bad-option", message, hint="use an earlier instant"))
    return study.setup, recovered.select(np.array([len(recovered.times) - 1]))
