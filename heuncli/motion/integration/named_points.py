"""The motion of points that expressions name, from what the kernel tells of the bodies."""

from __future__ import annotations

import numpy as np

from heuncli.multibody.mechanism.model import GROUND, NamedPoint
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import Table
from heuncli.scene.shapes.rotations import cross_rows

Jet = tuple[float, float, float]  # value, rate, second derivative


def motion_of(layout: Layout, point: NamedPoint, bodies: Table) -> list[dict[str, Jet]]:
    """A point's places and velocities at instants, as they go on from there, by their names; bodies (n_t, n_b)."""
    if point.body == GROUND:
        place = np.tile(point.place, (len(bodies), 1))
        velocity = acceleration = np.zeros_like(place)
    else:
        at = layout.place[point.body]
        own = bodies[:, at]
        arm = own["R"] @ (point.place - layout.reference[at])
        swept = cross_rows(own["omega"], arm)
        place, velocity = own["r"] + arm, own["v"] + swept
        acceleration = own["a"] + layout.mechanism.gravity + cross_rows(own["alpha"], arm)
        acceleration = np.nan_to_num(acceleration + cross_rows(own["omega"], swept))
    x, v, a = (rows @ point.axes.T for rows in (place, velocity, acceleration))
    x = x + point.offset
    return [
        {name: (float(x[i, k]), float(v[i, k]), float(a[i, k])) for k, name in enumerate("xyz")}
        | {f"v{name}": (float(v[i, k]), float(a[i, k]), 0.0) for k, name in enumerate("xyz")}
        for i in range(len(bodies))
    ]
