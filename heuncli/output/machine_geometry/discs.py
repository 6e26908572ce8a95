"""Round parts that rotate, in body axes: wheels, balls, gears, pulleys, sheaves, with spokes that show the rotation."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.machine_geometry.poses import Poses
from heuncli.output.machine_geometry.solids import Surface
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import RollingWheel
from heuncli.scene.file_format.models import Shape, Spec, Vec
from heuncli.scene.shapes.rotations import perpendicular_pair

CIRCLE_CORNERS = 48  # of a circle
HALF_THICKNESS = 0.06  # of the radius
SPOKE_OFFSET = 1.02  # spokes are drawn further out than their face by this factor, to be visible
RIM_RANGE = (0.7, 1.2)  # of the radius: surface corners at these distances from the axis belong to the wheel


class Disc(NamedTuple):
    """A circle about an axis of unit length.

    is_solid: whether a body without shapes is drawn as this disc
    has_spokes: whether it rotates with its body, so that spokes show its angle
    is_pitch_circle: whether it is that of a gear
    """

    centre: Array
    axis: Array
    radius: float
    is_solid: bool = True
    has_spokes: bool = True
    is_pitch_circle: bool = False

    @property
    def rim(self) -> Array:
        """The circle as a closed line, (CIRCLE_CORNERS + 1, 3)."""
        e, f = perpendicular_pair(self.axis)
        turn = np.linspace(0.0, 2.0 * np.pi, CIRCLE_CORNERS + 1)[:, None]
        found: Array = self.centre + self.radius * (np.cos(turn) * e + np.sin(turn) * f)
        return found

    @property
    def shape(self) -> Shape:
        """The disc as a thin cylinder."""
        half = HALF_THICKNESS * self.radius * self.axis
        return Shape("cylinder", from_=to_vec(self.centre - half), to=to_vec(self.centre + half), radius=self.radius)

    def iter_spokes(self, surfaces: tuple[Surface, ...]) -> Iterator[Array]:
        """Yield lines (2, 3) from rim to rim, two on each face that the disc has among its body's surfaces."""
        ends = np.array([-1.0, 1.0])[:, None]
        for height in self.find_face_heights(surfaces):
            for diameter in perpendicular_pair(self.axis):
                yield self.centre + SPOKE_OFFSET * height * self.axis + self.radius * ends * diameter

    def find_face_heights(self, surfaces: tuple[Surface, ...]) -> tuple[float, ...]:
        """Find the positions of its faces along the axis, from the surface corners near its rim; without any, its own
        plane.
        """
        offsets = np.concatenate([np.zeros((0, 3)), *(surface.corners for surface in surfaces)]) - self.centre
        heights = offsets @ self.axis
        distances = np.sqrt(np.maximum(np.sum(offsets * offsets, axis=1) - heights * heights, 0.0))
        rim_heights = heights[(distances >= RIM_RANGE[0] * self.radius) & (distances <= RIM_RANGE[1] * self.radius)]
        return (float(rim_heights.min()), float(rim_heights.max())) if len(rim_heights) else (0.0,)


def to_vec(x: Array) -> Vec:
    """Convert an array of three numbers to a tuple."""
    a, b, c = x.tolist()
    return a, b, c


def to_unit_vector(axis: Vec) -> Array:
    """Scale an axis to length 1."""
    v = np.array(axis)
    return np.asarray(v / np.sqrt(v @ v))


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
