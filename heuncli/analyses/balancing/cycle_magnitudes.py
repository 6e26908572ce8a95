"""Root mean square and largest magnitude of quantities over a cycle; the maximum is searched between the nodes as in a
run.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from heuncli.analyses.balancing.cycle_nodes import CycleNodes, Interpolant
from heuncli.analyses.balancing.results import Residual
from heuncli.base import tolerances
from heuncli.base.records import replace
from heuncli.results.results import Array
from heuncli.study.search.extremes import search_extremes

MAXIMUM_ONLY = (1.0,)


def compute_residuals(
    kinds: Mapping[str, Array], nodes: CycleNodes, thresholds: Mapping[str, float], noise: Mapping[str, float]
) -> dict[str, Residual]:
    """Return rms and peak of each kind's sum over the bodies, for values (n, bodies, c).

    thresholds: sums below are rounding, or within the error
    noise: errors of the values in addition to those at the nodes
    """
    sums = {name: values.sum(axis=1) for name, values in kinds.items()}
    magnitudes = compute_vector_magnitudes(sums, nodes)
    for name, values in kinds.items():
        largest = float(np.sqrt(np.sum(sums[name] ** 2, axis=1)).max())
        terms = float(np.sqrt(np.sum(values**2, axis=2)).sum(axis=1).max())
        if largest <= max(tolerances.CANCELS * terms, thresholds[name]):
            magnitudes[name] = Residual(0.0, 0.0, float(nodes.begin), max(largest, thresholds[name]))
        else:
            magnitudes[name] = replace(magnitudes[name], error=magnitudes[name].error + noise[name])
    return magnitudes


def compute_vector_magnitudes(kinds: Mapping[str, Array], nodes: CycleNodes) -> dict[str, Residual]:
    """Return rms and peak of the magnitudes of vectors (n, c) of several kinds."""
    values = np.concatenate([*kinds.values()], axis=1)
    interpolant, ends = nodes.interpolate(values), np.cumsum([own.shape[1] for own in kinds.values()])
    value_errors = nodes.estimate_errors(values).value
    slices = [slice(end - own.shape[1], end) for own, end in zip(kinds.values(), ends, strict=True)]
    errors = np.array([math.sqrt(float(np.sum(value_errors[part] ** 2))) for part in slices])

    def compute_squares(x: Array) -> Array:
        own = interpolant(x) ** 2
        return np.stack([own[:, part].sum(axis=1) for part in slices], axis=1)

    means = [float(nodes.weights @ np.sum(own**2, axis=1)) for own in kinds.values()]
    peaks = find_peaks(compute_squares, nodes, errors)
    return {
        name: Residual(math.sqrt(mean), peak, at, error)
        for name, mean, (peak, at), error in zip(kinds, means, peaks, errors.tolist(), strict=True)
    }


def compute_square_root_magnitudes(kinds: Mapping[str, Array], nodes: CycleNodes) -> dict[str, Residual]:
    """Return rms and peak of magnitudes whose squares are the values (n,); errors refer to the magnitudes."""
    values = np.stack([*kinds.values()], axis=1)
    value_errors, largest = nodes.estimate_errors(values).value, values.max(axis=0, initial=0.0)
    roots = np.sqrt(np.maximum(largest, value_errors))
    # error of the root from the error of the square
    errors = np.divide(value_errors, roots, out=np.zeros_like(value_errors), where=roots > 0.0)
    means = np.maximum(nodes.weights @ values, 0.0).tolist()
    peaks = find_peaks(nodes.interpolate(values), nodes, errors)
    return {
        name: Residual(math.sqrt(mean), peak, at, error)
        for name, mean, (peak, at), error in zip(kinds, means, peaks, errors.tolist(), strict=True)
    }


def find_peaks(squares: Interpolant, nodes: CycleNodes, errors: Array) -> list[tuple[float, float]]:
    """Return the peak of each magnitude from its squares, (n, m), and the angle of the peak; the first such angle for a
    constant one.
    """
    grid = nodes.grid
    grid_squares = squares(grid)

    def sample(x: Array) -> Array:
        return grid_squares if x is grid else squares(x)  # the search begins with the grid

    extremes = search_extremes(
        sample, grid, errors=errors, is_squared=np.ones(len(errors), dtype=bool), sides=MAXIMUM_ONLY
    )
    peaks = []
    for k, error in enumerate(errors.tolist()):
        peak = math.sqrt(max(float(extremes.high[k]), 0.0))
        equal_places = np.flatnonzero(np.sqrt(np.maximum(grid_squares[:, k], 0.0)) >= peak - error)
        peaks.append(
            (peak, nodes.compute_angle(float(grid[equal_places[0]] if len(equal_places) else extremes.high_at[k])))
        )
    return peaks
