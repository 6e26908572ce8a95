"""The geometry of rolling wheels: discs and balls in body axes, and their contact points on the road."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.output.machine_geometry.discs import Disc, to_unit_vector
from heuncli.output.machine_geometry.poses import Poses
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import RollingWheel
from heuncli.scene.file_format.models import Shape, Spec


def iter_wheel_discs(spec: Spec) -> Iterator[tuple[str, Disc]]:
    """Yield the discs that roll, each with its body."""
    for wheel in spec.rolling.values():
        if wheel.axis is not None:
            yield wheel.wheel.body, Disc(np.array(wheel.wheel.point), to_unit_vector(wheel.axis), wheel.radius)


def iter_balls(spec: Spec, body: str) -> Iterator[Shape]:
    """Yield the rolling balls as which a body without shapes is drawn."""
    for wheel in spec.rolling.values():
        if wheel.axis is None and wheel.wheel.body == body:
            yield Shape("sphere", center=wheel.wheel.point, radius=wheel.radius)


def find_contact_points(wheel: RollingWheel, poses: Poses) -> tuple[Array, Array]:
    """Find the contact points of a wheel with its plane at all instants (kernel/rolling.py), and the plane's normal,
    (n, 3) each.
    """
    C = poses.trace_point(wheel.wheel.body, np.array(wheel.wheel.point))
    n = poses.trace_direction(wheel.on.body, to_unit_vector(wheel.normal))
    if wheel.axis is None:
        return C - wheel.radius * n, n
    k = poses.trace_direction(wheel.wheel.body, to_unit_vector(wheel.axis))
    t = np.cross(k, n)
    size = np.linalg.norm(t, axis=1, keepdims=True)
    t = np.divide(t, size, out=np.zeros_like(t), where=size > 0.0)  # a rim that lies flat has no lowest point
    return C - wheel.radius * np.cross(t, k), n
