"""The end of a step: projected onto the closures, accepted, recorded, and sampled at the requested instants within it;
the length of the next step is proposed.
"""

from __future__ import annotations

from math import sqrt

from heuncli.kernel.attitudes import drop_small_parts, leave_chart
from heuncli.kernel.collocation import collocate_to
from heuncli.kernel.contact_rounding import clear_accelerations
from heuncli.kernel.contacts import start_contacts
from heuncli.kernel.declarations import *
from heuncli.kernel.dense import clip_time, ensure_interpolant, interpolate, record_course
from heuncli.kernel.events import follow_angles, hold_branches
from heuncli.kernel.following import prepare_step, project_sample
from heuncli.kernel.judging import find_growth_factor, update_imposed_rate, weighted_norm
from heuncli.kernel.points import evaluate_variables
from heuncli.kernel.response import (
    evaluate,
    evaluate_projected,
    must_choose_rows,
    project_evaluated_state,
    project_state,
)
from heuncli.kernel.selection import restore_choice, save_choice, select_independent_rows
from heuncli.kernel.stages import step_to_instant


def write_record(scene: cython.pointer[Scene], run: cython.pointer[Run], buffer: cython.p_double) -> cython.void:
    """Write what the next step starts from: the state, its compensation terms, the chosen rows; all else follows."""
    i: cython.Py_ssize_t
    for i in range(run.n):
        buffer[i] = run.y[i]
        buffer[run.n + i] = run.carry[i]
    save_choice(scene, buffer, 2 * run.n)


def restore_record(scene: cython.pointer[Scene], run: cython.pointer[Run], record: cython.p_double) -> cython.void:
    """Restore the state from a record."""
    i: cython.Py_ssize_t
    for i in range(run.n):
        run.y[i] = record[i]
        run.carry[i] = record[run.n + i]
    restore_choice(scene, record, 2 * run.n)


def leave_chart_of_step(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.void:
    """Convert the end of a step back to a state, and drop the compensation terms of the chart's numbers."""
    i: cython.Py_ssize_t
    for i in range(run.n):
        run.z[i] = run.chart.z[i]
    leave_chart(scene, method.attitude, run.y, run.z)
    drop_small_parts(scene, method.attitude, run.z_carry)


def sample_step(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """Find the states at the requested instants within the step y -> z; they have no effect on the steps."""
    x: cython.double
    pivot: cython.double = scene.pivot_of_step
    if run.samples.next >= run.samples.count or run.samples.times[run.samples.next] >= run.stop:
        return
    if method.by_step:
        sample_by_steps(scene, method, run)
        scene.pivot_of_step = pivot
        return
    ensure_interpolant(scene, method, run)
    scene.pivot_of_step = pivot
    while run.samples.next < run.samples.count and run.samples.times[run.samples.next] < run.stop:
        x = (run.samples.times[run.samples.next] - run.t) / run.h
        interpolate(scene, method, run, x, run.samples.states[run.samples.next])
        if run.determined:
            project_sample(scene, run, run.samples.states[run.samples.next])
        run.samples.next += 1


def sample_by_steps(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.void:
    """Find the requested instants within a step of a method without dense output: by a step of its own to each."""
    seeing: cython.bint = run.sees_stages
    run.sees_stages = 0
    run.has_interpolant = 1  # the scene is no longer evaluated at the step's end
    while run.samples.next < run.samples.count and run.samples.times[run.samples.next] < run.stop:
        if method.implicit:
            collocate_to(scene, method, run, run.samples.times[run.samples.next], run.samples.states[run.samples.next])
        else:
            step_to_instant(
                scene, method, run, run.samples.times[run.samples.next], run.samples.states[run.samples.next]
            )
        run.samples.next += 1
    run.sees_stages = seeing


def sample_reached(run: cython.pointer[Run]) -> cython.void:
    """Copy the state, which is on the closures, to the requested instants up to the one reached."""
    i: cython.Py_ssize_t
    while run.samples.next < run.samples.count and run.samples.times[run.samples.next] <= run.t:
        for i in range(run.n):
            run.samples.states[run.samples.next][i] = run.y[i]
        run.samples.next += 1


def accept_step(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """Accept the step: samples, new state, derivative, next length. CLOSURES_LOST, UNSOLVED or REACHED."""
    i: cython.Py_ssize_t
    code: cython.int = REACHED
    run.control.retries = 0
    if not (run.following or run.determined or method.fixed):
        update_imposed_rate(scene, run)
    sample_step(scene, method, run)
    if run.track.has_courses:
        record_course(method, run)
    for i in range(run.n):
        run.y[i] = run.z[i]
        run.carry[i] = run.z_carry[i]
    if not run.following:
        update_rates(run)
    run.t = run.stop
    run.control.on_grid += 1
    if run.landing.has_cut:
        run.control.grid = run.t
        run.control.on_grid = 0
    propose_next_length(method, run)
    run.control.rejected_before = 0
    run.landing.has_cut = run.landing.attempts = run.landing.contact_attempts = 0
    run.landing.turns_at_instant = 0
    run.steps += 1
    pivot: cython.double = scene.pivot_of_step
    turns: cython.bint = scene.held_count > 0 and switch_branches(scene, run)
    if scene.closure_count:
        code = project_step_end(scene, method, run)
        run.control.pivot_at_start = scene.pivot
    elif turns:
        evaluate(scene, clip_time(run, run.t), run.y, run.K[0])
        run.evaluations += 1
    else:
        for i in range(run.n):
            run.K[0][i] = run.K[method.stages][i]
    if code == REACHED and run.determined:
        prepare_step(scene, run)
    if code == REACHED and method.implicit and not run.newton.has_stages:
        code = UNSOLVED  # for a requested instant within the step
    if code == REACHED:
        sample_reached(run)
        if not run.following:
            run.track.pivots[run.track.step_count] = pivot
            record_step(scene, run)
        run.track.step_count += 1
    return code


def update_rates(run: cython.pointer[Run]) -> cython.void:
    """Update the largest rates so far, of each group and of the scene; the work of drives is no motion."""
    b: cython.Py_ssize_t
    for b in range(run.group_count):
        run.groups[b].rate = run.groups[b].trial
        if run.groups[b].rate > run.control.rate and b != run.energy_group:
            run.control.rate = run.groups[b].rate


def propose_next_length(method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """Set the next length from the error; a step cut short by an event does not prevent a longer one."""
    h: cython.double = run.h * find_growth_factor(method, run)
    if not (run.ends_piece or run.landing.has_cut) or run.control.proposed < h:
        run.control.proposed = h


def record_step(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.void:
    """Record the step's end, whether its stages were projected, and what the next one starts from."""
    run.track.ends[run.track.step_count] = run.t
    run.track.settled[run.track.step_count] = run.projects_stages
    write_record(scene, run, run.track.passed[run.track.step_count])


def switch_branches(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Record the held branches and take those of the next step. Returns whether they change."""
    i: cython.Py_ssize_t
    changed: cython.bint = run.landing.turns
    if run.following:
        changed = False
        if run.track.step_count + 1 < run.track.capacity:
            for i in range(scene.held_count):
                changed = changed or run.track.branches[run.track.step_count + 1][i] != scene.programs.branches[i]
            hold_branches(scene, run.track.branches[run.track.step_count + 1])
        return changed
    for i in range(scene.held_count):
        run.track.branches[run.track.step_count][i] = scene.programs.branches[i]
    run.track.turned[run.track.step_count] = run.landing.turns
    if run.landing.turns:
        hold_branches(scene, run.course.turned)
    elif scene.angle_count:
        evaluate_variables(scene, clip_time(run, run.t), run.y)
        follow_angles(scene, cython.address(run.course))
    return changed


def project_step_end(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.int:
    """Project the end of a step onto the closures, and find its derivative; CLOSURES_LOST if that fails."""
    t: cython.double = clip_time(run, run.t)
    gap: cython.double = (
        project_evaluated_state(scene, t, run.y) if is_evaluated_at_end(scene, run) else project_state(scene, t, run.y)
    )
    if must_choose_rows(scene, gap):
        select_independent_rows(scene, t, run.y, False)
        gap = project_state(scene, t, run.y)
    if gap > run.gap or gap != gap:
        run.gap = gap
    if not gap <= scene.limits.closures_lost * scene.size or has_rate_jump(scene, run):
        return CLOSURES_LOST
    evaluate_projected(scene, t, run.y, run.K[0])
    start_contacts(scene, t)
    clear_accelerations(scene, method, run.K[0], True)
    run.evaluations += 2
    return REACHED


def is_evaluated_at_end(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Return whether the scene was evaluated last at the end of the step."""
    return not (
        run.has_interpolant
        or run.sees_stages
        or run.determined
        or scene.held_count
        or run.newton.is_evaluated_elsewhere
    )


def has_rate_jump(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Return whether the closures changed the rates by more than the error explains: an impact or another branch."""
    b: cython.int
    i: cython.Py_ssize_t
    change: cython.double
    explained: cython.double = scene.limits.jump
    if run.control.step > 0.0:
        # the rates may be wrong by as much as a step turns the scene: Euler's method by half of it
        limit: cython.double = scene.limits.jump_of_given
        explained += run.h * run.control.rate if run.h * run.control.rate < limit else limit
    elif scene.pivot > 0.0:
        explained += scene.limits.jump_of_error * run.control.tolerance / sqrt(scene.pivot)
    if run.following or run.determined:
        return False
    for b in range(run.group_count):
        group: cython.pointer[Group] = cython.address(run.groups[b])
        for i in range(group.rates, group.end):
            run.stage[i] = run.y[i] - run.z[i]
        change = weighted_norm(run, run.stage, group.rates, group.end)
        if change > explained * run.control.rate:
            return True
    return False
