"""The stepping loop: Runge-Kutta methods of adaptive or given step, and the states at requested instants.

Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I (1993), II.4-II.6; accepting steps: judging.py.
"""

from __future__ import annotations

from math import fabs, pow, sqrt

from heuncli.kernel.attitudes import enter_chart, find_half_turn, half_turn_rate, measure_turns_left
from heuncli.kernel.collocation import collocate
from heuncli.kernel.contact_rounding import clear_accelerations
from heuncli.kernel.contacts import find_contact_code, find_pushing_rope, start_contacts
from heuncli.kernel.declarations import *
from heuncli.kernel.dense import clip_time, combine_stages, store_chart_slopes
from heuncli.kernel.evaluator import evaluate_program
from heuncli.kernel.events import hold_branches
from heuncli.kernel.following import follow_drives, is_determined, prepare_step
from heuncli.kernel.judging import SAFETY, assess_step, sum_magnitudes, update_imposed_rate, weighted_norm
from heuncli.kernel.landing import (
    begin_step_extremes,
    count_flurry_event,
    find_events_of_step,
    is_in_flurry,
    record_stage,
)
from heuncli.kernel.paths import hold_lift_pieces
from heuncli.kernel.response import evaluate, project_state
from heuncli.kernel.selection import choose_rows_again
from heuncli.kernel.stages import estimate_stiffness, evaluate_explicit_stages, is_stability_limited
from heuncli.kernel.step_ends import accept_step, leave_chart_of_step, sample_reached

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
    if run.following and scene.held_count:
        hold_branches(scene, run.track.branches[0])
    if not run.following:
        scene.programs.holding = FREE  # what was held belongs to another piece
    if scene.closure_count:
        choose_rows_again(scene, run.t, run.y)
        project_state(scene, run.t, run.y)
    if not run.following:
        scene.programs.holding = TAKEN
    evaluate(scene, run.t, run.y, run.K[0])
    if not run.following:
        for i in range(scene.watch_count):  # `evaluate` does not evaluate the watched conditions
            evaluate_program(scene.programs, scene.watches[i].program)
        hold_lift_pieces(scene)
    scene.programs.holding = HELD
    run.evaluations += 1
    start_contacts(scene, run.t)
    if run.watches_contacts and find_pushing_rope(scene, run):
        return ROPE_SLACK
    clear_accelerations(scene, method, run.K[0], True)
    measure_inertia(scene, run)
    if run.determined:
        run.control.proposed = run.end - run.t
        if not is_determined(scene):
            return COLLAPSED
        prepare_step(scene, run)
    elif not run.following:
        h = find_first_step(scene, method, run)
        if run.control.proposed <= 0.0 or h < run.control.proposed:
            run.control.proposed = h
    update_imposed_rate(scene, run)
    run.begins_piece = 0
    run.control.grid = run.t
    run.control.on_grid = 0
    run.control.rejected_before = 0
    run.landing.has_cut = run.landing.attempts = run.landing.contact_attempts = run.landing.turns_at_instant = 0
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


def measure_inertia(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.void:
    """Set sum m size^2, and the least m size of the bodies that have mass."""
    i: cython.Py_ssize_t
    g: cython.double
    run.control.energy_scale = run.control.least_mass_size = 0.0
    for i in range(scene.body_count):
        g = scene.bodies[i].mass * scene.size
        if g > 0.0 and (run.control.least_mass_size == 0.0 or g < run.control.least_mass_size):
            run.control.least_mass_size = g
        run.control.energy_scale += g * scene.size


def find_load_rate(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.double:
    """Return a fraction of the rate that the applied loads could cause, for parts that are held at rest [1/s].

    Loads on a body without mass move others: they are taken to act on the lightest.
    """
    i: cython.Py_ssize_t
    u: cython.double
    g: cython.double
    largest: cython.double = norm(scene.gravity) / scene.size
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        g = body.mass * scene.size
        if g == 0.0:
            g = run.control.least_mass_size
        u = (sum_magnitudes(body.f_applied) + sum_magnitudes(body.M_applied) / scene.size) / g
        if u > largest:
            largest = u
    return scene.limits.held_rate * sqrt(largest)


def set_step_end(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.void:
    """Set where the next step ends; the last of a piece ends with it, and the one before is halved for it.

    Given steps are counted from the start of the piece, or its last event. The ends alone define the steps.
    """
    run.stop = run.t + run.control.proposed
    run.ends_piece = run.t + 1.01 * run.control.proposed >= run.end
    if run.following:
        run.stop = run.track.ends[run.track.step_count]
        run.ends_piece = run.stop >= run.end
    elif run.landing.has_cut:
        run.stop = run.landing.cut
        run.ends_piece = 0
    elif run.control.step > 0.0:
        run.stop = run.control.grid + (run.control.on_grid + 1) * run.control.step
        run.ends_piece = run.stop + scene.limits.given_end * run.control.step >= run.end
        if run.ends_piece:
            run.stop = run.end
    elif run.ends_piece:
        run.stop = run.end
    elif run.t + 2.0 * run.control.proposed > run.end:
        run.stop = run.t + 0.5 * (run.end - run.t)
    run.h = run.stop - run.t


def find_step_obstacle(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.int:
    """Return why there is no further step: the closures lock, or it is rounding of the time; else REACHED."""
    if run.following or run.ends_piece or run.landing.has_cut:
        return REACHED
    if scene.closure_count and scene.pivot < scene.limits.locked and run.h <= scene.limits.locked_step * fabs(run.end):
        return CLOSURES_LOST
    if run.h <= scene.limits.least_step * fabs(run.end) or run.h < 1e-300:
        return CHATTERING if is_in_flurry(scene, run) else COLLAPSED
    return REACHED


def is_near_singular(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Return whether the step before, the last attempt at this one or its start came near a singular pose."""
    if run.following:
        return run.track.settled[run.track.step_count] > 0.0
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
    if run.sees_stages:
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
    if run.sees_stages:
        record_stage(scene, run, clip_time(run, run.stop))
    clear_accelerations(scene, method, run.K[method.stages], method.stages == 1)
    if run.stiffness.short_limit:
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


def leaves_chart(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.bint:
    """Return whether an attitude is at the end of its chart; else limit the step to a fraction of the way there."""
    run.chart.half_turn = find_half_turn(scene, method.attitude, run.y)
    measure_turns_left(scene, method.attitude, run.y, run.chart.angles_left)
    run.chart.approach_rate = half_turn_rate(scene, run.y, run.chart.angles_left)
    if SAFETY * scene.limits.chart_turn < run.chart.approach_rate * run.control.proposed:
        run.control.proposed = SAFETY * scene.limits.chart_turn / run.chart.approach_rate
    return run.chart.half_turn > 0


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
    run.projects_stages = is_near_singular(scene, run)
    scene.pivot_of_step = 1.0
    trouble: cython.int = attempt_step(scene, method, run)
    code = assess_step(scene, method, run, trouble)
    if code == AGAIN:
        run.landing.has_cut = run.landing.attempts = run.landing.contact_attempts = 0
        return REACHED
    if code != ACCEPTED:
        return code
    if run.sees_stages:
        event = find_events_of_step(scene, method, run)
        if event == EVENT_CHATTER:
            return CHATTERING
        if event == REPEAT_TO:
            run.landing.has_cut = run.landing.cut > run.t
            return (
                TURNED if run.stops_at_turns and not run.landing.has_cut else REACHED
            )  # branches changed at the start
        if event == CONTACT_EVENT and run.stop <= run.t:
            return find_contact_code(scene, run)
        if run.landing.turns and count_flurry_event(scene, run, run.stop):
            return CHATTERING
    code = accept_step(scene, method, run)
    return find_exit_code(scene, run, event) if code == REACHED else code


def find_exit_code(scene: cython.pointer[Scene], run: cython.pointer[Run], event: cython.int) -> cython.int:
    """Return why the loop ends after an accepted step; else REACHED."""
    if event == CONTACT_EVENT:
        return find_contact_code(scene, run)
    if run.stops_at_turns and run.landing.turns:
        return TURNED
    if run.stiffness.short_limit and is_stability_limited(run):
        return STIFF
    return REACHED


def run_steps(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """Take up to `most` accepted steps towards the end of the piece: REACHED, MORE to do, or why it stopped.

    Following, `ends` and `settled` give the steps. Halting, TURNED where a piece begins or branches change.
    """
    code: cython.int
    run.track.step_count = 0
    run.control.retries = 0
    run.watches_contacts = run.watches_contacts and not run.following and scene.contact_count > 0
    run.sees_stages = not run.following and (scene.watch_count > 0 or run.watches_contacts)
    if run.begins_piece:
        code = begin_piece(scene, method, run)
        if code != REACHED:
            return code
        if run.stops_at_turns:
            return TURNED
    sample_reached(run)
    run.control.pivot_at_start = scene.pivot
    attempts: cython.int = 0
    while run.t < run.end:
        attempts += 1
        if (
            run.track.step_count >= run.track.capacity or attempts > 100 * run.track.capacity
        ):  # also if no step is accepted, so that the caller can check the time
            return MORE
        code = try_step(scene, method, run)
        if code != REACHED:
            return code
    return REACHED
