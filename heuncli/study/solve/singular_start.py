"""Check that the accelerations at a start at rest belong to a motion: in a singular pose, first-order ones need not.

A chain stretched straight between two supports gives way across itself to the first order: there J has one independent
row less. Pushed across, it would have to move by a t^2/2, and to lengthen by the square of that, which no t^4 of any
other coordinate compensates. It does not move, and no finite force holds it. With x = a t^2/2 + b t^4/24 the closures
require J b + 3 gamma(a) = 0: what they require of b is what they require of accelerations where rates are a.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.bodies import BodyStates, make_body_states
from heuncli.loads.kinetostatics.reactions import NamedArrays
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.integration.run.runner import Runner
from heuncli.multibody.tree.layout import Island, Layout, rate_indices
from heuncli.results.results import Array


def require_motion(layout: Layout, start_solution: Evaluation) -> None:
    """Raise SolveError where loads push a resting singular pose along a motion that cannot continue.

    start_solution: of one instant. Poses with accelerating drives or with moving bodies pass unchecked.
    """
    rows = start_solution.rows[0]
    dependent = [
        i for i in layout.islands if (rows["chosen"] < rows["closed"])[i.rows].any() and not is_immobile(i, rows)
    ]
    if not dependent:
        return
    y, accelerations = start_solution.states[0], rate_derivatives(layout, start_solution)
    rate_places = rate_indices(layout)
    resting: dict[int, tuple[Array, Array]] = {}  # by island: places of its rates in the state, and their values
    for k, island in enumerate(dependent):
        own_places = rate_places[island.freedoms]
        weights = layout.weights[own_places]
        scale = float(np.abs(accelerations[own_places] * weights).max(initial=0.0))
        if scale > 0.0 and float(np.abs(y[own_places] * weights).max()) <= tolerances.AT_REST:
            resting[k] = own_places, accelerations[own_places] / scale
    if not resting:
        return
    bare = Runner(remove_weight_and_loads(layout))
    rates = rate_places[rate_places >= 0]
    all_motions, is_kept = solve_with_rates(bare, start_solution, rates, list(resting.values()))
    if is_kept and all_motions.residual[0] <= all_motions.allowed_residual[0]:
        # the usual case: one check of all islands together
        return
    for k, motion in resting.items():
        motion_solution, is_kept = solve_with_rates(bare, start_solution, rates, [motion])
        if (
            is_kept
            and motion_solution.residual[0] > motion_solution.allowed_residual[0]
            and is_pushed(layout, start_solution, motion_solution)
        ):
            raise SolveError(make_problem(layout, float(start_solution.times[0]), dependent[k]))


def is_immobile(island: Island, rows: NamedArrays) -> bool:
    """Return whether the island has as many independent rows as freedoms: what cannot move is pushed nowhere."""
    return float(rows["chosen"][island.rows].sum()) >= len(island.freedoms)


def solve_with_rates(
    unloaded: Runner, start_solution: Evaluation, rates: Array, motions: Sequence[tuple[Array, Array]]
) -> tuple[Evaluation, bool]:
    """Solve the scene without loads for given rates, all others 0; and whether the closures keep these rates.

    rates: the places of all rates in the state
    """
    y = start_solution.states[0].copy()
    y[rates] = 0.0
    for places, values in motions:
        y[places] = values
    solution = unloaded.evaluate(start_solution.times, y[None, :], holding=start_solution.holding)
    rate_changes = np.abs((solution.states[0] - y)[rates] * unloaded.layout.weights[rates])
    return solution, bool(rate_changes.max() <= tolerances.REMAINING_RATE)


def remove_weight_and_loads(layout: Layout) -> Layout:
    """Return the layout of the scene on which only its closures act."""
    mechanism = replace(layout.mechanism, gravity=np.zeros(3))
    return replace(layout, mechanism=mechanism, tables=layout.tables | {"loads": layout.tables["loads"][:0]})


def rate_derivatives(layout: Layout, solution: Evaluation) -> Array:
    """Return the derivatives of the state's rates at one instant, each at the place of its rate, 0 elsewhere."""
    found = np.zeros(layout.n_state)
    for k, body in enumerate(layout.bodies):
        if body["ball"]:
            found[body["rate_at"] : body["rate_at"] + 3] = solution.bodies["alpha"][0, k]
    for k, freedom in enumerate(layout.tables["freedoms"]):
        if not freedom["driven"]:
            found[freedom["u_at"]] = solution.freedoms["udot"][0, k]
    return found


def is_pushed(layout: Layout, solution: Evaluation, motion: Evaluation) -> bool:
    """Return whether the loads act along a motion by more than the pose is known: power of the inertia loads over
    loads.
    """
    bodies = layout.mechanism.bodies
    states: BodyStates = make_body_states(layout, solution)
    moving = make_body_states(layout, motion)
    mass = np.array([b.mass for b in bodies])
    speed = float(np.abs(moving.v_centre[0]).max())
    turn = float(np.abs(moving.omega[0]).max())
    power = float(np.sum(mass[:, None] * states.a_centre[0] * moving.v_centre[0]))
    for i, body in enumerate(bodies):
        R = states.R[0, i]
        power += float(moving.omega[0, i] @ R @ body.inertia @ R.T @ states.alpha[0, i])
    force = float(mass.sum() * np.abs(layout.mechanism.gravity).max() + np.abs(solution.loads["force"]).sum())
    moment = float(np.abs(solution.loads["moment"]).sum()) + force * layout.size
    return power > tolerances.LOAD_ALONG_FREE_MOTION * (force * speed + moment * turn)


def make_problem(layout: Layout, t: float, island: Island) -> Problem:
    """Make the problem of a closed chain that is pushed where it cannot move."""
    names = dict.fromkeys(layout.mechanism.owner_path(layout.rows[r]) for r in island.rows.tolist())
    through = " and ".join(names)
    message = (
        f"at t = {t:.9g} s the loads push the closed loop through {through} in a singular position (stretched, folded "
        "or flat) along a motion possible to first order only: no acceleration exists, and no finite force resists it"
    )
    hint = "start off that position (with some sag: forces grow as its inverse), or give the rate of one more joint"
    return Problem("singular-pose", message, hint=hint)
