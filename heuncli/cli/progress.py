"""A progress bar on standard error: only on a terminal, and only for work that takes a while. Impure."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from heuncli.cli.terminal import styled

PATIENCE = 1.5  # seconds before it shows
Tell = Callable[[int, int, str], None]


@contextmanager
def progress(quiet: bool) -> Iterator[Tell]:
    """What work calls with how much is done of how much, and what is under way."""
    bar = None if quiet or sys.stderr is None or not sys.stderr.isatty() or not styled() else Bar()
    try:
        yield bar.tell if bar is not None else _silent
    finally:
        if bar is not None:
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

    def close(self) -> None:
        """Take it away."""
        if self.shown is not None:
            self.shown.stop()
