"""What wheels look like: discs with spokes, which show how they turn, and balls; in their body's axes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.results import Array
from heuncli.shapes.rotations import perpendicular
from heuncli.spec.couplings import RollingWheel
from heuncli.spec.models import Shape, Spec, Vec

THICK = 0.06  # of its radius: how far a disc goes on either side of its rim


def wheels_of(spec: Spec, body: str) -> Iterator[RollingWheel]:
    """The wheels of a body."""
    for given in spec.rolling.values():
        if given.wheel.body == body:
            yield given


def wheel_shapes(spec: Spec, body: str) -> Iterator[Shape]:
    """The discs and balls of a body that has no shapes of its own."""
    for wheel in wheels_of(spec, body):
        centre = np.array(wheel.wheel.point)
        if wheel.axis is None:
            yield Shape("sphere", center=wheel.wheel.point, radius=wheel.radius)
        else:
            half = THICK * wheel.radius * direction(wheel.axis)
            yield Shape("cylinder", from_=vec(centre - half), to=vec(centre + half), radius=wheel.radius)


def spokes(spec: Spec, body: str) -> Iterator[Array]:
    """Lines (2, 3) across both faces of its discs, from rim to rim."""
    for wheel in wheels_of(spec, body):
        if wheel.axis is None:
            continue
        axle, centre = direction(wheel.axis), np.array(wheel.wheel.point)
        for face in (-THICK, THICK):
            for way in perpendicular(axle):
                ends = np.array([-1.0, 1.0])[:, None] * way + face * axle
                yield centre + wheel.radius * ends


def direction(axis: Vec) -> Array:
    """An axis at length 1."""
    v = np.array(axis)
    return np.asarray(v / np.sqrt(v @ v))


def vec(x: Array) -> Vec:
    """Three numbers."""
    a, b, c = x.tolist()
    return a, b, c
