"""The progress of a run: what is integrated, the kernel's loop, and the records of the steps done."""

from __future__ import annotations

import numpy as np

from heuncli.base.records import record
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.integration.integrated_scene import IntegratedScene
from heuncli.motion.integration.run.kernel_loop import KernelLoop
from heuncli.motion.integration.run.step_records import StepRecorder
from heuncli.results.results import Array

LAST_STEPS = 101  # whose mean length is the pace


@record
class RunProgress:
    """A running integration.

    scene: the scene whose motion is requested
    integrated_scene: what is integrated in its place
    kernel: the stepping loop
    steps: those done
    last: the intended end [s]
    """

    scene: Evaluator
    integrated_scene: IntegratedScene
    kernel: KernelLoop
    steps: StepRecorder
    last: float

    @property
    def t(self) -> float:
        """The instant reached [s]."""
        return self.kernel.loop.t

    @property
    def integrated_state(self) -> Array:
        """The integrated state reached, (n',)."""
        return np.array(self.kernel.loop.state())

    @property
    def state(self) -> Array:
        """The scene's state reached, (n,)."""
        return self.integrated_scene.embed_state(self.t, self.integrated_state)

    @property
    def pace(self) -> tuple[float, float]:
        """Mean length of the last steps [s], and their tolerance."""
        ends = self.steps.copy_column("ends")[-LAST_STEPS:]
        return (float(ends[-1] - ends[0]) / (len(ends) - 1) if len(ends) > 1 else 0.0), self.kernel.start.local

    @property
    def passed_states(self) -> list[tuple[float, Array]]:
        """Some instants and states of the scene (n,) that it has passed, ascending, for the explanation of an error."""
        passed = self.steps.passed_states(self.kernel.n)
        times = [t for t, _ in passed]
        return list(
            zip(times, self.integrated_scene.embed(np.array(times), np.array([y for _, y in passed])), strict=True)
        )
