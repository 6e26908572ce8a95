"""A solved scene that several Python threads may use: a lock admits one at a time, because the kernel's memory serves
one.

Impure: caches results.
"""

from __future__ import annotations

from _thread import RLock  # the lock of threading, whose import takes 0.5 ms
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from heuncli.app.python.python_warnings import emit_warnings
from heuncli.base.errors import Problem, SpecError, UsageError
from heuncli.output.tables.run_description import collect_warnings
from heuncli.results.results import Array, Results
from heuncli.study.model.options import require_within_run
from heuncli.study.model.setup import attach_locations
from heuncli.study.queries.study import Study

if TYPE_CHECKING:
    from heuncli.app.python.number import Number


class UnknownPath(SpecError, KeyError):
    """A path that leads to no number of the results; the hint suggests a similar one. Also a KeyError."""

    def __str__(self) -> str:
        return "\n".join(map(str, self.problems))


class LockedRun:
    """A study, and its results at its own instants or at others, behind a lock."""

    def __init__(self, study: Study, results: Results | None = None, lock: RLock | None = None) -> None:
        """results: results at other instants than the study's
        lock: the lock of other runs that share the study
        """
        self.study = study
        self.results = study.results if results is None else results
        self._lock = RLock() if lock is None else lock

    @property
    def times(self) -> Array:
        """Instants of the results, (n_t,) [s]. A read-only view of the run's own."""
        times = self.results.time.view()
        times.flags.writeable = False
        return times

    @property
    def horizon(self) -> float | None:
        """The instant [s] from which on no result is claimed, or None if all are."""
        return self.results.horizon

    @property
    def instants(self) -> Array | None:
        """Instants of the results (n,) [s] if they differ from the study's, else None."""
        return None if self.results is self.study.results else self.results.time

    @contextmanager
    def hold_lock(self) -> Iterator[None]:
        """Hold the lock; emit the warnings that arise meanwhile, and add spec locations to errors."""
        with self._lock, attach_locations(self.study.spec):
            known = {*self.study.later_warnings}
            yield
            new = [text for text in self.study.later_warnings if text not in known]
        emit_warnings(new)

    def warnings(self) -> list[str]:
        """Return the warnings of reading, of solving and of all later requests, each sentence once."""
        read, solved = collect_warnings(self.study.spec, self.study.results, self.study.later_warnings)
        return list(dict.fromkeys([*read, *solved]))

    def measure(self, words: str) -> Number:
        """Compute the number that the words of a measure describe. Raises UsageError, SpecError [unknown-path]."""
        from heuncli.app.python.number import compute_number

        with self.hold_lock():
            return compute_number(self.study, words)

    def resample(self, times: Array) -> LockedRun:
        """Return the same run at other instants, (n,) [s] ascending. Raises UsageError for no instants or any outside
        the run.
        """
        if not len(times):
            raise UsageError(Problem("bad-option", "at: no instants are given", hint="for example at=[0.1, 0.2], in s"))
        with self.hold_lock():
            results = self.study.resample(require_within_run("at", times.tolist(), self.study.results.time))
        return LockedRun(self.study, results, self._lock)


def find_distinct_instants(times: object) -> tuple[Array, Array]:
    """Return the instants as an array (...), and each of them once, ascending (n,)."""
    requested = np.asarray(times, dtype=np.float64)
    return requested, np.unique(requested)
