"""A scene in the kernel's memory, and its solutions at single states: the interface that heuncli/multibody/response.py
uses.

    recover                    everything the sweep knows at given states
    columns                    one factorisation, many loads: the response to each
    jacobians                  the closure rows on the tree's freedoms
    jacobian                   the tangent of the motion
    carry_multipliers          the joint loads that closure multipliers alone cause in the tree

Everything goes in and out as flat arrays of double (multibody/tree/tables.py names their parts); nothing is stored
between calls.
"""

from __future__ import annotations

from array import array
from typing import Any

from heuncli.kernel.closures import measure_rows
from heuncli.kernel.columns import measure_row_responses, solve_column, solve_impulse
from heuncli.kernel.declarations import *
from heuncli.kernel.expressions import Expressions
from heuncli.kernel.kinematics import update_kinematics
from heuncli.kernel.memory import Memory, allocate_work, copy_tables, set_numbers
from heuncli.kernel.response import configure, evaluate, must_choose_rows, project_state
from heuncli.kernel.selection import choose_rows_again, select_independent_rows, set_row_threshold
from heuncli.kernel.solutions import (
    find_joint_loads,
    recover_states,
    set_contact_modes,
    write_jacobian,
    write_measured_state,
)
from heuncli.kernel.tangent import find_jacobian, find_motions
from heuncli.kernel.tree import factor_tree


class Workspace:
    """A scene's tables in the kernel's memory (copies), with its work arrays."""

    def __init__(
        self, tables: dict[str, Any], indices: array[int], expressions: Expressions, numbers: dict[str, Any]
    ) -> None:
        """Copy a scene into the kernel's memory.

        tables: structured arrays by name (multibody/tree/tables.py)
        indices: of closure rows
        numbers: the other values
        """
        if not cython.compiled:
            self.scene: Scene = Scene.blank()
        scene: cython.pointer[Scene] = cython.address(self.scene)
        self.expressions: Expressions = expressions
        self.memory: Memory = Memory()
        mode_numbers: Any = [*tables["contacts"]["mode_index"].tolist(), *tables["contacts"]["latch_index"].tolist()]
        mode_numbers += 2 * tables["contacts"]["group_index"].tolist()
        self.opening: cython.int = sum(1 for k in mode_numbers if k)
        scene.programs = cython.address(expressions.programs)
        scene.held_count = expressions.held_count
        set_numbers(scene, tables, numbers)
        copy_tables(scene, self.memory, tables)
        allocate_work(scene, self.memory, indices, numbers)
        scene.least_row = scene.limits.independent

    # Preparing a state

    def start(self, t: cython.double, state: Any) -> None:
        """Set the threshold for the rank of the closures from a start, which is not changed."""
        memory: Memory = Memory()
        if self.scene.closure_count:
            set_row_threshold(cython.address(self.scene), t, memory.doubles(state))

    def hold(self, modes: Any) -> None:
        """Open and close the contacts, until the next call: a number for each, then one for each latch
        (set_contact_modes).
        """
        memory: Memory = Memory()
        if self.opening:
            set_contact_modes(cython.address(self.scene), memory.doubles(modes), 0)

    def configure_at(self, t: cython.double, state: Any) -> int:
        """Choose the closure rows and factor at a state, which is not changed."""
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        y: cython.p_double = memory.doubles(state)
        if scene.closure_count:
            choose_rows_again(scene, t, y)
        update_kinematics(scene, t, y)
        return configure(scene, t)

    def measure_at(self, t: cython.double, state: Any) -> None:
        """Find kinematics and closure rows at a state, which is not changed."""
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        update_kinematics(scene, t, memory.doubles(state))
        measure_rows(scene, t)

    # Results

    def measure(self, t: cython.double, state: Any, bodies: Any, gaps: Any, rates: Any) -> None:
        """Write the motion of bodies and closure rows at a state as it is to flat arrays, without projecting it."""
        memory: Memory = Memory()
        self.measure_at(t, state)
        write_measured_state(
            cython.address(self.scene), memory.view_row(bodies), memory.view_row(gaps), memory.view_row(rates)
        )
        memory.fetch()

    def variables(self, t: float, state: Any) -> list[float]:
        """Return the variables of the expressions at a state, which is not changed."""
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        update_kinematics(scene, t, memory.doubles(state))
        return [scene.programs.variables[i] for i in range(scene.variable_count)]

    def recover(self, arrays: dict[str, Any], choose_rows: cython.bint, causes: cython.bint) -> None:
        """Recover everything the sweep knows at given states: flat arrays `times` and `states`, which are projected in
        place.

        Results go to `bodies`, `freedoms`, `loads`, `rows`, `parts`, and for each instant to `whole`: the gap over all
        rows, how many freedoms have no inertia behind them, the smallest pivot of the closures, and the relative
        residual of all rows.

        `branches`: those that expressions hold, equally many for each instant; if empty, the states decide. `holding`:
        the same for the contacts, as `hold` takes them; if empty, they stay as they are.

        choose_rows: choose the closure rows at every instant again
        causes: write one column for each cause (columns.py) to `columns`
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
            choose_rows,
            len(arrays["branches"]) > 0,
            causes,
            self.opening if len(arrays["holding"]) else 0,
            memory.view_row(arrays["branches"]),
            memory.view_row(arrays["holding"]),
            memory.view_row(arrays["times"]),
            memory.view_row(arrays["states"]),
            memory.view_row(arrays["bodies"]),
            memory.view_row(arrays["freedoms"]),
            memory.view_row(arrays["loads"]),
            memory.view_row(arrays["rows"]),
            memory.view_row(arrays["parts"]),
            memory.view_row(arrays["whole"]),
            memory.view_row(arrays["columns"]),
            memory.zeros(n),
            memory.zeros(n),
        )
        with cython.nogil:
            recover_states(scene, cython.address(instants))
        memory.fetch()

    def columns(self, t: cython.double, state: Any, loads: Any, inertial: Any, responses: Any) -> int:
        """Factor once at a state and solve for many columns of loads (`write_column`). Returns what `configure`
        returns.

        loads: moment about the joint point and force for each body, column by column; inertial: for each column,
        whether velocity terms, drives and gravity count. All arrays are flat.
        """
        c: cython.Py_ssize_t
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        count: cython.Py_ssize_t = len(inertial)
        F: cython.pp_double = memory.view_rows(loads, count, 6 * scene.body_count)
        response_rows: cython.pp_double = memory.view_rows(responses, count, self.column_width)
        trouble: cython.int = self.configure_at(t, state)
        for c in range(count):
            solve_column(scene, F[c], response_rows[c], inertial[c])
        memory.fetch()
        return trouble

    def impulses(self, t: cython.double, state: Any, loads: Any, jumps: Any, responses: Any) -> int:
        """Solve for the jumps at a projected state, one column for each impulse: flat, each with the relative residual
        of its rows as its last number.

        loads: impulses, moment about the joint point and force for each body; jumps: of the rates of the freedoms, then
        of the closure rows; column by column. Returns what `configure` returns.
        """
        c: cython.Py_ssize_t
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        count: cython.Py_ssize_t = len(responses) // (self.column_width + 1)
        F: cython.pp_double = memory.view_rows(loads, count, 6 * scene.body_count)
        rates: cython.pp_double = memory.view_rows(jumps, count, scene.freedom_count + scene.closure_count)
        response_rows: cython.pp_double = memory.view_rows(responses, count, self.column_width + 1)
        self.measure_at(t, state)
        factor_tree(scene)
        measure_row_responses(scene)
        trouble: cython.int = self.configure_at(t, state)
        measure_rows(scene, t)
        for c in range(count):
            solve_impulse(scene, F[c], rates[c], response_rows[c])
        memory.fetch()
        return trouble

    def jacobians(self, times: Any, states: Any, result: Any) -> None:
        """Write J of all closure rows at projected states, flat: instant by instant, each row on its own path."""
        j: cython.Py_ssize_t
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        count: cython.Py_ssize_t = len(times)
        n: cython.Py_ssize_t = len(states) // max(count, 1)
        result_rows: cython.pp_double = memory.view_rows(result, count, len(result) // max(count, 1))
        for j in range(count):
            self.measure_at(times[j], states[n * j : n * j + n])
            write_jacobian(scene, result_rows[j])
        memory.fetch()

    def jacobian(self, t: cython.double, state: Any, result: Any, details: Any = None) -> None:
        """Write d(ydot)/dy at a state, which is not changed, flat by rows: closure rows and branches are those of the
        state.

        details: flat arrays `derivative`, ydot itself, and `motions` (`find_motions`), one direction after the other
        """
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        tangent: Tangent
        if not cython.compiled:
            tangent = Tangent.blank()
        tangent.n = len(state)
        y: cython.p_double = memory.doubles(state)
        tangent.derivative = memory.zeros(tangent.n)
        tangent.change = memory.zeros(tangent.n)
        tangent.J = memory.view_row(result)
        if scene.closure_count:
            choose_rows_again(scene, t, y)
        scene.programs.holding = TAKEN
        evaluate(scene, t, y, tangent.derivative)
        scene.programs.holding = HELD
        find_jacobian(scene, t, y, cython.address(tangent))
        scene.programs.holding = FREE
        memory.fetch()
        if details is not None:
            self.write_motions(y, tangent.derivative, details)

    def write_motions(self, y: cython.p_double, dy: cython.p_double, details: dict[str, Any]) -> None:
        """Write the derivative at the present state, and the changes of bodies and rows along its directions."""
        i: cython.Py_ssize_t
        memory: Memory = Memory()
        derivative = details["derivative"]
        n: cython.Py_ssize_t = len(derivative)
        for i in range(n):
            derivative[i] = dy[i]
        find_motions(cython.address(self.scene), y, n, memory.view_row(details["motions"]))
        memory.fetch()

    def slope(self, t: cython.double, state: Any, result: Any) -> float:
        """Write dy/dt at a state projected onto the closures, which itself is not changed. Returns the gap left [m].

        Branches of expressions are those of the state.
        """
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        y: cython.p_double = memory.doubles(state)
        gap: cython.double = project_state(scene, t, y)
        if scene.closure_count and must_choose_rows(scene, gap):
            select_independent_rows(scene, t, y, False)
            gap = project_state(scene, t, y)
        evaluate(scene, t, y, memory.view_row(result))
        memory.fetch()
        return gap

    def carry_multipliers(self, times: Any, states: Any, multipliers: Any, result: Any) -> None:
        """Write the joint loads that balance closure multipliers at rest: flat, instants, columns, bodies, moment and
        force.

        multipliers: instants, columns, rows; as many columns at each instant
        """
        j: cython.Py_ssize_t
        c: cython.Py_ssize_t
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        count: cython.Py_ssize_t = len(times)
        rows: cython.Py_ssize_t = scene.closure_count
        n: cython.Py_ssize_t = len(states) // max(count, 1)
        columns: cython.Py_ssize_t = len(multipliers) // max(count * rows, 1)
        z: cython.pp_double = memory.view_rows(multipliers, count * columns, rows)
        result_rows: cython.pp_double = memory.view_rows(result, count * columns, 6 * scene.body_count)
        for j in range(count):
            self.measure_at(times[j], states[n * j : n * j + n])
            for c in range(columns * j, columns * j + columns):
                find_joint_loads(scene, z[c], result_rows[c])
        memory.fetch()

    # Properties

    def count_independent_rows(self, t: cython.double, state: Any) -> int:
        """Return how many closure rows are independent at a state, which is not changed."""
        self.configure_at(t, state)
        return self.scene.selected_count

    @property
    def chosen_rows(self) -> list[int]:
        """Return the closure rows that were chosen last."""
        return [self.scene.selected[i] for i in range(self.scene.selected_count)]

    @property
    def least_row(self) -> float:
        """Return what must be left of a row for it to be an independent one."""
        return self.scene.least_row

    @property
    def friction_failure(self) -> tuple[int, int, float]:
        """Return where friction last had not exactly one solution: the outcome found instead, the load, and the time
        [s].
        """
        return self.scene.friction_outcome, self.scene.friction_outcome_load, self.scene.friction_outcome_time

    @property
    def freedom_count(self) -> int:
        """Return the number of scalar freedoms."""
        return self.scene.freedom_count

    @property
    def column_width(self) -> int:
        """Return how many numbers the response to one column has."""
        return 12 * self.scene.body_count + 2 * self.scene.freedom_count + self.scene.closure_count
