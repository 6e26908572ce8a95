"""A scene in the kernel's memory, and what it answers at single states: the doors that heuncli/response.py opens.

    recover     everything the sweep knows at given states
    columns     one factorisation, many loads: what answers each
    jacobians   the closure rows on the tree's freedoms
    jacobian    the tangent of the motion
    carried     the joint loads that closure multipliers alone leave in the tree
Everything goes in and out as flat arrays of double (tree/tables.py names their parts); nothing is kept between calls.
"""

from __future__ import annotations

from array import array
from typing import Any

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import Mat3, Vec3
    from heuncli.kernel.chosen import choose_afresh, judge_start
    from heuncli.kernel.closures import acceleration_of, measure_rows, push_closures, size_of_answer
    from heuncli.kernel.columns import answer_blow, answer_causes, answer_column, measure_answers, put, unmet
    from heuncli.kernel.events import find_angles
    from heuncli.kernel.expressions import FREE, HELD, TAKEN, Expressions
    from heuncli.kernel.jacobian import find_jacobian, find_motions
    from heuncli.kernel.memory import Memory
    from heuncli.kernel.orthogonal import doubt_multipliers
    from heuncli.kernel.response import configure, evaluate, must_choose_anew, settle
    from heuncli.kernel.scene import (
        APART,
        CARRIES,
        LEANS,
        Body,
        BodyAtState,
        BodyTangent,
        Closure,
        Contact,
        Counter,
        Freedom,
        FreedomTangent,
        Instants,
        Island,
        Lent,
        Limits,
        Load,
        Scene,
        Variable,
        Watch,
    )
    from heuncli.kernel.selection import jacobian_row, order_all, select_independent_rows
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.stepping import Tangent
    from heuncli.kernel.tree import balance, factor_tree, kinematics


def put_matrix(out: cython.p_double, at: cython.Py_ssize_t, R: Mat3) -> cython.Py_ssize_t:
    """Write a matrix by rows."""
    at = put(out, at, Vec3(R.xx, R.xy, R.xz))
    at = put(out, at, Vec3(R.yx, R.yy, R.yz))
    return put(out, at, Vec3(R.zx, R.zy, R.zz))


def put_body(out: cython.p_double, at: cython.Py_ssize_t, body: cython.pointer[Body]) -> cython.Py_ssize_t:
    """A body's motion and joint load, as tables.BODY_ANSWER."""
    at = put_matrix(out, at, body.R)
    at = put(out, at, body.r)
    at = put(out, at, body.omega)
    at = put(out, at, body.v)
    at = put(out, at, body.alpha)
    at = put(out, at, body.a)
    at = put(out, at, body.M_joint)
    return put(out, at, body.f_joint)


def put_load(out: cython.p_double, at: cython.Py_ssize_t, load: cython.pointer[Load]) -> cython.Py_ssize_t:
    """An applied load, as tables.LOAD_ANSWER."""
    at = put(out, at, load.force)
    at = put(out, at, load.moment)
    at = put(out, at, load.at)
    at = put(out, at, load.from_at)
    out[at] = load.value
    out[at + 1] = load.span
    out[at + 2] = load.rate
    out[at + 3] = load.power
    return at + 4


def put_row(
    scene: cython.pointer[Scene], out: cython.p_double, at: cython.Py_ssize_t, row: cython.pointer[Closure]
) -> cython.Py_ssize_t:
    """A closure row's unit load, multiplier and motion, as tables.CLOSURE_ANSWER."""
    at = put(out, at, row.f)
    at = put(out, at, row.m)
    out[at] = row.multiplier
    out[at + 1] = row.doubt
    out[at + 2] = row.gap
    out[at + 3] = row.rank >= 0
    out[at + 4] = row.mode != APART
    out[at + 5] = row.rate
    out[at + 6] = acceleration_of(scene, row)
    out[at + 7] = size_of_answer(scene, row)
    return at + 8


def put_answers(scene: cython.pointer[Scene], out: cython.p_double, at: cython.Py_ssize_t) -> cython.Py_ssize_t:
    """All bodies, freedoms, loads and closure rows, one after the other."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        at = put_body(out, at, cython.address(scene.bodies[i]))
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        out[at] = freedom.q
        out[at + 1] = freedom.u
        out[at + 2] = freedom.udot
        out[at + 3] = freedom.drive
        at += 4
    for i in range(scene.load_count):
        at = put_load(out, at, cython.address(scene.loads[i]))
    for i in range(scene.closure_count):
        at = put_row(scene, out, at, cython.address(scene.closures[i]))
    return at


def recover_state(
    scene: cython.pointer[Scene], t: cython.double, y: cython.p_double, dy: cython.p_double, afresh: cython.bint
) -> cython.int:
    """Settle y on the closures and find accelerations, multipliers and joint loads there; as `evaluate` gives.

    Leaves the gap over all rows in scene.gap; what `judge_closures` finds.
    """
    scene.gap = 0.0
    scene.pivot_recovered = 1.0
    if scene.closure_count:
        if afresh:
            choose_afresh(scene, t, y)
        scene.gap = settle(scene, t, y)
        if must_choose_anew(scene, scene.gap):
            select_independent_rows(scene, t, y, False)
            scene.gap = settle(scene, t, y)
    idle: cython.int = evaluate(scene, t, y, dy)
    if not scene.driven:
        push_closures(scene)
        balance(scene, True)
    judge_closures(scene, t)
    return idle


def judge_closures(scene: cython.pointer[Scene], t: cython.double) -> cython.void:
    """How well the answer found meets all rows, those left out too; how independent the others are, and their doubt."""
    measure_rows(scene, t)
    if scene.selected_count:
        doubt_multipliers(scene)
        scene.pivot_recovered = order_all(scene, 0.0)
        scene.pivot_recovered *= scene.pivot_recovered
    measure_answers(scene)
    scene.residual = unmet(scene)


def take_holding(scene: cython.pointer[Scene], holding: cython.p_double, at: cython.Py_ssize_t) -> cython.bint:
    """Open and close the contacts by the numbers from `at`; whether that is a change.

    Of each contact 0 where it is open, 1 where it is closed, 2 where others close it.
    """
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    mode: cython.int
    changed: cython.bint = False
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        if contact.opens:
            k = at + contact.opens - 1
            mode = APART
            if holding[k] > 0.0:
                mode = CARRIES if holding[k] < 1.5 else LEANS
            changed = changed or scene.closures[contact.row].mode != mode
            scene.closures[contact.row].mode = mode
    if changed:  # multipliers are found for the rows that carry; of the others they are 0
        for i in range(scene.closure_count):
            scene.closures[i].multiplier = 0.0
    return changed


def recover_states(scene: cython.pointer[Scene], instants: cython.pointer[Instants]) -> cython.void:
    """Recover one state after the other, each by itself; unless afresh, the rows chosen at one are the next one's."""
    j: cython.Py_ssize_t
    i: cython.Py_ssize_t
    at: cython.Py_ssize_t
    idle: cython.int
    n: cython.Py_ssize_t = instants.n
    opened: cython.bint = False
    for j in range(instants.count):
        if instants.opening:
            opened = take_holding(scene, instants.holding, j * instants.opening)
        for i in range(n):
            instants.y[i] = instants.states[j * n + i]
        if instants.held:
            scene.programs.holding = HELD
            for i in range(scene.held_count):
                scene.programs.held[i] = instants.branches[j * scene.held_count + i]
        idle = recover_state(scene, instants.times[j], instants.y, instants.dy, j == 0 or instants.afresh or opened)
        for i in range(n):
            instants.states[j * n + i] = instants.y[i]
        at = put_answers(scene, instants.out, j * instants.width)
        instants.out[at] = scene.gap
        instants.out[at + 1] = idle
        instants.out[at + 2] = scene.pivot_recovered
        instants.out[at + 3] = scene.residual
        if instants.causes:
            answer_causes(scene, instants.times[j], instants.y, instants.out, at + 4)
    scene.programs.holding = FREE


def carry(scene: cython.pointer[Scene], multipliers: cython.p_double, out: cython.p_double) -> cython.void:
    """Joint loads (moment about the joint point, force; a body each) that hold closure multipliers at rest."""
    i: cython.Py_ssize_t
    at: cython.Py_ssize_t = 0
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for i in range(scene.body_count):
        scene.bodies[i].M_applied = zero
        scene.bodies[i].f_applied = zero
        scene.bodies[i].alpha = zero
        scene.bodies[i].a = zero
    for i in range(scene.closure_count):
        scene.closures[i].multiplier = multipliers[i]
    push_closures(scene)
    balance(scene, False)
    for i in range(scene.body_count):
        at = put(out, at, scene.bodies[i].M_joint)
        at = put(out, at, scene.bodies[i].f_joint)
    for i in range(scene.closure_count):
        scene.closures[i].multiplier = 0.0  # where no row is independent none is solved for, and they stay as they are


def put_jacobian(scene: cython.pointer[Scene], out: cython.p_double) -> cython.void:
    """J of all rows, each on the freedoms of its path, one after the other."""
    r: cython.Py_ssize_t
    k: cython.Py_ssize_t
    at: cython.Py_ssize_t = 0
    for r in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[r])
        jacobian_row(scene, row)
        for k in range(row.answer_count):
            out[at] = scene.spread[scene.indices[row.answers + k]]
            at += 1


class Workspace:
    """A scene's tables in the kernel's memory (copies), with its work arrays."""

    def __init__(
        self, tables: dict[str, Any], indices: array[int], expressions: Expressions, numbers: dict[str, Any]
    ) -> None:
        """tables: structured arrays by name (tree/tables.py); indices: of the closure rows; numbers: single ones."""
        if not cython.compiled:
            self.scene: Scene = Scene.blank()
        scene: cython.pointer[Scene] = cython.address(self.scene)
        x, y, z = numbers["gravity"]
        self.expressions: Expressions = expressions
        self.memory: Memory = Memory()
        scene.gravity = Vec3(x, y, z)
        scene.size = numbers["size"]
        scene.rank_of_gap = numbers["rank_of_gap"]
        scene.driven = numbers["driven"]
        scene.work_at = numbers["work_at"]
        scene.answer_count = numbers["answer_count"]
        scene.selected_count = 0
        scene.pivot_chosen = 1.0
        scene.pivot = 1.0
        scene.pivot_of_step = 1.0
        scene.own_share = 1.0
        scene.lent_part = 1.0
        scene.programs = cython.address(expressions.programs)
        scene.body_count = len(tables["bodies"])
        scene.freedom_count = len(tables["freedoms"])
        scene.load_count = len(tables["loads"])
        scene.closure_count = len(tables["closures"])
        scene.counter_count = len(tables["counters"])
        scene.variable_count = len(tables["variables"])
        scene.lent_count = len(tables["lents"])
        scene.island_count = len(tables["islands"])
        scene.watch_count = len(tables["watches"])
        scene.contact_count = len(tables["contacts"])
        scene.flat = numbers["flat"] and scene.lent_count == 0
        self.opening: cython.int = sum(1 for opens in tables["contacts"]["opens"].tolist() if opens)
        scene.held_count = expressions.held
        self.take_tables(tables)
        self.take_arrays(indices, numbers)
        scene.least_row = scene.limits.independent

    def start(self, t: cython.double, state: Any) -> None:
        """Judge the rank of the closures by a start, which is not changed."""
        scene: cython.pointer[Scene] = cython.address(self.scene)
        if scene.closure_count == 0:
            return
        if cython.compiled:
            y: cython.double[::1] = array("d", state)
            judge_start(scene, t, cython.address(y[0]))
        else:
            judge_start(scene, t, list(state))

    def take_tables(self, tables: dict[str, Any]) -> None:
        """Copy the tables: their rows are the structs, or become the objects."""
        scene: cython.pointer[Scene] = cython.address(self.scene)
        if cython.compiled:
            scene.bodies = cython.cast(cython.pointer[Body], self.memory.rows(tables["bodies"], cython.sizeof(Body)))
            scene.freedoms = cython.cast(
                cython.pointer[Freedom], self.memory.rows(tables["freedoms"], cython.sizeof(Freedom))
            )
            scene.loads = cython.cast(cython.pointer[Load], self.memory.rows(tables["loads"], cython.sizeof(Load)))
            scene.closures = cython.cast(
                cython.pointer[Closure], self.memory.rows(tables["closures"], cython.sizeof(Closure))
            )
            scene.counters = cython.cast(
                cython.pointer[Counter], self.memory.rows(tables["counters"], cython.sizeof(Counter))
            )
            scene.variables = cython.cast(
                cython.pointer[Variable], self.memory.rows(tables["variables"], cython.sizeof(Variable))
            )
            scene.lents = cython.cast(cython.pointer[Lent], self.memory.rows(tables["lents"], cython.sizeof(Lent)))
            scene.islands = cython.cast(
                cython.pointer[Island], self.memory.rows(tables["islands"], cython.sizeof(Island))
            )
            scene.watches = cython.cast(
                cython.pointer[Watch], self.memory.rows(tables["watches"], cython.sizeof(Watch))
            )
            scene.contacts = cython.cast(
                cython.pointer[Contact], self.memory.rows(tables["contacts"], cython.sizeof(Contact))
            )
            limits: cython.pointer[Limits] = cython.cast(
                cython.pointer[Limits], self.memory.rows(tables["limits"], cython.sizeof(Limits))
            )
            scene.limits = limits[0]
        else:
            scene.bodies = [Body(row) for row in tables["bodies"].tolist()]
            scene.freedoms = [Freedom(row) for row in tables["freedoms"].tolist()]
            scene.loads = [Load(row) for row in tables["loads"].tolist()]
            scene.closures = [Closure(row) for row in tables["closures"].tolist()]
            scene.counters = [Counter(row) for row in tables["counters"].tolist()]
            scene.variables = [Variable(row) for row in tables["variables"].tolist()]
            scene.lents = [Lent(row) for row in tables["lents"].tolist()]
            scene.islands = [Island(row) for row in tables["islands"].tolist()]
            scene.watches = [Watch(row) for row in tables["watches"].tolist()]
            scene.contacts = [Contact(row) for row in tables["contacts"].tolist()]
            scene.limits = Limits(tables["limits"].tolist()[0])

    def take_arrays(self, indices: array[int], numbers: dict[str, Any]) -> None:
        """Copy the indices and the measures of the answers, make room for the work."""
        scene: cython.pointer[Scene] = cython.address(self.scene)
        answers: cython.Py_ssize_t = scene.answer_count
        rows: cython.Py_ssize_t = scene.closure_count
        scene.indices = self.memory.ints(indices)
        scene.selected = self.memory.ints(bytes(4 * rows))
        scene.envelope = self.memory.ints(bytes(4 * rows))
        scene.support = self.memory.ints(bytes(4 * numbers["column_count"]))
        scene.coupled = self.memory.ints(bytes(4 * len(indices)))
        scene.taken = self.memory.ints(bytes(4 * answers))
        scene.measure = self.memory.doubles(numbers["measure"])
        scene.e = self.memory.zeros(answers)
        scene.root = self.memory.zeros(answers)
        scene.spread = self.memory.zeros(answers)
        scene.columns = self.memory.zeros(numbers["column_count"])
        scene.R = self.memory.zeros(rows * rows)
        scene.J = self.memory.zeros(numbers["island_room"])
        scene.y = self.memory.zeros(rows)
        scene.is_angle = self.memory.ints(bytes(4 * scene.held_count))
        find_angles(scene)
        scene.least = self.memory.zeros(scene.variable_count)
        scene.most = self.memory.zeros(scene.variable_count)
        scene.own = self.memory.zeros(scene.lent_count * scene.lent_count)
        self.make_tangents()

    def make_tangents(self) -> None:
        """Room for what the scene changes by along a direction of its state."""
        scene: cython.pointer[Scene] = cython.address(self.scene)
        n: cython.Py_ssize_t = 2 * scene.freedom_count + scene.counter_count + 1
        i: cython.Py_ssize_t
        for i in range(scene.body_count):
            n += 7 * scene.bodies[i].ball
        scene.along = self.memory.zeros(n)
        scene.slopes = self.memory.zeros(scene.variable_count)
        scene.multipliers = self.memory.zeros(scene.closure_count)
        bodies: cython.Py_ssize_t = scene.body_count
        freedoms: cython.Py_ssize_t = scene.freedom_count
        if cython.compiled:
            scene.at_state = cython.cast(
                cython.pointer[BodyAtState], self.memory.zeros(bodies * cython.sizeof(BodyAtState) // 8)
            )
            scene.tangents = cython.cast(
                cython.pointer[BodyTangent], self.memory.zeros(bodies * cython.sizeof(BodyTangent) // 8)
            )
            scene.freedom_tangents = cython.cast(
                cython.pointer[FreedomTangent], self.memory.zeros(freedoms * cython.sizeof(FreedomTangent) // 8)
            )
        else:
            scene.at_state = [BodyAtState.blank() for _ in range(bodies)]
            scene.tangents = [BodyTangent.blank() for _ in range(bodies)]
            scene.freedom_tangents = [FreedomTangent.blank() for _ in range(freedoms)]

    def hold(self, holding: Any) -> None:
        """Open and close the contacts, until the next call: of each 0 open, 1 closed, 2 closed by others."""
        scene: cython.pointer[Scene] = cython.address(self.scene)
        if self.opening == 0:
            return
        if cython.compiled:
            given: cython.double[::1] = array("d", holding)
            take_holding(scene, cython.address(given[0]), 0)
        else:
            take_holding(scene, [float(x) for x in holding], 0)

    def recover(self, arrays: dict[str, Any], afresh: cython.bint, causes: cython.bint) -> None:
        """Everything the sweep knows at given states: flat arrays `times`, `states`, which are settled in place, `out`.

        After the answers of an instant: the gap over all rows, how many freedoms had no inertia behind them, the least
        pivot of the closures, and what of all rows the accelerations do not meet. `branches`: those that expressions
        hold, as many numbers an instant; empty: as the states say; `holding`: the same of the contacts, which `hold`
        takes; empty: as they are. afresh: choose the closure rows at every instant anew. causes: after all that a
        column a cause (columns.py).
        """
        scene: cython.pointer[Scene] = cython.address(self.scene)
        times, states, out = arrays["times"], arrays["states"], arrays["out"]
        branches, holding = arrays["branches"], arrays["holding"]
        count: cython.Py_ssize_t = len(times)
        if count == 0:
            return
        n: cython.Py_ssize_t = len(states) // count
        width: cython.Py_ssize_t = len(out) // count
        held: cython.bint = len(branches) > 0
        opening: cython.int = self.opening if len(holding) else 0
        work = array("d", bytes(16 * max(n, 1)))
        if cython.compiled:
            at: cython.double[::1] = times
            Y: cython.double[::1] = states
            to: cython.double[::1] = out
            room: cython.double[::1] = work
            taken: cython.double[::1] = branches if held else room
            open_: cython.double[::1] = holding if opening else room
            instants: Instants = Instants(
                count, n, width, afresh, held, causes, opening,
                cython.address(taken[0]), cython.address(open_[0]), cython.address(at[0]), cython.address(Y[0]),
                cython.address(to[0]), cython.address(room[0]), cython.address(room[n]),
            )  # fmt: skip
            with cython.nogil:
                recover_states(scene, cython.address(instants))
        else:
            plain = Instants(
                count, n, width, afresh, held, causes, opening, branches.tolist(), holding.tolist(), times.tolist(),
                states.tolist(), out.tolist(), [0.0] * n, [0.0] * n,
            )  # fmt: skip
            recover_states(scene, plain)
            states[:], out[:] = plain.states, plain.out

    def columns(self, t: cython.double, state: Any, loads: Any, inertial: Any, out: Any) -> int:
        """One factorisation at a state, many columns of loads: what answers each (`put_column`).

        loads: moment about the joint point and force, a body each, a column after the other; inertial: of each column,
        whether velocity terms, drives and gravity count. Flat arrays. Gives what `configure` gives.
        """
        c: cython.Py_ssize_t
        scene: cython.pointer[Scene] = cython.address(self.scene)
        count: cython.Py_ssize_t = len(inertial)
        height: cython.Py_ssize_t = 6 * scene.body_count
        width: cython.Py_ssize_t = self.column_width
        if cython.compiled:
            F: cython.double[::1] = loads
            to: cython.double[::1] = out
            idle: cython.int = self.configure_at(t, state)
            for c in range(count):
                answer_column(scene, cython.address(F[height * c]), cython.address(to[width * c]), inertial[c])
        else:
            idle = self.configure_at(t, state)
            for c in range(count):
                answer = [0.0] * width
                answer_column(scene, loads[height * c : height * c + height].tolist(), answer, inertial[c])
                out[width * c : width * c + width] = answer
        return idle

    def blow(self, t: cython.double, state: Any, loads: Any, jumps: Any, out: Any) -> int:
        """The jumps at a settled state, a column a blow: flat, each with what its rows leave unmet as its last number.

        loads: impulses, moment about the joint point and force, a body each; jumps: of the rates of the freedoms, then
        of the closure rows; a column after the other. Gives what `configure` gives.
        """
        c: cython.Py_ssize_t
        scene: cython.pointer[Scene] = cython.address(self.scene)
        height: cython.Py_ssize_t = 6 * scene.body_count
        rates: cython.Py_ssize_t = scene.freedom_count + scene.closure_count
        width: cython.Py_ssize_t = self.column_width + 1
        self.measure_at(t, state)
        factor_tree(scene)
        measure_answers(scene)
        idle: cython.int = self.configure_at(t, state)
        measure_rows(scene, t)
        for c in range(len(out) // width):
            if cython.compiled:
                F: cython.double[::1] = loads
                u: cython.double[::1] = jumps
                to: cython.double[::1] = out
                answer_blow(
                    scene,
                    cython.address(F[height * c]),
                    cython.address(u[rates * c]),
                    cython.address(to[width * c]),
                )
            else:
                answer = [0.0] * width
                own = loads[height * c : height * c + height].tolist(), jumps[rates * c : rates * c + rates].tolist()
                answer_blow(scene, *own, answer)
                out[width * c : width * c + width] = answer
        return idle

    @property
    def least_row(self) -> float:
        """What has to be left of a row for it to be one of the independent ones."""
        return self.scene.least_row

    def chosen_count(self, t: cython.double, state: Any) -> int:
        """How many closure rows are independent at a state, which is not changed."""
        self.configure_at(t, state)
        return self.scene.selected_count

    @property
    def freedom_count(self) -> int:
        """Scalar freedoms."""
        return self.scene.freedom_count

    @property
    def column_width(self) -> int:
        """Numbers that answer one column."""
        return 12 * self.scene.body_count + 2 * self.scene.freedom_count + self.scene.closure_count

    def jacobians(self, times: Any, states: Any, out: Any) -> None:
        """J of all closure rows at settled states, flat: an instant after the other, each row on its own path."""
        j: cython.Py_ssize_t
        scene: cython.pointer[Scene] = cython.address(self.scene)
        instants: cython.Py_ssize_t = len(times)
        n: cython.Py_ssize_t = len(states) // max(instants, 1)
        width: cython.Py_ssize_t = len(out) // max(instants, 1)
        for j in range(instants):
            self.measure_at(times[j], states[n * j : n * j + n])
            if cython.compiled:
                to: cython.double[::1] = out
                put_jacobian(scene, cython.address(to[width * j]))
            else:
                answer = [0.0] * width
                put_jacobian(scene, answer)
                out[width * j : width * j + width] = answer

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
        tangent.J = memory.over(out, 1, tangent.n * tangent.n)[0]
        if scene.closure_count:
            choose_afresh(scene, t, y)
        scene.programs.holding = TAKEN
        evaluate(scene, t, y, tangent.at)
        scene.programs.holding = HELD
        find_jacobian(scene, t, y, cython.address(tangent))
        scene.programs.holding = FREE
        if not cython.compiled:
            out[:] = tangent.J
        if more is not None:
            self.put_motions(y, tangent.at, more)

    def put_motions(self, y: cython.p_double, dy: cython.p_double, more: dict[str, Any]) -> None:
        """The derivative of a state that stands, and what bodies and rows change by along each of its directions."""
        i: cython.Py_ssize_t
        memory: Memory = Memory()
        derivative, motions = more["derivative"], more["motions"]
        n: cython.Py_ssize_t = len(derivative)
        for i in range(n):
            derivative[i] = dy[i]
        to: cython.p_double = memory.over(motions, 1, len(motions))[0]
        find_motions(cython.address(self.scene), y, n, to)
        if not cython.compiled:
            motions[:] = to

    @property
    def chosen(self) -> list[int]:
        """The closure rows that were chosen last."""
        scene: cython.pointer[Scene] = cython.address(self.scene)
        return [scene.selected[i] for i in range(scene.selected_count)]

    def slope(self, t: cython.double, state: Any, out: Any) -> float:
        """dy/dt at a state brought onto the closures, which itself is not changed; the gap left [m].

        Branches of expressions are those of the state.
        """
        scene: cython.pointer[Scene] = cython.address(self.scene)
        memory: Memory = Memory()
        y: cython.p_double = memory.doubles(state)
        rate: cython.p_double = memory.over(out, 1, len(state))[0]
        gap: cython.double = settle(scene, t, y)
        if scene.closure_count and must_choose_anew(scene, gap):
            select_independent_rows(scene, t, y, False)
            gap = settle(scene, t, y)
        evaluate(scene, t, y, rate)
        if not cython.compiled:
            out[:] = rate
        return gap

    def carried(self, times: Any, states: Any, multipliers: Any, out: Any) -> None:
        """Joint loads that hold closure multipliers at rest: flat, instants, columns, bodies, moment and force.

        multipliers: instants, columns, rows; as many columns at each instant.
        """
        j: cython.Py_ssize_t
        c: cython.Py_ssize_t
        scene: cython.pointer[Scene] = cython.address(self.scene)
        instants: cython.Py_ssize_t = len(times)
        rows: cython.Py_ssize_t = scene.closure_count
        width: cython.Py_ssize_t = 6 * scene.body_count
        n: cython.Py_ssize_t = len(states) // max(instants, 1)
        columns: cython.Py_ssize_t = len(multipliers) // max(instants * rows, 1)
        for j in range(instants):
            self.measure_at(times[j], states[n * j : n * j + n])
            for c in range(columns * j, columns * j + columns):
                if cython.compiled:
                    z: cython.double[::1] = multipliers
                    to: cython.double[::1] = out
                    carry(scene, cython.address(z[rows * c]), cython.address(to[width * c]))
                else:
                    answer = [0.0] * width
                    carry(scene, multipliers[rows * c : rows * c + rows].tolist(), answer)
                    out[width * c : width * c + width] = answer

    def configure_at(self, t: cython.double, state: Any) -> int:
        """Choose the closure rows and factor at a state, which is not changed."""
        scene: cython.pointer[Scene] = cython.address(self.scene)
        if cython.compiled:
            y: cython.double[::1] = array("d", state)
            if scene.closure_count:
                choose_afresh(scene, t, cython.address(y[0]))
            kinematics(scene, t, cython.address(y[0]))
            return configure(scene, t)
        plain = list(state)
        if scene.closure_count:
            choose_afresh(scene, t, plain)
        kinematics(scene, t, plain)
        return configure(scene, t)

    def measure_at(self, t: cython.double, state: Any) -> None:
        """Kinematics and closure rows at a state, which is not changed."""
        scene: cython.pointer[Scene] = cython.address(self.scene)
        if cython.compiled:
            y: cython.double[::1] = array("d", state)
            kinematics(scene, t, cython.address(y[0]))
        else:
            kinematics(scene, t, list(state))
        measure_rows(scene, t)
