"""Solve the linear system of a laid-out scene: factored once at a configuration, then solved for any number of columns.

Accelerations, projection onto the closures, single loads, impulses and self-stresses are solutions with the same
factors (kernel/response.py); here they are unpacked into arrays. Impure: a workspace holds the kernel's work arrays;
every call starts from its arguments.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.kernel.choose import expressions, workspace
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import COLUMN_PARTS, SOLUTION_PARTS, Table, split_parts
from heuncli.results.results import Array, Indices, Mask

Workspace = workspace.Workspace


def make_workspace(layout: Layout, closed_contacts: Array | None = None) -> workspace.Workspace:
    """Make the kernel's copy of a scene, with its work arrays. closed_contacts (contacts,): which are closed; none if
    None.

    The rank of the closures is judged at the start with all contacts open, for those that close later are open there.
    """
    kernel = workspace.Workspace(layout.tables, layout.indices, layout.pack.expressions, kernel_numbers(layout))
    kernel.hold(layout.open_contacts.tolist())
    kernel.start(0.0, layout.y0)
    if closed_contacts is not None:
        kernel.hold(closed_contacts.tolist())
    return kernel


def evaluate_variables(layout: Layout, t: float, state: Array) -> list[float]:
    """Return the values of the expressions' variables at a state, from a workspace of their own."""
    kernel = make_unsettled_workspace(layout)
    return list(kernel.variables(t, np.array(state, dtype=float)))


def kernel_numbers(layout: Layout) -> dict[str, Any]:
    """Return the numbers that the kernel needs of a scene besides its tables and indices."""
    return {
        "gravity": layout.mechanism.gravity.tolist(),
        "size": layout.size,
        "rank_of_gap": tolerances.RANK_OF_GAP / min((i.length for i in layout.islands), default=layout.size),
        "driven": int(layout.has_laws),
        "flat": int(layout.flat),
        "work_at": layout.work_at,
        "velocity_count": layout.velocity_count,
        "column_count": layout.column_count,
        "velocity_scale": layout.velocity_scale,
        "island_room": max((len(i.rows) * len(i.freedoms) for i in layout.islands), default=0),
    }


def solution_parts(layout: Layout) -> dict[str, tuple[Any, int]]:
    """Return the parts of the kernel's solution at a state: the type and the count of each."""
    counts = {
        "bodies": len(layout.place), "freedoms": len(layout.freedoms), "loads": len(layout.tables["loads"]),
        "rows": len(layout.rows), "parts": len(layout.tables["parts"]), "whole": 1,
    }  # fmt: skip
    return {name: (kind, counts[name]) for name, kind in SOLUTION_PARTS.items()}


def allocate_solutions(kinds: Mapping[str, tuple[Any, int]], n_t: int) -> dict[str, Table]:
    """Allocate tables (n_t, n) for the kernel's solutions at n_t states."""
    return {name: np.empty((n_t, count), kind) for name, (kind, count) in kinds.items()}


def as_numbers(table: Table) -> Array:
    """View a table (n_t, n) as the plain numbers in it, (n_t, width)."""
    n_t, count = table.shape
    return table.view(np.float64) if count else np.zeros((n_t, 0))


def settle_state(kernel: workspace.Workspace, layout: Layout, t: float, state: Array) -> tuple[Array, Table]:
    """Settle a state on the closures; return it, (n,), and the kernel's solution of the bodies there, in tree order."""
    settled_state, solution, empty = (
        np.array(state, dtype=float),
        allocate_solutions(solution_parts(layout), 1),
        np.zeros(0),
    )
    arrays = {"times": np.array([t]), "states": settled_state, "branches": empty, "holding": empty, "columns": empty}
    kernel.recover(arrays | {name: as_numbers(table).reshape(-1) for name, table in solution.items()}, True, False)
    return settled_state, solution["bodies"][0]


@record
class MeasuredState:
    """Position and motion of the bodies (tree order, tables.SOLUTION_PARTS; R, r, omega, v of it) and closure rows at a
    state.

    gaps, rates (rows,): as computed by the kernel, less the prescribed values
    """

    bodies: Table
    gaps: Array
    rates: Array


def make_unsettled_workspace(layout: Layout) -> workspace.Workspace:
    """Make the kernel's copy of a scene whose closures may still be open: their rank is not judged, and it cannot solve
    for loads.
    """
    pack = layout.pack
    evaluator = expressions.Expressions(
        pack.code, pack.constants, len(pack.variables), pack.branch_count, pack.starts, pack.tables
    )
    return workspace.Workspace(layout.tables, layout.indices, evaluator, kernel_numbers(layout))


def measure_state(kernel: workspace.Workspace, layout: Layout, t: float, state: Array) -> MeasuredState:
    """Measure the bodies and the closure rows at a state as it is, even where its closures are open."""
    bodies = np.empty((1, len(layout.place)), SOLUTION_PARTS["bodies"])
    gaps, rates = np.zeros(len(layout.rows)), np.zeros(len(layout.rows))
    kernel.measure(t, np.ascontiguousarray(state, dtype=float), as_numbers(bodies).reshape(-1), gaps, rates)
    return MeasuredState(bodies[0], gaps, rates)


@record
class Columns:
    """The solution for columns of loads: (n_c, n) tables of bodies and freedoms, multipliers (n_c, rows), tree order.

    For causes at several instants all arrays have an axis of instants first.
    """

    bodies: Table
    freedoms: Table
    multipliers: Array

    def select(self, which: Mask | Indices | slice | None) -> Columns:
        """Return some elements of the first axis; None inserts a new first axis."""
        return Columns(self.bodies[which], self.freedoms[which], self.multipliers[which])

    def take(self, k: int) -> Columns:
        """Return one element of the first axis, without that axis."""
        return Columns(self.bodies[k], self.freedoms[k], self.multipliers[k])

    def sum(self) -> Columns:
        """Sum the columns along the first axis."""

        def sum_rows(table: Table) -> Table:
            whole = np.zeros(table.shape[1:], table.dtype)
            for name in table.dtype.names or ():
                whole[name] = table[name].sum(axis=0)
            return whole

        return Columns(sum_rows(self.bodies), sum_rows(self.freedoms), self.multipliers.sum(axis=0))


def solve_columns(kernel: workspace.Workspace, t: float, state: Array, loads: Array, inertial: Array) -> Columns:
    """Solve for loads (n_c, n_b, 6) at a state: moment about each body's joint point, and force; tree order.

    inertial (n_c,): whether velocity terms, prescribed accelerations and gravity count in that column
    """
    flags = [int(flag) for flag in inertial]
    out = np.zeros((len(loads), kernel.column_width))
    kernel.columns(t, state, np.ascontiguousarray(loads, dtype=float).ravel(), flags, out.ravel())
    return unpack_columns(out, loads.shape[1], kernel.freedom_count)


def unpack_columns(rows: Array, n_b: int, n_f: int) -> Columns:
    """Unpack the kernel's numbers, (..., width), into columns."""
    flat, n = rows.reshape(-1, rows.shape[-1]), rows.shape[:-1]
    parts = [(COLUMN_PARTS["bodies"], n_b), (COLUMN_PARTS["freedoms"], n_f)]
    bodies, freedoms = split_parts(flat, parts)
    width = sum(kind.itemsize // 8 * count for kind, count in parts)
    return Columns(bodies.reshape(*n, n_b), freedoms.reshape(*n, n_f), rows[..., width:])


@record
class ImpulseColumns:
    """The solution for impulses at a settled state: columns of velocity jumps, and of the joints' impulses.

    unmet (n_c,): residual of J dV = -jumps, relative to its terms
    massless_count: number of freedoms without inertia
    """

    columns: Columns
    unmet: Array
    massless_count: int


def solve_impulses(kernel: workspace.Workspace, t: float, state: Array, loads: Array, jumps: Array) -> ImpulseColumns:
    """Solve for the velocity jumps caused by impulses (n_c, n_b, 6), as in `solve_columns`, and by jumps of prescribed
    rates.

    jumps (n_c, n_f + rows): of the rates of the driven freedoms, and of the driven lengths of closure rows
    """
    out = np.zeros((len(loads), kernel.column_width + 1))
    impulses, rates = (np.append(np.ascontiguousarray(x, dtype=float).ravel(), 0.0) for x in (loads, jumps))
    massless_count = kernel.impulses(t, state, impulses, rates, out.ravel())
    return ImpulseColumns(unpack_columns(out[:, :-1], loads.shape[1], kernel.freedom_count), out[:, -1], massless_count)


@record
class Jacobian:
    """J of the closure rows on the tree's freedoms: the rate of each row's gap for each freedom of its path.

    entries (n_t, n): one row after the other
    row, freedom (n,): of each entry

    A ball has three freedoms, its rotations about the world's axes; driven freedoms have the entry zero.
    """

    entries: Array
    row: Array
    freedom: Array
    shape: tuple[int, int]  # how many rows and freedoms there are

    def block(self, rows: Array | Indices, freedoms: Array | Indices) -> Array:
        """Return some rows on some freedoms, (n_t, rows, freedoms)."""
        at_row, at_freedom = (np.full(count, -1) for count in self.shape)
        at_row[rows], at_freedom[freedoms] = np.arange(len(rows)), np.arange(len(freedoms))
        i, j = at_row[self.row], at_freedom[self.freedom]
        inside = (i >= 0) & (j >= 0)
        J = np.zeros((len(self.entries), len(rows), len(freedoms)))
        J[:, i[inside], j[inside]] = self.entries[:, inside]
        return J


def jacobian(kernel: workspace.Workspace, layout: Layout, times: Array, states: Array) -> Jacobian:
    """Compute J of all closure rows at settled states."""
    width = int(layout.tables["closures"]["velocity_count"].sum())
    out = np.zeros(len(times) * width)
    kernel.jacobians(times, np.ascontiguousarray(states, dtype=float).ravel(), out)
    indices, closures = np.array(layout.indices), layout.tables["closures"]
    paths = [indices[row["velocities"] : row["velocities"] + row["velocity_count"]] for row in closures]
    freedom = np.concatenate([np.zeros(0, dtype=int), *paths])
    row: Array = np.repeat(np.arange(len(closures)), closures["velocity_count"])
    shape = (len(closures), layout.velocity_count)
    return Jacobian(out.reshape(len(times), width), row, freedom, shape)


def tangent(kernel: workspace.Workspace, t: float, state: Array) -> Array:
    """Return d(ydot)/dy at a state, (n, n), with closure rows and branches unchanged.

    For a state off the closures it is the derivative of the equations as they are integrated, which do not close the
    gaps.
    """
    n = len(state)
    out = np.zeros(n * n)
    kernel.jacobian(t, np.ascontiguousarray(state, dtype=float), out)
    return out.reshape(n, n)


@record
class Motions:
    """A state's derivative, and how the bodies move along each direction of the state; n_b bodies, tree order.

    turn (n_b, 3, n): of the attitude, as a small rotation
    r, v (n_b, 3, n): of the joint point's position and velocity
    omega (n_b, 3, n): of the angular velocity; all in world axes
    """

    derivative: Array  # (n,)
    tangent: Array  # (n, n) d(ydot)/dy
    turn: Array
    r: Array
    omega: Array
    v: Array
    rates: Array  # (rows, n) of the closure rows chosen


def compute_motions(kernel: workspace.Workspace, layout: Layout, t: float, state: Array) -> Motions:
    """Compute the derivatives of the motion at a settled state."""
    n, bodies, rows = len(state), len(layout.place), len(layout.rows)
    out, derivative, flat = np.zeros(n * n), np.zeros(n), np.zeros(n * (12 * bodies + rows))
    state_copy = np.ascontiguousarray(state, dtype=float)
    kernel.jacobian(t, state_copy, out, {"derivative": derivative, "motions": flat})
    table = flat.reshape(n, -1)
    turn, r, omega, v = table[:, : 12 * bodies].reshape(n, bodies, 4, 3).transpose(2, 1, 3, 0)
    return Motions(derivative, out.reshape(n, n), turn, r, omega, v, table[:, 12 * bodies :].T[kernel.chosen_rows])


def slope(kernel: workspace.Workspace, t: float, state: Array) -> tuple[Array, float]:
    """Return dy/dt (n,) at a state projected onto the closures, and the gap left there [m]; the state itself is not
    changed.
    """
    out = np.zeros(len(state))
    return out, kernel.slope(t, np.ascontiguousarray(state, dtype=float), out)


def multiplier_joint_loads(
    kernel: workspace.Workspace, times: Array, states: Array, multipliers: Array, n_b: int
) -> Array:
    """Joint loads ON the bodies, moment about the joint point and force, that balance closure multipliers at rest.

    At settled states; multipliers (n_t, k, rows); returns (n_t, k, n_b, 6), tree order.
    """
    n_t, k = multipliers.shape[:2]
    out = np.zeros(n_t * k * n_b * 6)
    kernel.carry_multipliers(
        times, np.ascontiguousarray(states, dtype=float).ravel(), np.ascontiguousarray(multipliers).ravel(), out
    )
    return out.reshape(n_t, k, n_b, 6)
