"""A machine as a view shows it: its bodies from the farthest to the nearest, what joins them, its joints, their names.

The joints' symbols follow from how they hold and let turn (joint_kinds.py), so that a new kind has one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import TYPES, Kind
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.output.drawing.figure import Item, Link, PlaceLabel, Polygon, Strokes, Symbol
from heuncli.output.figures.lettered import letters
from heuncli.output.machine_geometry.acting import kind_in
from heuncli.output.machine_geometry.machine import BodyLook, JointLook, LineLook, Machine
from heuncli.output.machine_geometry.poses import Poses
from heuncli.output.machine_geometry.silhouettes import SeenSolid, edges_seen, outline, silhouette, solid_of
from heuncli.output.machine_geometry.views import SceneView
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Bushing, Spec, Spring
from heuncli.scene.file_format.names import GROUND

PENS = (0, 2, 4, 6, 7)  # of bodies, by turns; the others are of what acts
DRIVEN, APPLIED = 3, 3
ALONG = 0.35  # of a unit axis that is seen: what shows less of it points at the eye
MOST_NAMED = 60  # bodies and joints: beyond that a picture of names alone
MOST_CENTRES = 40  # bodies whose centres of mass are marked
BAR, ARM, RIM, THIN = 3.0, 2.0, 1.3, 0.7  # pixels: a body that is lines, lines beside shapes, on them, later ones
LEVEL = 1e-6  # of the depth of a picture: what is as far
DOWN, UP = (0.0, -1.0), (0.0, 1.0)
STEEP = 0.2  # rise over run: what goes down less steeply from its support does not hang
TURNS: Mapping[str, tuple[str, str]] = {  # how it lets turn, seen along the axis and from aside
    "free": ("ball", "ball"), "axis": ("circle", "barrel"), "square": ("cross", "cross"),
    "alike": ("rosette", "rosette"), "all": ("square", "square"),
    "slider": ("slider", "slider"),
}  # fmt: skip
HOLDS: Mapping[str, tuple[str, str]] = {"line": ("bore", "guide"), "plane": ("field", "table")}  # along and aside


@record
class Stood:
    """A machine where it stands at some instants, and how it is seen; size: of the unit that is shown in a metre.

    centers: of mass, in body axes.
    """

    spec: Spec
    machine: Machine
    centers: Mapping[str, Array]
    poses: Poses
    view: SceneView
    size: float

    def seen(self, body: str, points: Array, k: int) -> Array:
        """Where a body's points (..., 3) are seen at an instant, (..., 2) in the unit shown."""
        return self.size * self.view.flat(self.poses.at(body, points, k))

    def seen_along(self, body: str, axis: Array, k: int) -> Array:
        """A direction in a body's axes as it is seen, (2,) of its length that is seen."""
        return self.view.flat(axis if body == GROUND else self.poses.attitudes[body][k] @ axis)

    def sense(self, body: str, axis: Array, k: int) -> float:
        """How much a direction in a body's axes points to the eye, -1 to 1."""
        return float(self.view.depth(axis if body == GROUND else self.poses.attitudes[body][k] @ axis))

    @cached_property
    def solids(self) -> dict[str, tuple[SeenSolid, ...]]:
        """The solids of each body."""
        shown = {body.name: body.surfaces for body in self.machine.bodies}
        for look in self.machine.joints:  # of what cannot turn nobody asks for the inertia
            if GROUND in (look.a, look.b) and kind_of(look, self.spec).turn.asks == "all":
                shown |= {
                    body.name: () for body in self.machine.bodies if body.spread and body.name in (look.a, look.b)
                }
        return {name: tuple(map(solid_of, surfaces)) for name, surfaces in shown.items()}

    @cached_property
    def pens(self) -> dict[str, int]:
        """A pen for each body."""
        return {body.name: PENS[k % len(PENS)] for k, body in enumerate(self.machine.bodies)}

    @cached_property
    def are_named(self) -> bool:
        """Whether the bodies and joints are few enough for their names to be told."""
        return len(self.machine.bodies) + len(self.machine.joints) <= MOST_NAMED

    @cached_property
    def masses(self) -> dict[str, list[Array]]:
        """The point masses of each body, in its axes."""
        return {
            name: [np.array(shape.at) for shape in body.shapes or () if shape.type == "point"]
            for name, body in self.spec.bodies.items()
        }

    def below(self, body: str, place: Array, k: int) -> tuple[float, float]:
        """Where the ground is drawn that holds a body at a place: under it, over it where the body hangs."""
        if body == GROUND:
            return DOWN
        return ground_side(place, self.seen(body, self.centers[body], k))


def ground_side(place: Array, other: Array) -> tuple[float, float]:
    """On which side of a place the ground is drawn that holds it: below, or above where what it holds hangs from it."""
    return UP if other[1] < place[1] - STEEP * abs(other[0] - place[0]) else DOWN


class SeenPiece(NamedTuple):
    """A part of a body with what is drawn of it: how near it is, how large, to be drawn in this order."""

    depth: float
    area: float
    items: tuple[Item, ...]


def bodies(stood: Stood, k: int, *, thin: bool = False) -> list[Item]:
    """The bodies at an instant, far ones first; what lies equally far large ones first."""
    pieces = [piece for body in stood.machine.bodies for piece in _pieces(stood, body, k, thin)]
    depths = [piece.depth for piece in pieces if piece.depth > -np.inf]
    step = LEVEL * (max(depths) - min(depths)) if depths else 0.0

    def order(piece: SeenPiece) -> tuple[float, float]:
        level = piece.depth if step == 0.0 or piece.depth == -np.inf else round(piece.depth / step)
        return float(level), -piece.area

    pieces.sort(key=order)
    paths = (stood.seen(GROUND, path, k) for path in stood.machine.paths if not thin)
    ways: list[Item] = [Strokes(np.stack([ends[:-1], ends[1:]], axis=1), None, THIN) for ends in paths]
    return ways + [item for piece in pieces for item in piece.items]


def _pieces(stood: Stood, body: BodyLook, k: int, thin: bool) -> Iterator[SeenPiece]:
    """The solids of a body, or the lines between its points."""
    pen = stood.pens[body.name]
    for solid in stood.solids[body.name]:
        places = stood.poses.at(body.name, solid.surface.corners, k)
        around = outline(stood.size * stood.view.flat(places))
        if body.spread:
            yield SeenPiece(-np.inf, area(around), (Polygon(body.name, around, pen, filled=not thin, width=THIN),))
            continue
        if not solid.surface.convex:
            yield _mesh(stood, body, solid, k, thin)
            continue
        lines: tuple[Item, ...] = ()
        if not thin:
            edges = edges_seen(solid, stood.poses.attitudes[body.name][k], stood.view)
            lines = (Strokes(stood.seen(body.name, edges, k), pen, THIN),)
        shape = Polygon(body.name, around, pen, solid=not thin, width=THIN if thin else 1.3)
        yield SeenPiece(float(stood.view.depth(places).mean()), area(around), (shape, *lines))
    for number, line in enumerate(body.strokes):
        if len(line) > 1:
            places = stood.poses.at(body.name, line, k)
            ends = stood.seen(body.name, line, k)
            width = RIM if number >= len(body.bars) else ARM if stood.solids[body.name] else BAR
            strokes = Strokes(np.stack([ends[:-1], ends[1:]], axis=1), pen, THIN if thin else width)
            yield SeenPiece(float(stood.view.depth(places).mean()), 0.0, (strokes,))


def _mesh(stood: Stood, body: BodyLook, solid: SeenSolid, k: int, thin: bool) -> SeenPiece:
    """A body of any form: its silhouette, one sees through its holes, and its edges on this side."""
    pen = stood.pens[body.name]
    R = stood.poses.attitudes[body.name][k]
    flat = stood.seen(body.name, solid.surface.corners, k)
    lines = [flat[line] for line in silhouette(solid, R, stood.view)]
    around = np.concatenate([np.concatenate([line, line[:1]]) for line in lines] or [flat[:0]])
    back = [line[:1] for line in lines[-2::-1]]  # the way between the lines, there and back, has no width
    rims = [np.stack([line, np.roll(line, -1, axis=0)], axis=1) for line in lines]
    items: list[Item] = [Polygon(body.name, np.concatenate([around, *back]), pen, solid=not thin, outlined=False)]
    items.append(Strokes(np.concatenate([flat[:0].reshape(0, 2, 2), *rims]), pen, THIN if thin else 1.3))
    if not thin:
        items.append(Strokes(stood.seen(body.name, edges_seen(solid, R, stood.view), k), pen, THIN))
    depth = float(stood.view.depth(stood.poses.at(body.name, solid.surface.corners, k)).mean())
    return SeenPiece(depth, sum(abs(area(stood.size * line)) for line in lines), tuple(items))


def on_paper(place: Array) -> tuple[float, float]:
    """The two numbers of a place (2,)."""
    x, y = place.tolist()
    return float(x), float(y)


def area(corners: Array) -> float:
    """The area of a polygon (n, 2)."""
    x, y = corners.T
    return 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def joints(stood: Stood, k: int, *, thin: bool = False) -> list[Item]:
    """The joints, those that slide beneath those that turn: a pin in a slider stands before it."""
    looks = sorted(stood.machine.joints, key=lambda look: not kind_of(look, stood.spec).shifts)
    return [item for look in looks for item in joint(stood, look, k, thin=thin)]


def kind_of(joint: JointLook, spec: Spec) -> Kind:
    """What a joint is, in a scene declared planar, too."""
    return kind_in(spec, joint.kind)


def turning(kind: Kind) -> str:
    """How a joint lets turn: a row of TURNS."""
    if kind.turn.asks == "all" and kind.shifts:
        return "slider"
    return "axis" if kind.turn.asks == "free" and not kind.ball else kind.turn.asks


def joint(stood: Stood, look: JointLook, k: int, *, thin: bool = False) -> list[Item]:
    """The symbol of a joint, with the ground where it stands on it; thin: a line, if it is one."""
    kind, name = kind_of(look, stood.spec), f"{look.name}: {look.kind}"
    x, y = stood.seen(look.b, look.q, k).tolist()
    if kind.keeps_distance:
        return _rod(stood, look, k, thin)
    if thin:
        return []
    if not stood.are_named and GROUND not in (look.a, look.b):
        return [Symbol(x, y, "dot")]
    axis = stood.seen_along(look.a, look.axis / np.linalg.norm(look.axis), k)
    aside = int(float(np.hypot(*axis)) > ALONG)
    along = (float(axis[0]), float(axis[1])) if aside else (1.0, 0.0)
    items: list[Item] = [*_ground(stood, look, kind, along if aside else None, k)]
    if kind.hold.asks in HOLDS:
        items.append(Symbol(x, y, HOLDS[kind.hold.asks][aside], along, None, name))
    # a ball in a bore that is seen from its end holds in the picture as a pin does
    turn = "axis" if kind.hold.asks == "line" and not aside and kind.ball else turning(kind)
    items.append(Symbol(x, y, TURNS[turn][aside], along, None, name))
    return items


def _ground(stood: Stood, look: JointLook, kind: Kind, along: tuple[float, float] | None, k: int) -> Iterator[Symbol]:
    """The ground at a joint that stands on it; along: its axis as it is seen, None: towards the eye."""
    if GROUND not in (look.a, look.b) or kind.hold.asks == "curve":
        return
    other = look.b if look.a == GROUND else look.a
    place = stood.seen(look.b, look.q, k)
    below = stood.below(other, place, k)
    symbol = "foot"
    if kind.hold.asks in HOLDS:
        symbol = "bed"
        if along is not None and kind.hold.asks == "line":
            across = np.array([-along[1], along[0]])
            below = tuple((across if across @ below > 0.0 else -across).tolist())
        elif along is not None:
            below = -along[0], -along[1]
    elif kind.turn.asks == "all":
        symbol = "clamp"
        away = place - stood.seen(other, stood.centers[other], k) if other != GROUND else np.zeros(2)
        below = tuple(away.tolist()) if away.any() else DOWN
    yield Symbol(*on_paper(place), symbol, below, None, f"{look.name}: on the ground")


def _rod(stood: Stood, look: JointLook, k: int, thin: bool) -> list[Item]:
    """A rod, a rope, or a rod whose length is driven."""
    own = stood.spec.joints[look.name]
    kind = "rope" if own.tension_only else "rod"
    pen: int | None = None
    if any(drive.joint == look.name for drive in stood.spec.drives.values()):
        kind, pen = "actuator", DRIVEN
    what = "rope" if own.tension_only else look.kind
    return _link(stood, LineLook(look.name, what, look.a, look.p, look.b, look.q), kind, pen, k, thin)


def line(stood: Stood, look: LineLook, k: int, *, thin: bool = False) -> list[Item]:
    """A spring, damped or not, or an actuator."""
    force = stood.spec.forces[look.name]
    if isinstance(force, Bushing):
        return _bushing(stood, look, k, thin)
    kind = "damped spring" if isinstance(force, Spring) and force.damping else look.kind
    return _link(stood, look, kind, APPLIED, k, thin)


def strands(stood: Stood, k: int) -> Iterator[Strokes]:
    """The strands of belts."""
    for belt in stood.machine.belts:
        yield Strokes(stood.seen(belt.carrier, belt.strands, k), APPLIED, ARM)


def _bushing(stood: Stood, look: LineLook, k: int, thin: bool) -> list[Item]:
    """Two sleeves about its `to` point, with the ground behind them where it stands on that; moved apart: a line."""
    first, second = (stood.seen(*end, k) for end in ((look.a, look.p), (look.b, look.q)))
    apart = Strokes(np.array([[first, second]]), APPLIED, THIN)
    if thin:
        return [apart]
    items: list[Item] = [apart]
    for body, place in ((look.a, first), (look.b, second)):
        if body == GROUND:
            other = look.b if body == look.a else look.a
            below = ground_side(place, stood.seen(other, stood.centers[other], k))
            items.append(Symbol(*on_paper(place), "foot", below, None, f"{look.name}: on the ground"))
    return [*items, Symbol(*on_paper(second), "bushing", (1.0, 0.0), APPLIED, f"{look.name}: bushing")]


def _link(stood: Stood, look: LineLook, kind: str, pen: int | None, k: int, thin: bool) -> list[Item]:
    """What joins two points, with the ground at those that stand on it."""
    first, second = (stood.seen(*end, k) for end in ((look.a, look.p), (look.b, look.q)))
    if thin:
        return [Strokes(np.array([[first, second]]), pen, THIN)]
    items: list[Item] = []
    for body, place, other in ((look.a, first, second), (look.b, second, first)):
        if body == GROUND:
            items.append(
                Symbol(*on_paper(place), "foot", ground_side(place, other), None, f"{look.name}: on the ground")
            )
    return [*items, Link(*on_paper(first), *on_paper(second), kind, pen, f"{look.name}: {look.kind}")]


def in_joints(stood: Stood, k: int) -> Iterator[Symbol]:
    """What drives joints, and what acts in them."""
    looks = {look.name: look for look in stood.machine.joints}
    for own in stood.machine.acting:
        look = looks[own.joint]
        axis = way_along(stood, look, k) if kind_of(look, stood.spec).follows_path else look.axis
        axis = axis / np.linalg.norm(axis)
        seen = stood.seen_along(look.a, axis, k)
        symbol = own.symbols[int(stood.sense(look.a, axis, k) < 0.0)]
        along = on_paper(seen) if own.slides and seen.any() else (1.0, 0.0)
        told = f"{own.name}: {own.what} in {own.joint}"
        yield Symbol(*on_paper(stood.seen(look.b, look.q, k)), symbol, along, APPLIED, told)


def way_along(stood: Stood, look: JointLook, k: int) -> Array:
    """Which way a path goes on where its point is, axes of its body; where it crosses itself one of both."""
    joint = stood.spec.joints[look.name]
    assert joint.path is not None
    D = stood.poses.at(look.b, look.q, k) - stood.poses.at(look.a, look.p, k)
    D = D if look.a == GROUND else D @ stood.poses.attitudes[look.a][k]
    return np.asarray(joint.path.at(float(joint.path.nearest(D)))[1])


def marks(stood: Stood, k: int) -> Iterator[Symbol]:
    """Point masses and centres of mass."""
    few = len(stood.machine.bodies) <= MOST_CENTRES
    for body in stood.machine.bodies:
        pen, centre = stood.pens[body.name], stood.centers[body.name]
        masses = stood.masses[body.name]
        for place in masses:
            at = on_paper(stood.seen(body.name, place, k))
            yield Symbol(*at, "mass", (1.0, 0.0), pen, f"{body.name}: point mass")
        near = tolerances.ONE_PLACE * float(np.abs(centre).max())
        if few and not any(np.abs(place - centre).max() <= near for place in masses):
            at = on_paper(stood.seen(body.name, centre, k))
            yield Symbol(*at, "centre", (1.0, 0.0), pen, f"{body.name}: centre of mass")


def names(stood: Stood, k: int) -> Iterator[PlaceLabel]:
    """The names of bodies, joints, springs and actuators; in letters capitals, numbers and small letters."""
    if not stood.are_named:
        return
    for letter, body in zip(letters("A"), stood.machine.bodies, strict=False):
        x, y = stood.seen(body.name, stood.centers[body.name], k).tolist()
        yield PlaceLabel(x, y, body.name, letter, stood.pens[body.name])
    for number, look in enumerate(stood.machine.joints, 1):
        ends = stood.seen(look.b, look.q, k), stood.seen(look.a, look.p, k)
        x, y = (0.5 * (ends[0] + ends[1]) if TYPES[look.kind].keeps_distance else ends[0]).tolist()
        yield PlaceLabel(x, y, look.name, str(number))
    for letter, own in zip(letters("a"), stood.machine.lines, strict=False):
        x, y = (0.5 * (stood.seen(own.a, own.p, k) + stood.seen(own.b, own.q, k))).tolist()
        yield PlaceLabel(x, y, own.name, letter, APPLIED)
