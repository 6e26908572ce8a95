"""Compute the coordinates of the joints, the motion of named points, and attitudes that are continuous over turns.

Of unit quaternions (w, x, y, z) q and -q are one attitude. A rotation matrix shows neither the sign nor how often a
body has turned; the state does, with the angles of its joints and the quaternions of its ball joints. So the
quaternions are products along the tree,

    q = q_parent * (cos phi/2, n sin phi/2) * frame * ...

and a body that turns by 360 degrees comes to -q. At the start of a run w >= 0, whatever instants are requested.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.kernel.choose import scene as kernel
from heuncli.loads.kinetostatics.bodies import BodyStates, find_path_place
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.model import Joint, Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import vector_array
from heuncli.results.results import Array, Block
from heuncli.scene.shapes.rotations import cross_rows, quaternion_from_matrix, quaternion_product, quaternions_about

# Coordinates


def evaluate_joint_coordinates(layout: Layout, evaluation: Evaluation, states: BodyStates) -> Block:
    """Return angle, rate, acceleration of pins; travel, speed, acceleration of slides; both of cylinders."""
    block: Block = {}
    for k, joint in enumerate(layout.mechanism.joints):
        kind = JOINTS[joint.kind]
        if "angle" in kind.coordinates:
            block[joint.name] = _evaluate_rotation(layout, evaluation, states, k, joint)
        if kind.follows_path:
            block[joint.name] = _evaluate_path_motion(layout, evaluation, states, k)
        elif "travel" in kind.coordinates:
            travel = _evaluate_translation(states, joint)
            if joint.name in block:
                block[joint.name]["angular_acceleration"] = block[joint.name].pop("acceleration")
            block[joint.name] = block.get(joint.name, {}) | travel
    return block


def _evaluate_rotation(layout: Layout, evaluation: Evaluation, states: BodyStates, k: int, joint: Joint) -> Block:
    """Return angle, rate and acceleration of a joint about its axis."""
    n = states.world_direction(joint.a, joint.axis)
    zero = np.zeros_like(n)
    wa, ua = (states.omega[:, joint.a], states.alpha[:, joint.a]) if joint.a >= 0 else (zero, zero)
    wb, ub = (states.omega[:, joint.b], states.alpha[:, joint.b]) if joint.b >= 0 else (zero, zero)
    freedom_index = next((i for i, f in enumerate(layout.freedoms) if f.joint == k), None)
    return {
        "angle": (
            _find_cut_angle(layout, evaluation, states, k, joint)
            if freedom_index is None
            else evaluation.freedoms["q"][:, freedom_index]
        ),
        "rate": np.sum(n * (wb - wa), axis=1),
        # d/dt [n.(w_b - w_a)] = n.(u_b - u_a) + (w_a x n).(w_b - w_a); the second term is 0, for w_b - w_a is along n
        "acceleration": np.sum(n * (ub - ua), axis=1),
    }


def _find_cut_angle(layout: Layout, evaluation: Evaluation, states: BodyStates, k: int, joint: Joint) -> Array:
    """Return the angle of a cut joint: that of the pose, in the revolution nearest to the angle that was integrated."""
    identity = np.broadcast_to(np.eye(3), (len(states.R), 3, 3))
    Ra, Rb = (states.R[:, body] if body >= 0 else identity for body in (joint.a, joint.b))
    Q = np.einsum("tji,tjk,lk->til", Ra, Rb, layout.starts[k].R_ref)
    skew = np.stack([Q[:, 2, 1] - Q[:, 1, 2], Q[:, 0, 2] - Q[:, 2, 0], Q[:, 1, 0] - Q[:, 0, 1]], axis=1)
    sine = 0.5 * (skew @ joint.axis)
    angle = np.arctan2(sine, 0.5 * (np.trace(Q, axis1=1, axis2=2) - 1.0))
    integrated_angle = evaluation.states[:, layout.counters[k]]
    return np.asarray(angle + 2.0 * np.pi * np.round((integrated_angle - angle) / (2.0 * np.pi)))


def _evaluate_path_motion(layout: Layout, evaluation: Evaluation, states: BodyStates, k: int) -> Block:
    """Return the path's parameter and its rates: a freedom of the tree, or computed from the pose."""
    if k in layout.counters:
        return dict(
            zip(("travel", "speed", "acceleration"), find_path_place(layout, evaluation, states, k), strict=True)
        )
    freedom_index = next(i for i, f in enumerate(layout.freedoms) if (f.joint, f.quantity) == (k, "travel"))
    freedoms = evaluation.freedoms
    return {
        "travel": freedoms["q"][:, freedom_index],
        "speed": freedoms["u"][:, freedom_index],
        "acceleration": freedoms["udot"][:, freedom_index],
    }


def _evaluate_translation(states: BodyStates, joint: Joint) -> Block:
    """Return travel, speed and acceleration of a joint along its axis, relative to its `from` body."""
    n = states.world_direction(joint.a, joint.axis)
    Q = states.point_position(joint.b, joint.q)
    v = states.point_velocity(joint.b, Q) - states.point_velocity(joint.a, Q)
    w = states.omega[:, joint.a] if joint.a >= 0 else np.zeros_like(n)
    a = states.point_acceleration(joint.b, Q) - states.point_acceleration(joint.a, Q) - 2.0 * cross_rows(w, v)
    D = Q - states.point_position(joint.a, joint.p)

    return {name: np.sum(n * vector, axis=1) for name, vector in (("travel", D), ("speed", v), ("acceleration", a))}


def evaluate_point_motions(mechanism: Mechanism, states: BodyStates) -> Block:
    """Return position, velocity and acceleration of every named point of a body."""
    block: Block = {}
    for i, body in enumerate(mechanism.bodies):
        for name, p in body.points.items():
            position = states.point_position(i, p)
            block[f"{body.name}.{name}"] = {
                "position": position,
                "velocity": states.point_velocity(i, position),
                "acceleration": states.point_acceleration(i, position),
            }
    return block


# Attitudes


def find_body_quaternions(layout: Layout, evaluation: Evaluation) -> Array:
    """Return the quaternions of all bodies in the order of the spec, (n_t, n, 4)."""
    angles = np.concatenate([find_start_angles(layout)[None], evaluation.freedoms["q"]])
    states = np.concatenate([layout.y0[None], evaluation.states])
    tree_quaternions = multiply_along_tree(layout, angles, states)
    start, later = tree_quaternions[0], tree_quaternions[1:]
    is_nonzero = np.abs(start) > tolerances.ZERO_COMPONENT
    first = np.argmax(is_nonzero, axis=1)  # half a turn has w = 0, but for rounding
    signs = np.sign(start[np.arange(len(start)), first])
    return np.asarray((later * signs[:, None])[:, [layout.place[i] for i in range(len(layout.bodies))]])


def find_rodrigues_vectors(q: Array) -> Array:
    """Return Rodrigues vectors tan(half the turn) n = (x, y, z) / w of quaternions (..., 4); nan close to half a
    turn.
    """
    w = np.where(np.abs(q[..., :1]) < tolerances.HALF_TURN, np.nan, q[..., :1])
    return np.asarray(q[..., 1:] / w)


def find_start_angles(layout: Layout) -> Array:
    """Return the coordinates of the freedoms at the start, (n,), as far as they are rotations."""
    driven = [layout.starts[freedom.joint].angle if freedom.q < 0 else 0.0 for freedom in layout.freedoms]
    places = np.array([freedom.q for freedom in layout.freedoms], dtype=int)
    return np.where(places >= 0, layout.y0[places], driven) if len(places) else np.zeros(0)


def multiply_along_tree(layout: Layout, angles: Array, states: Array) -> Array:
    """Return the quaternions of the bodies in tree order, (n_t, n, 4), at angles (n_t, freedoms) and states (n_t,
    n_state).
    """
    bodies, freedoms = layout.bodies, layout.tables["freedoms"]
    axes, kinds = vector_array(freedoms["direction"]), freedoms["kind"]
    result = np.zeros((len(states), len(bodies), 4))
    for i, body in enumerate(bodies):
        if body["ball"]:
            q = states[:, body["attitude_at"] :][:, :4]
        else:
            q = result[:, body["parent"]] if body["parent"] >= 0 else np.array([[1.0, 0.0, 0.0, 0.0]])
            body_freedoms = range(body["first_freedom"], body["end_freedom"])
            for k in (k for k in body_freedoms if kinds[k] == kernel.TURN_IN_PARENT):
                q = quaternion_product(q, quaternions_about(axes[k], angles[:, k]))
            if body["has_frame"]:
                q = quaternion_product(q, quaternion_from_matrix(np.reshape(body["frame"].tolist(), (3, 3)))[None])
            for k in (k for k in body_freedoms if kinds[k] == kernel.TURN_IN_BODY):
                q = quaternion_product(q, quaternions_about(axes[k], angles[:, k]))
        result[:, i] = q / np.sqrt(np.sum(q * q, axis=1))[:, None]
    return result
