"""What the kernel answers at given states: accelerations and loads, each state by itself."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import fields, record
from heuncli.multibody.response import Columns, answer_kinds, as_numbers, columns_of, room_for_answers, workspace_of
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array, Indices, Mask

AT_ONCE, ROWS = 20_000, 10  # body-states to a call of the kernel, some ten milliseconds; closure rows cost their square
CAUSES = ("motion", "drives", "gravity")  # beside the loads: velocity terms, what is prescribed, weight


@record
class Recovered:
    """The kernel's answers at the instants, tables (n_t, n) in tree order; their fields: multibody/tree/tables.py.

    times (n_t,) [s]; states (n_t, n_state), settled on the closures; gap (n_t,): the largest left [m]; idle (n_t,): how
    many freedoms have no inertia behind them.
    """

    times: Array
    states: Array
    bodies: Table
    freedoms: Table
    loads: Table
    rows: Table
    parts: Table  # of the rows that are sums
    gap: Array
    idle: Array
    pivot: Array  # square of the least pivot of the independent closure rows; 1: far from singular
    residual: Array  # of all rows, J Vdot + gamma at the accelerations found, of the terms it is the sum of
    may_stay: Array  # what of it rows may keep that were left out as dependent
    holding: Array  # (n_t, contacts and places): 0 open, 1 closed, also where others close it (Layout.closed)
    causes: Columns | None = None  # (n_t, n_c): each row of the table of loads alone, then CAUSES; their sum is all

    @property
    def dependent(self) -> Array:
        """How many of the closure rows that carry depend on others and are left out, (n_t,)."""
        return np.asarray((self.rows["closed"] - self.rows["chosen"]).sum(axis=1))

    def at(self, which: Mask | Indices | slice) -> Recovered:
        """At some of the instants; of a slice views."""
        if isinstance(which, slice) and which == slice(None):
            return self
        own = fields(self)
        causes = own.pop("causes")
        return Recovered(**{name: values[which] for name, values in own.items()}, causes=causes and causes.at(which))


def work_of(layout: Layout) -> int:
    """What a scene takes to be answered at a state, in bodies."""
    return len(layout.place) + len(layout.rows) ** 2 // ROWS


class Evaluator:
    """A laid-out scene with the kernel's work arrays; every call starts from what it is given."""

    def __init__(self, layout: Layout, closed_at_start: Callable[[Evaluator], Array] | None = None) -> None:
        """closed_at_start: which of the contacts are closed at the start, (contacts,); needed where there are any."""
        self.layout, self.closed_at_start = layout, closed_at_start
        self.workspace = workspace_of(layout)
        self.size = layout.size
        self.kinds = answer_kinds(layout)

    @cached_property
    def start_holding(self) -> Array:
        """The contacts that are closed at the start, (contacts,). Raises ValueError where nobody can tell."""
        if not self.layout.contacts:
            return np.zeros(0)
        if self.closed_at_start is None:
            raise ValueError("which contacts are closed at the start was not handed in")
        return self.closed_at_start(self)

    def may_stay(self, gap: Array) -> Array:
        """What accelerations may leave unmet of rows that depend on others, at gaps (n_t,), of the rows' terms."""
        return tolerances.UNMET * (self.workspace.least_row + tolerances.RANK_OF_GAP * gap / self.least_length)

    @cached_property
    def least_length(self) -> float:
        """Of the islands of loops the shortest length [m]; the scene's size where there are none."""
        return min((island.length for island in self.layout.islands), default=self.size)

    def recovered(
        self,
        times: Array,
        states: Array,
        *,
        branches: Array | None = None,
        hold_rows: bool = False,
        causes: bool = False,
        holding: Array | None = None,
    ) -> Recovered:
        """Accelerations and loads at the given states, which are projected onto the closures first.

        Each state by itself, whatever others are asked with it: its independent closure rows are chosen anew.
        branches (n_t, n): those that the expressions hold; without them branches are as the states say.
        hold_rows: those of the first serve the others too, as long as they can, for pivots that are comparable.
        causes: with a column a cause. holding (n_t, contacts) or (contacts,): which are closed, above 0; by default as
        at the start.
        """
        layout, n_t = self.layout, len(times)
        n_c = len(layout.tables["loads"]) + len(CAUSES) if causes else 0
        told, columns = room_for_answers(self.kinds, n_t), np.zeros((n_t, n_c * self.workspace.column_width))
        at = np.ascontiguousarray(times, dtype=float)
        settled = np.array(states, dtype=float, order="C").reshape(n_t, layout.n_state)
        held = np.zeros((n_t, 0)) if branches is None else np.ascontiguousarray(branches, dtype=float)
        closed = np.zeros((n_t, len(layout.all_open)))
        # what others close is closed as much: which of all carry is a matter of rank here, and of verdicts
        closed[:] = layout.closed(self.start_holding if holding is None else holding)
        given = {"times": at, "branches": held, "holding": closed}
        answers = {"states": settled, "columns": columns, **{name: as_numbers(table) for name, table in told.items()}}
        self._recover(given, answers, hold_rows, causes)
        rows, whole = told["rows"], told["whole"]
        residual = whole["residual"][:, 0]
        if layout.rows:
            # behind a blow that ends all motion rates are left by rounding, and what their squares ask for is nothing
            still = rows["terms"].max(axis=1, initial=0.0) <= tolerances.STILL
            residual = np.where(still, 0.0, residual)
        return Recovered(
            times=at, states=settled, bodies=told["bodies"], freedoms=told["freedoms"], loads=told["loads"], rows=rows,
            parts=told["parts"], gap=whole["gap"][:, 0], idle=whole["idle"][:, 0], pivot=whole["pivot"][:, 0],
            residual=residual, may_stay=self.may_stay(whole["gap"][:, 0]),
            holding=closed,
            causes=columns_of(columns.reshape(n_t, n_c, -1), len(layout.place), len(layout.freedoms))
            if causes
            else None,
        )  # fmt: skip

    def _recover(self, given: dict[str, Array], answers: dict[str, Array], hold_rows: bool, causes: bool) -> None:
        """The kernel's calls for arrays by instants; answers, the states among them, are written into.

        Each is so short that an alarm or an interrupt is heard soon: they wait for a call to end.
        """
        arrays = given | answers
        count, many = len(given["times"]), max(1, AT_ONCE // max(work_of(self.layout), 1))
        if 0 < count <= many:
            self.workspace.recover({name: values.reshape(-1) for name, values in arrays.items()}, not hold_rows, causes)
            return
        for begin in range(0, count, many):
            part = {name: values[begin : begin + many] for name, values in arrays.items()}
            first = hold_rows and begin > 0  # the rows are chosen there, once more
            if first:
                part = {name: np.concatenate([arrays[name][:1], values]) for name, values in part.items()}
            flat = {name: values.reshape(-1) for name, values in part.items()}
            self.workspace.recover(flat, not hold_rows, causes)
            if first:
                for name in answers:
                    arrays[name][begin : begin + many] = part[name][1:]
