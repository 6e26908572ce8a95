"""The tangent of the motion once more, by dual numbers run through the plain kernel: exact, and another route."""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.linearisation.dual_kernel import dual_module
from heuncli.linearisation.duals import Dual, gradient_of
from heuncli.linearisation.linearise import DualKernel, unit
from heuncli.results import Array
from heuncli.tree.layout import Layout


def dual_tangent(layout: Layout, t: float, state: Array) -> tuple[Array, Array]:
    """A state settled on the closures, and d(ydot)/dy there, (n, n); contacts open."""
    kernel = DualKernel(layout, t, state, None)
    y, n = list(kernel.state), len(state)
    if kernel.scene.closure_count:
        dual_module("chosen").choose_afresh(kernel.scene, t, list(y))
    moving: list[Any] = [Dual(x, unit(n, k)) for k, x in enumerate(y)]
    dy: list[Any] = [0.0] * n
    kernel.evaluate(t, moving, dy)
    return np.array(y), np.array([gradient_of(x, n) for x in dy]).reshape(n, n)
