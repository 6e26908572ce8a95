"""The equations of motion linearised at a state: accelerations with their derivatives, exact to rounding.

    a(q, u),   da = A_q dq + A_u du         J dq = 0,  J du + R_q dq = 0: what closures and their rates admit
dq are small displacements of the undriven freedoms of the tree, du changes of their rates, each in the order of the
layout's answers: a ball's three turns (and its angular velocity) about the world's axes, one number of any other. The
kernel differentiates its own equations (kernel/tangent.py); closure rows are chosen at the state and then held.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.base.records import record
from heuncli.multibody.response import motions, settled, workspace_of
from heuncli.multibody.tree.held_speeds import holds_speed
from heuncli.multibody.tree.layout import Layout, places_of_rates
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array, Indices
from heuncli.scene.shapes.rotations import cross, cross_rows


@record
class Linearised:
    """The linear equations at a state, n undriven freedoms of the tree, f of them left free by the closures.

    The motion within the closures goes on with tangent x for displacements, tangent x' + drift x for rates.
    """

    state: Array  # settled on the closures
    accelerations: Array  # (n,) of the undriven freedoms: a ball's three about world axes, one each of the others
    by_place: Array  # (n, n) d accelerations / d small displacements, at fixed rates
    by_rate: Array  # (n, n) d accelerations / d rates
    tangent: Array  # (n, f) orthonormal, by the layout's weights: displacements that the closures admit
    drift: Array  # (n, f) change of rates that a displacement along the tangent needs: 0 where nothing moves
    across: Array  # (n, m) the least displacement that opens one of the m independent closure rows by 1 m, others by 0
    twists: Array  # (n_b, 6, n) of each body, tree order: turn, and shift of its centre of mass; world axes
    attitudes: Array  # (n_b, 3, 3) body to world, tree order
    centres: Array  # (n_b, 3) of mass
    arms: Array  # (n_b,) how far they are from the bodies' joint points [m]
    omega: Array  # (n_b, 3)
    velocities: Array  # (n_b, 3) of the centres
    mass: Array  # (n, n) mass matrix of the tree, without what is lent
    posed: Posed | None = None  # where rows hold speeds


@record
class Posed:
    """What the rows that hold poses alone admit, where others hold speeds: all poses are reached, not all at once.

    tangent (n, p) orthonormal, by the layout's weights, p >= f; drift (n, p): the change of rates that each needs.
    """

    tangent: Array
    drift: Array


def linearised(layout: Layout, t: float, state: Array, holding: Array | None = None) -> Linearised:
    """Linearise at a state, which is brought onto the closures first.

    holding (contacts,): which contacts are closed; none if it is not given.

    Raises ValueError for a state of another layout: the compiled kernel takes a length on trust.
    """
    if len(state) != layout.n_state:
        message = f"a state of {layout.n_state} numbers is wanted, one of {len(state)} was given"
        raise ValueError(message)
    at = workspace_of(layout, None if holding is None else layout.closed(holding))
    own, poses = settled(at, layout, t, state)
    found = motions(at, layout, t, own)
    place = places_of_rates(layout)
    rates = place[place >= 0]
    shown = displacements(layout, own, rates)
    # what rates of the freedoms make of a row's rate, displacements make of its gap
    weights = layout.weights[rates]
    tangent, drift, across = admitted(found.rates[:, rates], found.rates @ shown, weights)
    return Linearised(
        state=own,
        accelerations=found.derivative[rates],
        by_place=found.tangent[rates] @ shown,
        by_rate=found.tangent[np.ix_(rates, rates)],
        tangent=tangent,
        drift=drift,
        posed=posed(layout, np.array(at.chosen, dtype=int), found.rates[:, rates], found.rates @ shown, weights),
        across=across / layout.tables["closures"]["weight"][at.chosen],
        **motions_of_bodies(layout, poses, found.omega[..., rates], found.v[..., rates]),
    )


def motion_slopes(layout: Layout, t: float, law: Linearised, holding: Array | None = None) -> tuple[Array, Array]:
    """What small displacements of the tree's freedoms change, at fixed rates, in tree order and world axes.

    Returns the changes of angular velocities and of the velocities of the centres of mass, (n_b, 3, n) each.
    """
    at = workspace_of(layout, None if holding is None else layout.closed(holding))
    own, _ = settled(at, layout, t, law.state)
    found = motions(at, layout, t, own)
    place = places_of_rates(layout)
    shown = displacements(layout, own, place[place >= 0])
    spins, speeds = found.omega @ shown, found.v @ shown
    for k, hang in enumerate(layout.spanning.hangs):
        arm = law.attitudes[k] @ (layout.mechanism.bodies[hang.body].center - layout.reference[k])
        turned = cross_rows((found.turn[k] @ shown).T, arm).T
        speeds[k] += cross_rows(spins[k].T, arm).T + np.cross(law.omega[k][:, None], turned, axis=0)
    return spins, speeds


def displacements(layout: Layout, state: Array, rates: Array) -> Array:
    """What of a state small displacements of its own freedoms change, (n_state, n): q of a ball by (0, turn) q / 2."""
    order = {at: k for k, at in enumerate(rates.tolist())}
    shown = np.zeros((len(state), len(rates)))
    for freedom in layout.tables["freedoms"]:
        if not freedom["driven"]:
            shown[freedom["q_at"], order[int(freedom["u_at"])]] = 1.0
    for body in layout.bodies:
        if body["ball"]:
            at, first = int(body["attitude_at"]), order[int(body["rate_at"])]
            w, x, y, z = state[at : at + 4]
            shown[at : at + 4, first : first + 3] = 0.5 * np.array([[-x, -y, -z], [w, z, -y], [-z, w, x], [y, -x, w]])
    return shown


def admitted(J: Array, turned: Array, weights: Array) -> tuple[Array, Array, Array]:
    """The displacements that closures admit, orthonormal by weights (n, f), the rates that these need, and the least
    displacements that open one row by 1, (n, m).

    J, turned (m, n): of the independent rows, what gap and rate of a row change by along displacements.
    """
    n = len(weights)
    if not len(J):
        return np.diag(1.0 / weights), np.zeros((n, n)), np.zeros((n, 0))
    U, s, V = np.linalg.svd(J / weights, full_matrices=True)
    m = len(s)
    tangent = V[m:].T / weights[:, None]
    by_rows = U.T @ (turned @ tangent)
    across = (V[:m].T / s @ U.T) / weights[:, None]
    return tangent, -(V[:m].T @ (by_rows / s[:, None])) / weights[:, None], across


def posed(layout: Layout, chosen: Indices, J: Array, turned: Array, weights: Array) -> Posed | None:
    """The displacements of rows that hold poses, where some of the independent ones (m,) hold speeds."""
    speeds = holds_speed(layout)[chosen]
    if not speeds.any():
        return None
    tangent, _, _ = admitted(J[~speeds], turned[~speeds], weights)
    tangent = tangent[:, : len(weights) - int(np.sum(~speeds))]
    needed = np.linalg.lstsq(J / weights, -turned @ tangent, rcond=None)[0]
    return Posed(tangent, needed / weights[:, None])


def motions_of_bodies(layout: Layout, poses: Table, turns: Array, shifts: Array) -> dict[str, Array]:
    """Where the bodies are, how they turn and their centres shift with the freedoms; the mass matrix of that.

    turns, shifts (n_b, 3, n): of angular velocities and of the velocities of the joint points, by the rates.
    """
    names = ("twists", "attitudes", "centres", "arms", "omega", "velocities")
    parts: dict[str, list[Any]] = {name: [] for name in names}
    n = turns.shape[2]
    mass = np.zeros((n, n))
    for k, hang in enumerate(layout.spanning.hangs):
        at, own = poses[k], layout.mechanism.bodies[hang.body]
        R, turn = at["R"], turns[k]
        arm = R @ (own.center - layout.reference[k])
        shift = shifts[k] + cross_rows(turn.T, arm).T
        mass += own.mass * shift.T @ shift + turn.T @ (R @ own.inertia @ R.T) @ turn
        parts["twists"].append(np.concatenate([turn, shift]))
        parts["attitudes"].append(R)
        parts["centres"].append(at["r"] + arm)
        parts["arms"].append(np.sqrt(arm @ arm))
        parts["omega"].append(at["omega"])
        parts["velocities"].append(at["v"] + cross(at["omega"], arm))
    return {name: np.array(values) for name, values in parts.items()} | {"mass": mass}
