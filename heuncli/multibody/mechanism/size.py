"""The size of a scene, which errors are relative to, and the points that stand for a body's extent."""

from __future__ import annotations

import math

import numpy as np

from heuncli.base import tolerances
from heuncli.multibody.mechanism.model import GROUND, Assembly, Body, Mechanism
from heuncli.results.results import Array


def size_of_scene(mechanism: Mechanism, start: Assembly) -> float:
    """Twice the largest distance of bodies' marks and the ground's joint points from their mean [m]; one place: 1."""
    places = [start.position[i] + start.rotation[i] @ p for i, body in enumerate(mechanism.bodies) for p in marks(body)]
    places += [j.p for j in mechanism.joints if j.a == GROUND] + [j.q for j in mechanism.joints if j.b == GROUND]
    x = np.array(places)
    reach = 2.0 * float(np.sqrt(np.max(np.sum(np.square(x - x.mean(axis=0)), axis=1))))
    return reach if reach > tolerances.ONE_PLACE * float(np.max(np.abs(x), initial=0.0)) else 1.0


def marks(body: Body) -> list[Array]:
    """Points that stand for a body's extent: its centre of mass and its named ones, body axes.

    Where none of them is as far from the centre as the radius of gyration, points so far along the axes stand for its
    extent.
    """
    found = [body.center, *body.points.values()]
    gyration = math.sqrt(max(float(np.trace(body.inertia)), 0.0) / (2.0 * body.mass))
    if max(x * x + y * y + z * z for x, y, z in (np.array(found) - body.center).tolist()) < gyration**2:
        found += [body.center + gyration * e for e in np.eye(3)]
    return found
