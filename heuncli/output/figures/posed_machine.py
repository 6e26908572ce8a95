"""A machine at the instants of a figure: its bodies projected to a view, its pens, and the side of the ground.

If no instant is given, it is drawn at that of the greatest joint force.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np

from heuncli.base.load_kinds import LOAD_KINDS
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.output.drawing.axes import format_short
from heuncli.output.figures.curves import choose_number_style
from heuncli.output.machine_geometry.machine import Machine
from heuncli.output.machine_geometry.marks import (
    find_guided_actuators,
    find_shaft_bearings,
)
from heuncli.output.machine_geometry.poses import Poses
from heuncli.output.machine_geometry.views import (
    SceneView,
    SolidEdges,
    find_solid_edges,
)
from heuncli.output.tables.summary_rows import SummaryRow
from heuncli.results.results import Array, Results
from heuncli.results.results_paths import find_values
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import GROUND
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.channels import Channel, make_path_channel
from heuncli.study.quantities.labels import make_labels
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.measure_uncertainty import find_search_error
from heuncli.study.queries.study import Study
from heuncli.study.search.columns import ChannelSearch

BODY_PENS = (0, 2, 4, 6, 7)  # of bodies in turn; the other pens are for loads
MAX_NAMED = 60  # bodies and joints; with more of them there are no names
LARGE_SIDE, LARGE_AREA = 0.5, 0.25  # of the machine's side and area: a larger part is light, and behind the others
DOWN, UP = (0.0, -1.0), (0.0, 1.0)
MIN_HANGING_SLOPE = 0.2  # rise over run: a body that is less steeply below its support does not hang
DRIVE_PEN, LOAD_PEN = 3, 3
TIME_DIGITS = 4
WORST_WORDS = {"joints": "joint", "forces": "bushing"}


@record
class PosedMachine:
    """A machine at its poses of some instants, as seen in a view.

    centers: centres of mass, body axes
    per_si: number of display units in a metre
    """

    spec: Spec
    machine: Machine
    centers: Mapping[str, Array]
    poses: Poses
    view: SceneView
    per_si: float

    def project(self, body: str, points: Array, k: int) -> Array:
        """Project points (..., 3) of a body at instant k to the view, (..., 2) in the display unit."""
        return self.per_si * self.view.project(self.poses.locate_points(body, points, k))

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


class WorstInstant(NamedTuple):
    """The instant [s] of the greatest force, and what transmits it.

    kind, name: joints and a joint, or forces and a bushing in a scene without joints; empty if no force is known, and
    then the instant is the first of the run
    force: its magnitude [N]
    """

    time: float
    kind: str = ""
    name: str = ""
    force: float = 0.0


def select_worst(rows: Sequence[SummaryRow]) -> SummaryRow | None:
    """Select the row of a summary with the greatest joint force; without joints, that of the greatest load between
    bodies or of the foundation. None if no force is known.
    """
    forces = [row for row in rows if row.unit == "N" and not row.is_given and row.kind != "section"]
    joints = [row for row in forces if row.path.startswith("joints.") and row.kind == "joint"]
    return max(joints or forces, key=lambda row: abs(row.value), default=None)


def find_worst_instant(study: Study) -> WorstInstant:
    """Find the greatest joint force of a run before its horizon, between the samples too; without joints, the greatest
    force of a bushing.
    """
    spec, first = study.spec, float(study.results.time[0])
    bushings = [name for name, force in spec.forces.items() if LOAD_KINDS[force.type].place == "bodies"]
    kind, names = ("joints", list(spec.joints)) if spec.joints else ("forces", bushings)
    if study.has_one_instant or not names:
        return WorstInstant(first)

    def collect(results: Results) -> list[Channel]:
        if names[0] not in getattr(results, kind):  # the run was asked for other reports
            results = study.compute_reports(results.time, frozenset({kind}))
        return [make_path_channel(find_values(results, f"{kind}.{name}.force")) for name in names]

    error = find_search_error(study, (kind, names[0], "force"))
    search = ChannelSearch(collect, lambda channel: error if math.isfinite(error) else math.nan, (1.0,))
    bounds = study.search_extremes(search, frozenset({kind}))
    forces = np.nan_to_num(np.asarray(bounds.high), nan=-math.inf)
    k = int(np.argmax(forces))
    if not forces[k] > 0.0:
        return WorstInstant(first)
    return WorstInstant(float(bounds.high_at[k]), kind, names[k], float(forces[k]))


def describe_instants(posed_machine: PosedMachine, worst: WorstInstant | None, units: Units) -> str:
    """Describe the instants and the view; worst: the instant of the greatest joint force, if that is known."""
    times = posed_machine.poses.times.tolist()
    text = f"t = {format_short(times[0], TIME_DIGITS)} s"
    if worst is not None and worst.name and worst.time == times[0]:
        style = choose_number_style("N", worst.force, units)
        name = describe_object(worst.kind, worst.name, make_labels(posed_machine.spec))
        text += (
            f", worst instant: greatest {WORST_WORDS[worst.kind]} force, {name} {style.write(worst.force)} {style.unit}"
        )
    if len(times) > 1:
        text += f"; pale: t = {', '.join(format_short(t, TIME_DIGITS) for t in times[1:])} s"
    return f"{text}; seen from {posed_machine.view.description}"
