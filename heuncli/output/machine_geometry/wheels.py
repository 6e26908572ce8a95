"""What wheels look like: discs and balls, in their body's axes, and the road where they touch it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.output.machine_geometry.discs import Disc, direction
from heuncli.output.machine_geometry.poses import Poses
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import RollingWheel
from heuncli.scene.file_format.models import Shape, Spec


def wheel_discs(spec: Spec) -> Iterator[tuple[str, Disc]]:
    """The discs that roll, each with its body."""
    for wheel in spec.rolling.values():
        if wheel.axis is not None:
            yield wheel.wheel.body, Disc(np.array(wheel.wheel.point), direction(wheel.axis), wheel.radius)


def balls_of(spec: Spec, body: str) -> Iterator[Shape]:
    """The balls that a body without shapes of its own is."""
    for wheel in spec.rolling.values():
        if wheel.axis is None and wheel.wheel.body == body:
            yield Shape("sphere", center=wheel.wheel.point, radius=wheel.radius)


def touched(wheel: RollingWheel, poses: Poses) -> tuple[Array, Array]:
    """Where a wheel touches its plane at all instants (kernel/rolling.py), and the plane's normal, (n, 3) each."""
    C = poses.ways(wheel.wheel.body, np.array(wheel.wheel.point))
    n = poses.directions(wheel.on.body, direction(wheel.normal))
    if wheel.axis is None:
        return C - wheel.radius * n, n
    k = poses.directions(wheel.wheel.body, direction(wheel.axis))
    t = np.cross(k, n)
    size = np.linalg.norm(t, axis=1, keepdims=True)
    t = np.divide(t, size, out=np.zeros_like(t), where=size > 0.0)  # a rim that lies flat has no lowest point
    return C - wheel.radius * np.cross(t, k), n
