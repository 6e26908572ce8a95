"""Spins that no law determines: thin rods and point masses held and loaded on their own axis only.

Such a spin is harmless: accelerations and reactions do not depend on it (theory.md section 3). For the motion the body
is given some inertia about that axis and no spin; a moment about it would have no answer and is looked for afterwards.
"""

from __future__ import annotations

import numpy as np

from heuncli import tolerances
from heuncli.joint_kinds import JOINTS
from heuncli.mechanism.model import Body, Mechanism, PointLoad
from heuncli.records import record
from heuncli.results import Array


@record
class IdleSpin:
    """A body's axes (body components, (k, 3), k = 1 or 3) of undetermined spin, and the inertia lent to it."""

    body: int
    axes: Array
    lent: Array


def idle_spins(mechanism: Mechanism, size: float) -> list[IdleSpin]:
    """The bodies with an undetermined spin."""
    points: dict[int, list[Array]] = {i: [] for i in range(len(mechanism.bodies))}
    held = set()
    for joint in mechanism.joints:
        for end, point in ((joint.a, joint.p), (joint.b, joint.q)):
            if end >= 0:
                points[end].append(point)
                kind = JOINTS[joint.kind]
                if not kind.ball or (kind.wanders and end == joint.a):
                    held.add(end)
    for load in mechanism.loads:
        if isinstance(load, PointLoad) and load.kind == "couple":
            continue
        for end, point in load.points:
            if end >= 0:
                points[end].append(point)
    found = []
    for i, body in enumerate(mechanism.bodies):
        if i in held:
            continue
        null, largest = without_inertia(body, size)
        if not len(null):
            continue
        arms = [p - body.center for p in points[i]]
        far = max(arms, key=lambda d: float(d @ d), default=np.zeros(3))
        reach = float(np.sqrt(far @ far))
        if reach > tolerances.ON_AXIS * size:
            n = far / reach
            off = max(float(np.sqrt(np.sum(np.square(d - (d @ n) * n)))) for d in arms)
            if off > tolerances.ON_AXIS * size or np.sum(np.square(null @ n)) < tolerances.ALONG_SQUARED:
                continue
            null = n[None, :]
        lent = max(largest, body.mass * max(reach, tolerances.LENT_REACH * size) ** 2)
        found.append(IdleSpin(i, null, lent * null.T @ null))
    return found


def without_inertia(body: Body, size: float) -> tuple[Array, float]:
    """The principal axes about which a body has no inertia (body components, (k, 3)); its largest moment of inertia."""
    scale = max(float(np.trace(body.inertia)), tolerances.POINT_MASS * body.mass * size * size)
    moments, axes = np.linalg.eigh(body.inertia)
    return axes[:, moments <= tolerances.NO_INERTIA * scale].T, float(moments[-1])
