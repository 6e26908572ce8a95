"""A run that will take long says so, once, while it goes on: how long, and which body keeps its steps short."""

from __future__ import annotations

import time

from heuncli.base.announcements import listener
from heuncli.motion.integration.run.pace import seconds_left
from heuncli.motion.integration.run.progress import Progress

PATIENCE = 4.0  # [s] of work before the pace is looked at
LONG = 20.0  # [s] that are left at this pace: shorter runs are waited for without a word


class SlowRunWatch:
    """Whether a run is slow; begun: time.monotonic() at its start. It is looked at again when it took twice as long."""

    def __init__(self, begun: float) -> None:
        self.begun, self.next, self.is_told = begun, PATIENCE, False

    def look(self, progress: Progress) -> None:
        """Announce a run that will take long at the pace of its last steps."""
        if self.is_told or (took := time.monotonic() - self.begun) < self.next or (write := listener()) is None:
            return
        self.next = 2.0 * took
        left = seconds_left(progress.steps.column("ends"), progress.last, took)
        if not left > LONG:
            return
        self.is_told = True
        from heuncli.motion.integration.diagnosis.fast_body import why_steps_are_short  # few runs are slow

        done = f"t = {progress.t:.3g} s of {progress.last:.6g} s after {took:.0f} s and {progress.steps.count} steps"
        write("; ".join(filter(None, (
            f"a long run: {done}, about {left:.1g} s more at this pace",
            why_steps_are_short(progress.scene, progress.t, progress.state, *progress.pace),
            "--time-limit ends it",
        ))))  # fmt: skip
