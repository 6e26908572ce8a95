"""The stepping loop: Runge-Kutta methods of adaptive or given step, and the states at requested instants.

Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I (1993), II.4-II.6; accepting steps: judging.py.
"""

from __future__ import annotations

from math import fabs, pow, sqrt

from heuncli.kernel.attitudes import (
    drop_small_parts,
    enter_chart,
    find_half_turn,
    half_turn_rate,
    leave_chart,
    measure_turns_left,
)
from heuncli.kernel.collocation import collocate, collocate_to
from heuncli.kernel.contact_rounding import clear_accelerations
from heuncli.kernel.contacts import classify_contact_event, find_pushing_rope, find_reopened_contact, start_contacts
from heuncli.kernel.declarations import *
from heuncli.kernel.dense import (
    CONTACT_EVENT,
    EVENT_CHATTER,
    NO_EVENT,
    REPEAT_TO,
    clip_time,
    combine_stages,
    ensure_interpolant,
    interpolate,
    record_course,
    store_chart_slopes,
)
from heuncli.kernel.evaluator import evaluate_program
from heuncli.kernel.events import follow_angles, hold_branches
from heuncli.kernel.following import follow_drives, is_determined, prepare_step, project_sample
from heuncli.kernel.judging import (
    ACCEPTED,
    AGAIN,
    CHATTERING,
    CLOSURES_LOST,
    COLLAPSED,
    HALF_TURN,
    LET_GO,
    MORE,
    NOT_A_NUMBER,
    REACHED,
    ROPE_SLACK,
    STIFF,
    STRUCK,
    TURNED,
    UNSOLVED,
    assess_step,
    growth_factor,
    weighted_norm,
)
from heuncli.kernel.landing import begin_step_extremes, find_events_of_step, is_in_flurry, record_stage
from heuncli.kernel.points import evaluate_variables
from heuncli.kernel.response import (
    evaluate,
    evaluate_projected,
    must_choose_rows,
    project_evaluated_state,
    project_state,
)
from heuncli.kernel.row_choice import choose_rows_again, restore_choice, save_choice
from heuncli.kernel.selection import select_independent_rows
from heuncli.kernel.stages import evaluate_explicit_stages, step_to_instant
from heuncli.kernel.stiffness import estimate_stiffness, is_stability_limited

CODES = {
    "reached": REACHED,
    "more": MORE,
    "collapsed": COLLAPSED,
    "not a number": NOT_A_NUMBER,
    "closures lost": CLOSURES_LOST,
    "rope slack": ROPE_SLACK,
    "chattering": CHATTERING,
    "struck": STRUCK,
    "let go": LET_GO,
    "turned": TURNED,
    "stiff": STIFF,
    "half turn": HALF_TURN,
    "unsolved": UNSOLVED,
}


def begin_piece(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """Begin a piece: find its first derivative and step. ROPE_SLACK if a rope would push, COLLAPSED if a freedom is
    left.
    """
    i: cython.Py_ssize_t
    h: cython.double
    scene.pivot_of_step = 1.0
    if scene.closure_count:
        choose_rows_again(scene, run.t, run.y)
        project_state(scene, run.t, run.y)
    if run.following and scene.held_count:
        hold_branches(scene, run.track.branches[0])
    if not run.following:
        scene.programs.holding = TAKEN
    evaluate(scene, run.t, run.y, run.K[0])
    if not run.following:
        for i in range(scene.watch_count):  # `evaluate` does not evaluate the watched conditions
            evaluate_program(scene.programs, scene.watches[i].program)
    scene.programs.holding = HELD
    run.evaluations += 1
    start_contacts(scene, run.t)
    if run.watching and find_pushing_rope(scene, run):
        return ROPE_SLACK
    clear_accelerations(scene, method, run.K[0], True)
    if run.determined:
        run.control.proposed = run.end - run.t
        if not is_determined(scene):
            return COLLAPSED
        prepare_step(scene, run)
    elif not run.following:
        h = find_first_step(scene, method, run)
        if run.control.proposed <= 0.0 or h < run.control.proposed:
            run.control.proposed = h
    run.fresh = 0
    run.control.grid = run.t
    run.control.on_grid = 0
    run.control.rejected_before = 0
    run.landing.has_cut = run.landing.attempts = run.landing.contact_attempts = run.landing.at_once = 0
    for i in range(run.n):
        run.carry[i] = 0.0
    return REACHED


def find_first_step(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.double:
    """Find a first step from the largest rate and acceleration; set the rate scales."""
    b: cython.int
    u: cython.double
    v: cython.double
    rate: cython.double = 0.0
    acceleration: cython.double = 0.0
    for b in range(run.group_count):
        if b != run.energy_group:
            group: cython.pointer[Group] = cython.address(run.groups[b])
            u = weighted_norm(run, run.y, group.rates, group.end)
            v = weighted_norm(run, run.K[0], group.rates, group.end)
            if u > group.rate:
                group.rate = u
            if u > rate:
                rate = u
            if v > acceleration:
                acceleration = v
    if rate > run.control.rate:
        run.control.rate = rate
    if sqrt(acceleration) > rate:
        rate = sqrt(acceleration)
    v = find_load_rate(scene, run)
    if v > run.control.rate:
        run.control.rate = v
    if rate > 0.0:
        return pow(run.control.tolerance, method.exponent) / rate
    return run.end - run.t


def find_load_rate(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.double:
    """Return a fraction of the rate that the applied loads could cause, for parts that are held at rest [1/s]."""
    i: cython.Py_ssize_t
    u: cython.double
    g: cython.double
    largest: cython.double = norm(scene.gravity) / scene.size
    run.control.energy_scale = 0.0
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        g = body.mass * scene.size
        run.control.energy_scale += g * scene.size
        u = (sum_magnitudes(body.f_applied) + sum_magnitudes(body.M_applied) / scene.size) / g
        if u > largest:
            largest = u
    return scene.limits.held_rate * sqrt(largest)


def sum_magnitudes(a: Vec3) -> cython.double:
    """|x| + |y| + |z|."""
    return fabs(a.x) + fabs(a.y) + fabs(a.z)


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


def set_step_end(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.void:
    """Set where the next step ends; the last of a piece ends with it, and the one before is halved for it.

    Given steps are counted from the start of the piece, or its last event. The ends alone define the steps.
    """
    run.stop = run.t + run.control.proposed
    run.last = run.t + 1.01 * run.control.proposed >= run.end
    if run.following:
        run.stop = run.track.ends[run.track.done]
        run.last = run.stop >= run.end
    elif run.landing.has_cut:
        run.stop = run.landing.cut
        run.last = 0
    elif run.control.step > 0.0:
        run.stop = run.control.grid + (run.control.on_grid + 1) * run.control.step
        run.last = run.stop + scene.limits.given_end * run.control.step >= run.end
        if run.last:
            run.stop = run.end
    elif run.last:
        run.stop = run.end
    elif run.t + 2.0 * run.control.proposed > run.end:
        run.stop = run.t + 0.5 * (run.end - run.t)
    run.h = run.stop - run.t


def find_step_obstacle(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.int:
    """Return why there is no further step: the closures lock, or it is rounding of the time; else REACHED."""
    if run.following or run.last or run.landing.has_cut:
        return REACHED
    if scene.closure_count and scene.pivot < scene.limits.locked and run.h <= scene.limits.locked_step * fabs(run.end):
        return CLOSURES_LOST
    if run.h <= scene.limits.least_step * fabs(run.end) or run.h < 1e-300:
        return CHATTERING if is_in_flurry(scene, run) else COLLAPSED
    return REACHED


def is_near_singular(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Return whether the step before, the last attempt at this one or its start came near a singular pose."""
    if run.following:
        return run.track.settled[run.track.done] > 0.0
    if scene.closure_count == 0:
        return False
    return scene.pivot_of_step < scene.limits.near_singular or run.control.pivot_at_start < scene.limits.near_singular


def attempt_step(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """Find the stages of a step and its solution z. Returns what `evaluate` returns at the end; if given, the worst
    stage.
    """
    i: cython.Py_ssize_t
    change: cython.double
    if run.determined:
        return follow_drives(scene, method, run)
    if method.implicit:
        return collocate(scene, method, run)
    run.has_interpolant = 0
    if run.seeing:
        begin_step_extremes(scene, run)
    if method.attitude:
        enter_chart_of_step(scene, method, run)
    worst: cython.int = evaluate_explicit_stages(scene, method, run)
    y: cython.p_double = run.chart.y
    z: cython.p_double = run.chart.z
    combine_stages(method, method.stages, run.chart.K, run.n, z)
    for i in range(run.n):
        change = run.h * z[i] + run.carry[i]
        z[i] = y[i] + change
        run.z_carry[i] = change - (z[i] - y[i])
    if method.attitude:
        leave_chart_of_step(scene, method, run)
    run.evaluations += method.stages
    trouble: cython.int = evaluate(scene, clip_time(run, run.stop), run.z, run.K[method.stages])
    if method.attitude:
        store_chart_slopes(scene, method, run, run.z, method.stages)
    if run.seeing:
        record_stage(scene, run, clip_time(run, run.stop))
    clear_accelerations(scene, method, run.K[method.stages], method.stages == 1)
    if run.stiffness.after:
        estimate_stiffness(method, run)
    return worst if method.fixed and worst < trouble else trouble


def enter_chart_of_step(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.void:
    """Convert the start of a step, with its derivative, to the chart of attitudes."""
    i: cython.Py_ssize_t
    for i in range(run.n):
        run.chart.y[i] = run.y[i]
    enter_chart(scene, method.attitude, run.y, run.y, run.chart.y)
    store_chart_slopes(scene, method, run, run.y, 0)


def leave_chart_of_step(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.void:
    """Convert the end of a step back to a state, and drop the compensation terms of the chart's numbers."""
    i: cython.Py_ssize_t
    for i in range(run.n):
        run.z[i] = run.chart.z[i]
    leave_chart(scene, method.attitude, run.y, run.z)
    drop_small_parts(scene, method.attitude, run.z_carry)


def leaves_chart(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.bint:
    """Return whether an attitude is at the end of its chart; else limit the step to a fraction of the way there."""
    run.chart.half_turn = find_half_turn(scene, method.attitude, run.y)
    measure_turns_left(scene, method.attitude, run.y, run.chart.ways)
    run.chart.nearing = half_turn_rate(scene, run.y, run.chart.ways)
    if 0.9 * scene.limits.chart_turn < run.chart.nearing * run.control.proposed:
        run.control.proposed = 0.9 * scene.limits.chart_turn / run.chart.nearing
    return run.chart.half_turn > 0


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
    seeing: cython.bint = run.seeing
    run.seeing = 0
    run.has_interpolant = 1  # the scene is no longer evaluated at the step's end
    while run.samples.next < run.samples.count and run.samples.times[run.samples.next] < run.stop:
        if method.implicit:
            collocate_to(scene, method, run, run.samples.times[run.samples.next], run.samples.states[run.samples.next])
        else:
            step_to_instant(
                scene, method, run, run.samples.times[run.samples.next], run.samples.states[run.samples.next]
            )
        run.samples.next += 1
    run.seeing = seeing


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
    run.control.dodges = 0
    sample_step(scene, method, run)
    if run.track.coursed:
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
    run.landing.at_once = 0
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
    if code == REACHED and method.implicit and not run.newton.solved:
        code = UNSOLVED  # for a requested instant within the step
    if code == REACHED:
        sample_reached(run)
        if not run.following:
            run.track.pivots[run.track.done] = pivot
            record_step(scene, run)
        run.track.done += 1
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
    h: cython.double = run.h * growth_factor(method, run)
    if not (run.last or run.landing.has_cut) or run.control.proposed < h:
        run.control.proposed = h


def record_step(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.void:
    """Record the step's end, whether its stages were projected, and what the next one starts from."""
    run.track.ends[run.track.done] = run.t
    run.track.settled[run.track.done] = run.near
    write_record(scene, run, run.track.passed[run.track.done])


def switch_branches(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Record the held branches and take those of the next step. Returns whether they change."""
    i: cython.Py_ssize_t
    changed: cython.bint = run.landing.turns
    if run.following:
        changed = False
        if run.track.done + 1 < run.track.most:
            for i in range(scene.held_count):
                changed = changed or run.track.branches[run.track.done + 1][i] != scene.programs.held[i]
            hold_branches(scene, run.track.branches[run.track.done + 1])
        return changed
    for i in range(scene.held_count):
        run.track.branches[run.track.done][i] = scene.programs.held[i]
    run.track.turned[run.track.done] = run.landing.turns
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
    if not gap <= scene.limits.lost * scene.size or has_rate_jump(scene, run):
        return CLOSURES_LOST
    evaluate_projected(scene, t, run.y, run.K[0])
    start_contacts(scene, t)
    clear_accelerations(scene, method, run.K[0], True)
    run.evaluations += 2
    return REACHED


def is_evaluated_at_end(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Return whether the scene was evaluated last at the end of the step."""
    return not (run.has_interpolant or run.seeing or run.determined or scene.held_count or run.newton.elsewhere)


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


def find_contact_code(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.int:
    """Return what the contact found does: STRUCK, LET_GO, or ROPE_SLACK if a rope without restitution would push."""
    event: cython.int = classify_contact_event(scene, run)
    if event == 3:
        return ROPE_SLACK
    return STRUCK if event == 1 else LET_GO


def try_step(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """Attempt a step once: REACHED, also if another length is to be tried; or why the loop ends."""
    code: cython.int
    event: cython.int = NO_EVENT
    if method.attitude and not run.following and leaves_chart(scene, method, run):
        return HALF_TURN
    set_step_end(scene, run)
    code = find_step_obstacle(scene, run)
    if code != REACHED:
        return code
    run.near = is_near_singular(scene, run)
    scene.pivot_of_step = 1.0
    trouble: cython.int = attempt_step(scene, method, run)
    code = assess_step(scene, method, run, trouble)
    if code == AGAIN:
        run.landing.has_cut = run.landing.attempts = run.landing.contact_attempts = 0
        return REACHED
    if code != ACCEPTED:
        return code
    if run.seeing:
        event = find_events_of_step(scene, method, run)
        if event == EVENT_CHATTER:
            return CHATTERING
        if event == REPEAT_TO:
            run.landing.has_cut = run.landing.cut > run.t
            return TURNED if run.halting and not run.landing.has_cut else REACHED  # branches changed at the start
        if event == CONTACT_EVENT and run.stop <= run.t:
            return find_contact_code(scene, run)
    code = accept_step(scene, method, run)
    return find_exit_code(scene, run, event) if code == REACHED else code


def find_exit_code(scene: cython.pointer[Scene], run: cython.pointer[Run], event: cython.int) -> cython.int:
    """Return why the loop ends after an accepted step; else REACHED."""
    if event == CONTACT_EVENT:
        return find_contact_code(scene, run)
    if run.watching and find_reopened_contact(scene, run):
        return LET_GO
    if run.halting and run.landing.turns:
        return TURNED
    if run.stiffness.after and is_stability_limited(run):
        return STIFF
    return REACHED


def run_steps(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """Take up to `most` accepted steps towards the end of the piece: REACHED, MORE to do, or why it stopped.

    Following, `ends` and `settled` give the steps. Halting, TURNED where a piece begins or branches change.
    """
    code: cython.int
    run.track.done = 0
    run.control.dodges = 0
    run.watching = run.watching and not run.following and scene.contact_count > 0
    run.seeing = not run.following and (scene.watch_count > 0 or run.watching)
    if run.fresh:
        code = begin_piece(scene, method, run)
        if code != REACHED:
            return code
        if run.halting:
            return TURNED
    sample_reached(run)
    run.control.pivot_at_start = scene.pivot
    attempts: cython.int = 0
    while run.t < run.end:
        attempts += 1
        if (
            run.track.done >= run.track.most or attempts > 100 * run.track.most
        ):  # also if no step is accepted, so that the caller can check the time
            return MORE
        code = try_step(scene, method, run)
        if code != REACHED:
            return code
    return REACHED
