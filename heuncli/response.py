"""The one linear map: a laid-out scene factored once at a configuration, then answered for any number of columns.

Accelerations, projection onto the closures, single loads, impulses and self-stresses are answers of the same factors
(kernel/response.py); here they are opened to arrays. Impure: a workspace holds the kernel's work arrays; every call
starts from what it is given.
"""

from __future__ import annotations

import numpy as np

from heuncli.kernel.choose import workspace
from heuncli.records import record
from heuncli.results import Array
from heuncli.tree.layout import Layout
from heuncli.tree.tables import COLUMN_ANSWER, Table

Workspace = workspace.Workspace


def workspace_of(layout: Layout) -> workspace.Workspace:
    """The kernel's copy of a scene, with its work arrays."""
    numbers = {
        "gravity": layout.mechanism.gravity.tolist(),
        "size": layout.size,
        "driven": int(layout.driven),
        "work_at": layout.work_at,
        "answer_count": layout.answer_count,
        "column_count": layout.column_count,
    }
    return workspace.Workspace(layout.tables, layout.indices, layout.pack.expressions, numbers)


@record
class Columns:
    """What answers columns of loads: bodies (n_c, n_b), fields of tables.COLUMN_ANSWER; multipliers (n_c, rows)."""

    bodies: Table
    multipliers: Array


def columns(at: workspace.Workspace, t: float, state: Array, loads: Array, inertial: Array) -> Columns:
    """Answers to loads (n_c, n_b, 6) at a state: moment about each body's joint point, and force; tree order.

    inertial (n_c,): whether velocity terms, prescribed accelerations and gravity count in that column.
    """
    n_c, n_b = loads.shape[:2]
    flags = [int(flag) for flag in inertial]
    width = at.column_width
    out = np.zeros(n_c * width)
    at.columns(t, state, np.ascontiguousarray(loads, dtype=float).ravel(), flags, out)
    rows = out.reshape(n_c, width)
    return Columns(np.ascontiguousarray(rows[:, : 12 * n_b]).view(COLUMN_ANSWER), rows[:, 12 * n_b :])


def jacobian(at: workspace.Workspace, times: Array, states: Array, shape: tuple[int, int]) -> Array:
    """J of the closure rows on the tree's freedoms at settled states, (n_t, rows, freedoms); shape: the latter two."""
    out = np.zeros(len(times) * shape[0] * shape[1])
    at.jacobians(times, np.ascontiguousarray(states, dtype=float).ravel(), out)
    return out.reshape(len(times), *shape)


def carried(at: workspace.Workspace, times: Array, states: Array, multipliers: Array, n_b: int) -> Array:
    """Joint loads ON the bodies, moment about the joint point and force, that hold closure multipliers at rest.

    multipliers (n_t, k, rows); gives (n_t, k, n_b, 6).
    """
    n_t, k = multipliers.shape[:2]
    out = np.zeros(n_t * k * n_b * 6)
    at.carried(times, np.ascontiguousarray(states, dtype=float).ravel(), np.ascontiguousarray(multipliers).ravel(), out)
    return out.reshape(n_t, k, n_b, 6)
