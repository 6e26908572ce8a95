"""Ropes: where within a step tried one would have to push for the first time.

Its multiplier along the dense output is bounded by its second differences; parts in doubt are halved, from left to
right. The step is done again up to there, until both agree, and the run ends.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import fabs

    from heuncli.kernel.dense import AGAIN_TO, MOST_LANDINGS, SLACK, STANDS, clipped, interpolate, need_interpolant
    from heuncli.kernel.response import evaluate, settle
    from heuncli.kernel.scene import Closure, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.structs import Method, Run

    # Halvings of a step, down to the rounding of its instants; into how many a part is divided to be looked at.
    HALVINGS, POINTS = 46, 8


def slackness(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.double:
    """The largest multiplier of a rope, as evaluated last: positive where it would push."""
    r: cython.int
    most: cython.double = -1e300
    for r in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[r])
        if row.rope and row.multiplier > most:
            most = row.multiplier
            run.rope = r + 1
    return most


def slackness_at(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run], x: cython.double
) -> cython.double:
    """The same at x of the step tried, by its dense output."""
    t: cython.double = clipped(run, run.t + x * run.h)
    interpolate(run, 3 + method.dense_rows, x, run.stage)
    settle(scene, t, run.stage)
    evaluate(scene, t, run.stage, run.fine)
    run.evaluations += 1
    return slackness(scene, run)


def meet_slack(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """Where within a step tried a rope would have to push for the first time: the run ends there."""
    x: cython.double
    at: cython.double
    near: cython.double = scene.limits.least_step * fabs(run.end)
    if run.most_slack + 0.5 * (run.most_slack - run.least_slack) < 0.0 and not run.slack_landings:
        return STANDS
    need_interpolant(scene, method, run)
    x = first_slack(scene, method, run)
    if x > 1.0:
        run.slack_landings = 0
        return STANDS
    at = run.t + x * run.h
    if at - run.t <= near:
        run.stop = run.t
        return SLACK
    if run.stop - at <= near or run.slack_landings >= MOST_LANDINGS:
        return SLACK
    run.slack_landings += 1
    run.cut = at
    return AGAIN_TO


def first_slack(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.double:
    """x just before the first instant of the step tried at which a rope would push; 2 where none does."""
    x: cython.double = 0.0
    middle: cython.double
    top: cython.int = 0
    noise: cython.double = scene.limits.rounding * fabs(run.least_slack)
    ends: cython.p_double = run.course.ends
    ends[0] = 1.0
    while top >= 0:
        middle = 0.5 * (x + ends[top])
        if top == HALVINGS or middle <= x or middle >= ends[top]:
            if slackness_at(scene, method, run, ends[top]) > noise:
                return x
            x = ends[top]
            top -= 1
        elif is_taut(scene, method, run, x, ends[top], noise):
            x = ends[top]
            top -= 1
        else:
            top += 1
            ends[top] = middle
    return 2.0


def is_taut(
    scene: cython.pointer[Scene],
    method: cython.pointer[Method],
    run: cython.pointer[Run],
    x0: cython.double,
    x1: cython.double,
    noise: cython.double,
) -> cython.bint:
    """Whether no rope would push between x0 and x1.

    Between equidistant points a function rises above the larger of two neighbours by no more than an eighth of its
    second differences; twice that is allowed for, as they vary.
    """
    i: cython.int
    f: cython.double
    bend: cython.double
    highest: cython.double = -1e300
    bent: cython.double = 0.0
    before: cython.double = 0.0
    first: cython.double = 0.0
    for i in range(POINTS + 1):
        f = slackness_at(scene, method, run, x0 + (x1 - x0) * i / POINTS)
        if not f <= noise:
            return False
        if f > highest:
            highest = f
        if i > 1:
            bend = fabs(f - 2.0 * before + first)
            if bend > bent:
                bent = bend
        first = before
        before = f
    return highest + 0.25 * bent <= noise
