"""Spins that no law determines: thin rods and point masses held and loaded on their own axis only.

Balls hold no spin, other joints none about an axis of theirs, but where they tell its angle it has to be determined.
Such a spin is harmless: accelerations and reactions do not depend on it (manual/theory.md, "Thin rods"). For the motion
the body is given some inertia about that axis and no spin; a moment about it would have no answer and is looked for
afterwards.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record
from heuncli.multibody.mechanism.model import Body, Mechanism, PointLoad
from heuncli.results.results import Array

Z = np.array([0.0, 0.0, 1.0])


@record
class IdleSpin:
    """A body's axes (body components, (k, 3), k = 1 or 3) of undetermined spin, and the inertia lent to it."""

    body: int
    axes: Array
    lent: Array


def idle_spins(mechanism: Mechanism, size: float) -> list[IdleSpin]:
    """The bodies with an undetermined spin."""
    points, free = attachments(mechanism)
    found = []
    for i, body in enumerate(mechanism.bodies):
        null, largest = without_inertia(body, size)
        for axis in free.get(i, ()):
            along = len(null) and float(np.sum(np.square(null @ axis))) >= tolerances.ALONG_SQUARED
            null = axis[None, :] if along else null[:0]
        if i not in free or not len(null):
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


def attachments(mechanism: Mechanism) -> tuple[dict[int, list[Array]], dict[int, list[Array]]]:
    """Of each body the points where joints and forces act, and the only axes about which its joints let it turn.

    A body that a joint holds altogether has no entry among the axes, one on balls alone an empty one. Body axes.
    """
    points: dict[int, list[Array]] = {i: [] for i in range(len(mechanism.bodies))}
    free: dict[int, list[Array]] = {i: [] for i in range(len(mechanism.bodies))}
    for joint in mechanism.joints:
        kind = JOINTS[joint.kind]
        for end, point, axis in ((joint.a, joint.p, joint.axis), (joint.b, joint.q, joint.to_axis)):
            if end < 0:
                continue
            points[end].append(point)
            if kind.wanders and end == joint.a:
                free.pop(end, None)
            elif kind.turns and "angle" not in kind.coordinates and end in free:
                free[end].append(Z if kind.turns == ("z",) else axis)
            elif not kind.ball:
                free.pop(end, None)
    for load in mechanism.loads:
        if isinstance(load, PointLoad) and load.kind == "couple":
            continue
        for end, point in load.points:
            if end >= 0:
                points[end].append(point)
    for coupling in mechanism.couplings:
        for part in (part for row in coupling.carriers for part in row.parts if part.turns_its_bodies):
            free.pop(part.a, None)
            free.pop(part.b, None)
    for named in mechanism.points.values():
        if named.body >= 0:
            points[named.body].append(named.place)
    return points, free


def without_inertia(body: Body, size: float) -> tuple[Array, float]:
    """The principal axes about which a body has no inertia (body components, (k, 3)); its largest moment of inertia."""
    scale = max(float(np.trace(body.inertia)), tolerances.POINT_MASS * body.mass * size * size)
    moments, axes = np.linalg.eigh(body.inertia)
    return axes[:, moments <= tolerances.NO_INERTIA * scale].T, float(moments[-1])
