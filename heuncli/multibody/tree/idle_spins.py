"""Find spins that no law determines: of thin rods and point masses that are held and loaded on their own axis only.

A ball joint leaves the spin about such an axis free, and so does any joint that turns about it. If a joint measures
that angle, however, the spin must be determined, and is not idle. An idle spin is harmless: accelerations and reactions
do not depend on it (manual/theory.md, "Thin rods"). For the motion the body gets an artificial inertia about the axis
and no spin. A moment about the axis would leave no solution; that is checked afterwards.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record
from heuncli.multibody.mechanism.loads import PointLoad
from heuncli.multibody.mechanism.model import Body, Mechanism
from heuncli.results.results import Array

Z = np.array([0.0, 0.0, 1.0])


@record
class IdleSpin:
    """A body's axes (body components, (k, 3), k = 1 or 3) of undetermined spin, and its artificial inertia."""

    body: int
    axes: Array
    artificial_inertia: Array


def find_idle_spins(mechanism: Mechanism, size: float) -> list[IdleSpin]:
    """Find the bodies with an undetermined spin."""
    points, free = find_attachments(mechanism)
    spins = []
    for i, axes in free.items():
        body = mechanism.bodies[i]
        null, largest = find_massless_axes(body, size)
        for axis in axes:
            along = len(null) and float(np.sum(np.square(null @ axis))) >= tolerances.ALONG_SQUARED
            null = axis[None, :] if along else null[:0]
        if not len(null):
            continue
        arms = [p - body.center for p in points[i]]
        farthest = max(arms, key=lambda d: float(d @ d), default=np.zeros(3))
        reach = float(np.sqrt(farthest @ farthest))
        if reach > tolerances.ON_AXIS * size:
            n = farthest / reach
            distance = max(float(np.sqrt(np.sum(np.square(d - (d @ n) * n)))) for d in arms)
            if distance > tolerances.ON_AXIS * size or np.sum(np.square(null @ n)) < tolerances.ALONG_SQUARED:
                continue
            null = n[None, :]
        moment = max(largest, body.mass * max(reach, tolerances.ARTIFICIAL_RADIUS * size) ** 2)
        spins.append(IdleSpin(i, null, moment * null.T @ null))
    return spins


def find_attachments(mechanism: Mechanism) -> tuple[dict[int, list[Array]], dict[int, list[Array]]]:
    """Return for each body the points where joints and forces act, and the only axes about which its joints let it
    turn.

    A body whose rotation a joint holds has no entry among the axes, one on balls alone an empty entry. Body axes.
    """
    points: dict[int, list[Array]] = {i: [] for i in range(len(mechanism.bodies))}
    free: dict[int, list[Array]] = {i: [] for i in range(len(mechanism.bodies))}
    for joint in mechanism.joints:
        kind = JOINTS[joint.kind]
        for end, point, axis in ((joint.a, joint.p, joint.axis), (joint.b, joint.q, joint.to_axis)):
            if end < 0:
                continue
            points[end].append(point)
            if kind.has_moving_contact and end == joint.a:
                free.pop(end, None)
            elif kind.turns and "angle" not in kind.coordinates and end in free:
                free[end].append(Z if kind.turns == ("z",) else axis)
            elif not kind.is_ball:
                free.pop(end, None)
    for load in mechanism.loads:
        if isinstance(load, PointLoad) and load.is_couple:
            continue
        for end, point in load.points:
            if end >= 0:
                points[end].append(point)
    for coupling in mechanism.couplings:
        for part in (part for row in coupling.loading_rows for part in row.parts if part.constrains_rotation):
            free.pop(part.a, None)
            free.pop(part.b, None)
    for named_point in mechanism.points.values():
        if named_point.body >= 0:
            points[named_point.body].append(named_point.place)
    return points, free


def find_massless_axes(body: Body, size: float) -> tuple[Array, float]:
    """Return the principal axes about which a body has no inertia (body components, (k, 3)), and its largest moment of
    inertia.
    """
    scale = max(float(np.trace(body.inertia)), tolerances.POINT_MASS * body.mass * size * size)
    moments, axes = np.linalg.eigh(body.inertia)
    return axes[:, moments <= tolerances.NO_INERTIA * scale].T, float(moments[-1])
