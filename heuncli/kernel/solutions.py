"""Write what the solver knows at a state as flat numbers; multibody/tree/tables.py names their columns."""

from __future__ import annotations

from heuncli.kernel.closures import apply_multipliers, measure_rows, row_acceleration, size_of_row_acceleration
from heuncli.kernel.columns import largest_relative_residual, measure_row_responses, solve_causes
from heuncli.kernel.declarations import *
from heuncli.kernel.loads import load_potential
from heuncli.kernel.orthogonal import estimate_multiplier_doubt
from heuncli.kernel.response import evaluate, must_choose_rows, project_state
from heuncli.kernel.selection import choose_rows_again, order_all, select_independent_rows, spread_jacobian_row
from heuncli.kernel.sticking import close_sticking_rows, open_sticking_rows, record_sticking, set_friction_mode
from heuncli.kernel.tree import balance_joints


def write_matrix(buffer: cython.p_double, offset: cython.Py_ssize_t, R: Mat3) -> cython.Py_ssize_t:
    """Write a matrix row by row and return the offset behind it."""
    offset = write_vector(buffer, offset, Vec3(R.xx, R.xy, R.xz))
    offset = write_vector(buffer, offset, Vec3(R.yx, R.yy, R.yz))
    return write_vector(buffer, offset, Vec3(R.zx, R.zy, R.zz))


def write_body(buffer: cython.p_double, offset: cython.Py_ssize_t, body: cython.pointer[Body]) -> cython.Py_ssize_t:
    """Write a body's motion and joint load in the order of tables.SOLUTION_PARTS; return the offset behind them."""
    offset = write_matrix(buffer, offset, body.R)
    offset = write_vector(buffer, offset, body.r)
    offset = write_vector(buffer, offset, body.omega)
    offset = write_vector(buffer, offset, body.v)
    offset = write_vector(buffer, offset, body.alpha)
    offset = write_vector(buffer, offset, body.a)
    offset = write_vector(buffer, offset, body.M_joint)
    return write_vector(buffer, offset, body.f_joint)


def write_load(
    scene: cython.pointer[Scene], buffer: cython.p_double, offset: cython.Py_ssize_t, load: cython.pointer[Load]
) -> cython.Py_ssize_t:
    """Write an applied load in the order of tables.SOLUTION_PARTS; return the offset behind it."""
    offset = write_vector(buffer, offset, load.force)
    offset = write_vector(buffer, offset, load.moment)
    offset = write_vector(buffer, offset, load.place)
    offset = write_vector(buffer, offset, load.place_on_a)
    offset = write_vector(buffer, offset, load.strain)
    offset = write_number(buffer, offset, load.value)
    offset = write_number(buffer, offset, load.span)
    offset = write_number(buffer, offset, load.rate)
    offset = write_number(buffer, offset, load.power)
    offset = write_number(buffer, offset, load.reserve)
    offset = write_number(buffer, offset, load_potential(scene, load))
    return write_number(buffer, offset, load.friction_outcome)


def write_row(
    scene: cython.pointer[Scene], buffer: cython.p_double, offset: cython.Py_ssize_t, row: cython.pointer[Closure]
) -> cython.Py_ssize_t:
    """Write a closure row's unit load, multiplier and motion in the order of tables.SOLUTION_PARTS; return the offset
    behind.
    """
    offset = write_vector(buffer, offset, row.f)
    offset = write_vector(buffer, offset, row.m)
    offset = write_number(buffer, offset, row.multiplier)
    offset = write_number(buffer, offset, row.multiplier_error)
    offset = write_number(buffer, offset, row.gap)
    offset = write_number(buffer, offset, row.rank >= 0)
    offset = write_number(buffer, offset, row.mode != APART)
    offset = write_number(buffer, offset, row.rate)
    offset = write_number(buffer, offset, row_acceleration(scene, row))
    return write_number(buffer, offset, size_of_row_acceleration(scene, row))


def write_instant(
    scene: cython.pointer[Scene], instants: cython.pointer[Instants], instant: cython.Py_ssize_t, idle: cython.int
) -> cython.void:
    """Write all bodies, freedoms, loads, closure rows and the totals of one instant, each kind into its own table.

    idle: what `evaluate` returned at this instant.
    """
    i: cython.Py_ssize_t
    offset: cython.Py_ssize_t = instant * instants.body_width
    for i in range(scene.body_count):
        offset = write_body(instants.bodies, offset, cython.address(scene.bodies[i]))
    offset = instant * instants.freedom_width
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        offset = write_number(instants.freedoms, offset, freedom.q)
        offset = write_number(instants.freedoms, offset, freedom.u)
        offset = write_number(instants.freedoms, offset, freedom.udot)
        offset = write_number(instants.freedoms, offset, freedom.drive)
    offset = instant * instants.load_width
    for i in range(scene.load_count):
        offset = write_load(scene, instants.loads, offset, cython.address(scene.loads[i]))
    offset = instant * instants.row_width
    for i in range(scene.closure_count):
        offset = write_row(scene, instants.rows, offset, cython.address(scene.closures[i]))
    offset = instant * instants.part_width
    for i in range(scene.part_count):
        part: cython.pointer[Closure] = cython.address(scene.parts[i])
        offset = write_vector(instants.parts, offset, scale_vector(part.factor, part.f))
        offset = write_vector(instants.parts, offset, scale_vector(part.factor, part.m))
        offset = write_vector(instants.parts, offset, part.Q)
        offset = write_vector(instants.parts, offset, part.on_a)
        offset = write_vector(instants.parts, offset, part.on_b)
        offset = write_number(instants.parts, offset, part.gap)
    offset = instant * instants.whole_width
    offset = write_number(instants.whole, offset, scene.gap)
    offset = write_number(instants.whole, offset, idle)
    offset = write_number(instants.whole, offset, scene.pivot_recovered)
    offset = write_number(instants.whole, offset, scene.residual)


def recover_state(
    scene: cython.pointer[Scene], t: cython.double, y: cython.p_double, dy: cython.p_double, choose_rows: cython.bint
) -> cython.int:
    """Project y onto the closures and find accelerations, multipliers and joint loads there. Returns what `evaluate`
    returns.

    choose_rows: choose the independent closure rows again first. Stores the largest gap of all rows in scene.gap, and
    what `assess_closures` finds.
    """
    scene.gap = 0.0
    scene.pivot_recovered = 1.0
    if scene.closure_count:
        if choose_rows:
            choose_rows_again(scene, t, y)
        scene.gap = project_state(scene, t, y)
        if must_choose_rows(scene, scene.gap):
            select_independent_rows(scene, t, y, False)
            scene.gap = project_state(scene, t, y)
    trouble: cython.int = evaluate(scene, t, y, dy)
    if not scene.has_drives:
        apply_multipliers(scene)
        balance_joints(scene, True)
    assess_closures(scene, t)
    record_sticking(scene)
    return trouble


def write_measured_state(
    scene: cython.pointer[Scene], bodies: cython.p_double, gaps: cython.p_double, rates: cython.p_double
) -> cython.void:
    """Write all bodies, as `write_body` does, and gap and rate of each closure row, without projecting the state."""
    i: cython.Py_ssize_t
    offset: cython.Py_ssize_t = 0
    for i in range(scene.body_count):
        offset = write_body(bodies, offset, cython.address(scene.bodies[i]))
    for i in range(scene.closure_count):
        gaps[i] = scene.closures[i].gap
        rates[i] = scene.closures[i].rate


def assess_closures(scene: cython.pointer[Scene], t: cython.double) -> cython.void:
    """Measure how well the solution meets all rows, omitted ones too, how independent the selected rows are, and their
    doubt.
    """
    measure_rows(scene, t)
    if scene.selected_count:
        estimate_multiplier_doubt(scene)
        scene.pivot_recovered = order_all(scene, 0.0)
        scene.pivot_recovered *= scene.pivot_recovered
    measure_row_responses(scene)
    scene.residual = largest_relative_residual(scene, scene.load_size)


def set_contact_modes(scene: cython.pointer[Scene], modes: cython.p_double, offset: cython.Py_ssize_t) -> cython.bint:
    """Open and close the contacts as `modes` says from `offset` on. Returns whether anything changed.

    One number a contact: 0 open, 1 closed, 2 kept closed by other contacts, -1 open but held at its limit by a latch,
    so that it is not watched. After them, for each latch, the length at which it holds, and for each friction that
    sticks that length, or the sign of its slip while it is open. Last, for each friction, its leader and transmission.
    """
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    mode: cython.int
    changed: cython.bint = False
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        if contact.mode_index:
            k = offset + contact.mode_index - 1
            mode = APART if modes[k] == 0.0 else LEANS
            if modes[k] > 0.0 and modes[k] < 1.5:
                mode = CARRIES
            changed = changed or scene.closures[contact.row].mode != mode
            scene.closures[contact.row].mode = mode
            if contact.friction:
                changed = set_friction_mode(scene, contact, modes[offset + contact.latch_index - 1]) or changed
                contact.leader = int(modes[offset + contact.group_index - 1])
                contact.transmission = modes[offset + contact.group_index]
            elif contact.latch_index:
                k = offset + contact.latch_index - 1
                changed = changed or scene.closures[contact.row].length != modes[k]
                scene.closures[contact.row].length = modes[k]
    if changed:  # only rows that carry have multipliers; those of the others are 0
        for i in range(scene.closure_count):
            scene.closures[i].multiplier = 0.0
        mark_still_freedoms(scene)
    return changed


def mark_still_freedoms(scene: cython.pointer[Scene]) -> cython.void:
    """Mark the freedoms that closed contacts hold at rest.

    Loads, events and conditions see 0 for such a rate. Its rounding error would switch branches at 0, as of abs(rate),
    back and forth, and leave a table that begins there.
    """
    i: cython.Py_ssize_t
    for i in range(scene.freedom_count):
        scene.freedoms[i].is_held = 0
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        if contact.freedom >= 0 and scene.closures[contact.row].mode != APART:
            scene.freedoms[contact.freedom].is_held = 1
    while mark_coupled_freedom(scene):
        pass


def mark_coupled_freedom(scene: cython.pointer[Scene]) -> cython.bint:
    """Mark the last moving freedom of a coupling whose other coordinates are still. Returns whether one was found."""
    i: cython.Py_ssize_t
    freedom: cython.int
    for i in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[i])
        if row.kind == SUM and row.mode == CARRIES and row.program.count == 0:
            freedom = find_only_moving_freedom(scene, row)
            if freedom >= 0 and not scene.freedoms[freedom].driven:
                scene.freedoms[freedom].is_held = 1
                return True
    return False


def find_only_moving_freedom(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.int:
    """Return the only freedom of a row that is not still; -1 if there is none, several, or the row is not of
    coordinates only.
    """
    i: cython.Py_ssize_t
    k: cython.int
    freedom: cython.int
    moving: cython.int = -1
    for i in range(row.part, row.part + row.part_count):
        part: cython.pointer[Closure] = cython.address(scene.parts[i])
        if part.kind != TURN and part.kind != MESH:
            return -1
        for k in range(1 if part.kind == TURN or part.ratio_b == 0.0 else 2):
            freedom = part.freedom if k == 0 else part.freedom_b
            if scene.freedoms[freedom].is_held or freedom == moving:
                continue
            if moving >= 0:
                return -1
            moving = freedom
    return moving


def recover_states(scene: cython.pointer[Scene], instants: cython.pointer[Instants]) -> cython.void:
    """Recover the states one by one. Unless `instants.afresh` is set, an instant uses the rows chosen at the one
    before.
    """
    j: cython.Py_ssize_t
    i: cython.Py_ssize_t
    trouble: cython.int
    n: cython.Py_ssize_t = instants.n
    has_changed: cython.bint = False
    was_sticking: cython.bint = False
    for j in range(instants.count):
        if instants.mode_count:
            has_changed = set_contact_modes(scene, instants.holding, j * instants.mode_count)
        for i in range(n):
            instants.y[i] = instants.states[j * n + i]
        if instants.has_branches:
            scene.programs.holding = HELD
            for i in range(scene.held_count):
                scene.programs.branches[i] = instants.branches[j * scene.held_count + i]
        trouble = recover_state(
            scene,
            instants.times[j],
            instants.y,
            instants.dy,
            j == 0 or instants.chooses_rows or has_changed or was_sticking,
        )
        for i in range(n):
            instants.states[j * n + i] = instants.y[i]
        write_instant(scene, instants, j, trouble)
        if instants.has_causes:
            was_sticking = open_sticking_rows(scene)
            if was_sticking:  # a friction that sticks is a cause like one that slips: the load that it was found to be
                select_independent_rows(scene, instants.times[j], instants.y, False)
            solve_causes(scene, instants.times[j], instants.y, instants.columns, j * instants.column_width)
            if was_sticking:
                close_sticking_rows(scene)
    scene.programs.holding = FREE


def find_joint_loads(
    scene: cython.pointer[Scene], multipliers: cython.p_double, buffer: cython.p_double
) -> cython.void:
    """Find the joint loads (moment about the joint point, force; per body) that balance closure multipliers at rest."""
    i: cython.Py_ssize_t
    offset: cython.Py_ssize_t = 0
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for i in range(scene.body_count):
        scene.bodies[i].M_applied = zero
        scene.bodies[i].f_applied = zero
        scene.bodies[i].alpha = zero
        scene.bodies[i].a = zero
    for i in range(scene.closure_count):
        scene.closures[i].multiplier = multipliers[i]
    apply_multipliers(scene)
    balance_joints(scene, False)
    for i in range(scene.body_count):
        offset = write_vector(buffer, offset, scene.bodies[i].M_joint)
        offset = write_vector(buffer, offset, scene.bodies[i].f_joint)
    for i in range(scene.closure_count):
        # if no row is independent none is solved for, and they would stay as they are
        scene.closures[i].multiplier = 0.0


def write_jacobian(scene: cython.pointer[Scene], buffer: cython.p_double) -> cython.void:
    """Write J of all rows, each over the freedoms of its path, one row after the other."""
    r: cython.Py_ssize_t
    k: cython.Py_ssize_t
    offset: cython.Py_ssize_t = 0
    for r in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[r])
        spread_jacobian_row(scene, row)
        for k in range(row.velocity_count):
            buffer[offset] = scene.velocity_vector[scene.indices[row.velocities + k]]
            offset += 1
