"""Show a progress bar on standard error, only on a terminal and only for work that takes a while. Impure."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from heuncli.app.cli.terminal import supports_styles
from heuncli.base.signals import CleanupOnSignal

PATIENCE = 1.5  # seconds before it shows
WIPE = b"\r\x1b[2K\x1b[?25h"  # clears the line and shows the cursor, which the bar hides
ReportProgress = Callable[[int, int, str], None]


@contextmanager
def show_progress(quiet: bool) -> Iterator[ReportProgress]:
    """Provide the function that work calls with the count done, the total, and the current task; wipe the bar at the
    end.
    """
    bar = None if quiet or sys.stderr is None or not sys.stderr.isatty() or not supports_styles() else ProgressBar()
    if bar is None:
        yield _ignore_progress
        return
    try:
        with CleanupOnSignal(bar.wipe):
            yield bar.update
    finally:
        bar.close()


def _ignore_progress(count: int, total: int, task: str) -> None:
    """Do nothing: no bar is shown."""


class ProgressBar:
    """A progress bar that appears once the work has taken a while."""

    def __init__(self) -> None:
        self.start_time = time.monotonic()
        self.display: Any = None
        self.task: Any = None

    def update(self, count: int, total: int, task: str) -> None:
        """Show the progress; makes the bar after PATIENCE seconds."""
        if self.display is None:
            if time.monotonic() - self.start_time < PATIENCE:
                return
            from rich.console import Console  # 44 ms, only for long work
            from rich.progress import BarColumn, Progress, TextColumn

            columns = (BarColumn(), TextColumn("{task.percentage:>3.0f} %  {task.description}"))
            self.display = Progress(*columns, console=Console(stderr=True), transient=True)
            self.display.start()
            self.task = self.display.add_task(task, total=total)
        self.display.update(self.task, completed=count, total=total, description=task)

    def wipe(self) -> None:
        """Erase the bar at once, when a signal ends the process."""
        if self.display is not None:
            os.write(2, WIPE)

    def close(self) -> None:
        """Stop and erase the bar."""
        if self.display is not None:
            self.display.stop()
