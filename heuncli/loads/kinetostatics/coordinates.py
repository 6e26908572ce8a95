"""Coordinates of the joints, and the motion of named points."""

from __future__ import annotations

import numpy as np

from heuncli.base.joint_kinds import JOINTS
from heuncli.loads.kinetostatics.bodies import BodyStates, place_beside
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.mechanism.model import Joint, Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Block
from heuncli.scene.shapes.rotations import cross_rows


def coordinates(layout: Layout, recovered: Recovered, states: BodyStates) -> Block:
    """angle, rate, acceleration of pins; travel, speed, acceleration of slides; both of cylinders."""
    block: Block = {}
    for k, joint in enumerate(layout.mechanism.joints):
        kind = JOINTS[joint.kind]
        if "angle" in kind.coordinates:
            block[joint.name] = _turning(layout, recovered, states, k, joint)
        if kind.follows_path:
            block[joint.name] = _along_path(layout, recovered, states, k)
        elif "travel" in kind.coordinates:
            travel = _sliding(states, joint)
            if joint.name in block:
                block[joint.name]["angular_acceleration"] = block[joint.name].pop("acceleration")
            block[joint.name] = block.get(joint.name, {}) | travel
    return block


def _turning(layout: Layout, recovered: Recovered, states: BodyStates, k: int, joint: Joint) -> Block:
    n = states.direction(joint.a, joint.axis)
    zero = np.zeros_like(n)
    wa, ua = (states.omega[:, joint.a], states.alpha[:, joint.a]) if joint.a >= 0 else (zero, zero)
    wb, ub = (states.omega[:, joint.b], states.alpha[:, joint.b]) if joint.b >= 0 else (zero, zero)
    rate = np.sum(n * (wb - wa), axis=1)
    # d/dt [n.(w_b - w_a)] = n.(u_b - u_a) + (w_a x n).(w_b - w_a); the second term is 0, for w_b - w_a is along n
    acceleration = np.sum(n * (ub - ua), axis=1)
    counted = next((i for i, f in enumerate(layout.freedoms) if f.joint == k), None)
    if counted is not None:
        return {"angle": recovered.freedoms["q"][:, counted], "rate": rate, "acceleration": acceleration}
    # a cut joint: the angle of the pose, in the revolution nearest to the angle that was integrated
    Ra = states.R[:, joint.a] if joint.a >= 0 else np.broadcast_to(np.eye(3), (len(n), 3, 3))
    Rb = states.R[:, joint.b] if joint.b >= 0 else np.broadcast_to(np.eye(3), (len(n), 3, 3))
    Q = np.einsum("tji,tjk,lk->til", Ra, Rb, layout.starts[k].R_ref)
    a = joint.axis
    skew = np.stack([Q[:, 2, 1] - Q[:, 1, 2], Q[:, 0, 2] - Q[:, 2, 0], Q[:, 1, 0] - Q[:, 0, 1]], axis=1)
    sine = 0.5 * (skew @ a)
    angle = np.arctan2(sine, 0.5 * (np.trace(Q, axis1=1, axis2=2) - 1.0))
    near = recovered.states[:, layout.counters[k]]
    return {
        "angle": angle + 2.0 * np.pi * np.round((near - angle) / (2.0 * np.pi)),
        "rate": rate,
        "acceleration": acceleration,
    }


def _along_path(layout: Layout, recovered: Recovered, states: BodyStates, k: int) -> Block:
    """The path's parameter: a freedom of the tree, or what follows from the pose."""
    if k in layout.counters:
        return dict(zip(("travel", "speed", "acceleration"), place_beside(layout, recovered, states, k), strict=True))
    own = next(i for i, f in enumerate(layout.freedoms) if (f.joint, f.quantity) == (k, "travel"))
    found = recovered.freedoms
    return {"travel": found["q"][:, own], "speed": found["u"][:, own], "acceleration": found["udot"][:, own]}


def _sliding(states: BodyStates, joint: Joint) -> Block:
    n = states.direction(joint.a, joint.axis)
    Q = states.point_position(joint.b, joint.q)
    v = states.velocity(joint.b, Q) - states.velocity(joint.a, Q)
    w = states.omega[:, joint.a] if joint.a >= 0 else np.zeros_like(n)
    a = states.acceleration(joint.b, Q) - states.acceleration(joint.a, Q) - 2.0 * cross_rows(w, v)
    D = Q - states.point_position(joint.a, joint.p)

    def along(x: Array) -> Array:
        component: Array = np.sum(n * x, axis=1)
        return component

    return {"travel": along(D), "speed": along(v), "acceleration": along(a)}


def points(mechanism: Mechanism, states: BodyStates) -> Block:
    """Position, velocity and acceleration of every named point of a body."""
    block: Block = {}
    for i, body in enumerate(mechanism.bodies):
        for name, p in body.points.items():
            position = states.point_position(i, p)
            block[f"{body.name}.{name}"] = {
                "position": position,
                "velocity": states.velocity(i, position),
                "acceleration": states.acceleration(i, position),
            }
    return block
