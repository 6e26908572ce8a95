"""Compute the motion of points that expressions name from the kernel's body results."""

from __future__ import annotations

import numpy as np

from heuncli.multibody.mechanism.model import GROUND, NamedPoint
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import Table
from heuncli.scene.shapes.rotations import cross_rows

Jet = tuple[float, float, float]  # value, rate, second derivative


def point_motion(layout: Layout, point: NamedPoint, bodies: Table) -> list[dict[str, Jet]]:
    """Return a point's position and velocity components with their derivatives at each instant, by name; bodies (n_t,
    n_b).
    """
    if point.body == GROUND:
        place = np.tile(point.place, (len(bodies), 1))
        velocity = acceleration = np.zeros_like(place)
    else:
        index = layout.place[point.body]
        body_rows = bodies[:, index]
        arm = body_rows["R"] @ (point.place - layout.reference[index])
        swept = cross_rows(body_rows["omega"], arm)
        place, velocity = body_rows["r"] + arm, body_rows["v"] + swept
        acceleration = body_rows["a"] + layout.mechanism.gravity + cross_rows(body_rows["alpha"], arm)
        acceleration = np.nan_to_num(acceleration + cross_rows(body_rows["omega"], swept))
    x, v, a = (rows @ point.axes.T for rows in (place, velocity, acceleration))
    x = x + point.offset
    return [
        {name: (float(x[i, k]), float(v[i, k]), float(a[i, k])) for k, name in enumerate("xyz")}
        | {f"v{name}": (float(v[i, k]), float(a[i, k]), 0.0) for k, name in enumerate("xyz")}
        for i in range(len(bodies))
    ]
