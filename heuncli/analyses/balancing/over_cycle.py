"""What acts over a cycle: root of the mean square and largest magnitude, searched between the nodes as in a run."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from heuncli.analyses.balancing.nodes import Course, CycleNodes
from heuncli.analyses.balancing.results import Residual
from heuncli.base import tolerances
from heuncli.base.records import replace
from heuncli.results.results import Array
from heuncli.study.search.extremes import search

HIGHEST = (1.0,)


def residuals(
    kinds: Mapping[str, Array], nodes: CycleNodes, least: Mapping[str, float], noise: Mapping[str, float]
) -> dict[str, Residual]:
    """Of each kind the sum over the bodies of values (n, bodies, c).

    least: what is below is rounding, or an error; noise: what values are off by besides what the nodes tell.
    """
    sums = {name: values.sum(axis=1) for name, values in kinds.items()}
    found = of_vectors(sums, nodes)
    for name, values in kinds.items():
        largest = float(np.sqrt(np.sum(sums[name] ** 2, axis=1)).max())
        terms = float(np.sqrt(np.sum(values**2, axis=2)).sum(axis=1).max())
        if largest <= max(tolerances.CANCELS * terms, least[name]):
            found[name] = Residual(0.0, 0.0, float(nodes.begin), max(largest, least[name]))
        else:
            found[name] = replace(found[name], error=found[name].error + noise[name])
    return found


def of_vectors(kinds: Mapping[str, Array], nodes: CycleNodes) -> dict[str, Residual]:
    """Of the magnitudes of vectors (n, c) of some kinds."""
    values = np.concatenate([*kinds.values()], axis=1)
    course, ends = nodes.course(values), np.cumsum([own.shape[1] for own in kinds.values()])
    off = nodes.errors(values).value
    slices = [slice(end - own.shape[1], end) for own, end in zip(kinds.values(), ends, strict=True)]
    errors = np.array([math.sqrt(float(np.sum(off[part] ** 2))) for part in slices])

    def squares(x: Array) -> Array:
        own = course(x) ** 2
        return np.stack([own[:, part].sum(axis=1) for part in slices], axis=1)

    means = [float(nodes.weights @ np.sum(own**2, axis=1)) for own in kinds.values()]
    tops = highest(squares, nodes, errors)
    return {
        name: Residual(math.sqrt(mean), peak, at, error)
        for name, mean, (peak, at), error in zip(kinds, means, tops, errors.tolist(), strict=True)
    }


def of_squares(kinds: Mapping[str, Array], nodes: CycleNodes) -> dict[str, Residual]:
    """Of magnitudes whose squares are values (n,); the errors of these are told by the magnitudes."""
    values = np.stack([*kinds.values()], axis=1)
    off, largest = nodes.errors(values).value, values.max(axis=0, initial=0.0)
    roots = np.sqrt(np.maximum(largest, off))
    errors = np.divide(
        off, roots, out=np.zeros_like(off), where=roots > 0.0
    )  # what an error of the square makes of its root
    means = np.maximum(nodes.weights @ values, 0.0).tolist()
    tops = highest(nodes.course(values), nodes, errors)
    return {
        name: Residual(math.sqrt(mean), peak, at, error)
        for name, mean, (peak, at), error in zip(kinds, means, tops, errors.tolist(), strict=True)
    }


def highest(squares: Course, nodes: CycleNodes, errors: Array) -> list[tuple[float, float]]:
    """The largest of each magnitude by its squares, (n, m), and its angle; of what does not vary that of the first."""
    grid = nodes.grid
    there = squares(grid)

    def sample(x: Array) -> Array:
        return there if x is grid else squares(x)  # which the search begins with

    top = search(sample, grid, errors=errors, even=np.ones(len(errors), dtype=bool), sides=HIGHEST)
    found = []
    for k, error in enumerate(errors.tolist()):
        peak = math.sqrt(max(float(top.high[k]), 0.0))
        alike = np.flatnonzero(np.sqrt(np.maximum(there[:, k], 0.0)) >= peak - error)
        found.append((peak, nodes.angle(float(grid[alike[0]] if len(alike) else top.high_at[k]))))
    return found
