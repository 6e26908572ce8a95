"""The stepping loop: Runge-Kutta methods of adaptive or of given step, and the states at asked instants.

A method is data (integration/methods); a step that was tried is judged in judging.py. Hairer, Norsett, Wanner, Solving
Ordinary Differential Equations I (1993), II.4-II.6.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import fabs, pow, sqrt

    from heuncli.kernel.algebra import Vec3, norm
    from heuncli.kernel.attitudes import at_half_turn, drop_small_parts, enter_chart, leave_chart, measure_ways, nearing
    from heuncli.kernel.chosen import choose_afresh, put_chosen, take_chosen
    from heuncli.kernel.collocation import collocate, collocate_to
    from heuncli.kernel.contacts import opened_by_others, pushed_at_once, start_contacts, turned_over
    from heuncli.kernel.dense import (
        AGAIN_TO,
        CHATTERS,
        STANDS,
        TURNS_OVER,
        clipped,
        combine,
        enter_slopes,
        interpolate,
        need_interpolant,
        put_course,
    )
    from heuncli.kernel.evaluator import value
    from heuncli.kernel.events import follow_angles, take_branches
    from heuncli.kernel.following import find_between, follow, is_determined, stand_here
    from heuncli.kernel.held import clear_accelerations
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
        growth,
        judge,
        norm_of,
    )
    from heuncli.kernel.landing import begin_to_see, find_events_of_step, in_flurry, see_stage
    from heuncli.kernel.points import look_at
    from heuncli.kernel.programs import HELD, TAKEN
    from heuncli.kernel.response import evaluate, evaluate_settled, must_choose_anew, settle, settle_evaluated
    from heuncli.kernel.scene import Body, Group, Scene
    from heuncli.kernel.selection import select_independent_rows
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.stages import step_to, take_stages
    from heuncli.kernel.stepping import Method, Run
    from heuncli.kernel.stiffness import estimate_swiftness, is_held_short

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
    """The derivative at the start of a piece and a first step from it; ROPE_SLACK where a rope would push at once.

    COLLAPSED where a motion that should be determined is not.
    """
    i: cython.Py_ssize_t
    h: cython.double
    scene.pivot_of_step = 1.0
    if scene.closure_count:
        choose_afresh(scene, run.t, run.y)
        settle(scene, run.t, run.y)
    if run.following and scene.held_count:
        take_branches(scene, run.track.branches[0])
    if not run.following:
        scene.programs.holding = TAKEN
    evaluate(scene, run.t, run.y, run.K[0])
    if not run.following:
        for i in range(scene.watch_count):  # conditions are no part of what was evaluated
            value(scene.programs, scene.watches[i].program)
    scene.programs.holding = HELD
    run.evaluations += 1
    start_contacts(scene, run.t)
    if run.watching and pushed_at_once(scene, run):
        return ROPE_SLACK
    clear_accelerations(scene, method, run.K[0], True)
    if run.determined:
        run.control.proposed = run.end - run.t
        if not is_determined(scene):
            return COLLAPSED
        stand_here(scene, run)
    elif not run.following:
        h = first_step(scene, method, run)
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


def first_step(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.double:
    """A first step from the largest rate and acceleration; sets the rate scales."""
    b: cython.int
    u: cython.double
    v: cython.double
    rate: cython.double = 0.0
    acceleration: cython.double = 0.0
    for b in range(run.group_count):
        if b != run.energy_group:
            group: cython.pointer[Group] = cython.address(run.groups[b])
            u = norm_of(run, run.y, group.rates, group.end)
            v = norm_of(run, run.K[0], group.rates, group.end)
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
    v = load_rate(scene, run)
    if v > run.control.rate:
        run.control.rate = v
    if rate > 0.0:
        return pow(run.control.tolerance, method.exponent) / rate
    return run.end - run.t


def load_rate(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.double:
    """A part of the rate that the applied loads could cause: what is held at rest has no rate of its own [1/s]."""
    i: cython.Py_ssize_t
    u: cython.double
    g: cython.double
    largest: cython.double = norm(scene.gravity) / scene.size
    run.control.energy_scale = 0.0
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        g = body.mass * scene.size
        run.control.energy_scale += g * scene.size
        u = (manhattan(body.f_applied) + manhattan(body.M_applied) / scene.size) / g
        if u > largest:
            largest = u
    return scene.limits.held_rate * sqrt(largest)


def manhattan(a: Vec3) -> cython.double:
    """|x| + |y| + |z|."""
    return fabs(a.x) + fabs(a.y) + fabs(a.z)


def put_record(scene: cython.pointer[Scene], run: cython.pointer[Run], out: cython.p_double) -> cython.void:
    """What the next step starts from: the state, the small parts that its digits do not hold, the chosen rows.

    All else follows: the derivative at the start is evaluated anew, and a step's length is the way to its end.
    """
    i: cython.Py_ssize_t
    for i in range(run.n):
        out[i] = run.y[i]
        out[run.n + i] = run.carry[i]
    put_chosen(scene, out, 2 * run.n)


def take_record(scene: cython.pointer[Scene], run: cython.pointer[Run], record: cython.p_double) -> cython.void:
    """Stand where a record was made."""
    i: cython.Py_ssize_t
    for i in range(run.n):
        run.y[i] = record[i]
        run.carry[i] = record[run.n + i]
    take_chosen(scene, record, 2 * run.n)


def propose(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.void:
    """Where the next step ends; the last of a piece ends it, the one before is halved with it.

    Given steps are counted from where the piece, or the last event in it, began: the last one is shorter.

    Its length is the way to that end, rounded as the end is: so the ends alone tell the steps.
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


def blocked(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.int:
    """Why there is no further step: the closures lock while rates grow, or the step is rounding of the time.

    One that lands on an event may be as short, and is done again as it is.
    """
    if run.following or run.last or run.landing.has_cut:
        return REACHED
    if scene.closure_count and scene.pivot < scene.limits.locked and run.h <= scene.limits.locked_step * fabs(run.end):
        return CLOSURES_LOST
    if run.h <= scene.limits.least_step * fabs(run.end) or run.h < 1e-300:
        return CHATTERING if in_flurry(scene, run) else COLLAPSED
    return REACHED


def near_singular(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Whether the step before, the last attempt at this one or its start came near to a singular pose."""
    if run.following:
        return run.track.settled[run.track.done] > 0.0
    if scene.closure_count == 0:
        return False
    return scene.pivot_of_step < scene.limits.near_singular or run.control.pivot_at_start < scene.limits.near_singular


def attempt(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """The stages of a step and its solution z, with its small parts beside it; what `evaluate` says there.

    Of a given step also what it says of the worst stage: no estimate of an error tells of it.
    """
    i: cython.Py_ssize_t
    change: cython.double
    if run.determined:
        return follow(scene, method, run)
    if method.implicit:
        return collocate(scene, method, run)
    run.has_interpolant = 0
    if run.seeing:
        begin_to_see(scene, run)
    if method.attitude:
        enter_chart_of_step(scene, method, run)
    worst: cython.int = take_stages(scene, method, run)
    y: cython.p_double = run.chart.y
    z: cython.p_double = run.chart.z
    combine(method, method.stages, run.chart.K, run.n, z)
    for i in range(run.n):
        change = run.h * z[i] + run.carry[i]
        z[i] = y[i] + change
        run.z_carry[i] = change - (z[i] - y[i])
    if method.attitude:
        leave_chart_of_step(scene, method, run)
    run.evaluations += method.stages
    trouble: cython.int = evaluate(scene, clipped(run, run.stop), run.z, run.K[method.stages])
    if method.attitude:
        enter_slopes(scene, method, run, run.z, method.stages)
    if run.seeing:
        see_stage(scene, run, clipped(run, run.stop))
    clear_accelerations(scene, method, run.K[method.stages], method.stages == 1)
    if run.stiffness.after:
        estimate_swiftness(method, run)
    return worst if method.fixed and worst < trouble else trouble


def enter_chart_of_step(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.void:
    """The start of a step, with its derivative, in the chart of attitudes."""
    i: cython.Py_ssize_t
    for i in range(run.n):
        run.chart.y[i] = run.y[i]
    enter_chart(scene, method.attitude, run.y, run.y, run.chart.y)
    enter_slopes(scene, method, run, run.y, 0)


def leave_chart_of_step(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.void:
    """The end of a step made a state again; small parts of a chart's numbers are none of the state's."""
    i: cython.Py_ssize_t
    for i in range(run.n):
        run.z[i] = run.chart.z[i]
    leave_chart(scene, method.attitude, run.y, run.z)
    drop_small_parts(scene, method.attitude, run.z_carry)


def leaves_chart(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.bint:
    """Whether an attitude is at the end of its chart; else the step is held to a part of the way there.

    So no step jumps over a half turn, however well its ends may fit.
    """
    run.chart.half_turn = at_half_turn(scene, method.attitude, run.y)
    measure_ways(scene, method.attitude, run.y, run.chart.ways)
    run.chart.nearing = nearing(scene, run.y, run.chart.ways)
    if 0.9 * scene.limits.chart_turn < run.chart.nearing * run.control.proposed:
        run.control.proposed = 0.9 * scene.limits.chart_turn / run.chart.nearing
    return run.chart.half_turn > 0


def sample(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """The asked instants within the step y -> z, before its end; which are asked changes nothing of the steps."""
    x: cython.double
    pivot: cython.double = scene.pivot_of_step
    if run.samples.next >= run.samples.count or run.samples.times[run.samples.next] >= run.stop:
        return
    if method.by_step:
        sample_by_steps(scene, method, run)
        scene.pivot_of_step = pivot
        return
    need_interpolant(scene, method, run)
    scene.pivot_of_step = pivot
    while run.samples.next < run.samples.count and run.samples.times[run.samples.next] < run.stop:
        x = (run.samples.times[run.samples.next] - run.t) / run.h
        interpolate(scene, method, run, x, run.samples.states[run.samples.next])
        if run.determined:
            find_between(scene, run, run.samples.states[run.samples.next])
        run.samples.next += 1


def sample_by_steps(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.void:
    """The asked instants within a step of a method without dense output: a step of its own to each."""
    seeing: cython.bint = run.seeing
    run.seeing = 0
    run.has_interpolant = 1  # the scene does not stand at the step's end any more
    while run.samples.next < run.samples.count and run.samples.times[run.samples.next] < run.stop:
        if method.implicit:
            collocate_to(scene, method, run, run.samples.times[run.samples.next], run.samples.states[run.samples.next])
        else:
            step_to(scene, method, run, run.samples.times[run.samples.next], run.samples.states[run.samples.next])
        run.samples.next += 1
    run.seeing = seeing


def sample_reached(run: cython.pointer[Run]) -> cython.void:
    """The asked instants up to the one reached: its state, on the closures."""
    i: cython.Py_ssize_t
    while run.samples.next < run.samples.count and run.samples.times[run.samples.next] <= run.t:
        for i in range(run.n):
            run.samples.states[run.samples.next][i] = run.y[i]
        run.samples.next += 1


def accept(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """The step stands: samples, the new state with its derivative, the next length; CLOSURES_LOST, or REACHED."""
    i: cython.Py_ssize_t
    code: cython.int = REACHED
    run.control.dodges = 0
    sample(scene, method, run)
    if run.track.coursed:
        put_course(method, run)
    for i in range(run.n):
        run.y[i] = run.z[i]
        run.carry[i] = run.z_carry[i]
    if not run.following:
        keep_rates(run)
    run.t = run.stop
    run.control.on_grid += 1
    if run.landing.has_cut:
        run.control.grid = run.t
        run.control.on_grid = 0
    propose_next(method, run)
    run.control.rejected_before = 0
    run.landing.has_cut = run.landing.attempts = run.landing.contact_attempts = 0
    run.landing.at_once = 0
    run.steps += 1
    pivot: cython.double = scene.pivot_of_step
    turns: cython.bint = scene.held_count > 0 and turn_branches(scene, run)
    if scene.closure_count:
        code = land(scene, method, run)
        run.control.pivot_at_start = scene.pivot
    elif turns:
        evaluate(scene, clipped(run, run.t), run.y, run.K[0])
        run.evaluations += 1
    else:
        for i in range(run.n):
            run.K[0][i] = run.K[method.stages][i]
    if code == REACHED and run.determined:
        stand_here(scene, run)
    if code == REACHED and method.implicit and not run.newton.solved:
        code = UNSOLVED  # of an asked instant within the step
    if code == REACHED:
        sample_reached(run)
        if not run.following:
            run.track.pivots[run.track.done] = pivot
            put_down(scene, run)
        run.track.done += 1
    return code


def keep_rates(run: cython.pointer[Run]) -> cython.void:
    """The largest rates so far, of each group and of the scene; the work of drives is no motion."""
    b: cython.Py_ssize_t
    for b in range(run.group_count):
        run.groups[b].rate = run.groups[b].trial
        if run.groups[b].rate > run.control.rate and b != run.energy_group:
            run.control.rate = run.groups[b].rate


def propose_next(method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """The next length by the error; a step cut short by an event or by its piece says nothing against a longer one."""
    h: cython.double = run.h * growth(method, run)
    if not (run.last or run.landing.has_cut) or run.control.proposed < h:
        run.control.proposed = h


def put_down(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.void:
    """The step by its end, whether its stages were settled, and what the next one starts from."""
    run.track.ends[run.track.done] = run.t
    run.track.settled[run.track.done] = run.near
    put_record(scene, run, run.track.passed[run.track.done])


def turn_branches(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """The branches of the next step, where those change at the end of this one; which were held is put down."""
    i: cython.Py_ssize_t
    changed: cython.bint = run.landing.turns
    if run.following:
        changed = False
        if run.track.done + 1 < run.track.most:
            for i in range(scene.held_count):
                changed = changed or run.track.branches[run.track.done + 1][i] != scene.programs.held[i]
            take_branches(scene, run.track.branches[run.track.done + 1])
        return changed
    for i in range(scene.held_count):
        run.track.branches[run.track.done][i] = scene.programs.held[i]
    run.track.turned[run.track.done] = run.landing.turns
    if run.landing.turns:
        take_branches(scene, run.course.turned)
    elif scene.angle_count:
        look_at(scene, clipped(run, run.t), run.y)
        follow_angles(scene, cython.address(run.course))
    return changed


def land(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """Bring the end of a step back onto the closures, with its derivative; CLOSURES_LOST where they cannot be held."""
    t: cython.double = clipped(run, run.t)
    gap: cython.double = settle_evaluated(scene, t, run.y) if stands_at_end(scene, run) else settle(scene, t, run.y)
    if must_choose_anew(scene, gap):
        select_independent_rows(scene, t, run.y, False)
        gap = settle(scene, t, run.y)
    if gap > run.gap or gap != gap:
        run.gap = gap
    if not gap <= scene.limits.lost * scene.size or jumped(scene, run):
        return CLOSURES_LOST
    evaluate_settled(scene, t, run.y, run.K[0])
    start_contacts(scene, t)
    clear_accelerations(scene, method, run.K[0], True)
    run.evaluations += 2
    return REACHED


def stands_at_end(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Whether what `attempt` evaluated last, the end of the step, is what the scene was put to last."""
    return not (run.has_interpolant or run.seeing or run.determined or scene.held_count or run.newton.elsewhere)


def jumped(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Whether the closures changed the rates of the step's end z by more than its error explains.

    That is a blow, or another branch, and no motion that goes on.
    """
    b: cython.int
    i: cython.Py_ssize_t
    change: cython.double
    explained: cython.double = scene.limits.jump
    if run.control.step > 0.0:
        # what a step may turn the scene by, its rates may be off by: Euler's are, by half of it
        most: cython.double = scene.limits.jump_of_given
        explained += run.h * run.control.rate if run.h * run.control.rate < most else most
    elif scene.pivot > 0.0:
        explained += scene.limits.jump_of_error * run.control.tolerance / sqrt(scene.pivot)
    if run.following or run.determined:
        return False
    for b in range(run.group_count):
        group: cython.pointer[Group] = cython.address(run.groups[b])
        for i in range(group.rates, group.end):
            run.stage[i] = run.y[i] - run.z[i]
        change = norm_of(run, run.stage, group.rates, group.end)
        if change > explained * run.control.rate:
            return True
    return False


def verdict(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.int:
    """What the contact found does: STRUCK, LET_GO, or a rope without restitution would push, ROPE_SLACK."""
    found: cython.int = turned_over(scene, run)
    if found == 3:
        return ROPE_SLACK
    return STRUCK if found == 1 else LET_GO


def try_step(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """One attempt at a step: REACHED, also where another length is to be tried; or why the loop is left."""
    code: cython.int
    met: cython.int = STANDS
    if method.attitude and not run.following and leaves_chart(scene, method, run):
        return HALF_TURN
    propose(scene, run)
    code = blocked(scene, run)
    if code != REACHED:
        return code
    run.near = near_singular(scene, run)
    scene.pivot_of_step = 1.0
    trouble: cython.int = attempt(scene, method, run)
    code = judge(scene, method, run, trouble)
    if code == AGAIN:
        run.landing.has_cut = run.landing.attempts = run.landing.contact_attempts = 0
        return REACHED
    if code != ACCEPTED:
        return code
    if run.seeing:
        met = find_events_of_step(scene, method, run)
        if met == CHATTERS:
            return CHATTERING
        if met == AGAIN_TO:
            run.landing.has_cut = run.landing.cut > run.t
            return TURNED if run.halting and not run.landing.has_cut else REACHED  # they turned at once
        if met == TURNS_OVER and run.stop <= run.t:
            return verdict(scene, run)
    code = accept(scene, method, run)
    return leave_for(scene, run, met) if code == REACHED else code


def leave_for(scene: cython.pointer[Scene], run: cython.pointer[Run], met: cython.int) -> cython.int:
    """What the loop is left for behind a step that stands; else REACHED."""
    if met == TURNS_OVER:
        return verdict(scene, run)
    if run.watching and opened_by_others(scene, run):
        return LET_GO
    if run.halting and run.landing.turns:
        return TURNED
    if run.stiffness.after and is_held_short(run):
        return STIFF
    return REACHED


def run_steps(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """Up to `most` accepted steps towards the end of the piece: REACHED, MORE to do, or why it cannot be continued.

    Following, `ends` and `settled` give the steps, and none is judged. Halting, TURNED where a piece begins and where
    branches turn. STIFF where stability keeps the steps short, if that is looked at.
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
        ):  # also where none stands: the clock is looked at
            return MORE
        code = try_step(scene, method, run)
        if code != REACHED:
            return code
    return REACHED
