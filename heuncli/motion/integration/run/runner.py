"""A scene that can be run: its motion over requested instants, and states and loads of that motion at others.

Read these modules in this order: request.py, what is requested; stepper.py, from segment to segment, with the checks on
the way; kernel_loop.py, the steps themselves (kernel/integration.py takes them); interruptions.py, impulses and
contacts between them; step_records.py, what is recorded; progress.py, how far a run has come, for all that check it:
limits.py with pace.py, stiffness.py with fastest_motion.py, event_frequency.py, conditions.py and, where it ends too
soon, failure.py and errors.py.

replay.py takes the same steps again for other instants. scipy_loop.py replaces all of it where a method of SciPy is
requested.

Impure: a `Runner` holds the kernel's work arrays; `run` reads the clock where a deadline is set.
"""

from __future__ import annotations

import time

from heuncli.base.errors import SolveError
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.motion.integration.integrated_scene import IntegratedScene, integrate_itself
from heuncli.motion.integration.run.errors import EventfulRun, StiffRun
from heuncli.motion.integration.run.interruptions import find_closed_at_start
from heuncli.motion.integration.run.replay import resample_run
from heuncli.motion.integration.run.request import DEFAULT_RULES, MotionTask, StoppingRules
from heuncli.motion.integration.run.stepper import Stepper, begin_run
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.stages import NO_CACHE, Stages
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene, find_missing_inertia
from heuncli.results.results import Array


class Runner(Evaluator):
    """A scene's layout with the kernel's work arrays. Each call depends only on its arguments.

    integrated_scene: the scene that is integrated in place of this one; by default this one
    """

    def __init__(self, layout: Layout, integrated_scene: IntegratedScene | None = None) -> None:
        super().__init__(layout, find_closed_at_start)
        self.integrated_scene = integrate_itself(self) if integrated_scene is None else integrated_scene

    def run(self, request: MotionTask, rules: StoppingRules = DEFAULT_RULES) -> Trajectory:
        """Integrate from the start at t = 0 over the requested instants.

        The run ends where a rope would have to push: the result has the instants up to there, and that one. It also
        ends where the condition that ends it becomes true, if that is watched.

        Raises SolveError where the motion cannot be continued, LimitError past the deadline; if they are watched,
        StiffRun where an implicit method takes less work, EventfulRun where events end most steps, or no longer do.
        """
        clock_start = time.perf_counter()
        if request.method.scipy_name:
            from heuncli.motion.integration.run import scipy_loop  # loads SciPy

            return scipy_loop.run_scipy(self.layout, self.integrated_scene, request)
        progress = begin_run(self, self.integrated_scene, request, rules)
        stepper = Stepper(progress, request, rules)
        try:
            ending = stepper.run_to_end()
        except SolveError as error:
            error.reached = progress.t if error.reached is None else error.reached
            raise
        except (StiffRun, EventfulRun) as stop:
            stop.seconds = time.perf_counter() - clock_start
            raise
        return stepper.make_trajectory(ending, time.perf_counter() - clock_start)

    def evaluate_run(self, run: Trajectory, times: Array) -> Evaluation:
        """Evaluate accelerations and loads at instants of a run (ascending, within it), with the contacts that held
        there.
        """
        return self.evaluate(times, self.resample(run, times), holding=run.find_holding(times))

    def resample(self, run: Trajectory, times: Array) -> Array:
        """Return states (n_t, n) of a run at other instants (ascending, within it), by replaying its own steps."""
        return resample_run(self.integrated_scene, run, times)


def make_runner(scene: PreparedScene, stage_cache: Stages = NO_CACHE) -> tuple[PreparedScene, Runner]:
    """Return a scene that can be run and its runner; massless motions of its tree get artificial inertia."""
    lacking = find_missing_inertia(scene, stage_cache)
    if lacking:
        from heuncli.motion.integration.diagnosis.massless_motions import add_artificial_inertia  # few scenes need it

        scene = add_artificial_inertia(scene, lacking)
    return scene, Runner(scene.layout)
