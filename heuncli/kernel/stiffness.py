"""Detect whether stability, and not accuracy, limits the steps of an explicit method.

The last two stages of an explicit method are at the same instant, the end of the step, and differ by errors in which
the fastest decay or oscillation dominates. So the quotient of their derivatives,

    h |lambda|  ~  h |f(z) - f(g)| / |z - g|,

is the estimate of the tangent's largest eigenvalue by one step of the power method; rates are multiplied by h, which
makes them changes of coordinates in a step. If accuracy decides, it is well below the boundary of the method's
stability; if stability does, the step size control keeps it there.

Hairer, Wanner, Solving Ordinary Differential Equations II (1996), IV.2.
"""

from __future__ import annotations

from math import sqrt

from heuncli.kernel.declarations import *


def estimate_stiffness(method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """Estimate h |lambda| of the trial step, whose last stage is still in `stage`."""
    b: cython.int
    i: cython.Py_ssize_t
    w: cython.double
    x: cython.double
    changes: cython.double = 0.0
    distance: cython.double = 0.0
    end: cython.p_double = run.K[method.stages]
    last: cython.p_double = run.K[method.stages - 1]
    for b in range(run.group_count):
        if b != run.energy_group:  # work has no say in the motion
            group: cython.pointer[Group] = cython.address(run.groups[b])
            for i in range(group.coordinates, group.end):
                w = run.weights[i]
                if i >= group.rates:
                    w *= run.h
                x = w * (run.z[i] - run.stage[i])
                distance += x * x
                x = w * (end[i] - last[i])
                changes += x * x
    run.stiffness.swiftness = run.h * sqrt(changes / distance) if distance > 0.0 else 0.0


def is_stability_limited(run: cython.pointer[Run]) -> cython.bint:
    """Return whether enough of the steps done were at the stability boundary; several in a row that were not reset the
    count.

    If loads may be stiff, also after some steps, and each time that their number has doubled: what saturates, as
    friction does, is driven back and forth by a coarse tolerance, and no quotient shows it.
    """
    if run.stiffness.total_limit and run.steps >= run.stiffness.total_limit:
        run.stiffness.total_limit = 2 * run.steps
        return True
    if run.projects_stages or run.ends_piece:
        return False  # its length says nothing
    if run.stiffness.swiftness > run.stiffness.stable:
        run.stiffness.steps += 1
        run.stiffness.easy_steps = 0
    else:
        run.stiffness.easy_steps += 1
        if run.stiffness.easy_steps >= run.stiffness.easy_limit:
            run.stiffness.steps = 0
    if run.stiffness.steps < run.stiffness.short_limit:
        return False
    run.stiffness.steps = 0
    return True
