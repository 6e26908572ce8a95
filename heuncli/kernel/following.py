"""Motions that their drives determine: nothing is integrated, the closures tell where everything is at an instant.

    g(q, t) = 0,   J u = -g_t,   J a = -gamma,   as many independent rows as coordinates
Newton's method finds q from a prediction, and several q may meet g = 0: the one asked for is that to which the drives
lead from the step's start. J is made of products of up to three directions and arms, which turn by what the bodies
turn: where coordinates move by m [rad, or of an island's length], J changes by some 3 m, and keeps its rank while that
is well below its least pivot. Then Newton's method contracts at every instant of the step, one solution lies as near,
and it is the one that moved there (Kantorovich). m is bounded, not sampled: the range of each drive over the step
(enclosure.py), times what a unit of it moves. Deuflhard, Newton Methods for Nonlinear Problems (2004), ch. 5.
What gears, belts and screws hold is linear in their coordinates, and J the same in every pose: in m count only
coordinates that other rows are made of. Of gears the drives' laws keep steps so short that interpolation follows them.

Where the pivot falls to nothing, steps do too: a singular pose is not passed, there what moves has a say in the branch.
The work that is done is the gain of kinetic and potential energy.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import atan2, fabs, sqrt

    from heuncli.kernel.algebra import (
        Quaternion,
        Vec3,
        add_scaled,
        cross,
        dot,
        norm,
        rotate_back,
        scaled,
        slightly_turned,
        transform,
    )
    from heuncli.kernel.columns import apply_none, prescribe, stand_still
    from heuncli.kernel.conditions import condition, condition_count
    from heuncli.kernel.course import set_time
    from heuncli.kernel.dense import clipped, interpolate, need_interpolant
    from heuncli.kernel.directions import direction_of
    from heuncli.kernel.enclosure import enclose
    from heuncli.kernel.events import see
    from heuncli.kernel.jets import jet
    from heuncli.kernel.landing import begin_to_see, see_stage
    from heuncli.kernel.libm import INFINITY
    from heuncli.kernel.loads import potential_of
    from heuncli.kernel.points import look_at
    from heuncli.kernel.programs import Bounds, Jet, Program
    from heuncli.kernel.response import evaluate, respond, settle
    from heuncli.kernel.scene import (
        MESH,
        SHIFT,
        TURN,
        Body,
        Closure,
        Counter,
        Freedom,
        Scene,
    )
    from heuncli.kernel.selection import order_all
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.stepping import Branch, Method, Run
    from heuncli.kernel.tracks import place_beside
    from heuncli.kernel.tree import kinematics

    LOOKED_AT = 2  # parts of a step at whose ends loads are seen


def is_determined(scene: cython.pointer[Scene]) -> cython.bint:
    """Whether the rows chosen leave no freedom."""
    i: cython.Py_ssize_t
    free: cython.int = 0
    for i in range(scene.body_count):
        if scene.bodies[i].ball:
            free += 3
    for i in range(scene.freedom_count):
        if not scene.freedoms[i].driven:
            free += 1
    return free == scene.selected_count


# Where a step starts


def stand_here(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.void:
    """What the next step needs of the state reached, as it was evaluated last."""
    i: cython.Py_ssize_t
    branch: cython.pointer[Branch] = cython.address(run.branch)
    if scene.closure_count == 0:
        kinematics(scene, clipped(run, run.t), run.y)
    branch.energy = mechanical_energy(scene)
    for i in range(scene.counter_count):
        counter: cython.pointer[Counter] = cython.address(scene.counters[i])
        if counter.track:
            continue
        mark: Vec3 = seen_from(scene, counter.b, direction_of(scene, counter.a, find_perpendicular(counter.axis)))
        branch.marks[3 * i] = mark.x
        branch.marks[3 * i + 1] = mark.y
        branch.marks[3 * i + 2] = mark.z
    if scene.closure_count and not run.following:
        branch.pivot = order_all(scene, 0.0)
        measure_reach(scene, branch)


def measure_reach(scene: cython.pointer[Scene], branch: cython.pointer[Branch]) -> cython.void:
    """How far a unit of each drive in a loop moves the coordinates: itself, or more; the kinematics are lost."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    gravity: Vec3 = scene.gravity
    scene.gravity = Vec3(0.0, 0.0, 0.0)
    for i in range(scene.freedom_count + scene.closure_count):
        if branch.travel[i] >= 0.0:
            stand_still(scene)
            for k in range(scene.freedom_count):
                scene.freedoms[k].udot = 1.0 if k == i else 0.0
            for k in range(scene.closure_count):
                scene.closures[k].prescribed_second = 1.0 if scene.freedom_count + k == i else 0.0
            prescribe(scene)
            apply_none(scene)
            respond(scene, True)
            shifts: cython.bint = i >= scene.freedom_count or scene.freedoms[i].kind == SHIFT
            own: cython.double = 1.0 / branch.length if shifts else 1.0
            bends: cython.bint = i >= scene.freedom_count or branch.bends[i] != 0
            branch.travel[i] = find_largest_change(scene, branch, own, False)
            branch.reach[i] = find_largest_change(scene, branch, own if bends else 0.0, True)
    scene.gravity = gravity


def is_linear(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.bint:
    """Whether a row's gap is a sum of coordinates, each times a constant: it has the same J in every pose."""
    i: cython.Py_ssize_t
    for i in range(condition_count(row)):
        kind: cython.int = condition(scene, row, i).kind
        if kind != MESH and kind != TURN:
            return False
    return True


def find_largest_change(
    scene: cython.pointer[Scene], branch: cython.pointer[Branch], found: cython.double, bending: cython.bint
) -> cython.double:
    """The largest of the coordinates' changes in the answer found, or what is given; bending: of those that turn J."""
    i: cython.Py_ssize_t
    x: cython.double
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if not freedom.driven and (branch.bends[i] or not bending):
            x = fabs(freedom.udot)
            if freedom.kind == SHIFT:
                x /= branch.length
            if not x <= found:
                found = x
    for i in range(scene.body_count):
        if scene.bodies[i].ball and (branch.bends[scene.freedom_count + i] or not bending):
            x = norm(scene.bodies[i].alpha)
            if not x <= found:
                found = x
    return found


def moved_by_drives(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.double:
    """How far any coordinate that J changes with moves at most within the step tried [rad, of an island's length]."""
    i: cython.Py_ssize_t
    n: cython.Py_ssize_t = scene.freedom_count
    program: Program
    over: Bounds
    found: cython.double = 0.0
    branch: cython.pointer[Branch] = cython.address(run.branch)
    if scene.closure_count == 0:
        return 0.0
    set_time(scene.programs, run.t, clipped(run, run.stop))
    for i in range(n + scene.closure_count):
        if branch.reach[i] > 0.0:
            if i < n:
                program = scene.freedoms[i].program
            else:
                program = scene.closures[i - n].program
            over = enclose(scene.programs, program).value
            found += branch.reach[i] * (over.high - over.low)
    return found


def bends_between(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Whether a drive does more within the step tried than its ends tell: there it is looked at for extremes."""
    i: cython.Py_ssize_t
    for i in range(scene.freedom_count):
        if scene.freedoms[i].driven and bends(scene, run, scene.freedoms[i].program, i):
            return True
    for i in range(scene.closure_count):
        if scene.closures[i].program.count and bends(scene, run, scene.closures[i].program, scene.freedom_count + i):
            return True
    return False


def bends(
    scene: cython.pointer[Scene], run: cython.pointer[Run], program: Program, at: cython.Py_ssize_t
) -> cython.bint:
    """Whether the acceleration of a drive is off, in the middle, that of the quintic by the values at both ends.

    That is 3 (v1 - v0) / 2h - (a0 + a1) / 4. A drive whose rate hardly changes bends nowhere. What it moves has such a
    quintic as its course between the ends, which is off by off h^2 / 24 a unit: of the sixth derivative an
    acceleration has 3 h^4 / 8, a value h^6 / 64, both by 720. That is looked at where m does not see to it.
    """
    travel: cython.double = run.branch.travel[at]
    first: Jet = jet(scene.programs, program, run.t)
    middle: Jet = jet(scene.programs, program, clipped(run, run.t + 0.5 * run.h))
    last: Jet = jet(scene.programs, program, clipped(run, run.stop))
    off: cython.double = middle.second - 1.5 * (last.rate - first.rate) / run.h + 0.25 * (first.second + last.second)
    rate: cython.double = fabs(first.rate) + fabs(middle.rate) + fabs(last.rate)
    size: cython.double = fabs(first.second) + fabs(middle.second) + fabs(last.second)
    part: cython.double = scene.limits.branch_bend
    if not fabs(off) <= part * (size + part * rate / run.h):
        return True
    if not travel > run.branch.reach[at]:
        return False
    rounding: cython.double = scene.limits.rounding * run.h * (rate + run.h * size)
    return not fabs(off) * run.h * run.h / 24.0 <= scene.limits.branch_between / travel + rounding


# A step


def room(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.double:
    """How far coordinates may move in a step; what begins beside the start goes in other steps."""
    return scene.limits.branch_step * run.branch.pivot * (scene.limits.branch_beside if run.late else 1.0)


def follow(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """The state z at the end of the step tried, with its derivative; -1 where the step is to be shorter."""
    t: cython.double = clipped(run, run.stop)
    gap: cython.double
    moved: cython.double
    run.has_interpolant = 0
    if not run.following:
        moved = moved_by_drives(scene, run)
        if scene.closure_count and not moved <= room(scene, run):
            shorten_to(run, 0.9 * room(scene, run) / moved)
            return -1
        if bends_between(scene, run):
            shorten_to(run, 0.5)
            return -1
        run.branch.moved = moved
    if run.seeing:
        begin_to_see(scene, run)
    predict(scene, run)
    gap = settle(scene, t, run.z)
    evaluate(scene, t, run.z, run.K[method.stages])
    carry_on(scene, run, run.z)
    run.evaluations += 1
    if not run.following and not fabs(mechanical_energy(scene)) < INFINITY:
        shorten_to(run, 0.0)
        return -1
    if run.seeing:
        see_stage(scene, run, t)
        see_between(scene, method, run)
    if not run.following and scene.closure_count and left_branch(scene, run, gap):
        shorten_to(run, 0.5)
        return -1
    return 0


def shorten_to(run: cython.pointer[Run], part: cython.double) -> cython.void:
    """The next attempt is a part of this one, a tenth at least."""
    run.control.proposed = run.h * (part if part > 0.1 else 0.1)
    run.control.rejected_before = 1


def predict(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.void:
    """z from the state, its rates and accelerations at the step's start."""
    i: cython.Py_ssize_t
    at: cython.Py_ssize_t
    u: cython.Py_ssize_t
    h: cython.double = run.h
    y: cython.p_double = run.y
    dy: cython.p_double = run.K[0]
    for i in range(run.n):
        run.z[i] = y[i] + h * dy[i]
        run.z_carry[i] = 0.0
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if not freedom.driven:
            run.z[freedom.q_at] = y[freedom.q_at] + h * (y[freedom.u_at] + 0.5 * h * dy[freedom.u_at])
    for i in range(scene.body_count):
        if scene.bodies[i].ball:
            at = scene.bodies[i].attitude_at
            u = scene.bodies[i].rate_at
            omega: Vec3 = Vec3(y[u], y[u + 1], y[u + 2])
            turn: Vec3 = scaled(h, add_scaled(omega, 0.5 * h, Vec3(dy[u], dy[u + 1], dy[u + 2])))
            q: Quaternion = slightly_turned(Quaternion(y[at], y[at + 1], y[at + 2], y[at + 3]), turn)
            run.z[at] = q.w
            run.z[at + 1] = q.x
            run.z[at + 2] = q.y
            run.z[at + 3] = q.z


def left_branch(scene: cython.pointer[Scene], run: cython.pointer[Run], gap: cython.double) -> cython.bint:
    """Whether z may be another solution than the one that moved there, or the pivot falls too fast to tell."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    x: cython.double
    square: cython.double
    most: cython.double = 2.0 * run.branch.moved + scene.limits.lost
    if not gap <= scene.limits.reopened * scene.size:
        return True
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if not freedom.driven and run.branch.bends[i]:
            x = fabs(run.z[freedom.q_at] - run.y[freedom.q_at])
            if not x <= most * (run.branch.length if freedom.kind == SHIFT else 1.0):
                return True
    for i in range(scene.body_count):
        if scene.bodies[i].ball:
            square = 0.0
            for k in range(scene.bodies[i].attitude_at, scene.bodies[i].attitude_at + 4):
                square += (run.z[k] - run.y[k]) * (run.z[k] - run.y[k])
            if not 2.0 * sqrt(square) <= most:
                return True
    return not order_all(scene, 0.0) >= 0.5 * run.branch.pivot


def carry_on(scene: cython.pointer[Scene], run: cython.pointer[Run], x: cython.p_double) -> cython.void:
    """Work and counted angles of a state whose kinematics are there, from those at the step's start."""
    i: cython.Py_ssize_t
    angle: cython.double
    half: cython.double = 3.141592653589793
    for i in range(scene.counter_count):
        counter: cython.pointer[Counter] = cython.address(scene.counters[i])
        if counter.track:
            x[counter.at] = place_beside(scene, cython.address(scene.closures[counter.track - 1]))
            continue
        n: Vec3 = counter.axis
        w: Vec3 = Vec3(run.branch.marks[3 * i], run.branch.marks[3 * i + 1], run.branch.marks[3 * i + 2])
        before: Vec3 = find_perpendicular(n)
        now: Vec3 = seen_from(scene, counter.a, direction_of(scene, counter.b, w))
        angle = run.y[counter.at] + atan2(dot(n, cross(before, now)), dot(before, now))
        while x[counter.at] - angle > half:
            angle += 2.0 * half
        while angle - x[counter.at] > half:
            angle -= 2.0 * half
        x[counter.at] = angle
    if scene.work_at >= 0:
        x[scene.work_at] = run.y[scene.work_at] + (mechanical_energy(scene) - run.branch.energy)


def find_perpendicular(n: Vec3) -> Vec3:
    """A direction across another one."""
    if fabs(n.x) <= fabs(n.y) and fabs(n.x) <= fabs(n.z):
        return cross(n, Vec3(1.0, 0.0, 0.0))
    if fabs(n.y) <= fabs(n.z):
        return cross(n, Vec3(0.0, 1.0, 0.0))
    return cross(n, Vec3(0.0, 0.0, 1.0))


def seen_from(scene: cython.pointer[Scene], body: cython.int, a: Vec3) -> Vec3:
    """A world direction in a body's axes, or the ground's (-1)."""
    if body < 0:
        return a
    return rotate_back(scene.bodies[body].R, a)


def mechanical_energy(scene: cython.pointer[Scene]) -> cython.double:
    """Kinetic energy, and potential energy of gravity (from the world's origin) and of loads [J]."""
    i: cython.Py_ssize_t
    found: cython.double = 0.0
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        turn: Vec3 = rotate_back(body.R, body.omega)
        found += 0.5 * (body.mass * dot(body.v, body.v) + dot(turn, transform(body.inertia, turn)))
        found += dot(body.v, cross(body.omega, body.mc))
        found -= dot(scene.gravity, add_scaled(body.mc, body.mass, body.r))
    for i in range(scene.load_count):
        found += potential_of(scene, cython.address(scene.loads[i]))
    return found


# Within a step


def see_between(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """What loads do on the way: a step that no load shortens would show them its two ends only."""
    k: cython.int
    part: cython.double
    if scene.watch_count == 0:
        return
    need_interpolant(scene, method, run)
    for k in range(1, LOOKED_AT):
        part = k
        interpolate(scene, method, run, part / LOOKED_AT, run.stage)
        look_at(scene, clipped(run, run.t + part / LOOKED_AT * run.h), run.stage)
        see(scene)


def find_between(scene: cython.pointer[Scene], run: cython.pointer[Run], x: cython.p_double) -> cython.void:
    """The state at an asked instant within the step, from its interpolation x."""
    t: cython.double = clipped(run, run.samples.times[run.samples.next])
    settle(scene, t, x)
    if scene.counter_count > 0 or scene.work_at >= 0:
        kinematics(scene, t, x)
        carry_on(scene, run, x)
