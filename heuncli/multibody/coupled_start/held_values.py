"""What is held at the start besides the closure rows: given poses and velocities of bodies, coordinates of joints.

    J y = lack                     y the step of the freedoms, turns in rad, lengths by the scene's size

Driven coordinates are not among the freedoms. Given values are satisfied as assembled, and stay so.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.multibody.coupled_start.freedoms import FreedomMotion
from heuncli.multibody.mechanism.model import Assembly, Directed, Joint
from heuncli.multibody.tree.idle_spins import IdleSpin
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.starts import axial_angle, body_state
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import vector_from_rotation

Rows = tuple[Array, Array]  # (k, n) and what they lack (k,)


def held_poses(scene: PreparedScene, present: Assembly, motion: FreedomMotion) -> Iterator[Rows]:
    """Yield the rows that hold poses; present: where the bodies have moved to from the scene's start."""
    size, start = scene.layout.size, scene.start
    for i, body in enumerate(scene.mechanism.bodies):
        if body.rotation is not None:
            yield motion.turns[i], -vector_from_rotation(present.rotation[i] @ start.rotation[i].T)
        if body.position is not None:
            yield motion.v[i] / size, (start.position[i] - present.position[i]) / size
    for joint in scene.mechanism.joints:
        turning, sliding = _joint_rows(joint, present, motion, size)
        if joint.angle is not None:
            yield turning, np.array([-_turn_since_start(joint, start, present)])
        if joint.travel is not None:
            yield sliding, np.array([_travel(joint, start) - _travel(joint, present)]) / size


def held_rates(scene: PreparedScene, present: Assembly, motion: FreedomMotion) -> Iterator[Rows]:
    """Yield the rows that hold rates; present: the start with its present rates."""
    size = scene.layout.size
    for i, body in enumerate(scene.mechanism.bodies):
        if body.angular_velocity is not None:
            projection = _determined_projection(i, scene.idle_spins, present.rotation[i])
            yield (
                projection @ motion.turns[i],
                projection @ (_world_vector(body.angular_velocity, present.rotation[i]) - present.angular_velocity[i]),
            )
        if body.velocity is not None:
            yield motion.v[i] / size, (_world_vector(body.velocity, present.rotation[i]) - present.velocity[i]) / size
    for joint in scene.mechanism.joints:
        turning, sliding = _joint_rows(joint, present, motion, size)
        if joint.rate is not None:
            yield turning, np.array([joint.rate - _joint_rates(joint, present)[0]])
        if joint.speed is not None:
            yield sliding, np.array([joint.speed - _joint_rates(joint, present)[1]]) / size


def _joint_rows(joint: Joint, present: Assembly, motion: FreedomMotion, size: float) -> Rows:
    """Return how the freedoms turn a joint about its axis, and shift it along (by the size), (1, n) each."""
    xb, Rb, _, _ = body_state(present, joint.b)
    n, Q = body_state(present, joint.a)[1] @ joint.axis, xb + Rb @ joint.q
    turning = n @ (motion.body_rotations(joint.b) - motion.body_rotations(joint.a))
    sliding = (
        _travel_direction(joint, present)
        @ (motion.point_velocities(joint.b, Q) - motion.point_velocities(joint.a, Q))
        / size
    )
    return turning[None, :], sliding[None, :]


def _travel_direction(joint: Joint, present: Assembly) -> Array:
    """Return the gradient of the travel as the `to` point shifts in `from`, world axes (3,): the axis; for a path
    r'/r'^2.
    """
    R = body_state(present, joint.a)[1]
    if joint.path is None:
        return np.asarray(R @ joint.axis)
    slope = joint.path.evaluate(_travel(joint, present))[1]
    return np.asarray(R @ slope / float(slope @ slope))


def _joint_rates(joint: Joint, present: Assembly) -> tuple[float, float]:
    """Return the rate about a joint's axis, and the speed along it."""
    xa, Ra, va, wa = body_state(present, joint.a)
    xb, Rb, vb, wb = body_state(present, joint.b)
    Q = xb + Rb @ joint.q
    v = vb + np.cross(wb, Q - xb) - va - np.cross(wa, Q - xa)
    return float((Ra @ joint.axis) @ (wb - wa)), float(_travel_direction(joint, present) @ v)


def _turn_since_start(joint: Joint, start: Assembly, present: Assembly) -> float:
    """Angle by which a joint has turned about its axis since the start, in (-pi, pi]."""
    before, after = (
        body_state(assembly, joint.a)[1].T @ body_state(assembly, joint.b)[1] for assembly in (start, present)
    )
    return axial_angle(after @ before.T, joint.axis)


def _travel(joint: Joint, assembly: Assembly) -> float:
    """The travel of a joint; along a path on the branch that is held."""
    xa, Ra, _, _ = body_state(assembly, joint.a)
    xb, Rb, _, _ = body_state(assembly, joint.b)
    place = Ra.T @ (xb + Rb @ joint.q - xa) - joint.p
    if joint.path is None:
        return float(joint.axis @ place)
    return (
        float(joint.path.find_nearest(place)) if joint.travel is None else joint.path.find_nearby(place, joint.travel)
    )


def _world_vector(directed: Directed, R: Array) -> Array:
    return R @ directed.vector if directed.in_body else directed.vector


def _determined_projection(body: int, idle_spins: tuple[IdleSpin, ...], R: Array) -> Array:
    """Return the matrix that projects an angular velocity onto its determined part, (3, 3)."""
    axes = next((spin.axes @ R.T for spin in idle_spins if spin.body == body), np.zeros((0, 3)))
    return np.eye(3) - axes.T @ axes
