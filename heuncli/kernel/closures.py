"""Closed chains on top of the sweep: closure rows, and their multipliers.

    J Vdot + gamma = 0,   A = J M^-1 J' = sum over freedoms e_r D^-1 e_s,   A lambda = -(J Vdot_free + gamma)
Row r puts the force f at the point Q and the couple m on body b for lambda = 1, and the opposite at the same place on
a; its column e_r comes from one upward pass along the two paths to the ground.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import sqrt

    from heuncli.kernel.algebra import (
        Vec3,
        add,
        add_cross,
        add_scaled,
        centripetal,
        cross,
        dot,
        norm,
        rotate,
        rotate_back,
        scaled,
        solve,
        sub,
    )
    from heuncli.kernel.expressions import jet
    from heuncli.kernel.scene import DOT, GUIDE, Body, Closure, Counter, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.structs import Carried, Jet
    from heuncli.kernel.tree import answered, direction_of, push


def carried(scene: cython.pointer[Scene], body: cython.int, x: Vec3) -> Carried:
    """How the body's point at the world place x moves; the ground's does not."""
    if body < 0:
        zero: Vec3 = Vec3(0.0, 0.0, 0.0)
        return Carried(zero, zero, zero)
    on: cython.pointer[Body] = cython.address(scene.bodies[body])
    arm: Vec3 = sub(x, on.r)
    return Carried(add_cross(on.v, on.omega, arm), centripetal(on.omega, arm), on.omega)


def place_of(scene: cython.pointer[Scene], body: cython.int, q: Vec3) -> Vec3:
    """World place of a body's point, given from its joint point in its axes; a ground point as it is."""
    if body < 0:
        return q
    return add(rotate(scene.bodies[body].R, q), scene.bodies[body].r)


def measure_rows(scene: cython.pointer[Scene], t: cython.double) -> cython.void:
    """Unit load, gap, rate and gamma of every row at the present kinematics."""
    r: cython.Py_ssize_t
    for r in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[r])
        row.Q = place_of(scene, row.b, row.q)
        if row.kind == GUIDE:
            guide_row(scene, row)
        elif row.kind == DOT:
            dot_row(scene, row)
        else:
            rod_row(scene, row)
        if row.program.count:
            given: Jet = jet(scene.programs, row.program, t)
            row.gap -= given.value
            row.rate -= given.rate
            row.gamma -= given.second
            row.prescribed_rate = given.rate


def guide_row(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """e . (Q - P) = length, e fixed in a: gamma = e . (cen_b - cen_a - 2 omega_a x (v_b - v_a)), both at Q."""
    b: Carried = carried(scene, row.b, row.Q)
    a: Carried = carried(scene, row.a, row.Q)
    e: Vec3 = direction_of(scene, row.a, row.e)
    v: Vec3 = sub(b.v, a.v)
    row.f = e
    row.m = Vec3(0.0, 0.0, 0.0)
    row.gap = dot(e, sub(row.Q, place_of(scene, row.a, row.p))) - row.length
    row.rate = dot(e, v)
    row.gamma = dot(e, add_scaled(sub(b.centripetal, a.centripetal), -2.0, cross(a.omega, v)))


def dot_row(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """e . g = 0, e fixed in a, g in b: gamma = (omega_a - omega_b) . ((omega_a x e) x g + e x (omega_b x g))."""
    b: Carried = carried(scene, row.b, row.Q)
    a: Carried = carried(scene, row.a, row.Q)
    e: Vec3 = direction_of(scene, row.a, row.e)
    g: Vec3 = direction_of(scene, row.b, row.g)
    row.f = Vec3(0.0, 0.0, 0.0)
    row.m = cross(g, e)
    row.gap = dot(e, g)
    row.rate = dot(row.m, sub(b.omega, a.omega))
    row.gamma = dot(sub(a.omega, b.omega), add(cross(cross(a.omega, e), g), cross(e, cross(b.omega, g))))


def rod_row(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """|Q - P| = length along the unit vector n: gamma = n . (cen_b - cen_a) + (v^2 - (n . v)^2) / |Q - P|."""
    P: Vec3 = place_of(scene, row.a, row.p)
    b: Carried = carried(scene, row.b, row.Q)
    a: Carried = carried(scene, row.a, P)
    D: Vec3 = sub(row.Q, P)
    v: Vec3 = sub(b.v, a.v)
    span: cython.double = norm(D)
    if span > 0.0:
        D = Vec3(D.x / span, D.y / span, D.z / span)
    row.f = D
    row.m = Vec3(0.0, 0.0, 0.0)
    row.gap = span - row.length
    row.rate = dot(D, v)
    row.gamma = dot(D, sub(b.centripetal, a.centripetal))
    if span > 0.0:
        row.gamma += (dot(v, v) - row.rate * row.rate) / span


def acceleration_along(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], inertial: cython.bint
) -> cython.double:
    """J Vdot of a row at the accelerations found; the ground at rest is accelerated by -g."""
    found: cython.double = 0.0
    ground: cython.double = -dot(row.f, scene.gravity) if inertial else 0.0
    found += acceleration_of(cython.address(scene.bodies[row.b]), row) if row.b >= 0 else ground
    found -= acceleration_of(cython.address(scene.bodies[row.a]), row) if row.a >= 0 else ground
    return found


def acceleration_of(body: cython.pointer[Body], row: cython.pointer[Closure]) -> cython.double:
    """f . (a + alpha x (Q - r)) + m . alpha."""
    return dot(row.f, add_cross(body.a, body.alpha, sub(row.Q, body.r))) + dot(row.m, body.alpha)


def put_unit_load(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], body: cython.int, sign: cython.double
) -> cython.void:
    """The row's load for lambda = sign on one of its bodies, as M_branch and f_branch about the joint point."""
    if body >= 0:
        on: cython.pointer[Body] = cython.address(scene.bodies[body])
        on.M_branch = add_scaled(on.M_branch, -sign, add_cross(row.m, sub(row.Q, on.r), row.f))
        on.f_branch = add_scaled(on.f_branch, -sign, row.f)


def clear_path(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """No unit load on the row's path."""
    n: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for n in range(row.path, row.path + row.path_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[scene.indices[n]])
        body.M_branch = zero
        body.f_branch = zero


def build_column(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """e_r: what the freedoms of the row's paths answer to its unit load, by the factored inertias."""
    clear_path(scene, row)
    put_unit_load(scene, row, row.b, 1.0)
    put_unit_load(scene, row, row.a, -1.0)
    sweep_column(scene, row)


def sweep_column(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """One upward pass of what stands in M_branch and f_branch along the row's paths, tips first."""
    n: cython.Py_ssize_t
    k: cython.Py_ssize_t
    at: cython.Py_ssize_t = row.column
    for n in range(row.path, row.path + row.path_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[scene.indices[n]])
        if body.ball:
            scene.columns[at] = -body.M_branch.x
            scene.columns[at + 1] = -body.M_branch.y
            scene.columns[at + 2] = -body.M_branch.z
            at += 3
            body.f_branch = sub(body.f_branch, rotate_back(body.G, body.M_branch))
            body.M_branch = Vec3(0.0, 0.0, 0.0)
        for k in range(body.first_freedom, body.end_freedom):
            scene.columns[at] = answered(body, cython.address(scene.freedoms[k]))
            at += 1
        if body.parent >= 0:
            parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
            parent.M_branch = add(parent.M_branch, add_cross(body.M_branch, body.arm, body.f_branch))
            parent.f_branch = add(parent.f_branch, body.f_branch)


def spread_column(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """D^-1 e_r, spread over all freedoms."""
    n: cython.Py_ssize_t
    k: cython.Py_ssize_t
    at: cython.Py_ssize_t = row.column
    to: cython.Py_ssize_t
    for n in range(row.path, row.path + row.path_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[scene.indices[n]])
        to = body.answer_at
        if body.ball:
            turns: Vec3 = solve(body.turning, Vec3(scene.columns[at], scene.columns[at + 1], scene.columns[at + 2]))
            scene.spread[to] = turns.x
            scene.spread[to + 1] = turns.y
            scene.spread[to + 2] = turns.z
            at += 3
            to += 3
        for k in range(body.first_freedom, body.end_freedom):
            scene.spread[to] = scene.freedoms[k].D * scene.columns[at]
            at += 1
            to += 1


def clear_column(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Take back what spread_column put down."""
    k: cython.Py_ssize_t
    for k in range(row.answers, row.answers + row.answer_count):
        scene.spread[scene.indices[k]] = 0.0


def column_product(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """e_r . (what is spread)."""
    k: cython.Py_ssize_t
    found: cython.double = 0.0
    for k in range(row.answer_count):
        found += scene.columns[row.column + k] * scene.spread[scene.indices[row.answers + k]]
    return found


def factor_closures(scene: cython.pointer[Scene]) -> cython.double:
    """Columns and Cholesky factor of A over the independent rows, within each row's envelope; the least pivot.

    Pivots are relative to what the row could answer when the rows were chosen: a row that vanishes counts.
    """
    i: cython.int
    pivot: cython.double
    least: cython.double = 1.0
    for i in range(scene.selected_count):
        build_column(scene, cython.address(scene.closures[scene.selected[i]]))
    for i in range(scene.selected_count):
        scene.envelope[i] = first_coupled(scene, i)
        pivot = eliminate_row(scene, i)
        if pivot < least:
            least = pivot
    return least


def first_coupled(scene: cython.pointer[Scene], i: cython.int) -> cython.int:
    """The first independent row whose paths meet those of the i-th."""
    k: cython.Py_ssize_t
    rank: cython.int
    first: cython.int = i
    row: cython.pointer[Closure] = cython.address(scene.closures[scene.selected[i]])
    for k in range(row.couplings, row.couplings + row.coupling_count):
        rank = scene.closures[scene.indices[k]].rank
        if rank >= 0 and rank < first:
            first = rank
    return first


def eliminate_row(scene: cython.pointer[Scene], i: cython.int) -> cython.double:
    """Row i of A and of its Cholesky factor (diagonal inverted); its pivot, scaled, or -1 where none is left."""
    m: cython.Py_ssize_t = scene.selected_count
    at: cython.Py_ssize_t = m * i
    of: cython.Py_ssize_t
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    begin: cython.Py_ssize_t
    x: cython.double
    first: cython.Py_ssize_t = scene.envelope[i]
    row: cython.pointer[Closure] = cython.address(scene.closures[scene.selected[i]])
    A: cython.p_double = scene.A
    spread_column(scene, row)
    for j in range(first, i + 1):
        A[at + j] = column_product(scene, cython.address(scene.closures[scene.selected[j]]))
    clear_column(scene, row)
    for j in range(first, i):
        of = m * j
        begin = scene.envelope[j] if scene.envelope[j] > first else first
        x = A[at + j]
        for k in range(begin, j):
            x -= A[at + k] * A[of + k]
        A[at + j] = x * A[of + j]
    x = A[at + i]
    for k in range(first, i):
        x -= A[at + k] * A[at + k]
    if x <= 0.0:
        A[at + i] = 1.0
        return -1.0
    A[at + i] = 1.0 / sqrt(x)
    return x * row.pose_scale * row.pose_scale


def solve_closures(scene: cython.pointer[Scene]) -> cython.void:
    """lambda = -A^-1 demand; adds sum lambda e_r to e."""
    m: cython.Py_ssize_t = scene.selected_count
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    x: cython.double
    A: cython.p_double = scene.A
    for i in range(scene.closure_count):
        scene.closures[i].multiplier = 0.0
    for i in range(m):
        x = -scene.closures[scene.selected[i]].demand
        for j in range(scene.envelope[i], i):
            x -= A[m * i + j] * scene.closures[scene.selected[j]].multiplier
        scene.closures[scene.selected[i]].multiplier = x * A[m * i + i]
    for i in range(m - 1, -1, -1):
        x = scene.closures[scene.selected[i]].multiplier * A[m * i + i]
        scene.closures[scene.selected[i]].multiplier = x
        for j in range(scene.envelope[i], i):
            scene.closures[scene.selected[j]].multiplier -= A[m * i + j] * x
    for i in range(m):
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.selected[i]])
        for j in range(row.answer_count):
            scene.e[scene.indices[row.answers + j]] += row.multiplier * scene.columns[row.column + j]


def push_closures(scene: cython.pointer[Scene]) -> cython.void:
    """Put the multipliers' forces and couples on the bodies, beside the applied loads."""
    r: cython.Py_ssize_t
    for r in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[r])
        push(scene, row.b, row.Q, scaled(row.multiplier, row.f), scaled(row.multiplier, row.m))
        push(scene, row.a, row.Q, scaled(-row.multiplier, row.f), scaled(-row.multiplier, row.m))


def count_turns(scene: cython.pointer[Scene], dy: cython.p_double) -> cython.void:
    """Rates of the angles that are counted beside the tree (pins that were cut): n . (omega_b - omega_a)."""
    i: cython.Py_ssize_t
    for i in range(scene.counter_count):
        counter: cython.pointer[Counter] = cython.address(scene.counters[i])
        n: Vec3 = direction_of(scene, counter.a, counter.axis)
        dy[counter.at] = 0.0
        if counter.b >= 0:
            dy[counter.at] += dot(n, scene.bodies[counter.b].omega)
        if counter.a >= 0:
            dy[counter.at] -= dot(n, scene.bodies[counter.a].omega)


def slack(scene: cython.pointer[Scene]) -> cython.int:
    """1 + the first rope that would have to push at the multipliers found; 0 if there is none."""
    r: cython.int
    for r in range(scene.closure_count):
        if scene.closures[r].rope and scene.closures[r].multiplier > 0.0:
            return r + 1
    return 0
