"""What is held at the start beside the closure rows: given poses and velocities of bodies, coordinates of joints.

    J y = lack                     y the step of the freedoms, turns in rad, lengths by the scene's size
Driven coordinates are none of the freedoms. What was given is met as assembled, and stays met.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.multibody.coupled_start.freedoms import FreedomMotion
from heuncli.multibody.mechanism.model import Assembly, Directed, Joint
from heuncli.multibody.tree.idle_spins import IdleSpin
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.starts import axial_angle, pose
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import to_vector

Rows = tuple[Array, Array]  # (k, n) and what they lack (k,)


def held_poses(scene: PreparedScene, now: Assembly, motion: FreedomMotion) -> Iterator[Rows]:
    """What holds poses; now: where the bodies have come to from the scene's start."""
    size, start = scene.layout.size, scene.start
    for i, body in enumerate(scene.mechanism.bodies):
        if body.rotation is not None:
            yield motion.turns[i], -to_vector(now.rotation[i] @ start.rotation[i].T)
        if body.position is not None:
            yield motion.v[i] / size, (start.position[i] - now.position[i]) / size
    for joint in scene.mechanism.joints:
        turning, sliding = _along(joint, now, motion, size)
        if joint.angle is not None:
            yield turning, np.array([-_turned(joint, start, now)])
        if joint.travel is not None:
            yield sliding, np.array([_travel(joint, start) - _travel(joint, now)]) / size


def held_rates(scene: PreparedScene, now: Assembly, motion: FreedomMotion) -> Iterator[Rows]:
    """What holds rates; now: as all moves."""
    size = scene.layout.size
    for i, body in enumerate(scene.mechanism.bodies):
        if body.angular_velocity is not None:
            seen = _determined(i, scene.idle, now.rotation[i])
            yield (
                seen @ motion.turns[i],
                seen @ (_world(body.angular_velocity, now.rotation[i]) - now.angular_velocity[i]),
            )
        if body.velocity is not None:
            yield motion.v[i] / size, (_world(body.velocity, now.rotation[i]) - now.velocity[i]) / size
    for joint in scene.mechanism.joints:
        turning, sliding = _along(joint, now, motion, size)
        if joint.rate is not None:
            yield turning, np.array([joint.rate - _rates(joint, now)[0]])
        if joint.speed is not None:
            yield sliding, np.array([joint.speed - _rates(joint, now)[1]]) / size


def _along(joint: Joint, now: Assembly, motion: FreedomMotion, size: float) -> Rows:
    """How the freedoms turn a joint about its axis, and shift it along (by the size), (1, n) each."""
    xb, Rb, _, _ = pose(now, joint.b)
    n, Q = pose(now, joint.a)[1] @ joint.axis, xb + Rb @ joint.q
    turning = n @ (motion.of_turn(joint.b) - motion.of_turn(joint.a))
    sliding = _way(joint, now) @ (motion.of_point(joint.b, Q) - motion.of_point(joint.a, Q)) / size
    return turning[None, :], sliding[None, :]


def _way(joint: Joint, now: Assembly) -> Array:
    """What the travel grows by as the `to` point shifts in `from`, world axes (3,): the axis; of a path r'/r'^2."""
    R = pose(now, joint.a)[1]
    if joint.path is None:
        return np.asarray(R @ joint.axis)
    slope = joint.path.at(_travel(joint, now))[1]
    return np.asarray(R @ slope / float(slope @ slope))


def _rates(joint: Joint, now: Assembly) -> tuple[float, float]:
    """The rate about a joint's axis, and the speed along it."""
    xa, Ra, va, wa = pose(now, joint.a)
    xb, Rb, vb, wb = pose(now, joint.b)
    Q = xb + Rb @ joint.q
    v = vb + np.cross(wb, Q - xb) - va - np.cross(wa, Q - xa)
    return float((Ra @ joint.axis) @ (wb - wa)), float(_way(joint, now) @ v)


def _turned(joint: Joint, start: Assembly, now: Assembly) -> float:
    """By how much a joint has turned about its axis since the start, in (-pi, pi]."""
    before, after = (pose(at, joint.a)[1].T @ pose(at, joint.b)[1] for at in (start, now))
    return axial_angle(after @ before.T, joint.axis)


def _travel(joint: Joint, at: Assembly) -> float:
    """The travel; along a path on the branch that is held."""
    xa, Ra, _, _ = pose(at, joint.a)
    xb, Rb, _, _ = pose(at, joint.b)
    place = Ra.T @ (xb + Rb @ joint.q - xa) - joint.p
    if joint.path is None:
        return float(joint.axis @ place)
    return float(joint.path.nearest(place)) if joint.travel is None else joint.path.near(place, joint.travel)


def _world(given: Directed, R: Array) -> Array:
    return R @ given.vector if given.in_body else given.vector


def _determined(body: int, idle: tuple[IdleSpin, ...], R: Array) -> Array:
    """Projects an angular velocity onto what is determined of it, (3, 3)."""
    axes = next((spin.axes @ R.T for spin in idle if spin.body == body), np.zeros((0, 3)))
    return np.eye(3) - axes.T @ axes
