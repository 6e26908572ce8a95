"""The one linear map: a laid-out scene factored once at a configuration, then answered for any number of columns.

Accelerations, projection onto the closures, single loads, impulses and self-stresses are answers of the same factors
(kernel/response.py); here they are opened to arrays. Impure: a workspace holds the kernel's work arrays; every call
starts from what it is given.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.kernel.choose import expressions, workspace
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import (
    BODY_ANSWER,
    CLOSURE_ANSWER,
    COLUMN_BODY,
    COLUMN_FREEDOM,
    FREEDOM_ANSWER,
    LOAD_ANSWER,
    PART_ANSWER,
    STATE_ANSWER,
    Table,
    parts,
)
from heuncli.results.results import Array, Indices, Mask

Workspace = workspace.Workspace


def workspace_of(layout: Layout, holding: Array | None = None) -> workspace.Workspace:
    """The kernel's copy of a scene, with its work arrays; holding (contacts,): which are closed, none if not given.

    The rank of the closures is judged at the start, where contacts that close later stand open: without them.
    """
    made = workspace.Workspace(layout.tables, layout.indices, layout.pack.expressions, numbers_of(layout))
    made.hold(layout.all_open.tolist())
    made.start(0.0, layout.y0)
    if holding is not None:
        made.hold(holding.tolist())
    return made


def variables_at(layout: Layout, t: float, state: Array) -> list[float]:
    """What the variables of the expressions are at a state, asked of a kernel of their own."""
    made = unsettled(layout)
    return list(made.variables(t, np.array(state, dtype=float)))


def numbers_of(layout: Layout) -> dict[str, Any]:
    """What the kernel takes of a scene beside its tables and indices."""
    return {
        "gravity": layout.mechanism.gravity.tolist(),
        "size": layout.size,
        "rank_of_gap": tolerances.RANK_OF_GAP / min((i.length for i in layout.islands), default=layout.size),
        "driven": int(layout.driven),
        "flat": int(layout.flat),
        "work_at": layout.work_at,
        "answer_count": layout.answer_count,
        "column_count": layout.column_count,
        "measure": layout.measure,
        "island_room": max((len(i.rows) * len(i.freedoms) for i in layout.islands), default=0),
    }


def answer_kinds(layout: Layout) -> dict[str, tuple[Any, int]]:
    """The parts of what the kernel answers at a state: of which kind, and how many."""
    return {
        "bodies": (BODY_ANSWER, len(layout.place)),
        "freedoms": (FREEDOM_ANSWER, len(layout.freedoms)),
        "loads": (LOAD_ANSWER, len(layout.tables["loads"])),
        "rows": (CLOSURE_ANSWER, len(layout.rows)),
        "parts": (PART_ANSWER, len(layout.tables["parts"])),
        "whole": (STATE_ANSWER, 1),
    }


def room_for_answers(kinds: Mapping[str, tuple[Any, int]], n_t: int) -> dict[str, Table]:
    """Tables (n_t, n) for what the kernel answers at so many states."""
    return {name: np.empty((n_t, count), kind) for name, (kind, count) in kinds.items()}


def as_numbers(table: Table) -> Array:
    """A table (n_t, n) as the numbers that it is made of, (n_t, width); a view."""
    n_t, count = table.shape
    return table.view(np.float64) if count else np.zeros((n_t, 0))


def settled(at: workspace.Workspace, layout: Layout, t: float, state: Array) -> tuple[Array, Table]:
    """A state settled on the closures, (n,), and what the kernel tells of the bodies there, tree order."""
    own, told, nothing = np.array(state, dtype=float), room_for_answers(answer_kinds(layout), 1), np.zeros(0)
    arrays = {"times": np.array([t]), "states": own, "branches": nothing, "holding": nothing, "columns": nothing}
    at.recover(arrays | {name: as_numbers(table).reshape(-1) for name, table in told.items()}, True, False)
    return own, told["bodies"][0]


@record
class MeasuredState:
    """How bodies (tree order, tables.BODY_ANSWER; of them R, r, omega, v) and closure rows stand and move at a state.

    gaps, rates (rows,): as the kernel has them, less what is prescribed.
    """

    bodies: Table
    gaps: Array
    rates: Array


def unsettled(layout: Layout) -> workspace.Workspace:
    """The kernel's copy of a scene whose closures may be open yet: their rank is not judged, nor may loads be asked."""
    pack = layout.pack
    own = expressions.Expressions(pack.code, pack.constants, len(pack.variables), pack.held, pack.starts, pack.tables)
    return workspace.Workspace(layout.tables, layout.indices, own, numbers_of(layout))


def measured(at: workspace.Workspace, layout: Layout, t: float, state: Array) -> MeasuredState:
    """What is measured at a state as it is, wherever its closures are open."""
    told = np.empty((1, len(layout.place)), BODY_ANSWER)
    gaps, rates = np.zeros(len(layout.rows)), np.zeros(len(layout.rows))
    at.measured(t, np.ascontiguousarray(state, dtype=float), as_numbers(told).reshape(-1), gaps, rates)
    return MeasuredState(told[0], gaps, rates)


@record
class Columns:
    """What answers columns of loads: (n_c, n) tables of bodies and freedoms, multipliers (n_c, rows), tree order.

    Of causes at several instants all have an axis of instants first.
    """

    bodies: Table
    freedoms: Table
    multipliers: Array

    def at(self, which: Mask | Indices | slice | None) -> Columns:
        """Some of the first axis; None: a new first axis."""
        return Columns(self.bodies[which], self.freedoms[which], self.multipliers[which])

    def only(self, k: int) -> Columns:
        """One of the first axis, without that axis."""
        return Columns(self.bodies[k], self.freedoms[k], self.multipliers[k])

    def sum(self) -> Columns:
        """All columns of the first axis together."""

        def added(table: Table) -> Table:
            whole = np.zeros(table.shape[1:], table.dtype)
            for name in table.dtype.names or ():
                whole[name] = table[name].sum(axis=0)
            return whole

        return Columns(added(self.bodies), added(self.freedoms), self.multipliers.sum(axis=0))


def columns(at: workspace.Workspace, t: float, state: Array, loads: Array, inertial: Array) -> Columns:
    """Answers to loads (n_c, n_b, 6) at a state: moment about each body's joint point, and force; tree order.

    inertial (n_c,): whether velocity terms, prescribed accelerations and gravity count in that column.
    """
    flags = [int(flag) for flag in inertial]
    out = np.zeros((len(loads), at.column_width))
    at.columns(t, state, np.ascontiguousarray(loads, dtype=float).ravel(), flags, out.ravel())
    return columns_of(out, loads.shape[1], at.freedom_count)


def columns_of(rows: Array, n_b: int, n_f: int) -> Columns:
    """Columns from the kernel's numbers, (..., width)."""
    flat, n = rows.reshape(-1, rows.shape[-1]), rows.shape[:-1]
    bodies, freedoms = parts(flat, [(COLUMN_BODY, n_b), (COLUMN_FREEDOM, n_f)])
    first = 12 * n_b + 2 * n_f
    return Columns(bodies.reshape(*n, n_b), freedoms.reshape(*n, n_f), rows[..., first:])


@record
class Blows:
    """What answers blows at a settled state: columns of jumps of velocities, and of the joints' impulses.

    unmet (n_c,): what is left of J dV = -jumps, relative to its terms; idle: how many freedoms have no inertia.
    """

    columns: Columns
    unmet: Array
    idle: int


def blows(at: workspace.Workspace, t: float, state: Array, loads: Array, jumps: Array) -> Blows:
    """The jumps of velocities that answer impulses (n_c, n_b, 6), as in `columns`, and jumps of prescribed rates.

    jumps (n_c, n_f + rows): of the rates of the freedoms that are driven, and of the driven lengths of closure rows.
    """
    out = np.zeros((len(loads), at.column_width + 1))
    impulses, rates = (np.append(np.ascontiguousarray(x, dtype=float).ravel(), 0.0) for x in (loads, jumps))
    idle = at.blow(t, state, impulses, rates, out.ravel())
    return Blows(columns_of(out[:, :-1], loads.shape[1], at.freedom_count), out[:, -1], idle)


@record
class Jacobian:
    """J of the closure rows on the tree's freedoms, the rate of each row's gap for each freedom of its path.

    entries (n_t, n): one row after the other; row, freedom (n,): of each entry. A ball has three freedoms, its turns
    about the world's axes; driven ones have the entry zero.
    """

    entries: Array
    row: Array
    freedom: Array
    shape: tuple[int, int]  # how many rows and freedoms there are

    def block(self, rows: Array | Indices, freedoms: Array | Indices) -> Array:
        """Some rows on some freedoms, (n_t, rows, freedoms)."""
        at_row, at_freedom = (np.full(count, -1) for count in self.shape)
        at_row[rows], at_freedom[freedoms] = np.arange(len(rows)), np.arange(len(freedoms))
        i, j = at_row[self.row], at_freedom[self.freedom]
        inside = (i >= 0) & (j >= 0)
        J = np.zeros((len(self.entries), len(rows), len(freedoms)))
        J[:, i[inside], j[inside]] = self.entries[:, inside]
        return J


def jacobian(at: workspace.Workspace, layout: Layout, times: Array, states: Array) -> Jacobian:
    """J of all closure rows at settled states."""
    width = int(layout.tables["closures"]["answer_count"].sum())
    out = np.zeros(len(times) * width)
    at.jacobians(times, np.ascontiguousarray(states, dtype=float).ravel(), out)
    indices, closures = np.array(layout.indices), layout.tables["closures"]
    paths = [indices[row["answers"] : row["answers"] + row["answer_count"]] for row in closures]
    freedom = np.concatenate([np.zeros(0, dtype=int), *paths])
    row: Array = np.repeat(np.arange(len(closures)), closures["answer_count"])
    shape = (len(closures), layout.answer_count)
    return Jacobian(out.reshape(len(times), width), row, freedom, shape)


def tangent(at: workspace.Workspace, t: float, state: Array) -> Array:
    """d(ydot)/dy at a state, (n, n): how the motion's derivative hangs on the state, closure rows and branches kept.

    Off the closures it is that of the equations as they are integrated: accelerations that keep gaps as they grow.
    """
    n = len(state)
    out = np.zeros(n * n)
    at.jacobian(t, np.ascontiguousarray(state, dtype=float), out)
    return out.reshape(n, n)


@record
class Motions:
    """A state's derivative and what it hangs on, along each direction of the state; n_b bodies, tree order.

    turn (n_b, 3, n): of the attitude, as a small turn; likewise r and v: of the joint point's place and velocity;
    omega: of the angular velocity. World axes.
    """

    derivative: Array  # (n,)
    tangent: Array  # (n, n) d(ydot)/dy
    turn: Array
    r: Array
    omega: Array
    v: Array
    rates: Array  # (rows, n) of the closure rows chosen


def motions(at: workspace.Workspace, layout: Layout, t: float, state: Array) -> Motions:
    """What the motion hangs on at a settled state."""
    n, bodies, rows = len(state), len(layout.place), len(layout.rows)
    out, derivative, flat = np.zeros(n * n), np.zeros(n), np.zeros(n * (12 * bodies + rows))
    own = np.ascontiguousarray(state, dtype=float)
    at.jacobian(t, own, out, {"derivative": derivative, "motions": flat})
    table = flat.reshape(n, -1)
    turn, r, omega, v = table[:, : 12 * bodies].reshape(n, bodies, 4, 3).transpose(2, 1, 3, 0)
    return Motions(derivative, out.reshape(n, n), turn, r, omega, v, table[:, 12 * bodies :].T[at.chosen])


def slope(at: workspace.Workspace, t: float, state: Array) -> tuple[Array, float]:
    """dy/dt (n,) at a state brought onto the closures, which is not changed itself; and the gap left there [m]."""
    out = np.zeros(len(state))
    return out, at.slope(t, np.ascontiguousarray(state, dtype=float), out)


def carried(at: workspace.Workspace, times: Array, states: Array, multipliers: Array, n_b: int) -> Array:
    """Joint loads ON the bodies, moment about the joint point and force, that hold closure multipliers at rest.

    At settled states; multipliers (n_t, k, rows); gives (n_t, k, n_b, 6), tree order.
    """
    n_t, k = multipliers.shape[:2]
    out = np.zeros(n_t * k * n_b * 6)
    at.carried(times, np.ascontiguousarray(states, dtype=float).ravel(), np.ascontiguousarray(multipliers).ravel(), out)
    return out.reshape(n_t, k, n_b, 6)
