"""What the sweep knows at a state, as flat numbers, whose parts multibody/tree/tables.py names."""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import Mat3, Vec3, scaled
    from heuncli.kernel.chosen import choose_afresh
    from heuncli.kernel.closures import acceleration_of, measure_rows, push_closures, size_of_answer
    from heuncli.kernel.columns import answer_causes, measure_answers, put, unmet
    from heuncli.kernel.loads import potential_of
    from heuncli.kernel.orthogonal import doubt_multipliers
    from heuncli.kernel.programs import FREE, HELD
    from heuncli.kernel.response import evaluate, must_choose_anew, settle
    from heuncli.kernel.scene import (
        APART,
        CARRIES,
        LEANS,
        MESH,
        SUM,
        TURN,
        Body,
        Closure,
        Contact,
        Freedom,
        Load,
        Scene,
    )
    from heuncli.kernel.selection import jacobian_row, order_all, select_independent_rows
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.tree import balance
    from heuncli.kernel.values import Instants


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


def put_load(
    scene: cython.pointer[Scene], out: cython.p_double, at: cython.Py_ssize_t, load: cython.pointer[Load]
) -> cython.Py_ssize_t:
    """An applied load, as tables.LOAD_ANSWER."""
    at = put(out, at, load.force)
    at = put(out, at, load.moment)
    at = put(out, at, load.at)
    at = put(out, at, load.from_at)
    at = put(out, at, load.strain)
    out[at] = load.value
    out[at + 1] = load.span
    out[at + 2] = load.rate
    out[at + 3] = load.power
    out[at + 4] = potential_of(scene, load)
    return at + 5


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


def put_answers(
    scene: cython.pointer[Scene], to: cython.pointer[Instants], j: cython.Py_ssize_t, idle: cython.int
) -> cython.void:
    """All bodies, freedoms, loads and closure rows at a state, each kind in its own place, and the state itself."""
    i: cython.Py_ssize_t
    at: cython.Py_ssize_t = j * to.body_width
    for i in range(scene.body_count):
        at = put_body(to.bodies, at, cython.address(scene.bodies[i]))
    at = j * to.freedom_width
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        to.freedoms[at] = freedom.q
        to.freedoms[at + 1] = freedom.u
        to.freedoms[at + 2] = freedom.udot
        to.freedoms[at + 3] = freedom.drive
        at += 4
    at = j * to.load_width
    for i in range(scene.load_count):
        at = put_load(scene, to.loads, at, cython.address(scene.loads[i]))
    at = j * to.row_width
    for i in range(scene.closure_count):
        at = put_row(scene, to.rows, at, cython.address(scene.closures[i]))
    at = j * to.part_width
    for i in range(scene.part_count):
        part: cython.pointer[Closure] = cython.address(scene.parts[i])
        at = put(to.parts, at, scaled(part.factor, part.f))
        at = put(to.parts, at, scaled(part.factor, part.m))
        at = put(to.parts, at, part.Q)
        at = put(to.parts, at, part.on_a)
        at = put(to.parts, at, part.on_b)
        to.parts[at] = part.gap
        at += 1
    at = j * to.whole_width
    to.whole[at] = scene.gap
    to.whole[at + 1] = idle
    to.whole[at + 2] = scene.pivot_recovered
    to.whole[at + 3] = scene.residual


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


def put_measured(
    scene: cython.pointer[Scene], bodies: cython.p_double, gaps: cython.p_double, rates: cython.p_double
) -> cython.void:
    """All bodies, as `put_body`, and gap and rate of each closure row, as they stand: nothing is settled."""
    i: cython.Py_ssize_t
    at: cython.Py_ssize_t = 0
    for i in range(scene.body_count):
        at = put_body(bodies, at, cython.address(scene.bodies[i]))
    for i in range(scene.closure_count):
        gaps[i] = scene.closures[i].gap
        rates[i] = scene.closures[i].rate


def judge_closures(scene: cython.pointer[Scene], t: cython.double) -> cython.void:
    """How well the answer found meets all rows, those left out too; how independent the others are, and their doubt."""
    measure_rows(scene, t)
    if scene.selected_count:
        doubt_multipliers(scene)
        scene.pivot_recovered = order_all(scene, 0.0)
        scene.pivot_recovered *= scene.pivot_recovered
    measure_answers(scene)
    scene.residual = unmet(scene, scene.load_size)


def take_holding(scene: cython.pointer[Scene], holding: cython.p_double, at: cython.Py_ssize_t) -> cython.bint:
    """Open and close the contacts by the numbers from `at`; whether that is a change.

    Of each contact 0 where it is open, 1 where it is closed, 2 where others close it, -1 where it is open, but a latch
    holds it at its limit, so that it is not looked at. Behind them, of each latch, the length at which it holds.
    """
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    mode: cython.int
    changed: cython.bint = False
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        if contact.opens:
            k = at + contact.opens - 1
            mode = APART if holding[k] == 0.0 else LEANS
            if holding[k] > 0.0 and holding[k] < 1.5:
                mode = CARRIES
            changed = changed or scene.closures[contact.row].mode != mode
            scene.closures[contact.row].mode = mode
            if contact.held_at:
                k = at + contact.held_at - 1
                changed = changed or scene.closures[contact.row].length != holding[k]
                scene.closures[contact.row].length = holding[k]
    if changed:  # multipliers are found for the rows that carry; of the others they are 0
        for i in range(scene.closure_count):
            scene.closures[i].multiplier = 0.0
        hold_still(scene)
    return changed


def hold_still(scene: cython.pointer[Scene]) -> cython.void:
    """Tell the freedoms which of them closed contacts hold.

    What loads, events and conditions see of such a rate is 0: its rounding would turn branches at 0, as of abs(rate),
    to and fro, and leave a table that begins there.
    """
    i: cython.Py_ssize_t
    for i in range(scene.freedom_count):
        scene.freedoms[i].still = 0
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        if contact.freedom >= 0 and scene.closures[contact.row].mode != APART:
            scene.freedoms[contact.freedom].still = 1
    while pass_on(scene):
        pass


def pass_on(scene: cython.pointer[Scene]) -> cython.bint:
    """A coupling of coordinates that all stand still but one holds that one; whether one is found."""
    i: cython.Py_ssize_t
    last: cython.int
    for i in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[i])
        if row.kind == SUM and row.mode == CARRIES and row.program.count == 0:
            last = moving_alone(scene, row)
            if last >= 0 and not scene.freedoms[last].driven:
                scene.freedoms[last].still = 1
                return True
    return False


def moving_alone(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.int:
    """The one freedom of a row that does not stand still; -1: none, several, or it is of more than coordinates."""
    i: cython.Py_ssize_t
    k: cython.int
    of: cython.int
    last: cython.int = -1
    for i in range(row.part, row.part + row.part_count):
        part: cython.pointer[Closure] = cython.address(scene.parts[i])
        if part.kind != TURN and part.kind != MESH:
            return -1
        for k in range(1 if part.kind == TURN or part.ratio_b == 0.0 else 2):
            of = part.freedom if k == 0 else part.freedom_b
            if scene.freedoms[of].still or of == last:
                continue
            if last >= 0:
                return -1
            last = of
    return last


def recover_states(scene: cython.pointer[Scene], instants: cython.pointer[Instants]) -> cython.void:
    """Recover one state after the other, each by itself; unless afresh, the rows chosen at one are the next one's."""
    j: cython.Py_ssize_t
    i: cython.Py_ssize_t
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
        put_answers(scene, instants, j, idle)
        if instants.causes:
            answer_causes(scene, instants.times[j], instants.y, instants.columns, j * instants.column_width)
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
