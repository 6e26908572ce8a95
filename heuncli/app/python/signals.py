"""The numbers at one path of the results: an array with its instants, its unit and its error."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from heuncli.app.python.arguments import NUMBERS, check_arguments
from heuncli.app.python.asked_run import AskedRun, UnknownPath, distinct
from heuncli.base.errors import Problem, SpecError, UsageError
from heuncli.base.foreign_text import shown
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Mask, Results
from heuncli.results.results_paths import Numbers, find, section_of
from heuncli.results.results_schema import BLOWS, CUT, EVENTS, REPORT_OF, quantity
from heuncli.study.ask.measure import MeasureRequest, Peak, lost_from
from heuncli.study.quantities.series import component_names
from heuncli.study.quantities.stated import error_of, unit_of

if TYPE_CHECKING:
    from heuncli.app.python.measured import Number

LISTS = (BLOWS, "certain_sums")  # blocks of the results that are lists of blocks
SUMS = "certain_sums"


def signal_at(run: AskedRun, path: str) -> Signal:
    """The numbers at a path. Raises UnknownPath."""
    results = run.results
    if not isinstance(path, str):
        message = f"{shown(repr(path))[:60]} is no path into the results"
        raise UnknownPath(Problem("unknown-path", message, hint='paths are texts, such as "energy.kinetic"'))
    try:
        return Signal(run, path, find(results, path))
    except SpecError as error:
        problems = [problem._replace(hint=_left_out(results, path) or problem.hint) for problem in error.problems]
        raise UnknownPath(*problems) from None


def _left_out(results: Results, path: str) -> str:
    """A hint: that a whole report was not solved for."""
    block = path.split(".")[0]
    if block not in REPORT_OF or getattr(results, block):
        return ""
    return f"this run does not tell {block}: the scene has none, or `report` or only= leave them out"


def paths_of(results: Results) -> list[str]:
    """The paths of all numbers of the results, in the order of the JSON."""
    return [".".join(keys) for keys in _leaves(vars(results), ())]


def _leaves(node: Any, keys: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    if isinstance(node, dict):
        for key, member in node.items():
            yield from _leaves(member, (*keys, key))
    elif isinstance(node, list) and keys[-1] in LISTS:
        for number, member in enumerate(node):
            yield from _leaves(member, (*keys, str(number)))
    else:
        row = quantity(keys)
        if row is not None and row.units:
            yield keys


class CutRow(NamedTuple):
    """One row of a run of cuts: its distance from the first point [m], and the side of what acts there, if any."""

    s: float
    side: str | None


class Signal(NDArrayOperatorsMixin):
    """The numbers at one path of a solved scene: an array for NumPy, which knows its instants, unit and error.

    `values` (n_t, ...): over the instants first; then, as the quantity has them, the cuts of a run, the components
    x, y, z. What has no instants (`accuracy.horizon`, numbers of a blow) has them not: `times` is None.
    nan is what the laws of rigid bodies leave `open`, what is `unknown` beside a singular pose, and what lies `beyond`
    the horizon, from which on nothing is claimed; `computed` has these last, too, as the JSON has them.
    """

    def __init__(self, run: AskedRun, path: str, found: Numbers) -> None:
        self._run, self._found = run, found
        self.path = path

    @property
    def _time(self) -> Array:
        return self._run.times

    @property
    def unit(self) -> str:
        """The SI unit: "N", "N·m", "rad", ...; "1" of what has none."""
        keys = self._found.keys
        if SUMS in keys:
            return _unit_of_sum(self._run.results, keys)
        return unit_of(self.path, self._run.study.spec)

    @cached_property
    def error(self) -> float:
        """The stated absolute error of any of the numbers, in their unit; nan where the run states none.

        An estimate that holds for all instants of the run up to the horizon, asked or not.
        """
        with self._run.asking():
            stated = error_of(MeasureRequest("", self.path), Peak(math.nan, None), self._run.study)
        return math.nan if stated is None else float(stated)

    @property
    def label(self) -> str:
        """The path and the unit, as an axis is labelled: "joints.main.force [N]"."""
        return self.path if self.unit in ("", "1") else f"{self.path} [{self.unit}]"

    @property
    def times(self) -> Array | None:
        """The instants, (n_t,) [s]; None where the numbers do not run over them."""
        return self._time if self._found.timed else None

    @cached_property
    def computed(self) -> Array:
        """All numbers as they were computed, those beyond the horizon, too; nan is open or unknown. Read-only."""
        return _locked(np.array(self._found.values, dtype=np.float64))

    @cached_property
    def values(self) -> Array:
        """The numbers that are claimed, (n_t, ...); nan elsewhere. Read-only."""
        if not self.beyond.any():
            return self.computed
        values = self.computed.copy()
        values[self.beyond] = np.nan
        return _locked(values)

    @cached_property
    def beyond(self) -> Mask:
        """Which instants lie beyond the horizon, (n_t,); one truth () of what has no instants."""
        horizon, keys = self._run.horizon, self._found.keys
        if self._found.timed and keys != ("time",) and horizon is not None:
            return np.asarray(self._time >= horizon)
        if self._found.timed:
            return np.zeros(len(self._time), dtype=bool)
        lost = keys[0] != EVENTS and lost_from(MeasureRequest("", self.path), self._run.study) is not None
        return np.asarray(lost)

    @property
    def unknown(self) -> Mask:
        """Which instants stand beside a singular pose, where rounding reaches what is nan, (n_t,)."""
        lost = self._run.results.accuracy.get("unknown", ())
        return np.isin(self._time, lost) if self._found.timed else np.asarray(False)

    @cached_property
    def open(self) -> Mask:
        """Which of the numbers the laws of rigid bodies leave open, as `values` (n_t, ...)."""
        unknown = self.unknown.reshape(self.unknown.shape + (1,) * (self.computed.ndim - self.unknown.ndim))
        return np.asarray(np.isnan(self.computed) & ~unknown)

    @property
    def components(self) -> tuple[str, ...]:
        """What the numbers of one instant are called behind the path: ("x", "y", "z"), ("0.x", ...), ("",) of one."""
        sizes = self.computed.shape[1 if self._found.timed else 0 :]
        return component_names(self._found.axes, sizes)

    @property
    def cuts(self) -> list[CutRow]:
        """The rows of a run of cuts, as the axis behind the instants has them; empty where it is no run."""
        if CUT not in self._found.axes:
            return []
        section = section_of(self._run.results, self._found.keys)
        s = section["s"].tolist()
        return [CutRow(at, side) for at, side in zip(s, section.get("side") or [None] * len(s), strict=True)]

    def at(self, times: float | Sequence[float] | Array) -> Array:
        """The numbers at any instants [s] of the run, in the order given, (*times.shape, ...); nothing is solved again.

        nan is open, unknown or beyond the horizon. Raises UsageError outside of the run, and of what has no instants.
        """
        if not self._found.timed:
            message = f"at: {self.path} has no instants"
            raise UsageError(Problem("bad-option", message, hint=f'its numbers are study["{self.path}"].values'))
        check_arguments(("times", times, NUMBERS), optional=False)
        asked, once = distinct(times)
        if not len(once):
            return np.zeros((*asked.shape, *self.computed.shape[1:]))
        found = find(self._run.told_at(once).results, self.path).values
        if self._run.horizon is not None:
            found = np.array(found)
            found[once >= self._run.horizon] = np.nan
        return np.asarray(found[np.searchsorted(once, asked)])

    def highest(self) -> Number:
        """The highest over the whole run up to the horizon, between the samples, too; of vectors the magnitude."""
        return self._run.measure(f"max {self.path}")

    def lowest(self) -> Number:
        """The lowest, likewise."""
        return self._run.measure(f"min {self.path}")

    def largest(self) -> Number:
        """The largest magnitude, likewise."""
        return self._run.measure(f"max abs {self.path}")

    # -- as an array

    @property
    def shape(self) -> tuple[int, ...]:
        """Of `values`."""
        return self.values.shape

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        if dtype is None or np.dtype(dtype) == self.values.dtype:
            return self.values.copy() if copy else self.values
        if copy is False:
            raise ValueError(f"{self.path}: numbers of another type are a copy")
        return self.values.astype(dtype)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        if any(isinstance(out, Signal) for out in options.get("out", ())):
            return NotImplemented
        given = [each.values if isinstance(each, Signal) else each for each in inputs]
        return getattr(ufunc, method)(*given, **options)

    def __len__(self) -> int:
        return len(self.values)

    def __iter__(self) -> Iterator[Any]:
        return iter(self.values)

    def __getitem__(self, place: Any) -> Any:
        return self.values[place]

    def __float__(self) -> float:
        if self.values.size != 1:
            raise TypeError(f"{self.path} is {self.values.size} numbers: say which")
        return float(self.values.reshape(()))

    def __repr__(self) -> str:
        over = ""
        if self._found.timed:
            times = self._time
            over = f" over {times[0]:.6g} to {times[-1]:.6g} s" if len(times) > 1 else f" at t = {times[0]:.6g} s"
        parts = [f"<{self.label}: {self.values.shape}{over}"]
        parts += [f"error {self.error:.2g}"] if math.isfinite(self.error) else []
        for word, mask in (("open", self.open), ("beyond the horizon", self.beyond)):
            parts += [f"{int(mask.sum())} {word}"] if mask.any() else []
        return ", ".join(parts) + ">"


def _locked(values: Array) -> Array:
    values.flags.writeable = False
    return values


def _unit_of_sum(results: Results, keys: Sequence[str]) -> str:
    """The unit of a certain sum: of moments where no force is among its terms; of a blow in seconds times these."""
    block: Any = vars(results)
    for key in keys[:-1]:
        block = block[int(key) if isinstance(block, list) else key]
    row = quantity(tuple(keys))
    return "" if row is None else row.unit(turning=not any(".force." in term for term in block["terms"]))
