"""The size of a scene, to which errors are relative, and the points that represent a body's extent."""

from __future__ import annotations

import math

import numpy as np

from heuncli.base import tolerances
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Assembly, Body, Mechanism
from heuncli.results.results import Array


def scene_size(mechanism: Mechanism, start: Assembly) -> float:
    """Twice the largest distance of the bodies' extent points and the ground's joint points from their mean [m]; 1 if
    all coincide.
    """
    places = [
        start.position[i] + start.rotation[i] @ p
        for i, body in enumerate(mechanism.bodies)
        for p in extent_points(body)
    ]
    places += [j.p for j in mechanism.joints if j.a == GROUND] + [j.q for j in mechanism.joints if j.b == GROUND]
    x = np.array(places)
    reach = 2.0 * float(np.sqrt(np.max(np.sum(np.square(x - x.mean(axis=0)), axis=1))))
    return reach if reach > tolerances.ONE_PLACE * float(np.max(np.abs(x), initial=0.0)) else 1.0


def extent_points(body: Body) -> list[Array]:
    """Return points that represent a body's extent: its centre of mass and its named points, body axes.

    Where none of them is as far from the centre as the radius of gyration, points at that distance along the axes are
    added.
    """
    points = [body.center, *body.points.values()]
    gyration = math.sqrt(max(float(np.trace(body.inertia)), 0.0) / (2.0 * body.mass))
    if max(x * x + y * y + z * z for x, y, z in (np.array(points) - body.center).tolist()) < gyration**2:
        points += [body.center + gyration * e for e in np.eye(3)]
    return points
