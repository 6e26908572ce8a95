"""What acts over a cycle: root of the mean square and largest magnitude, searched between the nodes as in a run."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from heuncli import tolerances
from heuncli.balancing.nodes import Nodes
from heuncli.balancing.results import Residual
from heuncli.results import Array
from heuncli.study.search.extremes import search

HIGHEST = (1.0,)


def residuals(kinds: Mapping[str, Array], nodes: Nodes, least: Mapping[str, float]) -> dict[str, Residual]:
    """Of each kind the sum over the bodies of values (n, bodies, c); least: what is below is rounding, or an error."""
    found = {}
    for name, values in kinds.items():
        sum_ = values.sum(axis=1)
        largest = float(np.sqrt(np.sum(sum_**2, axis=1)).max())
        terms = float(np.sqrt(np.sum(values**2, axis=2)).sum(axis=1).max())
        if largest <= max(tolerances.CANCELS * terms, least[name]):
            found[name] = Residual(0.0, 0.0, float(nodes.begin), max(largest, least[name]))
        else:
            found[name] = of_vectors(sum_, nodes)
    return found


def of_vectors(values: Array, nodes: Nodes) -> Residual:
    """Of the magnitudes of vectors (n, c)."""
    course = nodes.course(values)
    error = float(np.sqrt(np.sum(nodes.errors(values).value ** 2)))

    def squares(x: Array) -> Array:
        return np.asarray(np.sum(course(x) ** 2, axis=1)[:, None])

    top = search(squares, nodes.grid, errors=np.array([error]), even=np.array([True]), sides=HIGHEST)
    rms = float(np.sqrt(nodes.weights @ np.sum(values**2, axis=1)))
    return Residual(rms, float(np.sqrt(top.high[0])), nodes.angle(float(top.high_at[0])), error)


def of_squares(values: Array, nodes: Nodes) -> Residual:
    """Of a magnitude whose squares are values (n,); the error of these is told by the magnitude."""
    course = nodes.course(values[:, None])
    largest = float(values.max(initial=0.0))
    off = float(nodes.errors(values[:, None]).value[0])
    error = off / math.sqrt(largest) if largest > off else math.sqrt(off)
    top = search(course, nodes.grid, errors=np.array([error]), even=np.array([True]), sides=HIGHEST)
    rms = math.sqrt(max(float(nodes.weights @ values), 0.0))
    return Residual(rms, math.sqrt(max(float(top.high[0]), 0.0)), nodes.angle(float(top.high_at[0])), error)
