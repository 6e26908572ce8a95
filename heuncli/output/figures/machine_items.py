"""Draw a machine in a view: its bodies, from the farthest to the nearest, and what connects them.

Bodies have point masses and centres of mass; they are connected by joints with their ground and actions, loads between
points, and ropes. Marks stand about them.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JointKind
from heuncli.base.load_kinds import LOAD_KINDS
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import Item, Link, Polygon, Strokes, Symbol
from heuncli.output.drawing.style import ARM_WIDTH, DASH_DOT, LINK_WIDTH, OUTLINE_WIDTH, RIM_WIDTH, THIN_WIDTH
from heuncli.output.figures.posed_machine import (
    DOWN,
    DRIVE_PEN,
    LOAD_PEN,
    PosedMachine,
    choose_ground_side,
    compute_area,
    to_pair,
)
from heuncli.output.machine_geometry.machine import BodyGeometry, JointGeometry, LineGeometry
from heuncli.output.machine_geometry.marks import (
    find_scene_joint_kind,
)
from heuncli.output.machine_geometry.ropes import iter_rope_lines
from heuncli.output.machine_geometry.solids import compute_convex_hull
from heuncli.output.machine_geometry.views import SolidEdges, find_silhouette, select_visible_edges
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import GROUND

MAX_CENTRES = 40  # bodies; with more of them no centres of mass are marked
SAME_DEPTH = 1e-6  # share of the figure's depth: closer pieces are equally far
MIN_AXIS_LENGTH = 0.35  # visible length of a unit axis; a shorter one points to the viewer
TURN_SYMBOLS: Mapping[str, tuple[str, str]] = {  # key of the turn -> symbols along and across the axis
    "free": ("ball", "ball"), "axis": ("circle", "barrel"), "square": ("cross", "cross"),
    "alike": ("rosette", "rosette"), "all": ("square", "square"),
    "slider": ("slider", "slider"),
}  # fmt: skip
MIN_SEEN = 0.2  # visible share of a mark's direction; with less it is not drawn
HOLD_SYMBOLS: Mapping[str, tuple[str, str]] = {"line": ("bore", "guide"), "plane": ("field", "table")}  # along, across


class DrawnPiece(NamedTuple):
    """A part of a body with its items; depth and area decide the order of drawing."""

    depth: float
    area: float
    items: tuple[Item, ...]


def draw_bodies(posed_machine: PosedMachine, k: int) -> list[Item]:
    """Draw the bodies at instant k, far ones first; of equally far ones the large ones first."""
    pieces = [piece for body in posed_machine.machine.bodies for piece in _draw_pieces(posed_machine, body, k)]
    depths = [piece.depth for piece in pieces if piece.depth > -np.inf]
    step = SAME_DEPTH * (max(depths) - min(depths)) if depths else 0.0

    def order(piece: DrawnPiece) -> tuple[float, float]:
        level = piece.depth if step == 0.0 or piece.depth == -np.inf else round(piece.depth / step)
        return float(level), -piece.area

    pieces.sort(key=order)
    circles = [] if k > 0 else _draw_pitch_circles(posed_machine, k)
    paths = (posed_machine.project(GROUND, path, k) for path in posed_machine.machine.paths if k == 0)
    path_strokes: list[Item] = [Strokes(np.stack([ends[:-1], ends[1:]], axis=1), None, OUTLINE_WIDTH) for ends in paths]
    return [*path_strokes, *(item for piece in pieces for item in piece.items), *circles]


def _draw_pieces(posed_machine: PosedMachine, body: BodyGeometry, k: int) -> Iterator[DrawnPiece]:
    """Yield the solids of a body, or the lines between its points."""
    pen = posed_machine.pens[body.name]
    for solid in posed_machine.solids[body.name]:
        places = posed_machine.poses.locate_points(body.name, solid.surface.corners, k)
        contour = compute_convex_hull(posed_machine.per_si * posed_machine.view.project(places))
        if not solid.surface.convex:
            yield _draw_mesh(posed_machine, body, solid, k)
            continue
        depth, is_large = float(posed_machine.view.compute_depth(places).mean()), posed_machine.is_large(contour)
        lines: tuple[Item, ...] = ()
        if k == 0:
            edges = select_visible_edges(solid, posed_machine.poses.orientations[body.name][k], posed_machine.view)
            lines = (Strokes(posed_machine.project(body.name, edges, k), pen, OUTLINE_WIDTH, is_ghost=is_large),)
        width = OUTLINE_WIDTH if k > 0 or is_large else RIM_WIDTH
        shape = Polygon(body.name, contour, pen, is_opaque=k == 0, width=width, is_ghost=k > 0, is_light=is_large)
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
            if k > 0 or not is_link:
                width = (
                    RIM_WIDTH
                    if number >= len(body.bars)
                    else ARM_WIDTH
                    if posed_machine.solids[body.name]
                    else LINK_WIDTH
                )
                item = Strokes(
                    np.stack([ends[:-1], ends[1:]], axis=1), pen, OUTLINE_WIDTH if k > 0 else width, is_ghost=k > 0
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


def _draw_mesh(posed_machine: PosedMachine, body: BodyGeometry, solid: SolidEdges, k: int) -> DrawnPiece:
    """Draw a body of any form: its silhouette, with see-through holes, and its edges on the near side."""
    pen = posed_machine.pens[body.name]
    R = posed_machine.poses.orientations[body.name][k]
    flat = posed_machine.project(body.name, solid.surface.corners, k)
    lines = [flat[line] for line in find_silhouette(solid, R, posed_machine.view)]
    contour = np.concatenate([np.concatenate([line, line[:1]]) for line in lines] or [flat[:0]])
    return_path = [line[:1] for line in lines[-2::-1]]  # the path between the lines and back has no width
    rims = [np.stack([line, np.roll(line, -1, axis=0)], axis=1) for line in lines]
    items: list[Item] = [
        Polygon(body.name, np.concatenate([contour, *return_path]), pen, is_opaque=k == 0, has_outline=False)
    ]
    items.append(
        Strokes(
            np.concatenate([flat[:0].reshape(0, 2, 2), *rims]),
            pen,
            OUTLINE_WIDTH if k > 0 else RIM_WIDTH,
            is_ghost=k > 0,
        )
    )
    if k == 0:
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
    return DrawnPiece(depth, sum(abs(compute_area(posed_machine.per_si * line)) for line in lines), tuple(items))


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


def draw_joints(posed_machine: PosedMachine, k: int) -> list[Item]:
    """Draw the joints, sliding ones below turning ones, so that a pin is in front of its slider."""
    joints = sorted(
        posed_machine.machine.joints, key=lambda joint: not find_joint_kind(joint, posed_machine.spec).shifts
    )
    return [item for joint in joints for item in draw_joint(posed_machine, joint, k)]


def find_joint_kind(joint: JointGeometry, spec: Spec) -> JointKind:
    """Return the kind of a joint, also in a scene declared planar."""
    return find_scene_joint_kind(spec, joint.kind)


def find_turn_key(kind: JointKind) -> str:
    """Return the key of TURN_SYMBOLS that says how a joint lets turn."""
    if kind.turn.condition == "all" and kind.shifts:
        return "slider"
    return "axis" if kind.turn.condition == "free" and not kind.is_ball else kind.turn.condition


def draw_joint(posed_machine: PosedMachine, joint: JointGeometry, k: int) -> list[Item]:
    """Draw the symbol of a joint, with the ground if it is mounted there; later only its line, if any."""
    kind, name = find_joint_kind(joint, posed_machine.spec), f"{joint.name}: {joint.kind}"
    x, y = posed_machine.project(joint.b, joint.q, k).tolist()
    if kind.keeps_distance:
        return _draw_rod(posed_machine, joint, k)
    if k > 0:
        return []
    if not posed_machine.has_names and GROUND not in (joint.a, joint.b):
        return [Symbol(x, y, "dot")]
    axis = posed_machine.project_direction(joint.a, joint.axis / np.linalg.norm(joint.axis), k)
    is_seen_aside = int(float(np.hypot(*axis)) > MIN_AXIS_LENGTH)
    along = (float(axis[0]), float(axis[1])) if is_seen_aside else (1.0, 0.0)
    if is_seen_aside and joint.name in posed_machine.bearings:
        symbol = "fixed bearing" if posed_machine.bearings[joint.name] else "floating bearing"
        return [Symbol(x, y, symbol, along, None, name)]
    items: list[Item] = [*_draw_ground(posed_machine, joint, kind, along if is_seen_aside else None, k)]
    if kind.hold.gap_type in HOLD_SYMBOLS:
        items.append(Symbol(x, y, HOLD_SYMBOLS[kind.hold.gap_type][is_seen_aside], along, None, name))
    # a ball in a bore, seen along the bore, constrains in the figure like a pin
    turn = "axis" if kind.hold.gap_type == "line" and not is_seen_aside and kind.is_ball else find_turn_key(kind)
    items.append(Symbol(x, y, TURN_SYMBOLS[turn][is_seen_aside], along, None, name))
    return items


def _draw_ground(
    posed_machine: PosedMachine, joint: JointGeometry, kind: JointKind, seen_axis: tuple[float, float] | None, k: int
) -> Iterator[Symbol]:
    """Draw the ground at a joint that is mounted there.

    seen_axis: its axis in the view, None if it points to the viewer
    """
    if GROUND not in (joint.a, joint.b) or kind.hold.gap_type == "curve":
        return
    other = joint.b if joint.a == GROUND else joint.a
    place = posed_machine.project(joint.b, joint.q, k)
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
    yield Symbol(*to_pair(place), symbol, ground_direction, None, f"{joint.name}: on the ground")


def _draw_rod(posed_machine: PosedMachine, joint: JointGeometry, k: int) -> list[Item]:
    """Draw a rod, a rope, or a rod whose length is driven."""
    joint_spec = posed_machine.spec.joints[joint.name]
    kind = "rope" if joint_spec.tension_only else "rod"
    pen: int | None = None
    if any(drive.joint == joint.name for drive in posed_machine.spec.drives.values()):
        kind, pen = "actuator", DRIVE_PEN
    what = "rope" if joint_spec.tension_only else joint.kind
    return _draw_link(posed_machine, LineGeometry(joint.name, what, joint.a, joint.p, joint.b, joint.q), kind, pen, k)


def draw_force_line(posed_machine: PosedMachine, line: LineGeometry, k: int) -> list[Item]:
    """Draw a load between two points by its symbol, with or without damper, or one between two bodies."""
    if line.name in posed_machine.guided_actuators:
        return []  # drawn as what it exerts
    kind = LOAD_KINDS[line.kind]
    if kind.place == "bodies":
        return _draw_bushing(posed_machine, line, k)
    is_damped = bool(getattr(posed_machine.spec.forces[line.name], "damping", 0.0))
    return _draw_link(posed_machine, line, kind.symbols[-1 if is_damped else 0], LOAD_PEN, k)


def draw_belt_strands(posed_machine: PosedMachine, k: int) -> Iterator[Strokes]:
    """Draw the strands of belts."""
    for belt in posed_machine.machine.belts:
        yield Strokes(posed_machine.project(belt.carrier, belt.strands, k), LOAD_PEN, ARM_WIDTH)


def _draw_bushing(posed_machine: PosedMachine, line: LineGeometry, k: int) -> list[Item]:
    """Draw two sleeves about the bushing's `to` point, with the ground if it is mounted there, and a line if it is
    displaced.
    """
    first, second = (posed_machine.project(*end, k) for end in ((line.a, line.p), (line.b, line.q)))
    displacement_line = Strokes(np.array([[first, second]]), LOAD_PEN, OUTLINE_WIDTH, is_ghost=k > 0)
    if k > 0:
        return [displacement_line]
    items: list[Item] = [displacement_line]
    for body, place in ((line.a, first), (line.b, second)):
        if body == GROUND:
            other = line.b if body == line.a else line.a
            ground_direction = choose_ground_side(place, posed_machine.project(other, posed_machine.centers[other], k))
            items.append(Symbol(*to_pair(place), "foot", ground_direction, None, f"{line.name}: on the ground"))
    return [*items, Symbol(*to_pair(second), "bushing", (1.0, 0.0), LOAD_PEN, f"{line.name}: bushing")]


def _draw_link(posed_machine: PosedMachine, line: LineGeometry, kind: str, pen: int | None, k: int) -> list[Item]:
    """Draw the link between two points, with the ground at those that are fixed to it."""
    first, second = (posed_machine.project(*end, k) for end in ((line.a, line.p), (line.b, line.q)))
    if k > 0:
        return [Strokes(np.array([[first, second]]), pen, OUTLINE_WIDTH, is_ghost=True)]
    items: list[Item] = []
    for body, place, other in ((line.a, first, second), (line.b, second, first)):
        if body == GROUND:
            items.append(
                Symbol(*to_pair(place), "foot", choose_ground_side(place, other), None, f"{line.name}: on the ground")
            )
    return [*items, Link(*to_pair(first), *to_pair(second), kind, pen, f"{line.name}: {line.kind}")]


def draw_joint_actions(posed_machine: PosedMachine, k: int, drawn_names: Collection[str] = ()) -> Iterator[Symbol]:
    """Draw the drives of joints, and the loads that act in them.

    drawn_names: of loads that have an arrow, and need no symbol
    """
    joints = {joint.name: joint for joint in posed_machine.machine.joints}
    for action in posed_machine.machine.joint_symbols:
        if action.name in drawn_names:
            continue
        joint = joints[action.joint]
        axis = (
            find_path_tangent(posed_machine, joint, k)
            if find_joint_kind(joint, posed_machine.spec).follows_path
            else joint.axis
        )
        axis = axis / np.linalg.norm(axis)
        seen_axis = posed_machine.project_direction(joint.a, axis, k)
        symbol = action.symbols[int(posed_machine.find_depth_component(joint.a, axis, k) < 0.0)]
        symbol_axis = to_pair(seen_axis) if action.slides and seen_axis.any() else (1.0, 0.0)
        kind = "force" if action.load_kind == "torque" and action.slides else action.load_kind
        label = f"{action.name}: {kind} on {action.joint}"
        yield Symbol(*to_pair(posed_machine.project(joint.b, joint.q, k)), symbol, symbol_axis, LOAD_PEN, label)


def find_path_tangent(posed_machine: PosedMachine, joint: JointGeometry, k: int) -> Array:
    """Return the tangent of a path at its point, in axes of its body; where the path crosses itself one of both."""
    path_joint = posed_machine.spec.joints[joint.name]
    assert path_joint.path is not None
    D = posed_machine.poses.locate_points(joint.b, joint.q, k) - posed_machine.poses.locate_points(joint.a, joint.p, k)
    D = D if joint.a == GROUND else D @ posed_machine.poses.orientations[joint.a][k]
    return np.asarray(path_joint.path.evaluate(float(path_joint.path.find_nearest(D)))[1])


def draw_ropes(posed_machine: PosedMachine, k: int) -> Iterator[Strokes]:
    """Draw all ropes at instant k."""
    for rope in posed_machine.machine.ropes:
        for line in iter_rope_lines(rope, posed_machine.poses, k):
            flat = posed_machine.per_si * posed_machine.view.project(line)
            yield Strokes(
                np.stack([flat[:-1], flat[1:]], axis=1),
                LOAD_PEN,
                OUTLINE_WIDTH if k > 0 else ARM_WIDTH,
                is_ghost=k > 0,
            )


def draw_marks(posed_machine: PosedMachine, k: int) -> Iterator[Symbol]:
    """Draw the marks whose direction is visible."""
    for mark in posed_machine.machine.marks:
        places, directions = mark.locate(posed_machine.poses)
        seen_direction = posed_machine.view.project(directions[k])
        if float(np.hypot(*seen_direction)) > MIN_SEEN * float(np.linalg.norm(directions[k])):
            place = posed_machine.per_si * posed_machine.view.project(places[k])
            yield Symbol(*to_pair(place), mark.symbol, to_pair(seen_direction), None, mark.description)


def iter_mark_places(posed_machine: PosedMachine) -> Iterator[Array]:
    """Yield the places of marks at all instants, (n, 2) each."""
    for mark in posed_machine.machine.marks:
        yield posed_machine.per_si * posed_machine.view.project(mark.locate(posed_machine.poses)[0])
