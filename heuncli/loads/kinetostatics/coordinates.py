"""Compute the coordinates of the joints, and the motion of named points."""

from __future__ import annotations

import numpy as np

from heuncli.base.joint_kinds import JOINTS
from heuncli.loads.kinetostatics.bodies import BodyStates, find_path_place
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.model import Joint, Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Block
from heuncli.scene.shapes.rotations import cross_rows


def evaluate_joint_coordinates(layout: Layout, evaluation: Evaluation, states: BodyStates) -> Block:
    """Return angle, rate, acceleration of pins; travel, speed, acceleration of slides; both of cylinders."""
    block: Block = {}
    for k, joint in enumerate(layout.mechanism.joints):
        kind = JOINTS[joint.kind]
        if "angle" in kind.coordinates:
            block[joint.name] = _rotation(layout, evaluation, states, k, joint)
        if kind.follows_path:
            block[joint.name] = _path_motion(layout, evaluation, states, k)
        elif "travel" in kind.coordinates:
            travel = _translation(states, joint)
            if joint.name in block:
                block[joint.name]["angular_acceleration"] = block[joint.name].pop("acceleration")
            block[joint.name] = block.get(joint.name, {}) | travel
    return block


def _rotation(layout: Layout, evaluation: Evaluation, states: BodyStates, k: int, joint: Joint) -> Block:
    n = states.world_direction(joint.a, joint.axis)
    zero = np.zeros_like(n)
    wa, ua = (states.omega[:, joint.a], states.alpha[:, joint.a]) if joint.a >= 0 else (zero, zero)
    wb, ub = (states.omega[:, joint.b], states.alpha[:, joint.b]) if joint.b >= 0 else (zero, zero)
    rate = np.sum(n * (wb - wa), axis=1)
    # d/dt [n.(w_b - w_a)] = n.(u_b - u_a) + (w_a x n).(w_b - w_a); the second term is 0, for w_b - w_a is along n
    acceleration = np.sum(n * (ub - ua), axis=1)
    freedom_index = next((i for i, f in enumerate(layout.freedoms) if f.joint == k), None)
    if freedom_index is not None:
        return {"angle": evaluation.freedoms["q"][:, freedom_index], "rate": rate, "acceleration": acceleration}
    # a cut joint: the angle of the pose, in the revolution nearest to the angle that was integrated
    Ra = states.R[:, joint.a] if joint.a >= 0 else np.broadcast_to(np.eye(3), (len(n), 3, 3))
    Rb = states.R[:, joint.b] if joint.b >= 0 else np.broadcast_to(np.eye(3), (len(n), 3, 3))
    Q = np.einsum("tji,tjk,lk->til", Ra, Rb, layout.starts[k].R_ref)
    a = joint.axis
    skew = np.stack([Q[:, 2, 1] - Q[:, 1, 2], Q[:, 0, 2] - Q[:, 2, 0], Q[:, 1, 0] - Q[:, 0, 1]], axis=1)
    sine = 0.5 * (skew @ a)
    angle = np.arctan2(sine, 0.5 * (np.trace(Q, axis1=1, axis2=2) - 1.0))
    integrated_angle = evaluation.states[:, layout.counters[k]]
    return {
        "angle": angle + 2.0 * np.pi * np.round((integrated_angle - angle) / (2.0 * np.pi)),
        "rate": rate,
        "acceleration": acceleration,
    }


def _path_motion(layout: Layout, evaluation: Evaluation, states: BodyStates, k: int) -> Block:
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


def _translation(states: BodyStates, joint: Joint) -> Block:
    n = states.world_direction(joint.a, joint.axis)
    Q = states.point_position(joint.b, joint.q)
    v = states.point_velocity(joint.b, Q) - states.point_velocity(joint.a, Q)
    w = states.omega[:, joint.a] if joint.a >= 0 else np.zeros_like(n)
    a = states.point_acceleration(joint.b, Q) - states.point_acceleration(joint.a, Q) - 2.0 * cross_rows(w, v)
    D = Q - states.point_position(joint.a, joint.p)

    def axial(x: Array) -> Array:
        component: Array = np.sum(n * x, axis=1)
        return component

    return {"travel": axial(D), "speed": axial(v), "acceleration": axial(a)}


def point_motions(mechanism: Mechanism, states: BodyStates) -> Block:
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
