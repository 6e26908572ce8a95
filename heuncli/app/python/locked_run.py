"""A solved scene that several Python threads may use: a lock admits one at a time, because the kernel's memory serves
one. Its numbers with unit and error, and its warnings as Python warnings.

Impure: caches results, emits warnings.
"""

from __future__ import annotations

import math
import sys
import warnings
from _thread import RLock  # the lock of threading, whose import takes 0.5 ms
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import numpy as np

from heuncli.base.errors import Problem, SpecError, UsageError
from heuncli.output.documents.document import append_unit
from heuncli.output.tables import measure
from heuncli.output.tables.run_description import collect_warnings
from heuncli.results.results import Array, Results
from heuncli.study.model.options import require_within_run
from heuncli.study.model.setup import attach_locations
from heuncli.study.queries.measure_uncertainty import find_unit, measure_uncertainty
from heuncli.study.queries.study import Study

OWN_FRAMES = (__name__.partition(".")[0], "contextlib")  # frames that are heun's own


class HeunWarning(UserWarning):
    """A warning of a run: `warnings.simplefilter("error", heuncli.HeunWarning)` turns it into an error."""


def emit_warnings(texts: Iterable[str]) -> None:
    """Emit each text as a Python warning, at the line of the first caller outside heun."""
    messages = list(texts)
    if not messages:
        return
    depth, frame = 1, sys._getframe()
    while frame.f_back is not None and str(frame.f_globals.get("__name__", "")).partition(".")[0] in OWN_FRAMES:
        depth, frame = depth + 1, frame.f_back
    for text in messages:
        warnings.warn(text, HeunWarning, stacklevel=depth)


COMMAND = "measure"


class Number(float):
    """A number of a run: a float with its unit, error, instant and position.

    unit: SI
    error: the stated absolute error, nan if the run states none
    at: its instant [s], or None
    s: position along a series of cuts [m]; side, cut: the side of a load there, and the number of the cut
    horizon: the instant [s] from which on nothing is claimed, if that makes the number nan
    is_open: whether it is nan because the laws of rigid bodies do not determine it
    """

    unit: str = ""
    error: float = math.nan
    at: float | None = None
    s: float | None = None
    side: str | None = None
    cut: int | None = None
    horizon: float | None = None
    is_open: bool = False

    def __repr__(self) -> str:
        words = append_unit(str(self), self.unit)
        words += f" at t = {self.at:.6g} s" if self.at is not None else ""
        words += f", s = {self.s:.6g} m" if self.s is not None else ""
        words += f" (error {self.error:.2g})" if math.isfinite(self.error) else ""
        words += f" (not reliable from t = {self.horizon:.4g} s on)" if self.horizon is not None else ""
        return words + (" (open)" if self.is_open else "")

    def __str__(self) -> str:
        return float.__repr__(self)


def compute_number(study: Study, words: str) -> Number:
    """Compute the number that the words of a measure describe. Raises UsageError, SpecError [unknown-path]."""
    request = measure.parse_measure(words, COMMAND)
    measure.require_known_paths([request], study.spec, COMMAND)
    peak, horizon = measure.measure_number(request, study, COMMAND)
    block = measure.describe_measure(request, study, peak, horizon)
    number = Number(math.nan if block["value"] is None else block["value"])
    number.unit, number.at, number.horizon = find_unit(request.path, study.spec), block["at"], block.get("horizon")
    number.s, number.side, number.cut = block.get("s"), block.get("side"), block.get("cut")
    stated = measure_uncertainty(study, request.path, request.how, peak.value)
    number.error = math.nan if stated is None else float(stated)
    number.is_open = math.isnan(number) and number.horizon is None and number.at not in study.unknown
    return number


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
