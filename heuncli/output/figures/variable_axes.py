"""Axes of what a sweep varied, and of what it measured."""

from __future__ import annotations

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import Scaling
from heuncli.output.drawing.ticks import ends, near_zero
from heuncli.output.figures.swept import SweptVariable
from heuncli.results.results import Array

NAMES_WIDE, NAMES_MOST = 100, 12  # letters and names below an axis; more are numbered
EVEN = 1e-6  # of steps between values: those of equal steps


class VariableAxis(NamedTuple):
    """A variable along an axis: its places (n,) of all rows, its levels, how these are told, and what is numbered."""

    variable: SweptVariable
    scaling: Scaling
    note: str


def axis_of(variable: SweptVariable, *, cells: bool = False) -> VariableAxis:
    """A variable along an axis; cells: each of its values has a cell."""
    levels = variable.levels
    if variable.texts:
        names = [variable.texts[int(k)] for k in levels]
        numbered = len(names) > NAMES_MOST or sum(map(len, names)) > NAMES_WIDE
        told = [str(k + 1) for k in range(len(names))] if numbered else names
        scaling = Scaling(
            variable.name, float(levels[0]) - 0.5, float(levels[-1]) + 0.5,
            named=tuple(zip(levels.tolist(), told, strict=True)),
        )  # fmt: skip
        pairs = ", ".join(f"{k} {name}" for k, name in zip(told, names, strict=True))
        return VariableAxis(variable, scaling, f"{variable.name}: {pairs}" if numbered else "")
    by_ratio = _by_ratio(levels)
    if cells:
        edges = _between(levels, by_ratio)
        return VariableAxis(variable, Scaling(variable.head, float(edges[0]), float(edges[-1]), by_ratio), "")
    if by_ratio:
        return VariableAxis(variable, Scaling(variable.head, float(levels[0]), float(levels[-1]), logarithmic=True), "")
    return VariableAxis(variable, Scaling(variable.head, *ends(float(levels[0]), float(levels[-1]), spare=0.03)), "")


def _by_ratio(levels: Array) -> bool:
    """Whether values stand evenly by their logarithms, and not by themselves."""
    if len(levels) < 3 or levels[0] <= 0.0:
        return False
    steps, ratios = np.diff(levels), np.diff(np.log(levels))
    return bool(np.ptp(ratios) <= EVEN * ratios.max() and np.ptp(steps) > EVEN * steps.max())


def _between(levels: Array, by_ratio: bool) -> Array:
    """The edges of the cells of values, (n + 1,): half way between neighbours."""
    at = np.log(levels) if by_ratio else levels
    middle = 0.5 * (at[1:] + at[:-1])
    edges = np.concatenate([[2.0 * at[0] - middle[0]], middle, [2.0 * at[-1] - middle[-1]]])
    return np.asarray(np.exp(edges) if by_ratio else edges)


def edges_of(variable: SweptVariable, scaling: Scaling) -> Array:
    """The edges of the cells of a variable along its axis."""
    if variable.texts:
        return np.asarray(np.arange(len(variable.levels) + 1) + scaling.low)
    return _between(variable.levels, scaling.logarithmic)


def measured_axis(unit: str, values: Array, errors: Array, spare: float = 0.12) -> Scaling:
    """The axis of a measure."""
    known = np.isfinite(values)
    low = float((values - errors)[known].min()) if known.any() else 0.0
    high = float((values + errors)[known].max()) if known.any() else 1.0
    return Scaling(f"[{unit or '-'}]", *ends(low, high, zero=near_zero(low, high), spare=spare))
