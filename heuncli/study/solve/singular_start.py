"""Whether the accelerations at a start at rest belong to a motion: in a singular pose those of first order need not.

A chain stretched straight between two supports gives way across itself to the first order: where it lies J has one
independent row less. Pushed across, it would have to move by a t^2/2, and to be longer by the square of that, which no
t^4 of any other coordinate makes up for. It does not move, and no finite force holds it. With x = a t^2/2 + b t^4/24
the closures ask for J b + 3 gamma(a) = 0: what they ask of b is what they ask of accelerations where rates are a.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.bodies import BodyStates, body_states
from heuncli.loads.kinetostatics.reactions import Named
from heuncli.motion.integration.evaluator import Recovered
from heuncli.motion.integration.run.runner import Runner
from heuncli.multibody.tree.layout import Island, Layout, places_of_rates
from heuncli.results.results import Array


def require_motion(layout: Layout, recovered: Recovered) -> None:
    """Raise SolveError where loads push what rests in a singular pose along a motion that does not go on.

    recovered: of one instant. Where drives accelerate, or where bodies move already, nothing is said.
    """
    rows = recovered.rows[0]
    dependent = [i for i in layout.islands if (rows["chosen"] < rows["closed"])[i.rows].any() and not is_held(i, rows)]
    if not dependent:
        return
    y, accelerations = recovered.states[0], rates_of(layout, recovered)
    place = places_of_rates(layout)
    resting: dict[int, tuple[Array, Array]] = {}  # of each island its rates' places, and what they shall be
    for k, island in enumerate(dependent):
        own = place[island.freedoms]
        weights = layout.weights[own]
        scale = float(np.abs(accelerations[own] * weights).max(initial=0.0))
        if scale > 0.0 and float(np.abs(y[own] * weights).max()) <= tolerances.AT_REST:
            resting[k] = own, accelerations[own] / scale
    if not resting:
        return
    bare = Runner(without_loads(layout))
    rates = place[place >= 0]
    whole, kept = set_moving(bare, recovered, rates, list(resting.values()))
    if kept and whole.residual[0] <= whole.may_stay[0]:  # mostly so: one look at all islands
        return
    for k, motion in resting.items():
        along, kept = set_moving(bare, recovered, rates, [motion])
        if kept and along.residual[0] > along.may_stay[0] and pushed(layout, recovered, along):
            raise SolveError(goes_nowhere(layout, float(recovered.times[0]), dependent[k]))


def is_held(island: Island, rows: Named) -> bool:
    """Whether as many of its rows are independent as it has freedoms: what nothing can move is pushed nowhere."""
    return float(rows["chosen"][island.rows].sum()) >= len(island.freedoms)


def set_moving(
    bare: Runner, recovered: Recovered, rates: Array, motions: Sequence[tuple[Array, Array]]
) -> tuple[Recovered, bool]:
    """What the scene without loads does where these rates are given and all others are 0; whether closures let them be.

    rates: where all of them stand in the state.
    """
    y = recovered.states[0].copy()
    y[rates] = 0.0
    for own, values in motions:
        y[own] = values
    along = bare.recovered(recovered.times, y[None, :], holding=recovered.holding)
    changed = np.abs((along.states[0] - y)[rates] * bare.layout.weights[rates])
    return along, bool(changed.max() <= tolerances.MOVES)


def without_loads(layout: Layout) -> Layout:
    """The scene without weight and loads: what its closures ask for is then all there is."""
    mechanism = replace(layout.mechanism, gravity=np.zeros(3))
    return replace(layout, mechanism=mechanism, tables=layout.tables | {"loads": layout.tables["loads"][:0]})


def rates_of(layout: Layout, recovered: Recovered) -> Array:
    """The derivatives of the state's rates, each where the rate stands, 0 elsewhere; of one instant."""
    found = np.zeros(layout.n_state)
    for k, body in enumerate(layout.bodies):
        if body["ball"]:
            found[body["rate_at"] : body["rate_at"] + 3] = recovered.bodies["alpha"][0, k]
    for k, freedom in enumerate(layout.tables["freedoms"]):
        if not freedom["driven"]:
            found[freedom["u_at"]] = recovered.freedoms["udot"][0, k]
    return found


def pushed(layout: Layout, recovered: Recovered, along: Recovered) -> bool:
    """Whether the loads act along a motion by more than the pose is known: power of the inertia loads over loads."""
    bodies = layout.mechanism.bodies
    at: BodyStates = body_states(layout, recovered)
    moving = body_states(layout, along)
    mass = np.array([b.mass for b in bodies])
    speed = float(np.abs(moving.v_centre[0]).max())
    turn = float(np.abs(moving.omega[0]).max())
    power = float(np.sum(mass[:, None] * at.a_centre[0] * moving.v_centre[0]))
    for i, body in enumerate(bodies):
        R = at.R[0, i]
        power += float(moving.omega[0, i] @ R @ body.inertia @ R.T @ at.alpha[0, i])
    force = float(mass.sum() * np.abs(layout.mechanism.gravity).max() + np.abs(recovered.loads["force"]).sum())
    moment = float(np.abs(recovered.loads["moment"]).sum()) + force * layout.size
    return power > tolerances.PUSHED * (force * speed + moment * turn)


def goes_nowhere(layout: Layout, t: float, island: Island) -> Problem:
    """The problem of a chain that is pushed where it cannot go."""
    names = dict.fromkeys(layout.mechanism.owner(layout.rows[r]) for r in island.rows.tolist())
    through = " and ".join(names)
    message = (
        f"at t = {t:.9g} s the loads push the closed chain through {through} in a singular pose (stretched, folded or "
        "flat) along a motion that closes to the first order only: no acceleration exists, and no finite force holds it"
    )
    hint = "draw it off that pose (with some sag, say: forces grow as its inverse), or give the rate of one more joint"
    return Problem("singular-pose", message, hint=hint)
