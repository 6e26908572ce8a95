"""Linearise the equations of motion at a state: accelerations with their derivatives, exact to rounding.

    a(q, u),   da = A_q dq + A_u du         J dq = 0,  J du + R_q dq = 0: what closures and their rates admit

dq are small displacements of the undriven freedoms of the tree, du changes of their rates, both in the order of the
layout's results: a ball joint's three rotations (and its angular velocity) about the world's axes, one number for any
other freedom. The kernel differentiates its own equations (kernel/tangent.py); closure rows are chosen at the state and
then held.

As joint coordinates, displacements are angles and travels, and rotations and shifts where joints leave more free:

    pin, slide, cylinder     J.angle, J.travel
    line                     J.travel, and the rotations J.x, J.y, J.z
    ball, universal          J.x, J.y, J.z       rotation of `to` against `from` about the world's axes [rad]
    plane                    the same, and J.dx, J.dy, J.dz    shift of the `to` point against `from` [m]
    a body without a joint                   B.x ... B.dz  of the body and its centre

What a joint holds is left out. In closed chains all joints are included, wherever the tree was cut.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.base.joint_kinds import JOINTS
from heuncli.base.linear_algebra import solve_least_squares
from heuncli.base.records import record
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Joint
from heuncli.multibody.response import compute_motions, make_workspace, settle_state
from heuncli.multibody.tree.layout import Layout, find_speed_rows, rate_indices
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array, Indices
from heuncli.scene.shapes.rotations import cross_rows, cross_vectors

# Linearise


@record
class LinearisedEquations:
    """The linear equations at a state, with n undriven freedoms of the tree, of which the closures leave f free.

    The motion within the closures has displacements tangent x and rates tangent x' + drift x.
    """

    state: Array  # projected onto the closures
    accelerations: Array  # (n,) of the undriven freedoms: a ball's three about world axes, one each of the others
    by_place: Array  # (n, n) d accelerations / d small displacements, at fixed rates
    by_rate: Array  # (n, n) d accelerations / d rates
    tangent: Array  # (n, f) orthonormal, by the layout's weights: displacements that the closures admit
    drift: Array  # (n, f) change of rates that a displacement along the tangent needs: 0 where nothing moves
    opening_directions: Array  # (n, m) smallest displacements that open one of the m independent closure rows by 1 m
    twists: Array  # (n_b, 6, n) of each body, tree order: turn, and shift of its centre of mass; world axes
    attitudes: Array  # (n_b, 3, 3) body to world, tree order
    centres: Array  # (n_b, 3) of mass
    arms: Array  # (n_b,) how far they are from the bodies' joint points [m]
    omega: Array  # (n_b, 3)
    velocities: Array  # (n_b, 3) of the centres
    mass: Array  # (n, n) mass matrix of the tree, without artificial inertia
    pose_directions: PoseDirections | None = None  # where rows constrain speeds


@record
class PoseDirections:
    """What the rows that constrain poses alone admit, where others constrain speeds: all poses are reachable, not all
    at once.

    tangent (n, p): orthonormal, by the layout's weights, p >= f
    drift (n, p): the change of rates that each needs
    """

    tangent: Array
    drift: Array


def linearise(layout: Layout, t: float, state: Array, holding: Array | None = None) -> LinearisedEquations:
    """Linearise at a state, which is first projected onto the closures.

    holding (contacts,): the closed contacts; by default none

    Raises ValueError for a state of another layout, because the compiled kernel does not check the length.
    """
    if len(state) != layout.n_state:
        message = f"expected a state of {layout.n_state} numbers, found {len(state)}"
        raise ValueError(message)
    workspace = make_workspace(layout, None if holding is None else layout.closed_contacts(holding))
    projected_state, poses = settle_state(workspace, layout, t, state)
    derivatives = compute_motions(workspace, layout, t, projected_state)
    place = rate_indices(layout)
    rates = place[place >= 0]
    state_changes = state_displacements(layout, projected_state, rates)
    # a row's gap depends on displacements as its rate depends on the rates of the freedoms
    weights = layout.weights[rates]
    tangent, drift, opening_directions = find_admitted(
        derivatives.rates[:, rates], derivatives.rates @ state_changes, weights
    )
    return LinearisedEquations(
        state=projected_state,
        accelerations=derivatives.derivative[rates],
        by_place=derivatives.tangent[rates] @ state_changes,
        by_rate=derivatives.tangent[np.ix_(rates, rates)],
        tangent=tangent,
        drift=drift,
        pose_directions=find_pose_directions(
            layout,
            np.array(workspace.chosen_rows, dtype=int),
            derivatives.rates[:, rates],
            derivatives.rates @ state_changes,
            weights,
        ),
        opening_directions=opening_directions / layout.tables["closures"]["weight"][workspace.chosen_rows],
        **find_body_motions(layout, poses, derivatives.omega[..., rates], derivatives.v[..., rates]),
    )


def find_velocity_derivatives(
    layout: Layout, t: float, law: LinearisedEquations, holding: Array | None = None
) -> tuple[Array, Array]:
    """Return the derivatives of the bodies' velocities by small displacements of the freedoms, at fixed rates.

    Returns the changes of angular velocities and of the velocities of the centres of mass, (n_b, 3, n) each, in tree
    order and world axes.
    """
    workspace = make_workspace(layout, None if holding is None else layout.closed_contacts(holding))
    projected_state, _ = settle_state(workspace, layout, t, law.state)
    derivatives = compute_motions(workspace, layout, t, projected_state)
    place = rate_indices(layout)
    state_changes = state_displacements(layout, projected_state, place[place >= 0])
    spins, speeds = derivatives.omega @ state_changes, derivatives.v @ state_changes
    for k, link in enumerate(layout.spanning.links):
        arm = law.attitudes[k] @ (layout.mechanism.bodies[link.body].center - layout.reference[k])
        rotated_arms = cross_rows((derivatives.turn[k] @ state_changes).T, arm).T
        speeds[k] += cross_rows(spins[k].T, arm).T + np.cross(law.omega[k][:, None], rotated_arms, axis=0)
    return spins, speeds


def state_displacements(layout: Layout, state: Array, rates: Array) -> Array:
    """Return the changes of a state by small displacements of its freedoms, (n_state, n): q of a ball joint by (0,
    turn) q / 2.
    """
    order = {index: k for k, index in enumerate(rates.tolist())}
    changes = np.zeros((len(state), len(rates)))
    for freedom in layout.tables["freedoms"]:
        if not freedom["driven"]:
            changes[freedom["q_at"], order[int(freedom["u_at"])]] = 1.0
    for body in layout.bodies:
        if body["ball"]:
            index, first = int(body["attitude_at"]), order[int(body["rate_at"])]
            w, x, y, z = state[index : index + 4]
            changes[index : index + 4, first : first + 3] = 0.5 * np.array(
                [[-x, -y, -z], [w, z, -y], [-z, w, x], [y, -x, w]]
            )
    return changes


def find_admitted(J: Array, rate_changes: Array, weights: Array) -> tuple[Array, Array, Array]:
    """Return the displacements that closures admit, orthonormal by weights (n, f), the rates that these need, and the
    smallest displacements that open one row by 1, (n, m).

    J, rate_changes (m, n): changes of gap and rate of the independent rows by displacements
    """
    n = len(weights)
    if not len(J):
        return np.diag(1.0 / weights), np.zeros((n, n)), np.zeros((n, 0))
    U, s, V = np.linalg.svd(J / weights, full_matrices=True)
    m = len(s)
    tangent = V[m:].T / weights[:, None]
    by_rows = U.T @ (rate_changes @ tangent)
    opening_directions = (V[:m].T / s @ U.T) / weights[:, None]
    return tangent, -(V[:m].T @ (by_rows / s[:, None])) / weights[:, None], opening_directions


def find_pose_directions(
    layout: Layout, chosen_rows: Indices, J: Array, rate_changes: Array, weights: Array
) -> PoseDirections | None:
    """Return the displacements that pose constraints admit, where some of the independent rows (m,) constrain
    speeds.
    """
    holds_speeds = find_speed_rows(layout)[chosen_rows]
    if not holds_speeds.any():
        return None
    tangent, _, _ = find_admitted(J[~holds_speeds], rate_changes[~holds_speeds], weights)
    tangent = tangent[:, : len(weights) - int(np.sum(~holds_speeds))]
    needed = solve_least_squares(J / weights, -rate_changes @ tangent)
    return PoseDirections(tangent, needed / weights[:, None])


def find_body_motions(layout: Layout, poses: Table, turns: Array, shifts: Array) -> dict[str, Array]:
    """Return the positions of the bodies, their motions with the freedoms, and the mass matrix.

    turns, shifts (n_b, 3, n): angular velocities, and velocities of the joint points, per rate
    """
    names = ("twists", "attitudes", "centres", "arms", "omega", "velocities")
    parts: dict[str, list[Any]] = {name: [] for name in names}
    n = turns.shape[2]
    mass = np.zeros((n, n))
    for k, link in enumerate(layout.spanning.links):
        pose, body = poses[k], layout.mechanism.bodies[link.body]
        R, turn = pose["R"], turns[k]
        arm = R @ (body.center - layout.reference[k])
        shift = shifts[k] + cross_rows(turn.T, arm).T
        mass += body.mass * shift.T @ shift + turn.T @ (R @ body.inertia @ R.T) @ turn
        parts["twists"].append(np.concatenate([turn, shift]))
        parts["attitudes"].append(R)
        parts["centres"].append(pose["r"] + arm)
        parts["arms"].append(np.sqrt(arm @ arm))
        parts["omega"].append(pose["omega"])
        parts["velocities"].append(pose["v"] + cross_vectors(pose["omega"], arm))
    return {name: np.array(values) for name, values in parts.items()} | {"mass": mass}


# Shapes

AXES = ("x", "y", "z")
IN_PLANE = ("z", "dx", "dy")  # what is left in a scene that is declared planar


def make_coordinate_rows(layout: Layout, linear: LinearisedEquations) -> dict[str, Array]:
    """Return for each coordinate its row on the undriven freedoms, (n,)."""
    mechanism = layout.mechanism
    rows: dict[str, Array] = {}
    for joint in mechanism.joints:
        rows |= {f"{joint.name}.{name}": row for name, row in joint_rows(layout, linear, joint).items()}
    for k, link in enumerate(layout.spanning.links):
        if link.joint < 0:
            body = mechanism.bodies[link.body].name
            rows |= dict(zip((f"{body}.{a}" for a in AXES), linear.twists[k, :3], strict=True))
            rows |= dict(zip((f"{body}.d{a}" for a in AXES), linear.twists[k, 3:], strict=True))
    if mechanism.planar:
        rows = {name: row for name, row in rows.items() if len(end := name.split(".")[1]) > 2 or end in IN_PLANE}
    return rows


def joint_rows(layout: Layout, linear: LinearisedEquations, joint: Joint) -> dict[str, Array]:
    """Return the rows of one joint's coordinates."""
    kind = JOINTS[joint.kind]
    if kind.keeps_distance or kind.is_rigid:
        return {}
    to_twist, end = point_twist(layout, linear, joint.b, joint.q, None)
    carrier, _ = point_twist(layout, linear, joint.a, joint.p, end)
    turn, shift = to_twist[:3] - carrier[:3], to_twist[3:] - carrier[3:]
    axis = joint.axis if joint.a == GROUND else linear.attitudes[layout.place[joint.a]] @ joint.axis
    rows: dict[str, Array] = {}
    if "angle" in kind.coordinates:
        rows["angle"] = axis @ turn
    elif kind.is_ball_in_tree or kind.turns:
        rows |= dict(zip(AXES, turn, strict=True))
    if joint.path is not None:
        rows["travel"] = make_path_row(layout, joint, linear, shift)
    elif len(kind.shifts) == 1:
        rows["travel"] = axis @ shift
    elif kind.shifts:
        rows |= dict(zip((f"d{a}" for a in AXES), shift, strict=True))
    return rows


def make_path_row(layout: Layout, joint: Joint, linear: LinearisedEquations, shift: Array) -> Array:
    """Return the row of a path's parameter: a freedom of the tree or, where it was cut, r' . shift / |r'|^2."""
    k = next(k for k, freedom in enumerate(layout.mechanism.joints) if freedom.name == joint.name)
    if k in layout.counters:
        assert joint.path is not None
        slope = joint.path.evaluate(float(linear.state[layout.counters[k]]))[1]
        direction = slope if joint.a == GROUND else linear.attitudes[layout.place[joint.a]] @ slope
        return np.asarray(direction @ shift / (slope @ slope))
    freedom = next(f for f in layout.freedoms if (f.joint, f.quantity) == (k, "travel"))
    places = rate_indices(layout)
    return np.where(places[places >= 0] == freedom.u, 1.0, 0.0)


def point_twist(
    layout: Layout, linear: LinearisedEquations, body: int, point: Array, world_place: Array | None
) -> tuple[Array, Array]:
    """Return rotation and shift (6, n) of a body's point, or of the body's material at a world position, and that
    position.
    """
    n = linear.twists.shape[2]
    if body == GROUND:
        return np.zeros((6, n)), point if world_place is None else world_place
    k = layout.place[body]
    body_data = layout.mechanism.bodies[body]
    place = linear.centres[k] + linear.attitudes[k] @ (point - body_data.center) if world_place is None else world_place
    turn, shift = linear.twists[k, :3], linear.twists[k, 3:]
    return np.concatenate([turn, shift + np.cross(turn, place - linear.centres[k], axis=0)]), place
