"""A progress bar on standard error: only on a terminal, and only for work that takes a while. Impure."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from heuncli.app.cli.terminal import styled
from heuncli.base.signals import Undoing

PATIENCE = 1.5  # seconds before it shows
WIPE = b"\r\x1b[2K\x1b[?25h"  # clears the line and shows the cursor, which the bar hides
Tell = Callable[[int, int, str], None]


@contextmanager
def progress(quiet: bool) -> Iterator[Tell]:
    """What work calls with how much is done of how much, and what is under way."""
    bar = None if quiet or sys.stderr is None or not sys.stderr.isatty() or not styled() else Bar()
    if bar is None:
        yield _silent
        return
    try:
        with Undoing(bar.wipe):
            yield bar.tell
    finally:
        bar.close()


def _silent(done: int, of: int, what: str) -> None:
    """Nothing is told."""


class Bar:
    """The bar, which is made when the work has taken a while."""

    def __init__(self) -> None:
        self.begun = time.monotonic()
        self.shown: Any = None
        self.task: Any = None

    def tell(self, done: int, of: int, what: str) -> None:
        """So much is done."""
        if self.shown is None:
            if time.monotonic() - self.begun < PATIENCE:
                return
            from rich.console import Console  # 44 ms, only for long work
            from rich.progress import BarColumn, Progress, TextColumn

            columns = (BarColumn(), TextColumn("{task.percentage:>3.0f} %  {task.description}"))
            self.shown = Progress(*columns, console=Console(stderr=True), transient=True)
            self.shown.start()
            self.task = self.shown.add_task(what, total=of)
        self.shown.update(self.task, completed=done, total=of, description=what)

    def wipe(self) -> None:
        """Take it away at once, where a signal leaves no time to."""
        if self.shown is not None:
            os.write(2, WIPE)

    def close(self) -> None:
        """Take it away."""
        if self.shown is not None:
            self.shown.stop()
