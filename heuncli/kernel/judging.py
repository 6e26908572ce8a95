"""Judge a step that was tried: accept it, try another length, or give up.

A step of given length is accepted if its end could be computed. The error of any other is measured body by body and
the largest counts, for a resting neighbour must not dilute it: coordinates against tol (angles) and tol * size
(shifts), rates against tol * the largest rate the body has had. Hairer, Norsett, Wanner, Solving Ordinary Differential
Equations I (1993), II.4.
"""

from __future__ import annotations

from math import fabs, pow, sqrt

from heuncli.kernel.attitudes import scale_chart_errors
from heuncli.kernel.collocation import estimate_error, refine_error
from heuncli.kernel.contact_rounding import remove_contact_rounding
from heuncli.kernel.declarations import *
from heuncli.kernel.dense import combine_stages

# Hairer, Norsett and Wanner, II.4: take a little less than the length that would just be allowed, as a rejected step
# costs a whole one, and limit the change of length, as the error estimate is valid for small changes only.
SAFETY = 0.9
MIN_STEP_FACTOR = 0.2  # shorter after a rejection
MAX_STEP_FACTOR = 6.0  # longer after what was accepted
UNDEFINED_STEP_FACTOR = 0.1  # shorter where a stage has no value at all
# share of the squared coarser estimate (II.10): it keeps the combined error from vanishing with the finer one
COARSE_SHARE = 0.01
SINGULAR_NOISE = 0.1  # effect of rounding on the closures, relative to the tolerance: above it, try another length
NO_RATE = 1e-200  # added to a rate, so that what never moves divides by no zero
UNBOUNDED = 1e300  # larger than any finite error, inertia or coordinate
INSTANT_ROUNDING = 1e-15  # relative: a step that is shorter does not change the time
UNSOLVED_ERROR = 1.8  # error assigned to unsolved stages, to the method's order: 0.9/1.8, half the step


def weighted_norm(run: cython.pointer[Run], x: cython.p_double, begin: cython.int, end: cython.int) -> cython.double:
    """Return sqrt(sum (w_i x_i)^2) over i from `begin` to `end`, w_i: `run.weights`."""
    i: cython.Py_ssize_t
    g: cython.double
    square: cython.double = 0.0
    for i in range(begin, end):
        g = x[i] * run.weights[i]
        square += g * g
    return sqrt(square)


def measure_step_error(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.double:
    """Return the largest error over the groups, 1 = just allowed; NaN if one is."""
    b: cython.int
    error: cython.double
    worst: cython.double = 0.0
    for b in range(run.group_count):
        error = measure_group_error(scene, method, run, b)
        if error != error:
            return error
        if error > worst:
            worst = error
    return worst


def measure_group_error(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run], b: cython.int
) -> cython.double:
    """Return the error of a group: h e^2 / sqrt(e^2 + 0.01 c^2), e and c the norms of the finer and the coarser
    estimate, or h e from one.
    """
    group: cython.pointer[Group] = cython.address(run.groups[b])
    i: cython.Py_ssize_t
    e: cython.double
    g: cython.double
    fine: cython.double = 0.0
    coarse: cython.double = 0.0
    rate: cython.double = weighted_norm(run, run.z, group.rates, group.end)
    if rate < group.rate:
        rate = group.rate
    group.trial = rate
    floor: cython.double = find_rate_floor(scene, run, b == run.energy_group)
    scale: cython.double = 1.0 / run.control.tolerance
    for i in range(group.coordinates, group.end):
        if i == group.rates:
            scale = 1.0 / (run.control.tolerance * (rate + floor + NO_RATE))
        g = run.weights[i] * scale
        e = run.fine[i] * g
        fine += e * e
        if method.estimates == 2:
            e = run.coarse[i] * g
            coarse += e * e
    if fine > 0.0:
        return run.h * fine / sqrt(fine + COARSE_SHARE * coarse)
    return fine  # 0, or not a number


def find_rate_floor(scene: cython.pointer[Scene], run: cython.pointer[Run], is_energy: cython.bint) -> cython.double:
    """Return what is added to a group's rate before its errors are measured by it, so that slow groups cost no steps.

    It is a fraction of the largest rate of the scene; where all that moves is rounding (`update_imposed_rate`), at
    least the rounding of what is imposed. Of energy, the same with the energies that such rates give the bodies.
    """
    floor: cython.double = scene.limits.slow_rate * run.control.rate
    if is_energy:
        floor = scene.limits.slow_rate * run.control.energy_scale * run.control.rate * run.control.rate
    if run.control.is_balanced:
        least: cython.double = scene.limits.imposed_rounding * run.control.imposed_rate / run.control.tolerance
        if is_energy:
            least *= run.control.energy_scale * run.control.imposed_rate
        if floor < least:
            floor = least
    return floor


def update_imposed_rate(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.void:
    """Update the largest rate so far that drives, and each load on its own, impose at the instant evaluated last, and
    whether all moves so much slower that its rates may be rounding.

    Where they balance, all that they act on rests but for rounding: two springs that pull against each other, a
    pendulum that hangs still in a rotor.
    """
    i: cython.Py_ssize_t
    rate_of_drive: cython.double
    load_size: cython.double
    rate: cython.double = 0.0
    largest_square: cython.double = 0.0
    mass_size: cython.double
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if freedom.driven:
            rate_of_drive = fabs(freedom.u) * norm(freedom.s)
            if freedom.kind == SHIFT:
                rate_of_drive /= scene.size
            if rate_of_drive > rate:
                rate = rate_of_drive
    for i in range(scene.load_count):
        load: cython.pointer[Load] = cython.address(scene.loads[i])
        if load.a == load.b:  # within one body
            continue
        mass_size = find_least_mass_size(scene, run, load)
        load_size = sum_magnitudes(load.force) + sum_magnitudes(load.moment) / scene.size
        if mass_size > 0.0 and load_size > largest_square * mass_size:
            largest_square = load_size / mass_size
    if largest_square > rate * rate:
        rate = sqrt(largest_square)
    if rate > run.control.imposed_rate:
        run.control.imposed_rate = rate
    run.control.is_balanced = run.control.rate < scene.limits.balanced_rate * run.control.imposed_rate


def find_least_mass_size(
    scene: cython.pointer[Scene], run: cython.pointer[Run], load: cython.pointer[Load]
) -> cython.double:
    """Return the least of mass times size [kg m] of the two bodies on which a load acts; UNBOUNDED for the ground.

    F / (m size) is a squared rate [1/s^2]: a load F that acts along the size of a mass m gives it the energy of that
    rate. Loads on a body without mass move others: they are taken to act on the lightest.
    """
    first: cython.double = find_body_mass_size(scene, run, load.a)
    second: cython.double = find_body_mass_size(scene, run, load.b)
    return first if first < second else second


def find_body_mass_size(scene: cython.pointer[Scene], run: cython.pointer[Run], k: cython.int) -> cython.double:
    """Return mass times size of a body [kg m]: of the ground (-1) UNBOUNDED, of one without mass the lightest's."""
    if k < 0:
        return UNBOUNDED
    return scene.bodies[k].mass * scene.size if scene.bodies[k].mass > 0.0 else run.control.least_mass_size


def sum_magnitudes(a: Vec3) -> cython.double:
    """Return |x| + |y| + |z|."""
    return fabs(a.x) + fabs(a.y) + fabs(a.z)


def propose_shorter_turn(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Propose a shorter step if a stage turned so fast that this one may have passed the end of the chart. Returns
    whether it did.
    """
    part: cython.double
    if not run.chart.approach_rate * run.h > scene.limits.chart_turn:
        return False
    part = SAFETY * scene.limits.chart_turn / (run.chart.approach_rate * run.h)
    run.control.proposed = run.h * (part if part > MIN_STEP_FACTOR else MIN_STEP_FACTOR)
    run.control.rejected_before = 1
    return True


def assess_step(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run], evaluation_code: cython.int
) -> cython.int:
    """Judge a step that was tried, and propose another length where it is to be tried AGAIN.

    Returns ACCEPTED, AGAIN, NOT_A_NUMBER; for given lengths also UNSOLVED or CLOSURES_LOST. evaluation_code: what
    `evaluate` returned at the step's end, or at a stage that failed; negative where it failed
    """
    error: cython.double
    noise: cython.double = 0.0
    run.control.error = 0.0
    if run.following:
        return ACCEPTED
    if run.determined:
        return AGAIN if evaluation_code < 0 else ACCEPTED
    if method.fixed:
        return assess_given_step(method, run, evaluation_code)
    error = (
        estimate_implicit_error(scene, method, run) if method.implicit else estimate_explicit_error(scene, method, run)
    )
    if run.projects_stages:
        if propose_length_off_singularity(scene, run, error, evaluation_code):
            return AGAIN
        noise = find_singular_noise(scene, run)
    if error != error or evaluation_code < 0:
        # outside the scene's range of motion: try a much smaller step, or stop
        run.control.proposed = UNDEFINED_STEP_FACTOR * run.h
        run.control.rejected_before = 1
        least: cython.double = scene.limits.least_step * (run.end - run.t)
        if run.control.proposed < least or run.control.proposed <= INSTANT_ROUNDING * fabs(run.t):
            return NOT_A_NUMBER
        return AGAIN
    if error > 1.0 + noise:
        factor: cython.double = SAFETY * pow(error, -method.exponent)
        run.control.proposed = run.h * (factor if factor > MIN_STEP_FACTOR else MIN_STEP_FACTOR)
        run.control.rejected_before = 1
        return AGAIN
    if method.attitude and propose_shorter_turn(scene, run):
        return AGAIN
    run.control.error = error
    return ACCEPTED


def assess_given_step(
    method: cython.pointer[Method], run: cython.pointer[Run], evaluation_code: cython.int
) -> cython.int:
    """Return ACCEPTED, or why a step whose length is given cannot be taken."""
    if method.implicit and not run.newton.has_stages:
        return UNSOLVED
    if not update_group_rates(run):
        return NOT_A_NUMBER
    return CLOSURES_LOST if evaluation_code < 0 else ACCEPTED


def update_group_rates(run: cython.pointer[Run]) -> cython.bint:
    """Set the rates of the groups at the end of a given step. Returns whether all is finite there."""
    b: cython.int
    size: cython.double = 0.0
    for b in range(run.group_count):
        group: cython.pointer[Group] = cython.address(run.groups[b])
        group.trial = weighted_norm(run, run.z, group.rates, group.end)
        if group.trial < group.rate:
            group.trial = group.rate
        size += weighted_norm(run, run.z, group.coordinates, group.end)
    return size < UNBOUNDED  # neither infinite nor not a number


def estimate_explicit_error(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.double:
    """Return the error of the trial step of an explicit method, 1 = just allowed."""
    row: cython.int = method.stages + 1 + method.extra
    combine_stages(method, row, run.chart.K, run.n, run.coarse)
    combine_stages(method, row + method.estimates - 1, run.chart.K, run.n, run.fine)
    if method.attitude:
        scale_chart_errors(scene, method.attitude, run.chart.y, run.coarse)
        scale_chart_errors(scene, method.attitude, run.chart.y, run.fine)
    return measure_free_error(scene, method, run)


def measure_free_error(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.double:
    """Return the error without the rounding that contacts hold, 1 = just allowed; NaN if one is."""
    remove_contact_rounding(scene, method, run)
    return measure_step_error(scene, method, run)


def estimate_implicit_error(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.double:
    """Return the error of the trial step of an implicit method; without stages, a value that halves the step."""
    if not run.newton.has_stages:
        return pow(UNSOLVED_ERROR, 1.0 / method.exponent)
    estimate_error(method, run, run.K[0])
    error: cython.double = measure_free_error(scene, method, run)
    if not error <= 1.0:
        refine_error(scene, method, run)
        error = measure_free_error(scene, method, run)
    return error


def propose_length_off_singularity(
    scene: cython.pointer[Scene], run: cython.pointer[Run], error: cython.double, evaluation_code: cython.int
) -> cython.bint:
    """Propose another length that may keep the stages off a singular pose, at last the best of those tried. Returns
    whether one is to be tried.
    """
    # effect of rounding on the closures at the worst of the stages, relative to the tolerance
    noise: cython.double = UNBOUNDED
    if scene.pivot_of_step > 0.0:
        noise = scene.limits.pivot_rounding * run.h * run.control.rate / (scene.pivot_of_step * run.control.tolerance)
    broken: cython.bint = error != error or evaluation_code < 0
    # all lengths tried, or the step must end where it ends
    if run.control.retries >= scene.limits.singular_retries or run.ends_piece:
        return False
    # no sign of a singular pose: the error alone decides
    if not (noise > SINGULAR_NOISE or broken or (error > 1.0 and run.control.retries > 0)):
        return False
    worst: cython.double = error if error > noise else noise
    if broken:
        worst = UNBOUNDED
    if run.control.retries == 0 or worst < run.control.best:
        run.control.best = worst
        run.control.best_h = run.h
    run.control.retries += 1
    run.control.proposed = (
        run.control.best_h if run.control.retries == scene.limits.singular_retries else scene.limits.retry_ratio * run.h
    )
    return True


def find_singular_noise(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.double:
    """Return the error that rounding may cause near a singular pose, also at the start, in a step that could not avoid
    it.
    """
    pivot: cython.double = scene.pivot_of_step
    if run.control.pivot_at_start < pivot:
        pivot = run.control.pivot_at_start
    if pivot > 0.0 and run.control.retries == scene.limits.singular_retries:
        return scene.limits.pivot_noise * run.h * run.control.rate / (pivot * run.control.tolerance)
    return 0.0


def find_growth_factor(method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.double:
    """Return by what factor the next step may be longer; at most 1 after a rejection."""
    factor: cython.double = MAX_STEP_FACTOR
    if run.control.error > 1.0:
        factor = 1.0
    elif run.control.error > 0.0:
        factor = SAFETY * pow(run.control.error, -method.exponent)
        if factor > MAX_STEP_FACTOR:
            factor = MAX_STEP_FACTOR
    if run.control.rejected_before and factor > 1.0:
        factor = 1.0
    return factor
