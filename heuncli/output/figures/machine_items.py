"""Draw a machine as a view shows it: bodies from the farthest to the nearest, connections, joints, names.

The symbol of a joint follows from what it constrains and how it lets turn (joint_kinds.py), so that a new kind has one.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from functools import cached_property

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import TYPES, JointKind
from heuncli.base.load_kinds import LOAD_KINDS
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.output.drawing.figure import Item, Link, PlaceLabel, Polygon, Strokes, Symbol
from heuncli.output.drawing.style import ARM_WIDTH, DASH_DOT, LINK_WIDTH, OUTLINE_WIDTH, RIM_WIDTH, THIN_WIDTH
from heuncli.output.figures.scene_labels import iter_letters
from heuncli.output.machine_geometry.joint_symbols import (
    find_guided_actuators,
    find_scene_joint_kind,
    find_shaft_bearings,
)
from heuncli.output.machine_geometry.machine import BodyGeometry, JointGeometry, LineGeometry, Machine
from heuncli.output.machine_geometry.poses import Poses
from heuncli.output.machine_geometry.silhouettes import (
    SolidEdges,
    compute_convex_hull,
    find_silhouette,
    find_solid_edges,
    select_visible_edges,
)
from heuncli.output.machine_geometry.views import SceneView
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import GROUND
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.labels import Labels

BODY_PENS = (0, 2, 4, 6, 7)  # of bodies in turn; the other pens are for loads
DRIVE_PEN, LOAD_PEN = 3, 3
MIN_AXIS_LENGTH = 0.35  # visible length of a unit axis; a shorter one points to the viewer
MAX_NAMED = 60  # bodies and joints; with more of them there are no names
MAX_CENTRES = 40  # bodies; with more of them no centres of mass are marked
LARGE_SIDE, LARGE_AREA = 0.5, 0.25  # of the machine's side and area: a larger part is light, and behind the others
SAME_DEPTH = 1e-6  # share of the figure's depth: closer pieces are equally far
DOWN, UP = (0.0, -1.0), (0.0, 1.0)
MIN_HANGING_SLOPE = 0.2  # rise over run: a body that is less steeply below its support does not hang
TURN_SYMBOLS: Mapping[str, tuple[str, str]] = {  # key of the turn -> symbols along and across the axis
    "free": ("ball", "ball"), "axis": ("circle", "barrel"), "square": ("cross", "cross"),
    "alike": ("rosette", "rosette"), "all": ("square", "square"),
    "slider": ("slider", "slider"),
}  # fmt: skip
HOLD_SYMBOLS: Mapping[str, tuple[str, str]] = {"line": ("bore", "guide"), "plane": ("field", "table")}  # along, across


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
        """The actuators that are drawn as what they exert."""
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


class DrawnPiece(NamedTuple):
    """A part of a body with its items; depth and area decide the order of drawing."""

    depth: float
    area: float
    items: tuple[Item, ...]


def draw_bodies(posed_machine: PosedMachine, k: int, *, thin: bool = False) -> list[Item]:
    """Draw the bodies at instant k, far ones first; of equally far ones the large ones first."""
    pieces = [piece for body in posed_machine.machine.bodies for piece in _draw_pieces(posed_machine, body, k, thin)]
    depths = [piece.depth for piece in pieces if piece.depth > -np.inf]
    step = SAME_DEPTH * (max(depths) - min(depths)) if depths else 0.0

    def order(piece: DrawnPiece) -> tuple[float, float]:
        level = piece.depth if step == 0.0 or piece.depth == -np.inf else round(piece.depth / step)
        return float(level), -piece.area

    pieces.sort(key=order)
    circles = [] if thin else _draw_pitch_circles(posed_machine, k)
    paths = (posed_machine.project(GROUND, path, k) for path in posed_machine.machine.paths if not thin)
    path_strokes: list[Item] = [Strokes(np.stack([ends[:-1], ends[1:]], axis=1), None, OUTLINE_WIDTH) for ends in paths]
    return [*path_strokes, *(item for piece in pieces for item in piece.items), *circles]


def _draw_pieces(posed_machine: PosedMachine, body: BodyGeometry, k: int, thin: bool) -> Iterator[DrawnPiece]:
    """Yield the solids of a body, or the lines between its points."""
    pen = posed_machine.pens[body.name]
    for solid in posed_machine.solids[body.name]:
        places = posed_machine.poses.locate_points(body.name, solid.surface.corners, k)
        contour = compute_convex_hull(posed_machine.size * posed_machine.view.project(places))
        if not solid.surface.convex:
            yield _draw_mesh(posed_machine, body, solid, k, thin)
            continue
        depth, is_large = float(posed_machine.view.compute_depth(places).mean()), posed_machine.is_large(contour)
        lines: tuple[Item, ...] = ()
        if not thin:
            edges = select_visible_edges(solid, posed_machine.poses.orientations[body.name][k], posed_machine.view)
            lines = (Strokes(posed_machine.project(body.name, edges, k), pen, OUTLINE_WIDTH, is_ghost=is_large),)
        width = OUTLINE_WIDTH if thin or is_large else RIM_WIDTH
        shape = Polygon(body.name, contour, pen, is_opaque=not thin, width=width, is_ghost=thin, is_light=is_large)
        yield DrawnPiece(-np.inf if is_large else depth, compute_area(contour), (shape, *lines))
    middle = max((posed_machine.find_depth(body.name, own.corners, k) for own in body.surfaces), default=-np.inf)
    is_link = not (body.surfaces or body.lines or body.pitch_circles)
    for number, line in enumerate((*body.bars, *body.lines)):
        if len(line) > 1:
            depth = posed_machine.find_depth(body.name, line, k)
            if number >= len(body.bars) and depth < middle - SAME_DEPTH * posed_machine.extent.max():
                continue  # on the far side of the body
            ends = posed_machine.project(body.name, line, k)
            item: Item = Link(*to_pair(ends[0]), *to_pair(ends[-1]), "bar", pen, body.name)
            if thin or not is_link:
                width = (
                    RIM_WIDTH
                    if number >= len(body.bars)
                    else ARM_WIDTH
                    if posed_machine.solids[body.name]
                    else LINK_WIDTH
                )
                item = Strokes(
                    np.stack([ends[:-1], ends[1:]], axis=1), pen, OUTLINE_WIDTH if thin else width, is_ghost=thin
                )
            yield DrawnPiece(depth, 0.0, (item,))


def _draw_pitch_circles(posed_machine: PosedMachine, k: int) -> Iterator[Strokes | Symbol]:
    """Draw the pitch circles of gears, over the bodies, and the points at which they mesh."""
    for body in posed_machine.machine.bodies:
        for circle in body.pitch_circles:
            ends = posed_machine.project(body.name, circle, k)
            yield Strokes(np.stack([ends[:-1], ends[1:]], axis=1), posed_machine.pens[body.name], THIN_WIDTH, DASH_DOT)
    for mesh in posed_machine.machine.pitch_points:
        place = to_pair(posed_machine.project(mesh.carrier, mesh.point, k))
        yield Symbol(*place, "pitch point", (1.0, 0.0), None, f"{mesh.name}: pitch point")


def _draw_mesh(posed_machine: PosedMachine, body: BodyGeometry, solid: SolidEdges, k: int, thin: bool) -> DrawnPiece:
    """Draw a body of any form: its silhouette, with see-through holes, and its edges on the near side."""
    pen = posed_machine.pens[body.name]
    R = posed_machine.poses.orientations[body.name][k]
    flat = posed_machine.project(body.name, solid.surface.corners, k)
    lines = [flat[line] for line in find_silhouette(solid, R, posed_machine.view)]
    contour = np.concatenate([np.concatenate([line, line[:1]]) for line in lines] or [flat[:0]])
    return_path = [line[:1] for line in lines[-2::-1]]  # the path between the lines and back has no width
    rims = [np.stack([line, np.roll(line, -1, axis=0)], axis=1) for line in lines]
    items: list[Item] = [
        Polygon(body.name, np.concatenate([contour, *return_path]), pen, is_opaque=not thin, has_outline=False)
    ]
    items.append(
        Strokes(
            np.concatenate([flat[:0].reshape(0, 2, 2), *rims]),
            pen,
            OUTLINE_WIDTH if thin else RIM_WIDTH,
            is_ghost=thin,
        )
    )
    if not thin:
        items.append(
            Strokes(
                posed_machine.project(body.name, select_visible_edges(solid, R, posed_machine.view), k),
                pen,
                OUTLINE_WIDTH,
            )
        )
    depth = float(
        posed_machine.view.compute_depth(posed_machine.poses.locate_points(body.name, solid.surface.corners, k)).mean()
    )
    return DrawnPiece(depth, sum(abs(compute_area(posed_machine.size * line)) for line in lines), tuple(items))


def to_pair(place: Array) -> tuple[float, float]:
    """Convert a place (2,) to two floats."""
    x, y = place.tolist()
    return float(x), float(y)


def compute_area(corners: Array) -> float:
    """Return the area of a polygon (n, 2)."""
    x, y = corners.T
    return 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def draw_joints(posed_machine: PosedMachine, k: int, *, thin: bool = False) -> list[Item]:
    """Draw the joints, sliding ones below turning ones, so that a pin is in front of its slider."""
    looks = sorted(posed_machine.machine.joints, key=lambda look: not find_joint_kind(look, posed_machine.spec).shifts)
    return [item for look in looks for item in draw_joint(posed_machine, look, k, thin=thin)]


def find_joint_kind(joint: JointGeometry, spec: Spec) -> JointKind:
    """Return the kind of a joint, also in a scene declared planar."""
    return find_scene_joint_kind(spec, joint.kind)


def find_turn_key(kind: JointKind) -> str:
    """Return the key of TURN_SYMBOLS that says how a joint lets turn."""
    if kind.turn.condition == "all" and kind.shifts:
        return "slider"
    return "axis" if kind.turn.condition == "free" and not kind.is_ball else kind.turn.condition


def draw_joint(posed_machine: PosedMachine, look: JointGeometry, k: int, *, thin: bool = False) -> list[Item]:
    """Draw the symbol of a joint, with the ground if it is mounted there; thin: only its line, if it has one."""
    kind, name = find_joint_kind(look, posed_machine.spec), f"{look.name}: {look.kind}"
    x, y = posed_machine.project(look.b, look.q, k).tolist()
    if kind.keeps_distance:
        return _draw_rod(posed_machine, look, k, thin)
    if thin:
        return []
    if not posed_machine.has_names and GROUND not in (look.a, look.b):
        return [Symbol(x, y, "dot")]
    axis = posed_machine.project_direction(look.a, look.axis / np.linalg.norm(look.axis), k)
    is_seen_aside = int(float(np.hypot(*axis)) > MIN_AXIS_LENGTH)
    along = (float(axis[0]), float(axis[1])) if is_seen_aside else (1.0, 0.0)
    if is_seen_aside and look.name in posed_machine.bearings:
        symbol = "fixed bearing" if posed_machine.bearings[look.name] else "floating bearing"
        return [Symbol(x, y, symbol, along, None, name)]
    items: list[Item] = [*_draw_ground(posed_machine, look, kind, along if is_seen_aside else None, k)]
    if kind.hold.gap_type in HOLD_SYMBOLS:
        items.append(Symbol(x, y, HOLD_SYMBOLS[kind.hold.gap_type][is_seen_aside], along, None, name))
    # a ball in a bore, seen along the bore, constrains in the figure like a pin
    turn = "axis" if kind.hold.gap_type == "line" and not is_seen_aside and kind.is_ball else find_turn_key(kind)
    items.append(Symbol(x, y, TURN_SYMBOLS[turn][is_seen_aside], along, None, name))
    return items


def _draw_ground(
    posed_machine: PosedMachine, look: JointGeometry, kind: JointKind, seen_axis: tuple[float, float] | None, k: int
) -> Iterator[Symbol]:
    """Draw the ground at a joint that is mounted there.

    seen_axis: its axis in the view, None if it points to the viewer
    """
    if GROUND not in (look.a, look.b) or kind.hold.gap_type == "curve":
        return
    other = look.b if look.a == GROUND else look.a
    place = posed_machine.project(look.b, look.q, k)
    ground_direction = posed_machine.find_ground_side(other, place, k)
    symbol = "foot"
    if kind.hold.gap_type in HOLD_SYMBOLS:
        symbol = "bed"
        if seen_axis is not None and kind.hold.gap_type == "line":
            across = np.array([-seen_axis[1], seen_axis[0]])
            ground_direction = tuple((across if across @ ground_direction > 0.0 else -across).tolist())
        elif seen_axis is not None:
            ground_direction = -seen_axis[0], -seen_axis[1]
    elif kind.turn.condition == "all":
        symbol = "clamp"
        outward = (
            place - posed_machine.project(other, posed_machine.centers[other], k) if other != GROUND else np.zeros(2)
        )
        ground_direction = tuple(outward.tolist()) if outward.any() else DOWN
    yield Symbol(*to_pair(place), symbol, ground_direction, None, f"{look.name}: on the ground")


def _draw_rod(posed_machine: PosedMachine, look: JointGeometry, k: int, thin: bool) -> list[Item]:
    """Draw a rod, a rope, or a rod whose length is driven."""
    joint_spec = posed_machine.spec.joints[look.name]
    kind = "rope" if joint_spec.tension_only else "rod"
    pen: int | None = None
    if any(drive.joint == look.name for drive in posed_machine.spec.drives.values()):
        kind, pen = "actuator", DRIVE_PEN
    what = "rope" if joint_spec.tension_only else look.kind
    return _draw_link(posed_machine, LineGeometry(look.name, what, look.a, look.p, look.b, look.q), kind, pen, k, thin)


def draw_force_line(posed_machine: PosedMachine, look: LineGeometry, k: int, *, thin: bool = False) -> list[Item]:
    """Draw a load between two points by its symbol, with or without damper, or one between two bodies."""
    if look.name in posed_machine.guided_actuators:
        return []  # drawn as what it exerts
    kind = LOAD_KINDS[look.kind]
    if kind.place == "bodies":
        return _draw_bushing(posed_machine, look, k, thin)
    is_damped = bool(getattr(posed_machine.spec.forces[look.name], "damping", 0.0))
    return _draw_link(posed_machine, look, kind.symbols[-1 if is_damped else 0], LOAD_PEN, k, thin)


def draw_belt_strands(posed_machine: PosedMachine, k: int) -> Iterator[Strokes]:
    """Draw the strands of belts."""
    for belt in posed_machine.machine.belts:
        yield Strokes(posed_machine.project(belt.carrier, belt.strands, k), LOAD_PEN, ARM_WIDTH)


def _draw_bushing(posed_machine: PosedMachine, look: LineGeometry, k: int, thin: bool) -> list[Item]:
    """Draw two sleeves about the bushing's `to` point, with the ground if it is mounted there, and a line if it is
    displaced.
    """
    first, second = (posed_machine.project(*end, k) for end in ((look.a, look.p), (look.b, look.q)))
    displacement_line = Strokes(np.array([[first, second]]), LOAD_PEN, OUTLINE_WIDTH, is_ghost=thin)
    if thin:
        return [displacement_line]
    items: list[Item] = [displacement_line]
    for body, place in ((look.a, first), (look.b, second)):
        if body == GROUND:
            other = look.b if body == look.a else look.a
            ground_direction = choose_ground_side(place, posed_machine.project(other, posed_machine.centers[other], k))
            items.append(Symbol(*to_pair(place), "foot", ground_direction, None, f"{look.name}: on the ground"))
    return [*items, Symbol(*to_pair(second), "bushing", (1.0, 0.0), LOAD_PEN, f"{look.name}: bushing")]


def _draw_link(
    posed_machine: PosedMachine, look: LineGeometry, kind: str, pen: int | None, k: int, thin: bool
) -> list[Item]:
    """Draw the link between two points, with the ground at those that are fixed to it."""
    first, second = (posed_machine.project(*end, k) for end in ((look.a, look.p), (look.b, look.q)))
    if thin:
        return [Strokes(np.array([[first, second]]), pen, OUTLINE_WIDTH, is_ghost=True)]
    items: list[Item] = []
    for body, place, other in ((look.a, first, second), (look.b, second, first)):
        if body == GROUND:
            items.append(
                Symbol(*to_pair(place), "foot", choose_ground_side(place, other), None, f"{look.name}: on the ground")
            )
    return [*items, Link(*to_pair(first), *to_pair(second), kind, pen, f"{look.name}: {look.kind}")]


def draw_joint_actions(posed_machine: PosedMachine, k: int, drawn_names: Collection[str] = ()) -> Iterator[Symbol]:
    """Draw the drives of joints, and the loads that act in them.

    drawn_names: of loads that have an arrow, and need no symbol
    """
    looks = {look.name: look for look in posed_machine.machine.joints}
    for action in posed_machine.machine.joint_symbols:
        if action.name in drawn_names:
            continue
        look = looks[action.joint]
        axis = (
            find_path_tangent(posed_machine, look, k)
            if find_joint_kind(look, posed_machine.spec).follows_path
            else look.axis
        )
        axis = axis / np.linalg.norm(axis)
        seen_axis = posed_machine.project_direction(look.a, axis, k)
        symbol = action.symbols[int(posed_machine.find_depth_component(look.a, axis, k) < 0.0)]
        symbol_axis = to_pair(seen_axis) if action.slides and seen_axis.any() else (1.0, 0.0)
        label = f"{action.name}: {action.load_kind} on {action.joint}"
        yield Symbol(*to_pair(posed_machine.project(look.b, look.q, k)), symbol, symbol_axis, LOAD_PEN, label)


def find_path_tangent(posed_machine: PosedMachine, look: JointGeometry, k: int) -> Array:
    """Return the tangent of a path at its point, in axes of its body; where the path crosses itself one of both."""
    joint = posed_machine.spec.joints[look.name]
    assert joint.path is not None
    D = posed_machine.poses.locate_points(look.b, look.q, k) - posed_machine.poses.locate_points(look.a, look.p, k)
    D = D if look.a == GROUND else D @ posed_machine.poses.orientations[look.a][k]
    return np.asarray(joint.path.evaluate(float(joint.path.find_nearest(D)))[1])


def draw_mass_marks(posed_machine: PosedMachine, k: int) -> Iterator[Symbol]:
    """Draw point masses and centres of mass."""
    shows_centres = len(posed_machine.machine.bodies) <= MAX_CENTRES
    for body in posed_machine.machine.bodies:
        pen, centre = posed_machine.pens[body.name], posed_machine.centers[body.name]
        masses = posed_machine.masses[body.name]
        for place in masses:
            position = to_pair(posed_machine.project(body.name, place, k))
            yield Symbol(*position, "mass", (1.0, 0.0), pen, f"{body.name}: point mass")
        tolerance = tolerances.ONE_PLACE * float(np.abs(centre).max())
        if shows_centres and not any(np.abs(place - centre).max() <= tolerance for place in masses):
            position = to_pair(posed_machine.project(body.name, centre, k))
            yield Symbol(*position, "centre", (1.0, 0.0), pen, f"{body.name}: centre of mass")


def make_labels(posed_machine: PosedMachine, k: int, labels: Labels, labelled: Collection[str]) -> Iterator[PlaceLabel]:
    """Yield the labels of joints, springs and actuators, and bodies; short forms are numbers, small letters and
    capitals.

    labelled: the words of loads that have a label
    """
    if not posed_machine.has_names:
        return
    for number, look in enumerate(posed_machine.machine.joints, 1):
        ends = posed_machine.project(look.b, look.q, k), posed_machine.project(look.a, look.p, k)
        place = 0.5 * (ends[0] + ends[1]) if TYPES[look.kind].keeps_distance else ends[0]
        text = describe_object("joints", look.name, labels)
        if text not in labelled:
            yield PlaceLabel(*to_pair(place), text, str(number))
    for letter, line in zip(iter_letters("a"), posed_machine.machine.lines, strict=False):
        ends = posed_machine.project(line.a, line.p, k), posed_machine.project(line.b, line.q, k)
        text = describe_object("forces", line.name, labels)
        if text not in labelled and line.name not in posed_machine.guided_actuators:
            yield PlaceLabel(*to_pair(0.5 * (ends[0] + ends[1])), text, letter, LOAD_PEN)
    for letter, body in zip(iter_letters("A"), posed_machine.machine.bodies, strict=False):
        place = posed_machine.project(body.name, posed_machine.centers[body.name], k)
        text = describe_object("bodies", body.name, labels)
        yield PlaceLabel(*to_pair(place), text, letter, posed_machine.pens[body.name])
