"""What acts over a cycle: root of the mean square and largest magnitude, searched between the nodes as in a run."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from heuncli import tolerances
from heuncli.balancing.nodes import Course, Nodes
from heuncli.balancing.results import Residual
from heuncli.records import replace
from heuncli.results import Array
from heuncli.study.search.extremes import search

HIGHEST = (1.0,)


def residuals(
    kinds: Mapping[str, Array], nodes: Nodes, least: Mapping[str, float], noise: Mapping[str, float]
) -> dict[str, Residual]:
    """Of each kind the sum over the bodies of values (n, bodies, c).

    least: what is below is rounding, or an error; noise: what values are off by besides what the nodes tell.
    """
    found = {}
    for name, values in kinds.items():
        sum_ = values.sum(axis=1)
        largest = float(np.sqrt(np.sum(sum_**2, axis=1)).max())
        terms = float(np.sqrt(np.sum(values**2, axis=2)).sum(axis=1).max())
        if largest <= max(tolerances.CANCELS * terms, least[name]):
            found[name] = Residual(0.0, 0.0, float(nodes.begin), max(largest, least[name]))
        else:
            own = of_vectors(sum_, nodes)
            found[name] = replace(own, error=own.error + noise[name])
    return found


def of_vectors(values: Array, nodes: Nodes) -> Residual:
    """Of the magnitudes of vectors (n, c)."""
    course = nodes.course(values)
    error = float(np.sqrt(np.sum(nodes.errors(values).value ** 2)))

    def squares(x: Array) -> Array:
        return np.asarray(np.sum(course(x) ** 2, axis=1)[:, None])

    rms = float(np.sqrt(nodes.weights @ np.sum(values**2, axis=1)))
    peak, at = highest(squares, nodes, error)
    return Residual(rms, peak, at, error)


def highest(squares: Course, nodes: Nodes, error: float) -> tuple[float, float]:
    """The largest magnitude by its squares, (n, 1), and its angle; of what does not vary that of the first node."""
    grid = nodes.grid
    top = search(squares, grid, errors=np.array([error]), even=np.array([True]), sides=HIGHEST)
    peak = math.sqrt(max(float(top.high[0]), 0.0))
    alike = np.flatnonzero(np.sqrt(np.maximum(squares(grid)[:, 0], 0.0)) >= peak - error)
    return peak, nodes.angle(float(grid[alike[0]] if len(alike) else top.high_at[0]))


def of_squares(values: Array, nodes: Nodes) -> Residual:
    """Of a magnitude whose squares are values (n,); the error of these is told by the magnitude."""
    course = nodes.course(values[:, None])
    largest = float(values.max(initial=0.0))
    off = float(nodes.errors(values[:, None]).value[0])
    error = off / math.sqrt(largest) if largest > off else math.sqrt(off)
    rms = math.sqrt(max(float(nodes.weights @ values), 0.0))
    peak, at = highest(course, nodes, error)
    return Residual(rms, peak, at, error)
