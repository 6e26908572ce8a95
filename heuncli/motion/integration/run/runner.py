"""A scene that can be run: its motion over asked instants, and states and loads of that motion at others.

To be read in this order: request.py, what is asked for; stepper.py, from segment to segment, and what is looked at on
the way; kernel_loop.py, the steps themselves (kernel/integration.py takes them); interruptions.py, blows and contacts
between them; step_records.py, what is put down; progress.py, how far a run has come, for all that look at it:
limits.py with pace.py, stiffness.py with fastest_motion.py, event_frequency.py, conditions.py and, where it ends too
soon, failure.py and errors.py.
replay.py takes the same steps again for other instants. scipy_loop.py stands in for all of it where a method of SciPy
is asked for.

Impure: a `Runner` keeps the kernel's work arrays; `trajectory` looks at the clock where a deadline is set.
"""

from __future__ import annotations

import time

from heuncli.base.errors import SolveError
from heuncli.motion.integration.evaluator import Evaluator, Recovered
from heuncli.motion.integration.integrated_scene import IntegratedScene, itself
from heuncli.motion.integration.run.errors import Eventful, Stiff
from heuncli.motion.integration.run.interruptions import closed_at_start
from heuncli.motion.integration.run.replay import resampled
from heuncli.motion.integration.run.request import FOR_ITS_ENDING, MotionTask, StoppingRules
from heuncli.motion.integration.run.stepper import Stepper, begun
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.stages import ANEW, Stages
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene, lacking_inertia
from heuncli.results.results import Array


class Runner(Evaluator):
    """A laid-out scene with the kernel's work arrays; every call starts from what it is given.

    moving: what is integrated in the scene's place; else the scene itself.
    """

    def __init__(self, layout: Layout, moving: IntegratedScene | None = None) -> None:
        super().__init__(layout, closed_at_start)
        self.moving = itself(self) if moving is None else moving

    def trajectory(self, request: MotionTask, rules: StoppingRules = FOR_ITS_ENDING) -> Trajectory:
        """Integrate from the start at t = 0 over the asked instants.

        Where a rope would have to push the run ends: the instants up to there, and that one. So it does where the
        condition that ends it becomes true, if that is watched.

        Raises SolveError where the motion cannot be continued, LimitError past the deadline; if they are watched, Stiff
        where an implicit method takes less, Eventful where events end most steps, or cease to.
        """
        since = time.perf_counter()
        if request.method.foreign:
            from heuncli.motion.integration.run import scipy_loop  # loads SciPy

            return scipy_loop.trajectory(self.layout, self.moving, request)
        progress = begun(self, self.moving, request, rules)
        stepper = Stepper(progress, request, rules)
        try:
            ending = stepper.to_end()
        except SolveError as error:
            error.reached = progress.t if error.reached is None else error.reached
            raise
        except (Stiff, Eventful) as left:
            left.seconds = time.perf_counter() - since
            raise
        return stepper.trajectory(ending, time.perf_counter() - since)

    def answers_at(self, run: Trajectory, times: Array) -> Recovered:
        """Accelerations and loads at instants of a run (ascending, within it), by what held there."""
        return self.recovered(times, self.resample(run, times), holding=run.holding_at(times))

    def resample(self, run: Trajectory, times: Array) -> Array:
        """States (n_t, n) of a run at other instants (ascending, within it), by replaying its own steps."""
        return resampled(self.moving, run, times)


def ready(scene: PreparedScene, stages: Stages = ANEW) -> tuple[PreparedScene, Runner]:
    """A scene to be run and its work arrays: inertia is lent where motions of its tree move no mass."""
    lacking = lacking_inertia(scene, stages)
    if lacking:
        from heuncli.motion.integration.diagnosis.massless_motions import lend  # few scenes need it

        scene = lend(scene, lacking)
    return scene, Runner(scene.layout)
