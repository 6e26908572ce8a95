"""Motions that their drives determine: nothing is integrated, the closures give the pose at every instant.

    g(q, t) = 0,   J u = -g_t,   J a = -gamma,   as many independent rows as coordinates

Newton's method finds q from a prediction. Several q may satisfy g = 0: the right one is that to which the drives lead
from the step's start. J consists of products of up to three directions and arms, which turn as the bodies turn: where
coordinates move by m [rad, or of an island's length], J changes by some 3 m, and keeps its rank while that is well
below its smallest pivot. Then Newton's method contracts at every instant of the step, only one solution lies that near,
and it is the one that moved there (Kantorovich). m is bounded, not sampled: the range of each drive over the step
(enclosure.py), times the motion per unit of it. Deuflhard, Newton Methods for Nonlinear Problems (2004), ch. 5.

Conditions of gears, belts and screws are linear in their coordinates, and J is the same in every pose: m counts only
coordinates that other rows are made of. For gears the drives' laws keep steps so short that interpolation follows them.
Where the pivot falls to zero, so do the steps: a singular pose is not passed, because there the branch depends on the
masses that move. The work done is the gain of kinetic and potential energy.
"""

from __future__ import annotations

from math import atan2, fabs, sqrt

from heuncli.kernel.carried_points import find_perpendicular
from heuncli.kernel.columns import add_prescribed, clear_loads, clear_motion
from heuncli.kernel.conditions import condition, condition_count
from heuncli.kernel.course import set_time_range
from heuncli.kernel.declarations import *
from heuncli.kernel.dense import clip_time, ensure_interpolant, interpolate
from heuncli.kernel.enclosure import enclose
from heuncli.kernel.jets import jet
from heuncli.kernel.kinematics import update_kinematics
from heuncli.kernel.landing import begin_step_extremes, record_stage
from heuncli.kernel.libm import INFINITY
from heuncli.kernel.loads import load_potential
from heuncli.kernel.points import evaluate_variables
from heuncli.kernel.response import evaluate, project_state, solve_response
from heuncli.kernel.selection import order_all
from heuncli.kernel.tracks import find_track_place
from heuncli.kernel.watches import record_extremes

WATCH_PARTS = 2  # parts of a step, at whose ends loads are recorded


def is_determined(scene: cython.pointer[Scene]) -> cython.bint:
    """Return whether the chosen rows leave no freedom."""
    i: cython.Py_ssize_t
    free_count: cython.int = 0
    for i in range(scene.body_count):
        if scene.bodies[i].ball:
            free_count += 3
    for i in range(scene.freedom_count):
        if not scene.freedoms[i].driven:
            free_count += 1
    return free_count == scene.selected_count


# Where a step starts


def prepare_step(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.void:
    """Store what the next step needs of the state reached, which was evaluated last."""
    i: cython.Py_ssize_t
    branch: cython.pointer[FollowedStep] = cython.address(run.followed_step)
    if scene.closure_count == 0:
        update_kinematics(scene, clip_time(run, run.t), run.y)
    branch.energy = mechanical_energy(scene)
    for i in range(scene.counter_count):
        counter: cython.pointer[Counter] = cython.address(scene.counters[i])
        if counter.track:
            continue
        marker: Vec3 = body_components(
            scene, counter.b, world_direction(scene, counter.a, find_perpendicular(counter.axis))
        )
        write_vector(branch.marks, 3 * i, marker)
    if scene.closure_count and not run.following:
        branch.pivot = order_all(scene, 0.0)
        measure_reach(scene, branch)


def measure_reach(scene: cython.pointer[Scene], branch: cython.pointer[FollowedStep]) -> cython.void:
    """Find how far a unit of each drive in a loop moves the coordinates, at least itself; the kinematics are lost."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    gravity: Vec3 = scene.gravity
    scene.gravity = Vec3(0.0, 0.0, 0.0)
    for i in range(scene.freedom_count + scene.closure_count):
        if branch.travel[i] >= 0.0:
            clear_motion(scene)
            for k in range(scene.freedom_count):
                scene.freedoms[k].udot = 1.0 if k == i else 0.0
            for k in range(scene.closure_count):
                scene.closures[k].prescribed_second = 1.0 if scene.freedom_count + k == i else 0.0
            add_prescribed(scene)
            clear_loads(scene)
            solve_response(scene, True)
            shifts: cython.bint = i >= scene.freedom_count or scene.freedoms[i].kind == SHIFT
            drive_motion: cython.double = 1.0 / branch.length if shifts else 1.0
            bends: cython.bint = i >= scene.freedom_count or branch.bends[i] != 0
            branch.travel[i] = find_largest_change(scene, branch, drive_motion, False)
            branch.reach[i] = find_largest_change(scene, branch, drive_motion if bends else 0.0, True)
    scene.gravity = gravity


def is_linear(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.bint:
    """Return whether a row's gap is a sum of coordinates, each times a constant: its J is the same in every pose."""
    i: cython.Py_ssize_t
    for i in range(condition_count(row)):
        kind: cython.int = condition(scene, row, i).kind
        if kind != MESH and kind != TURN:
            return False
    return True


def find_largest_change(
    scene: cython.pointer[Scene], branch: cython.pointer[FollowedStep], largest: cython.double, bending: cython.bint
) -> cython.double:
    """Return the largest change of the coordinates in the response, or `largest`; bending: of those that change J."""
    i: cython.Py_ssize_t
    x: cython.double
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if not freedom.driven and (branch.bends[i] or not bending):
            x = fabs(freedom.udot)
            if freedom.kind == SHIFT:
                x /= branch.length
            if not x <= largest:
                largest = x
    for i in range(scene.body_count):
        if scene.bodies[i].ball and (branch.bends[scene.freedom_count + i] or not bending):
            x = norm(scene.bodies[i].alpha)
            if not x <= largest:
                largest = x
    return largest


def bound_drive_motion(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.double:
    """Bound how far any coordinate that changes J moves within the trial step [rad, of an island's length]."""
    i: cython.Py_ssize_t
    n: cython.Py_ssize_t = scene.freedom_count
    program: Program
    bounds: Bounds
    motion: cython.double = 0.0
    branch: cython.pointer[FollowedStep] = cython.address(run.followed_step)
    if scene.closure_count == 0:
        return 0.0
    set_time_range(scene.programs, run.t, clip_time(run, run.stop))
    for i in range(n + scene.closure_count):
        if branch.reach[i] > 0.0:
            if i < n:
                program = scene.freedoms[i].program
            else:
                program = scene.closures[i - n].program
            bounds = enclose(scene.programs, program).value
            motion += branch.reach[i] * (bounds.high - bounds.low)
    return motion


def drives_bend(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Return whether a drive does more within the trial step than its ends show; extremes are then looked for."""
    i: cython.Py_ssize_t
    for i in range(scene.freedom_count):
        if scene.freedoms[i].driven and drive_bends(scene, run, scene.freedoms[i].program, i):
            return True
    for i in range(scene.closure_count):
        if scene.closures[i].program.count and drive_bends(
            scene, run, scene.closures[i].program, scene.freedom_count + i
        ):
            return True
    return False


def drive_bends(
    scene: cython.pointer[Scene], run: cython.pointer[Run], program: Program, drive: cython.Py_ssize_t
) -> cython.bint:
    """Return whether a drive's acceleration in the middle deviates from that of the quintic through both ends.

    That is 3 (v1 - v0) / 2h - (a0 + a1) / 4. A drive whose rate hardly changes bends nowhere. What it moves follows
    such a quintic between the ends, and deviates by deviation h^2 / 24 per unit: of the sixth derivative an
    acceleration has 3 h^4 / 8, a value h^6 / 64, both divided by 720. That is checked where m does not limit the step.
    """
    travel: cython.double = run.followed_step.travel[drive]
    first: Jet = jet(scene.programs, program, run.t)
    middle: Jet = jet(scene.programs, program, clip_time(run, run.t + 0.5 * run.h))
    last: Jet = jet(scene.programs, program, clip_time(run, run.stop))
    deviation: cython.double = (
        middle.second - 1.5 * (last.rate - first.rate) / run.h + 0.25 * (first.second + last.second)
    )
    rate: cython.double = fabs(first.rate) + fabs(middle.rate) + fabs(last.rate)
    size: cython.double = fabs(first.second) + fabs(middle.second) + fabs(last.second)
    part: cython.double = scene.limits.branch_bend
    if not fabs(deviation) <= part * (size + part * rate / run.h):
        return True
    if not travel > run.followed_step.reach[drive]:
        return False
    rounding: cython.double = scene.limits.rounding * run.h * (rate + run.h * size)
    return not fabs(deviation) * run.h * run.h / 24.0 <= scene.limits.branch_between / travel + rounding


# A step


def allowed_motion(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.double:
    """Return how far coordinates may move in a step; a run that begins late takes other steps."""
    return scene.limits.branch_step * run.followed_step.pivot * (scene.limits.branch_next_start if run.late else 1.0)


def follow_drives(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """Find the state z at the end of the trial step, with its derivative. Returns -1 if the step must be shorter."""
    t: cython.double = clip_time(run, run.stop)
    gap: cython.double
    moved: cython.double
    run.has_interpolant = 0
    if not run.following:
        moved = bound_drive_motion(scene, run)
        if scene.closure_count and not moved <= allowed_motion(scene, run):
            propose_shorter(run, 0.9 * allowed_motion(scene, run) / moved)
            return -1
        if drives_bend(scene, run):
            propose_shorter(run, 0.5)
            return -1
        run.followed_step.moved = moved
    if run.sees_stages:
        begin_step_extremes(scene, run)
    predict_state(scene, run)
    gap = project_state(scene, t, run.z)
    evaluate(scene, t, run.z, run.K[method.stages])
    continue_counters(scene, run, run.z)
    run.evaluations += 1
    if not run.following and not fabs(mechanical_energy(scene)) < INFINITY:
        propose_shorter(run, 0.0)
        return -1
    if run.sees_stages:
        record_stage(scene, run, t)
        record_within_step(scene, method, run)
    if not run.following and scene.closure_count and may_have_left_branch(scene, run, gap):
        propose_shorter(run, 0.5)
        return -1
    return 0


def propose_shorter(run: cython.pointer[Run], part: cython.double) -> cython.void:
    """Propose a fraction of this step, a tenth at least, as the next attempt."""
    run.control.proposed = run.h * (part if part > 0.1 else 0.1)
    run.control.rejected_before = 1


def predict_state(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.void:
    """Predict z from the state, its rates and accelerations at the step's start."""
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
            omega: Vec3 = read_vector(y, u)
            turn: Vec3 = scale_vector(h, add_scaled(omega, 0.5 * h, read_vector(dy, u)))
            q: Quaternion = apply_small_rotation(read_quaternion(y, at), turn)
            write_quaternion(run.z, at, q)


def may_have_left_branch(scene: cython.pointer[Scene], run: cython.pointer[Run], gap: cython.double) -> cython.bint:
    """Return whether z may be another solution than the one that moved there, or the pivot falls too fast to decide."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    x: cython.double
    square: cython.double
    most: cython.double = 2.0 * run.followed_step.moved + scene.limits.closures_lost
    if not gap <= scene.limits.reopened * scene.size:
        return True
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if not freedom.driven and run.followed_step.bends[i]:
            x = fabs(run.z[freedom.q_at] - run.y[freedom.q_at])
            if not x <= most * (run.followed_step.length if freedom.kind == SHIFT else 1.0):
                return True
    for i in range(scene.body_count):
        if scene.bodies[i].ball:
            square = 0.0
            for k in range(scene.bodies[i].attitude_at, scene.bodies[i].attitude_at + 4):
                square += (run.z[k] - run.y[k]) * (run.z[k] - run.y[k])
            if not 2.0 * sqrt(square) <= most:
                return True
    return not order_all(scene, 0.0) >= 0.5 * run.followed_step.pivot


def continue_counters(scene: cython.pointer[Scene], run: cython.pointer[Run], x: cython.p_double) -> cython.void:
    """Find work and counted angles of a state whose kinematics are known, from those at the step's start."""
    i: cython.Py_ssize_t
    angle: cython.double
    half: cython.double = 3.141592653589793
    for i in range(scene.counter_count):
        counter: cython.pointer[Counter] = cython.address(scene.counters[i])
        if counter.track:
            x[counter.state_at] = find_track_place(scene, cython.address(scene.closures[counter.track - 1]))
            continue
        n: Vec3 = counter.axis
        w: Vec3 = read_vector(run.followed_step.marks, 3 * i)
        start_direction: Vec3 = find_perpendicular(n)
        end_direction: Vec3 = body_components(scene, counter.a, world_direction(scene, counter.b, w))
        angle = run.y[counter.state_at] + atan2(
            dot(n, cross(start_direction, end_direction)), dot(start_direction, end_direction)
        )
        while x[counter.state_at] - angle > half:
            angle += 2.0 * half
        while angle - x[counter.state_at] > half:
            angle -= 2.0 * half
        x[counter.state_at] = angle
    if scene.work_at >= 0:
        x[scene.work_at] = run.y[scene.work_at] + (mechanical_energy(scene) - run.followed_step.energy)


def body_components(scene: cython.pointer[Scene], body: cython.int, a: Vec3) -> Vec3:
    """Return a world direction in a body's axes, or the ground's (-1)."""
    if body < 0:
        return a
    return rotate_back(scene.bodies[body].R, a)


def mechanical_energy(scene: cython.pointer[Scene]) -> cython.double:
    """Return the kinetic energy plus the potential energy of gravity (from the world's origin) and of loads [J]."""
    i: cython.Py_ssize_t
    total: cython.double = 0.0
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        omega: Vec3 = rotate_back(body.R, body.omega)
        total += 0.5 * (body.mass * dot(body.v, body.v) + dot(omega, transform(body.inertia, omega)))
        total += dot(body.v, cross(body.omega, body.mc))
        total -= dot(scene.gravity, add_scaled(body.mc, body.mass, body.r))
    for i in range(scene.load_count):
        total += load_potential(scene, cython.address(scene.loads[i]))
    return total


# Within a step


def record_within_step(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.void:
    """Record the loads within the step: a step that no load shortens would show its two ends only."""
    k: cython.int
    part: cython.double
    if scene.watch_count == 0:
        return
    ensure_interpolant(scene, method, run)
    for k in range(1, WATCH_PARTS):
        part = k
        interpolate(scene, method, run, part / WATCH_PARTS, run.stage)
        evaluate_variables(scene, clip_time(run, run.t + part / WATCH_PARTS * run.h), run.stage)
        record_extremes(scene)


def project_sample(scene: cython.pointer[Scene], run: cython.pointer[Run], x: cython.p_double) -> cython.void:
    """Project the state at a requested instant within the step, from its interpolation x."""
    t: cython.double = clip_time(run, run.samples.times[run.samples.next])
    project_state(scene, t, x)
    if scene.counter_count > 0 or scene.work_at >= 0:
        update_kinematics(scene, t, x)
        continue_counters(scene, run, x)
