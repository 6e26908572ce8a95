"""A machine at the instants of a figure: its bodies projected to a view, its pens, and the side of the ground."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

import numpy as np

from heuncli.base.records import record
from heuncli.output.machine_geometry.joint_symbols import (
    find_guided_actuators,
    find_shaft_bearings,
)
from heuncli.output.machine_geometry.machine import Machine
from heuncli.output.machine_geometry.poses import Poses
from heuncli.output.machine_geometry.silhouettes import (
    SolidEdges,
    find_solid_edges,
)
from heuncli.output.machine_geometry.views import SceneView
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import GROUND

BODY_PENS = (0, 2, 4, 6, 7)  # of bodies in turn; the other pens are for loads
MAX_NAMED = 60  # bodies and joints; with more of them there are no names
LARGE_SIDE, LARGE_AREA = 0.5, 0.25  # of the machine's side and area: a larger part is light, and behind the others
DOWN, UP = (0.0, -1.0), (0.0, 1.0)
MIN_HANGING_SLOPE = 0.2  # rise over run: a body that is less steeply below its support does not hang
DRIVE_PEN, LOAD_PEN = 3, 3


@record
class PosedMachine:
    """A machine at its poses of some instants, as seen in a view.

    centers: centres of mass, body axes
    size: number of display units in a metre
    """

    spec: Spec
    machine: Machine
    centers: Mapping[str, Array]
    poses: Poses
    view: SceneView
    size: float

    def project(self, body: str, points: Array, k: int) -> Array:
        """Project points (..., 3) of a body at instant k to the view, (..., 2) in the display unit."""
        return self.size * self.view.project(self.poses.locate_points(body, points, k))

    def project_direction(self, body: str, axis: Array, k: int) -> Array:
        """Project a direction in a body's axes to the view, (2,) with its visible length."""
        return self.view.project(axis if body == GROUND else self.poses.orientations[body][k] @ axis)

    def find_depth_component(self, body: str, axis: Array, k: int) -> float:
        """Return the component of a direction in a body's axes towards the viewer, -1 to 1."""
        return float(self.view.compute_depth(axis if body == GROUND else self.poses.orientations[body][k] @ axis))

    def find_depth(self, body: str, points: Array, k: int) -> float:
        """Return the mean depth of points (n, 3) of a body at instant k; larger is nearer."""
        return float(self.view.compute_depth(self.poses.locate_points(body, points, k)).mean())

    @cached_property
    def solids(self) -> dict[str, tuple[SolidEdges, ...]]:
        """The solids of each body."""
        return {body.name: tuple(map(find_solid_edges, body.surfaces)) for body in self.machine.bodies}

    @cached_property
    def bearings(self) -> dict[str, bool]:
        """The joints that are bearings of shafts, each with whether it is fixed."""
        return find_shaft_bearings(self.spec)

    @cached_property
    def guided_actuators(self) -> frozenset[str]:
        """The actuators that are drawn as arrows of their force."""
        return find_guided_actuators(self.spec)

    @cached_property
    def extent(self) -> Array:
        """The sides (2,) of the rectangle around all bodies and joints at the first instant."""
        bodies = self.machine.bodies
        parts = [(body.name, surface.corners) for body in bodies for surface in body.surfaces]
        parts += [(body.name, line) for body in bodies for line in body.strokes]
        parts += [(joint.b, joint.q[None]) for joint in self.machine.joints]
        points = [self.project(name, part, 0) for name, part in parts]
        return np.asarray(np.ptp(np.concatenate(points), axis=0)) if points else np.zeros(2)

    def is_large(self, contour: Array) -> bool:
        """Whether an outline (n, 2) would hide most of the machine."""
        side, area = float(np.ptp(contour, axis=0).max()), compute_area(contour)
        is_alone = sum(map(len, self.solids.values())) == 1
        return not is_alone and side > LARGE_SIDE * self.extent.max() and area > LARGE_AREA * float(self.extent.prod())

    @cached_property
    def pens(self) -> dict[str, int]:
        """The pen of each body."""
        return {body.name: BODY_PENS[k % len(BODY_PENS)] for k, body in enumerate(self.machine.bodies)}

    @cached_property
    def has_names(self) -> bool:
        """Whether the bodies and joints are few enough to show their names."""
        return len(self.machine.bodies) + len(self.machine.joints) <= MAX_NAMED

    @cached_property
    def masses(self) -> dict[str, list[Array]]:
        """The point masses of each body, body axes."""
        return {
            name: [np.array(shape.at) for shape in body.shapes or () if shape.type == "point"]
            for name, body in self.spec.bodies.items()
        }

    def find_ground_side(self, body: str, place: Array, k: int) -> tuple[float, float]:
        """Return the direction in which to draw the ground that holds a body: down, or up if the body hangs from the
        place.
        """
        if body == GROUND:
            return DOWN
        return choose_ground_side(place, self.project(body, self.centers[body], k))


def choose_ground_side(place: Array, other: Array) -> tuple[float, float]:
    """Return the direction in which to draw the ground at a place: down, or up if what it holds hangs from it."""
    return UP if other[1] < place[1] - MIN_HANGING_SLOPE * abs(other[0] - place[0]) else DOWN


def to_pair(place: Array) -> tuple[float, float]:
    """Convert a place (2,) to two floats."""
    x, y = place.tolist()
    return float(x), float(y)


def compute_area(corners: Array) -> float:
    """Return the area of a polygon (n, 2)."""
    x, y = corners.T
    return 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))
