"""A scene in the kernel's memory, and what it answers at single states: the doors that heuncli/multibody/response.py
opens.

    recover     everything the sweep knows at given states
    columns     one factorisation, many loads: what answers each
    jacobians   the closure rows on the tree's freedoms
    jacobian    the tangent of the motion
    carried     the joint loads that closure multipliers alone leave in the tree
Everything goes in and out as flat arrays of double (multibody/tree/tables.py names their parts); nothing is kept
between calls.
"""

from __future__ import annotations

from array import array
from typing import Any

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.answers import carry, put_jacobian, put_measured, recover_states, take_holding
    from heuncli.kernel.chosen import choose_afresh, judge_start
    from heuncli.kernel.closures import measure_rows
    from heuncli.kernel.columns import answer_blow, answer_column, measure_answers
    from heuncli.kernel.expressions import Expressions
    from heuncli.kernel.jacobian import find_jacobian, find_motions
    from heuncli.kernel.memory import Memory
    from heuncli.kernel.programs import FREE, HELD, TAKEN
    from heuncli.kernel.response import configure, evaluate, must_choose_anew, settle
    from heuncli.kernel.room import make_room, take_numbers, take_tables
    from heuncli.kernel.scene import Scene
    from heuncli.kernel.selection import select_independent_rows
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.stepping import Tangent
    from heuncli.kernel.tree import factor_tree, kinematics
    from heuncli.kernel.values import Instants


class Workspace:
    """A scene's tables in the kernel's memory (copies), with its work arrays."""

    def __init__(
        self, tables: dict[str, Any], indices: array[int], expressions: Expressions, numbers: dict[str, Any]
    ) -> None:
        """tables: structured arrays by name (multibody/tree/tables.py); indices: of closure rows; numbers: others."""
        if not cython.compiled:
            self.scene: Scene = Scene.blank()
        scene: cython.pointer[Scene] = cython.address(self.scene)
        self.expressions: Expressions = expressions
        self.memory: Memory = Memory()
        told: Any = [*tables["contacts"]["opens"].tolist(), *tables["contacts"]["held_at"].tolist()]
        self.opening: cython.int = sum(1 for k in told if k)
        scene.programs = cython.address(expressions.programs)
        scene.held_count = expressions.held
        take_numbers(scene, tables, numbers)
        take_tables(scene, self.memory, tables)
        make_room(scene, self.memory, indices, numbers)
        scene.least_row = scene.limits.independent

    # What the scene is put to

    def start(self, t: cython.double, state: Any) -> None:
        """Judge the rank of the closures by a start, which is not changed."""
        memory: Memory = Memory()
        if self.scene.closure_count:
            judge_start(cython.address(self.scene), t, memory.doubles(state))

    def hold(self, holding: Any) -> None:
        """Open and close the contacts, until the next call: of each a number, then of each latch one (take_holding)."""
        memory: Memory = Memory()
        if self.opening:
            take_holding(cython.address(self.scene), memory.doubles(holding), 0)

    def configure_at(self, t: cython.double, state: Any) -> int:
        """Choose the closure rows and factor at a state, which is not changed."""
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        y: cython.p_double = memory.doubles(state)
        if scene.closure_count:
            choose_afresh(scene, t, y)
        kinematics(scene, t, y)
        return configure(scene, t)

    def measure_at(self, t: cython.double, state: Any) -> None:
        """Kinematics and closure rows at a state, which is not changed."""
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        kinematics(scene, t, memory.doubles(state))
        measure_rows(scene, t)

    # What is asked of it

    def measured(self, t: cython.double, state: Any, bodies: Any, gaps: Any, rates: Any) -> None:
        """How bodies and closure rows stand and move at a state as it is, into flat arrays: nothing is settled."""
        memory: Memory = Memory()
        self.measure_at(t, state)
        put_measured(cython.address(self.scene), memory.whole(bodies), memory.whole(gaps), memory.whole(rates))
        memory.fetch()

    def variables(self, t: float, state: Any) -> list[float]:
        """The variables of the expressions at a state, which is not changed."""
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        kinematics(scene, t, memory.doubles(state))
        return [scene.programs.variables[i] for i in range(scene.variable_count)]

    def recover(self, arrays: dict[str, Any], afresh: cython.bint, causes: cython.bint) -> None:
        """Everything the sweep knows at given states: flat arrays `times`, `states`, which are settled in place.

        Into `bodies`, `freedoms`, `loads`, `rows`, `parts` goes what is told of each of these, into `whole` of an
        instant: the gap over all rows, how many freedoms had no inertia behind them, the least pivot of the closures,
        and what of all rows the accelerations do not meet. `branches`: those that expressions
        hold, as many numbers an instant; empty: as the states say; `holding`: the same of the contacts, which `hold`
        takes; empty: as they are. afresh: choose the closure rows at every instant anew. causes: a column a cause
        (columns.py) goes into `columns`.
        """
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        count: cython.Py_ssize_t = len(arrays["times"])
        if count == 0:
            return
        n: cython.Py_ssize_t = len(arrays["states"]) // count
        instants: Instants = Instants(
            count,
            n,
            len(arrays["bodies"]) // count,
            len(arrays["freedoms"]) // count,
            len(arrays["loads"]) // count,
            len(arrays["rows"]) // count,
            len(arrays["parts"]) // count,
            len(arrays["whole"]) // count,
            len(arrays["columns"]) // count,
            afresh,
            len(arrays["branches"]) > 0,
            causes,
            self.opening if len(arrays["holding"]) else 0,
            memory.whole(arrays["branches"]),
            memory.whole(arrays["holding"]),
            memory.whole(arrays["times"]),
            memory.whole(arrays["states"]),
            memory.whole(arrays["bodies"]),
            memory.whole(arrays["freedoms"]),
            memory.whole(arrays["loads"]),
            memory.whole(arrays["rows"]),
            memory.whole(arrays["parts"]),
            memory.whole(arrays["whole"]),
            memory.whole(arrays["columns"]),
            memory.zeros(n),
            memory.zeros(n),
        )
        with cython.nogil:
            recover_states(scene, cython.address(instants))
        memory.fetch()

    def columns(self, t: cython.double, state: Any, loads: Any, inertial: Any, out: Any) -> int:
        """One factorisation at a state, many columns of loads: what answers each (`put_column`).

        loads: moment about the joint point and force, a body each, a column after the other; inertial: of each column,
        whether velocity terms, drives and gravity count. Flat arrays. Gives what `configure` gives.
        """
        c: cython.Py_ssize_t
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        count: cython.Py_ssize_t = len(inertial)
        F: cython.pp_double = memory.over(loads, count, 6 * scene.body_count)
        to: cython.pp_double = memory.over(out, count, self.column_width)
        idle: cython.int = self.configure_at(t, state)
        for c in range(count):
            answer_column(scene, F[c], to[c], inertial[c])
        memory.fetch()
        return idle

    def blow(self, t: cython.double, state: Any, loads: Any, jumps: Any, out: Any) -> int:
        """The jumps at a settled state, a column a blow: flat, each with what its rows leave unmet as its last number.

        loads: impulses, moment about the joint point and force, a body each; jumps: of the rates of the freedoms, then
        of the closure rows; a column after the other. Gives what `configure` gives.
        """
        c: cython.Py_ssize_t
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        count: cython.Py_ssize_t = len(out) // (self.column_width + 1)
        F: cython.pp_double = memory.over(loads, count, 6 * scene.body_count)
        rates: cython.pp_double = memory.over(jumps, count, scene.freedom_count + scene.closure_count)
        to: cython.pp_double = memory.over(out, count, self.column_width + 1)
        self.measure_at(t, state)
        factor_tree(scene)
        measure_answers(scene)
        idle: cython.int = self.configure_at(t, state)
        measure_rows(scene, t)
        for c in range(count):
            answer_blow(scene, F[c], rates[c], to[c])
        memory.fetch()
        return idle

    def jacobians(self, times: Any, states: Any, out: Any) -> None:
        """J of all closure rows at settled states, flat: an instant after the other, each row on its own path."""
        j: cython.Py_ssize_t
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        count: cython.Py_ssize_t = len(times)
        n: cython.Py_ssize_t = len(states) // max(count, 1)
        to: cython.pp_double = memory.over(out, count, len(out) // max(count, 1))
        for j in range(count):
            self.measure_at(times[j], states[n * j : n * j + n])
            put_jacobian(scene, to[j])
        memory.fetch()

    def jacobian(self, t: cython.double, state: Any, out: Any, more: Any = None) -> None:
        """d(ydot)/dy at a state, which is not changed, flat by rows: rows and branches are those of the state.

        more: flat arrays `derivative`, ydot itself, and `motions` (`find_motions`), a direction after the other.
        """
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        tangent: Tangent
        if not cython.compiled:
            tangent = Tangent.blank()
        tangent.n = len(state)
        y: cython.p_double = memory.doubles(state)
        tangent.at = memory.zeros(tangent.n)
        tangent.beside = memory.zeros(tangent.n)
        tangent.J = memory.whole(out)
        if scene.closure_count:
            choose_afresh(scene, t, y)
        scene.programs.holding = TAKEN
        evaluate(scene, t, y, tangent.at)
        scene.programs.holding = HELD
        find_jacobian(scene, t, y, cython.address(tangent))
        scene.programs.holding = FREE
        memory.fetch()
        if more is not None:
            self.put_motions(y, tangent.at, more)

    def put_motions(self, y: cython.p_double, dy: cython.p_double, more: dict[str, Any]) -> None:
        """The derivative of a state that stands, and what bodies and rows change by along each of its directions."""
        i: cython.Py_ssize_t
        memory: Memory = Memory()
        derivative = more["derivative"]
        n: cython.Py_ssize_t = len(derivative)
        for i in range(n):
            derivative[i] = dy[i]
        find_motions(cython.address(self.scene), y, n, memory.whole(more["motions"]))
        memory.fetch()

    def slope(self, t: cython.double, state: Any, out: Any) -> float:
        """dy/dt at a state brought onto the closures, which itself is not changed; the gap left [m].

        Branches of expressions are those of the state.
        """
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        y: cython.p_double = memory.doubles(state)
        gap: cython.double = settle(scene, t, y)
        if scene.closure_count and must_choose_anew(scene, gap):
            select_independent_rows(scene, t, y, False)
            gap = settle(scene, t, y)
        evaluate(scene, t, y, memory.whole(out))
        memory.fetch()
        return gap

    def carried(self, times: Any, states: Any, multipliers: Any, out: Any) -> None:
        """Joint loads that hold closure multipliers at rest: flat, instants, columns, bodies, moment and force.

        multipliers: instants, columns, rows; as many columns at each instant.
        """
        j: cython.Py_ssize_t
        c: cython.Py_ssize_t
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        count: cython.Py_ssize_t = len(times)
        rows: cython.Py_ssize_t = scene.closure_count
        n: cython.Py_ssize_t = len(states) // max(count, 1)
        columns: cython.Py_ssize_t = len(multipliers) // max(count * rows, 1)
        z: cython.pp_double = memory.over(multipliers, count * columns, rows)
        to: cython.pp_double = memory.over(out, count * columns, 6 * scene.body_count)
        for j in range(count):
            self.measure_at(times[j], states[n * j : n * j + n])
            for c in range(columns * j, columns * j + columns):
                carry(scene, z[c], to[c])
        memory.fetch()

    # How it stands

    def chosen_count(self, t: cython.double, state: Any) -> int:
        """How many closure rows are independent at a state, which is not changed."""
        self.configure_at(t, state)
        return self.scene.selected_count

    @property
    def chosen(self) -> list[int]:
        """The closure rows that were chosen last."""
        return [self.scene.selected[i] for i in range(self.scene.selected_count)]

    @property
    def least_row(self) -> float:
        """What has to be left of a row for it to be one of the independent ones."""
        return self.scene.least_row

    @property
    def jammed(self) -> tuple[int, int, float]:
        """Where friction had not one answer last: what was found in place of it, of which load, when [s]."""
        return self.scene.jammed, self.scene.jammed_load, self.scene.jammed_at

    @property
    def freedom_count(self) -> int:
        """Scalar freedoms."""
        return self.scene.freedom_count

    @property
    def column_width(self) -> int:
        """Numbers that answer one column."""
        return 12 * self.scene.body_count + 2 * self.scene.freedom_count + self.scene.closure_count
