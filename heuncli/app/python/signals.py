"""The numbers at one path of the results: an array with its instants, its unit and its error."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from heuncli.app.python.arguments import NUMBERS, check_arguments
from heuncli.app.python.locked_run import LockedRun, UnknownPath, find_distinct_instants
from heuncli.base.errors import Problem, SpecError, UsageError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.output.documents.document import format_head
from heuncli.output.tables.measure import SUMS, find_sum_unit
from heuncli.results.path_words import find_quantity
from heuncli.results.results import Array, Mask, Results
from heuncli.results.results_paths import PathValues, find_section, find_values
from heuncli.results.results_schema import CUT, EVENTS, IMPULSES, REPORT_OF
from heuncli.study.quantities.channels import make_component_names
from heuncli.study.queries.measure import MeasureRequest, find_exceeded_horizon
from heuncli.study.queries.measure_uncertainty import find_unit, measure_uncertainty

if TYPE_CHECKING:
    from heuncli.app.python.locked_run import Number

LISTS = (IMPULSES, "certain_sums")  # blocks of the results that are lists of blocks


def make_signal(run: LockedRun, path: str) -> Signal:
    """Make the signal at a path of the results. Raises UnknownPath."""
    results = run.results
    if not isinstance(path, str):
        message = f"{escape(repr(path))[:60]} is not a result path"
        raise UnknownPath(Problem("unknown-path", message, hint='paths are strings, such as "energy.kinetic"'))
    try:
        return Signal(run, path, find_values(results, path))
    except SpecError as error:
        problems = [
            problem._replace(hint=_explain_missing_block(results, path) or problem.hint) for problem in error.problems
        ]
        raise UnknownPath(*problems) from None


def _explain_missing_block(results: Results, path: str) -> str:
    """Return a hint that a whole report was not solved for, or an empty text."""
    block = path.split(".")[0]
    if block not in REPORT_OF or getattr(results, block):
        return ""
    return f"this run has no {block}: the model has none, or `report` or only= leaves them out"


def list_paths(results: Results) -> list[str]:
    """List the paths of all numbers of the results, in the order of the JSON."""
    return [".".join(keys) for keys in _iter_leaves(vars(results), ())]


def _iter_leaves(node: Any, keys: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """Yield the keys that lead to each number over time below a node."""
    if isinstance(node, dict):
        for key, member in node.items():
            yield from _iter_leaves(member, (*keys, key))
    elif isinstance(node, list) and keys[-1] in LISTS:
        for number, member in enumerate(node):
            yield from _iter_leaves(member, (*keys, str(number)))
    else:
        row = find_quantity(keys)
        if row is not None and row.units:
            yield keys


class CutRow(NamedTuple):
    """One row of a series of cuts: its distance from the first point [m], and on which side of a load it lies, if at
    one.
    """

    s: float
    side: str | None


class Signal(NDArrayOperatorsMixin):
    """The numbers at one path of a solved scene: an array for NumPy, with instants, unit and error.

    `values` (n_t, ...): instants first; then, depending on the quantity, the cuts of a run and the components x, y, z.
    Numbers without instants (`accuracy.horizon`, those of an impulse) lack the first axis, and `times` is None. nan is
    what the laws of rigid bodies leave indeterminate (`open`), what is uncertain near a singular pose (`unknown`), and
    what lies past the horizon (`beyond`), from which on nothing is claimed; `computed` keeps the last, as the JSON
    does.
    """

    def __init__(self, run: LockedRun, path: str, numbers: PathValues) -> None:
        self._run, self._numbers = run, numbers
        self.path = path

    @property
    def _time(self) -> Array:
        """Instants of the run [s], (n_t,)."""
        return self._run.times

    @property
    def unit(self) -> str:
        """The SI unit: "N", "N·m", "rad", ...; "1" if dimensionless."""
        keys = self._numbers.keys
        if SUMS in keys:
            return find_sum_unit(self._run.results, keys)
        return find_unit(self.path, self._run.study.spec)

    @cached_property
    def error(self) -> float:
        """The stated absolute error of each number, in its unit, or nan if the run states none.

        The estimate holds at all instants of the run up to the horizon, not only at those of `times`.
        """
        with self._run.hold_lock():
            stated = measure_uncertainty(self._run.study, self.path)
        return math.nan if stated is None else float(stated)

    @property
    def label(self) -> str:
        """The path and the unit, for an axis: "joints.main.force [N]"."""
        return format_head(self.path, self.unit)

    @property
    def times(self) -> Array | None:
        """The instants, (n_t,) [s], or None if the numbers do not depend on time."""
        return self._time if self._numbers.is_timed else None

    @cached_property
    def computed(self) -> Array:
        """All numbers as they were computed, also past the horizon; nan is indeterminate or unknown. Read-only."""
        return _make_read_only(np.array(self._numbers.values, dtype=np.float64))

    @cached_property
    def values(self) -> Array:
        """The numbers that are claimed, (n_t, ...), and nan elsewhere. Read-only."""
        if not self.beyond.any():
            return self.computed
        values = self.computed.copy()
        values[self.beyond] = np.nan
        return _make_read_only(values)

    @cached_property
    def beyond(self) -> Mask:
        """Mask of the instants past the horizon, (n_t,); shape () for numbers without instants."""
        horizon, keys = self._run.horizon, self._numbers.keys
        if self._numbers.is_timed and keys != ("time",) and horizon is not None:
            return np.asarray(self._time >= horizon)
        if self._numbers.is_timed:
            return np.zeros(len(self._time), dtype=bool)
        is_lost = (
            keys[0] != EVENTS and find_exceeded_horizon(MeasureRequest("", self.path), self._run.study) is not None
        )
        return np.asarray(is_lost)

    @property
    def unknown(self) -> Mask:
        """Mask of the instants near a singular pose where rounding errors make the numbers uncertain, (n_t,)."""
        unknown_times = self._run.results.accuracy.get("unknown", ())
        return np.isin(self._time, unknown_times) if self._numbers.is_timed else np.asarray(False)

    @cached_property
    def open(self) -> Mask:
        """Mask of the numbers that the laws of rigid bodies leave indeterminate, shaped as `values` (n_t, ...)."""
        unknown = self.unknown.reshape(self.unknown.shape + (1,) * (self.computed.ndim - self.unknown.ndim))
        return np.asarray(np.isnan(self.computed) & ~unknown)

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the numbers of one instant, appended to the path: ("x", "y", "z"), ("0.x", ...), or ("",) for one
        number.
        """
        sizes = self.computed.shape[1 if self._numbers.is_timed else 0 :]
        return make_component_names(self._numbers.axes, sizes)

    @property
    def cuts(self) -> list[CutRow]:
        """The rows of a series of cuts, in the order of the axis after the instants; empty for other numbers."""
        if CUT not in self._numbers.axes:
            return []
        section = find_section(self._run.results, self._numbers.keys)
        s = section["s"].tolist()
        return [
            CutRow(position, side) for position, side in zip(s, section.get("side") or [None] * len(s), strict=True)
        ]

    def at(self, times: float | Sequence[float] | Array) -> Array:
        """Return the numbers at any instants [s] of the run, in the given order, (*times.shape, ...); nothing is solved
        again.

        nan is indeterminate, unknown or beyond the horizon. Raises UsageError for instants outside the run, and for
        numbers without instants.
        """
        if not self._numbers.is_timed:
            message = f"at: {self.path} does not depend on time"
            raise UsageError(Problem("bad-option", message, hint=f'use study["{self.path}"].values'))
        check_arguments(("times", times, NUMBERS), optional=False)
        requested, distinct_times = find_distinct_instants(times)
        if not len(distinct_times):
            return np.zeros((*requested.shape, *self.computed.shape[1:]))
        samples = find_values(self._run.resample(distinct_times).results, self.path).values
        if self._run.horizon is not None:
            samples = np.array(samples)
            samples[distinct_times >= self._run.horizon] = np.nan
        return np.asarray(samples[np.searchsorted(distinct_times, requested)])

    def highest(self) -> Number:
        """Return the maximum over the whole run up to the horizon, searched between the samples; of a vector that of
        its magnitude.
        """
        return self._run.measure(f"max {self.path}")

    def lowest(self) -> Number:
        """Return the minimum, likewise."""
        return self._run.measure(f"min {self.path}")

    def largest(self) -> Number:
        """Return the largest magnitude, likewise."""
        return self._run.measure(f"max abs {self.path}")

    # -- as an array

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of `values`."""
        return self.values.shape

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        if dtype is None or np.dtype(dtype) == self.values.dtype:
            return self.values.copy() if copy else self.values
        if copy is False:
            raise ValueError(f"{self.path}: another dtype requires a copy")
        return self.values.astype(dtype)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        if any(isinstance(out, Signal) for out in options.get("out", ())):
            return NotImplemented
        arrays = [each.values if isinstance(each, Signal) else each for each in inputs]
        return getattr(ufunc, method)(*arrays, **options)

    def __len__(self) -> int:
        return len(self.values)

    def __iter__(self) -> Iterator[Any]:
        return iter(self.values)

    def __getitem__(self, place: Any) -> Any:
        return self.values[place]

    def __float__(self) -> float:
        if self.values.size != 1:
            raise TypeError(f"{self.path} has {self.values.size} numbers: select one")
        return float(self.values.reshape(()))

    def __repr__(self) -> str:
        range_text = ""
        if self._numbers.is_timed:
            times = self._time
            range_text = f" over {times[0]:.6g} to {times[-1]:.6g} s" if len(times) > 1 else f" at t = {times[0]:.6g} s"
        parts = [f"<{self.label}: {self.values.shape}{range_text}"]
        parts += [f"error {self.error:.2g}"] if math.isfinite(self.error) else []
        for word, mask in (("open", self.open), ("past the horizon", self.beyond)):
            parts += [f"{int(mask.sum())} {word}"] if mask.any() else []
        return ", ".join(parts) + ">"


def _make_read_only(values: Array) -> Array:
    """Return the array, which can no longer be written to."""
    values.flags.writeable = False
    return values
