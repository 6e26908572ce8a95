"""How far a run has come: what is integrated, the kernel's loop, and what is put down of the steps done."""

from __future__ import annotations

import numpy as np

from heuncli.base.records import record
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.integration.integrated_scene import IntegratedScene
from heuncli.motion.integration.run.kernel_loop import KernelLoop
from heuncli.motion.integration.run.step_records import Steps
from heuncli.results.results import Array

LAST_STEPS = 101  # whose mean length tells the pace


@record
class Progress:
    """A run under way.

    scene: whose motion is asked for; moving: what is integrated in its place; kernel: the stepping loop; steps: those
    done; last: the instant at which it is to end [s].
    """

    scene: Evaluator
    moving: IntegratedScene
    kernel: KernelLoop
    steps: Steps
    last: float

    @property
    def t(self) -> float:
        """The instant that it has reached [s]."""
        return self.kernel.loop.t

    @property
    def integrated_state(self) -> Array:
        """The state that it has reached, of what is integrated, (n',)."""
        return np.array(self.kernel.loop.state())

    @property
    def state(self) -> Array:
        """The scene's state that it has reached, (n,)."""
        return self.moving.state(self.t, self.integrated_state)

    @property
    def pace(self) -> tuple[float, float]:
        """The mean length of its last steps [s], and their tolerance."""
        ends = self.steps.column("ends")[-LAST_STEPS:]
        return (float(ends[-1] - ends[0]) / (len(ends) - 1) if len(ends) > 1 else 0.0), self.kernel.start.local

    @property
    def passed(self) -> list[tuple[float, Array]]:
        """Instants and the scene's states (n,) that it has passed, ascending: some, on the way to an error."""
        passed = self.steps.passed(self.kernel.n)
        times = [t for t, _ in passed]
        return list(zip(times, self.moving.embed(np.array(times), np.array([y for _, y in passed])), strict=True))
