"""Evaluate accelerations and loads at given states with the kernel, each state independently."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import fields, record
from heuncli.multibody.response import (
    Columns,
    allocate_solutions,
    as_numbers,
    make_workspace,
    solution_parts,
    unpack_columns,
)
from heuncli.multibody.tree.layout import CLOSED_BY_OTHERS, OPEN, Layout
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array, Indices, Mask

AT_ONCE, ROWS = 20_000, 10  # body-states per kernel call, about ten milliseconds; closure rows count by their square
CAUSES = ("motion", "drives", "gravity")  # besides the loads: velocity terms, prescribed motion, weight


@record
class Evaluation:
    """The kernel's results at a set of instants: tables (n_t, n) in tree order; their fields are in
    multibody/tree/tables.py.

    times (n_t,): instants [s]
    states (n_t, n_state): states, projected onto the closures
    gap (n_t,): largest closure gap left [m]
    massless_count (n_t,): number of freedoms without inertia
    """

    times: Array
    states: Array
    bodies: Table
    freedoms: Table
    loads: Table
    rows: Table
    parts: Table  # of the rows that are sums
    gap: Array
    massless_count: Array
    pivot: Array  # square of the least pivot of the independent closure rows; 1: far from singular
    residual: Array  # of all rows, J Vdot + gamma at the accelerations found, relative to its terms
    allowed_residual: Array  # the residual that rows left out as dependent may have
    # (n_t, contacts and latch places): 0 open, 1 closed, also if others close it (Layout.closed_contacts)
    holding: Array
    causes: Columns | None = None  # (n_t, n_c): one column per load row, then CAUSES; their sum is all

    @property
    def dependent_count(self) -> Array:
        """Number of active closure rows that depend on others and are left out, (n_t,)."""
        return np.asarray((self.rows["closed"] - self.rows["chosen"]).sum(axis=1))

    def select(self, instants: Mask | Indices | slice) -> Evaluation:
        """Select some of the instants; a slice gives views."""
        if isinstance(instants, slice) and instants == slice(None):
            return self
        values_by_name = fields(self)
        causes = values_by_name.pop("causes")
        if isinstance(instants, slice):
            selection = {name: values[instants] for name, values in values_by_name.items()}
        else:  # of a table an index copies each field by itself, which takes ten times as long
            indices = instants.nonzero()[0] if instants.dtype == bool else instants
            selection = {name: values.take(indices, axis=0) for name, values in values_by_name.items()}
        return Evaluation(**selection, causes=causes and causes.select(instants))


def estimate_work(layout: Layout) -> int:
    """Estimate the work to evaluate a scene at one state, in bodies."""
    return len(layout.place) + len(layout.rows) ** 2 // ROWS


class Evaluator:
    """A scene's layout with the kernel's work arrays. Each call depends only on its arguments."""

    def __init__(self, layout: Layout, closed_at_start: Callable[[Evaluator], Array] | None = None) -> None:
        """closed_at_start: finds which contacts are closed at the start, (contacts,); required if the scene has
        contacts
        """
        self.layout, self.closed_at_start = layout, closed_at_start
        self.workspace = make_workspace(layout)
        self.size = layout.size
        self.kinds = solution_parts(layout)

    @cached_property
    def start_holding(self) -> Array:
        """The contacts that are closed at the start, (contacts,). Raises ValueError if `closed_at_start` was not
        given.
        """
        if not self.layout.contacts:
            return np.zeros(0)
        if self.closed_at_start is None:
            raise ValueError("closed_at_start is required for a model with contacts")
        return self.closed_at_start(self)

    def allowed_residual(self, gap: Array) -> Array:
        """Return the residual that accelerations may leave in dependent rows, relative to the rows' terms; gap
        (n_t,).
        """
        return tolerances.UNMET_ROW_FACTOR * (self.workspace.least_row + tolerances.RANK_OF_GAP * gap / self.min_length)

    @cached_property
    def min_length(self) -> float:
        """Shortest length of the islands of loops [m]; the scene's size if there are none."""
        return min((island.length for island in self.layout.islands), default=self.size)

    def evaluate(
        self,
        times: Array,
        states: Array,
        *,
        branches: Array | None = None,
        hold_rows: bool = False,
        causes: bool = False,
        holding: Array | None = None,
    ) -> Evaluation:
        """Evaluate accelerations and loads at given states, which are first projected onto the closures.

        Each state is evaluated independently of the others: its independent closure rows are chosen for it alone.

        branches (n_t, n): branches that the expressions hold; by default each state determines its own
        hold_rows: reuse the rows of the first state for the others as long as possible, so that pivots are comparable
        causes: whether to compute one column per cause, too
        holding (n_t, contacts) or (contacts,): closed contacts are above 0; by default as at the start
        """
        layout, n_t = self.layout, len(times)
        n_c = len(layout.tables["loads"]) + len(CAUSES) if causes else 0
        tables, columns = allocate_solutions(self.kinds, n_t), np.zeros((n_t, n_c * self.workspace.column_width))
        instants = np.ascontiguousarray(times, dtype=float)
        projected_states = np.array(states, dtype=float, order="C").reshape(n_t, layout.n_state)
        held_branches = np.zeros((n_t, 0)) if branches is None else np.ascontiguousarray(branches, dtype=float)
        closed = np.zeros((n_t, len(layout.open_contacts)))
        # contacts closed by others count as closed too: the rank, and later checks, decide which of them carry
        contact_states = self.start_holding if holding is None else holding
        closed[:] = layout.closed_contacts(contact_states)
        inputs = {"times": instants, "branches": held_branches, "holding": closed}
        numbers = {name: as_numbers(table) for name, table in tables.items()}
        outputs = {"states": projected_states, "columns": columns, **numbers}
        self._recover(inputs, outputs, hold_rows, causes)
        rows, whole = tables["rows"], tables["whole"]
        residual = self._drop_rounding(whole["residual"][:, 0], rows)
        allowed_residual = self.allowed_residual(whole["gap"][:, 0])
        is_opening = self._find_opening(contact_states, rows, residual, allowed_residual) if layout.contacts else None
        if is_opening is not None and is_opening.any():
            open_states = np.where(is_opening, OPEN, contact_states)
            return self.evaluate(
                times, states, branches=branches, hold_rows=hold_rows, causes=causes, holding=open_states
            )
        return Evaluation(
            times=instants,
            states=projected_states,
            bodies=tables["bodies"],
            freedoms=tables["freedoms"],
            loads=tables["loads"],
            rows=rows,
            parts=tables["parts"],
            gap=whole["gap"][:, 0],
            massless_count=whole["idle"][:, 0],
            pivot=whole["pivot"][:, 0],
            residual=residual,
            allowed_residual=allowed_residual,
            holding=closed,
            causes=unpack_columns(columns.reshape(n_t, n_c, -1), len(layout.place), len(layout.freedoms))
            if causes
            else None,
        )

    def _drop_rounding(self, residual: Array, rows: Table) -> Array:
        """Count residuals (n_t,) as zero where the rows' terms are squares of rates that are rounding, as after an
        impulse that ends all motion.
        """
        if not self.layout.rows:
            return residual
        is_still = rows["terms"].max(axis=1, initial=0.0) <= tolerances.STILL
        return np.asarray(np.where(is_still, 0.0, residual))

    def _find_opening(self, contact_states: Array, rows: Table, residual: Array, allowed_residual: Array) -> Mask:
        """Mark contacts (n_t, contacts), closed by others, that a drive opens by less than the rounding of gaps: where
        the residual is not allowed.
        """
        is_opening = np.zeros((len(rows), len(self.layout.open_contacts)), dtype=bool)
        is_closed_by_others = np.asarray(contact_states) == CLOSED_BY_OTHERS
        is_unmet = residual > allowed_residual
        if not (is_unmet.any() and is_closed_by_others.any()):
            return is_opening
        for k, contact in enumerate(self.layout.contacts):
            row = rows[:, contact.row]
            is_opening[:, k] = -contact.sense * row["acceleration"] > allowed_residual * row["terms"]
        return np.asarray(is_opening & is_closed_by_others & is_unmet[:, None])

    def _recover(self, inputs: dict[str, Array], outputs: dict[str, Array], hold_rows: bool, causes: bool) -> None:
        """Call the kernel in batches of instants; the output arrays, the states among them, are written in place.

        Signals and timeouts wait until a call ends, so each call is short.
        """
        arrays = inputs | outputs
        count, batch_size = len(inputs["times"]), max(1, AT_ONCE // max(estimate_work(self.layout), 1))
        if 0 < count <= batch_size:
            self.workspace.recover({name: values.reshape(-1) for name, values in arrays.items()}, not hold_rows, causes)
            return
        for begin in range(0, count, batch_size):
            part = {name: values[begin : begin + batch_size] for name, values in arrays.items()}
            first = hold_rows and begin > 0  # repeats the first state, where the rows are chosen
            if first:
                part = {name: np.concatenate([arrays[name][:1], values]) for name, values in part.items()}
            flat = {name: values.reshape(-1) for name, values in part.items()}
            self.workspace.recover(flat, not hold_rows, causes)
            if first:
                for name in outputs:
                    arrays[name][begin : begin + batch_size] = part[name][1:]
