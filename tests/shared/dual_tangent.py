"""The tangent of the motion once more, by dual numbers run through the plain kernel: exact, and another route."""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.multibody.response import kernel_numbers
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from tests.shared.dual_kernel import dual_module
from tests.shared.duals import Dual, gradient_of


def dual_tangent(layout: Layout, t: float, state: Array, closed: float = 0.0) -> tuple[Array, Array]:
    """A state settled on the closures, and d(ydot)/dy there, (n, n); contacts open, or closed (1)."""
    pack, n = layout.pack, len(state)
    programs = dual_module("expressions").Expressions(
        pack.code, pack.constants, len(pack.variables), pack.branch_count, pack.starts, pack.tables
    )
    workspace = dual_module("workspace").Workspace(layout.tables, layout.indices, programs, kernel_numbers(layout))
    workspace.hold([closed] * len(layout.contacts))
    workspace.start(0.0, layout.y0.tolist())
    scene, kernel, chosen = workspace.scene, dual_module("response"), dual_module("selection")
    y: list[float] = np.asarray(state, dtype=float).tolist()
    for _ in range(2):
        if scene.closure_count:
            chosen.choose_rows_again(scene, t, y)
        kernel.project_state(scene, t, y)
    moving: list[Any] = [Dual(x, row) for x, row in zip(y, np.eye(n), strict=True)]
    dy: list[Any] = [0.0] * n
    kernel.evaluate(scene, t, moving, dy)
    return np.array(y), np.array([gradient_of(x, n) for x in dy]).reshape(n, n)
