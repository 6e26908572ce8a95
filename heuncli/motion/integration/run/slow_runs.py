"""Announce once, while it runs, that a run will take long: how long, and which body keeps its steps short."""

from __future__ import annotations

import time

from heuncli.base.progress_messages import current_listener
from heuncli.motion.integration.run.pace import estimate_seconds_left
from heuncli.motion.integration.run.progress import RunProgress

PATIENCE = 4.0  # [s] of work before the first check
LONG_RUN = 20.0  # [s] remaining at this pace, above which the run is announced


class SlowRunWatch:
    """Watches whether a run is slow. The next look is when it has taken twice as long.

    start_time: time.monotonic() at the start
    """

    def __init__(self, start_time: float) -> None:
        self.start_time, self.next, self.is_reported = start_time, PATIENCE, False

    def check(self, progress: RunProgress) -> None:
        """Announce a run that will take long at the pace of its last steps."""
        if (
            self.is_reported
            or (seconds := time.monotonic() - self.start_time) < self.next
            or (report := current_listener()) is None
        ):
            return
        self.next = 2.0 * seconds
        remaining = estimate_seconds_left(progress.steps.copy_column("ends"), progress.last, seconds)
        if not remaining > LONG_RUN:
            return
        self.is_reported = True
        from heuncli.motion.integration.diagnosis.fast_body import explain_short_steps  # few runs are slow

        done_text = (
            f"t = {progress.t:.3g} s of {progress.last:.6g} s after {seconds:.0f} s and {progress.steps.count} steps"
        )
        report("; ".join(filter(None, (
            f"long run: {done_text}, about {remaining:.1g} s more at this pace",
            explain_short_steps(progress.scene, progress.t, progress.state, *progress.pace),
            "--time-limit stops it",
        ))))  # fmt: skip
