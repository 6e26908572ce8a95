"""A solved scene that is asked from Python: by one at a time, for the kernel's memory serves one.

Impure: keeps answers.
"""

from __future__ import annotations

from _thread import RLock  # that of threading, which takes 0.5 ms
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from heuncli.app.python.warned import warn
from heuncli.base.errors import Problem, SpecError, UsageError
from heuncli.output.snapshots.warned import warnings_of
from heuncli.results.results import Array, Results
from heuncli.study.ask.asked_values import within_run
from heuncli.study.ask.study import Study
from heuncli.study.model.error_places import placed

if TYPE_CHECKING:
    from heuncli.app.python.measured import Number


class UnknownPath(SpecError, KeyError):
    """A path that leads to no number of the results; the hint says what may be meant. A KeyError, too."""

    def __str__(self) -> str:
        return "\n".join(map(str, self.problems))


class AskedRun:
    """A study, and its results at its own instants or at others."""

    def __init__(self, study: Study, results: Results | None = None, lock: RLock | None = None) -> None:
        """results: at other instants than the study's; lock: of whoever asks the same study."""
        self.study = study
        self.results = study.results if results is None else results
        self._lock = RLock() if lock is None else lock

    @property
    def times(self) -> Array:
        """The instants at which it is told, (n_t,) [s]. Read-only: the run's own."""
        times = self.results.time.view()
        times.flags.writeable = False
        return times

    @property
    def horizon(self) -> float | None:
        """The instant [s] from which on nothing is claimed; None where all is."""
        return self.results.horizon

    @property
    def instants(self) -> Array | None:
        """Those at which it is told (n,), where they are others than the study's."""
        return None if self.results is self.study.results else self.results.time

    @contextmanager
    def asking(self) -> Iterator[None]:
        """Alone with the kernel; what is warned of meanwhile is told, errors get their places in the spec."""
        with self._lock, placed(self.study.spec):
            before = {*self.study.later_warnings}
            yield
            new = [text for text in self.study.later_warnings if text not in before]
        warn(new)

    def warnings(self) -> list[str]:
        """What reading and solving warned of, and all that was asked since: sentences, once each."""
        read, solved = warnings_of(self.study.spec, self.study.results, self.study.later_warnings)
        return list(dict.fromkeys([*read, *solved]))

    def measure(self, words: str) -> Number:
        """The number that the words of a measure mean. Raises UsageError, SpecError [unknown-path]."""
        from heuncli.app.python.measured import measured

        with self.asking():
            return measured(self.study, words)

    def told_at(self, times: Array) -> AskedRun:
        """The same run at other instants, (n,) ascending. Raises UsageError outside of it, and for none."""
        if not len(times):
            raise UsageError(Problem("bad-option", "at: no instants are given", hint="such as at=[0.1, 0.2], in s"))
        with self.asking():
            found = self.study.resample(within_run("at", times.tolist(), self.study.results.time))
        return AskedRun(self.study, found, self._lock)


def distinct(times: object) -> tuple[Array, Array]:
    """Instants as they were asked for (...), and each of them once, ascending (n,)."""
    asked = np.asarray(times, dtype=np.float64)
    return asked, np.unique(asked)
