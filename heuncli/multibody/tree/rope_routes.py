"""Find the routes of ropes at the start: past which sides of their sheaves, how long, and the resulting conditions.

Between two places where a rope is held, its ends and the sheaves on which it does not slip, one tension acts in all
strands: one condition, whose parts are the strands, the arcs on the sheaves where it slides, and the wound lengths on
those where it does not (kernel/sheaves.py). Which way round a sheave is meant can only be found from the poses.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise, product

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record, replace
from heuncli.multibody.mechanism.couplings import NO_VECTOR, Coordinate, CoupledRow, Coupling, CouplingPart
from heuncli.multibody.mechanism.loads import GROUND, RopeLoad
from heuncli.multibody.mechanism.model import Assembly, Mechanism
from heuncli.multibody.mechanism.strands import rope_load
from heuncli.multibody.tree.starts import compute_joint_start
from heuncli.results.results import Array
from heuncli.scene.file_format import couplings as spec

# Rope routes

Z = np.array([0.0, 0.0, 1.0])
SIDES = "left (counter-clockwise about the axis) or right"
MAX_OPEN_SIDES = 10  # sheaves of a rope whose sides are found by trying all combinations: a thousand routes


@record
class RopePoint:
    """A point or sheave that a rope passes, at the start: point and axis in body axes, place and normal in world axes.

    carrier: the body that the sheave turns on, its own body if unknown
    turn: the pin's coordinate, times the factor to the sheave's rotation about its axis
    """

    passage: spec.RopePassage
    body: int
    point: Array
    axis: Array
    place: Array
    normal: Array
    carrier: int
    turn: Coordinate | None

    @property
    def radius(self) -> float:
        """Radius of the sheave; 0: a point."""
        return self.passage.radius


@record
class StrandLine:
    """A strand at the start: its direction normal to the sheaves' axis, and its length."""

    t: Array
    length: float
    slant: float  # along the axis, of the length


@record
class RopeRoute:
    """A route round the sheaves: sides, 1 counter-clockwise about each axis, 0 for points; the strands; angles of
    arcs.
    """

    sides: tuple[int, ...]
    strands: tuple[StrandLine, ...]
    arcs: tuple[float, ...]
    length: float


def route_rope(mechanism: Mechanism, start: Assembly, coupling: Coupling) -> Coupling:
    """Add the conditions of a rope; of an elastic one the row along which its load pulls."""
    rope = coupling.entry
    assert isinstance(rope, spec.Rope)
    points = [make_rope_point(mechanism, start, coupling.name, k, passage) for k, passage in enumerate(rope.through)]
    route = find_route(mechanism, coupling.name, points)
    if not (rope.tension_only and rope.restitution is not None):  # else it may be slack there
        require_directions(coupling.name, points)
    held = [k for k, x in enumerate(points) if k in (0, len(points) - 1) or x.passage.grips]
    rows = []
    for first, last in pairwise(held):
        parts = make_parts(start, points, route, first, last)
        length = route_length(points, route, first, last) + wound_length(mechanism, start, parts)
        if rope.length is not None:
            length = rope.length  # the start is moved to it (coupled_start), or the rope is slack
        elif rope.law is not None:
            length = 0.0  # the law gives the whole length, and moves the start
        rows.append(CoupledRow(parts, length, 1.0, rope.tension_only, rope.restitution, rope.law))
    if rope.is_elastic:
        return replace(coupling, stretched_row=rows[0])  # no sheave holds it
    return replace(coupling, rows=tuple(rows))


# Where it passes


def make_rope_point(mechanism: Mechanism, start: Assembly, name: str, k: int, passage: spec.RopePassage) -> RopePoint:
    """Make one point of a rope."""
    names = [body.name for body in mechanism.bodies]
    body = GROUND if passage.end.body == "ground" else names.index(passage.end.body)
    point = np.array(passage.end.point)
    x, R = body_pose(start, body)
    pins = find_pins(mechanism, body, point) if passage.radius else []
    axis = Z if passage.axis is None else normalize(np.array(passage.axis))
    if passage.radius and passage.axis is None and not mechanism.planar:
        if not pins or not all(is_parallel(a, pins[0][1]) for _, a, _, _ in pins):
            message = f"the sheave has no axis: {'more than one pin' if pins else 'no pin'} at its centre"
            raise rope_error(name, k, "rope-axis", message, "axis: [x, y, z], in the axes of its body")
        axis = pins[0][1]
        if passage.side in ("left", "right") and any(float(a @ axis) < 0.0 for _, a, _, _ in pins):
            message = (
                "the axes of the pins at the sheave's centre have opposite directions: left and right are undefined"
            )
            raise rope_error(name, k, "rope-axis", message, "axis: [x, y, z], in the axes of its body")
    coaxial = [
        (carrier, joint, sign * float(np.sign(a @ axis))) for joint, a, carrier, sign in pins if is_parallel(a, axis)
    ]
    carrier, turn = body, None
    if coaxial:
        carrier, joint, sign = coaxial[0]
        turn = Coordinate(joint, "angle", sign)
    elif passage.grips:
        message = "the sheave has no pin about its axis, whose angle would give the rope length wound on it"
        raise rope_error(
            name, k, "rope-grip", message, "mount its body on a pin through the sheave's centre, or give slip: free"
        )
    return RopePoint(passage, body, point, axis, x + R @ point, R @ axis, carrier, turn)


def body_pose(start: Assembly, body: int) -> tuple[Array, Array]:
    """Position of a body's origin and its attitude."""
    if body == GROUND:
        return np.zeros(3), np.eye(3)
    return start.position[body], start.rotation[body]


def find_pins(mechanism: Mechanism, body: int, point: Array) -> list[tuple[int, Array, int, float]]:
    """Find the pins of a body whose axes contain a point: joint, axis in body axes, the other body, sense of rotation.

    The sense is 1 where the pin's angle is the body's rotation about that axis relative to the other body.
    """
    pins = []
    for k, joint in enumerate(mechanism.joints):
        if joint.kind not in ("pin", "spun pin") or body not in (joint.a, joint.b):
            continue
        is_to = joint.b == body
        q, other, sign = (joint.q, joint.a, 1.0) if is_to else (joint.p, joint.b, -1.0)
        axis = joint.to_axis if is_to else joint.axis
        if mechanism.planar:  # the pin's own angle runs about z or about -z
            axis = math.copysign(1.0, float(axis[2])) * Z
        arm = point - q
        offset = arm - (arm @ axis) * axis
        if offset @ offset <= (tolerances.ON_AXIS * (1.0 + math.sqrt(float(arm @ arm)))) ** 2:
            pins.append((k, axis, other, sign))
    return pins


def is_parallel(a: Array, b: Array) -> bool:
    """Return whether two unit vectors are along one line."""
    off = np.cross(a, b)
    return bool(off @ off <= tolerances.ON_AXIS**2)


def normalize(a: Array) -> Array:
    """Return the direction of a nonzero vector."""
    a = a / np.abs(a).max()
    return np.asarray(a / np.sqrt(a @ a))


def rope_error(name: str, k: int | None, code: str, message: str, hint: str) -> SolveError:
    """Make the error of a rope, or of one of its points."""
    path = f"couplings.{name}" if k is None else f"couplings.{name}.through.{k}"
    return SolveError(Problem(code, message, None, hint, path))


# Which way it runs


def find_strand(a: RopePoint, b: RopePoint, side_a: int, side_b: int) -> StrandLine | None:
    """Find the strand from one point to the next, past the given sides; None where a sheave blocks it."""
    if not a.radius and not b.radius:
        D = b.place - a.place
        length = float(np.sqrt(D @ D))
        return StrandLine(D / (length or 1.0), length, 0.0)
    n = a.normal if a.radius else b.normal
    other = float(np.sign(n @ b.normal)) if a.radius and b.radius else 1.0
    sigma = side_a * a.radius - other * side_b * b.radius
    D = b.place - a.place
    h = float(n @ D)
    p = D - h * n
    square = float(p @ p)
    free = square - sigma**2
    if not free > 0.0:
        return None
    l, length = math.sqrt(free), math.sqrt(free + h * h)
    return StrandLine((l * p + sigma * np.cross(n, p)) / square, length, h / length)


def arc_angle(x: RopePoint, side: int, incoming: Array, outgoing: Array) -> float:
    """Angle by which a rope wraps a sheave, at least 0 and less than a whole turn."""
    if not x.radius:
        return 0.0
    angle = math.atan2(side * float(x.normal @ np.cross(incoming, outgoing)), float(incoming @ outgoing))
    return angle if angle >= -tolerances.ON_AXIS else angle + 2.0 * math.pi


def make_route(points: Sequence[RopePoint], sides: tuple[int, ...]) -> RopeRoute | None:
    """Make the route past given sides; None where there is none."""
    strands = []
    for (a, side_a), (b, side_b) in pairwise(zip(points, sides, strict=True)):
        strand = find_strand(a, b, side_a, side_b)
        if strand is None:
            return None
        strands.append(strand)
    inner = zip(points[1:-1], sides[1:-1], strands[:-1], strands[1:], strict=True)
    arcs = (0.0, *(arc_angle(x, s, incoming.t, outgoing.t) for x, s, incoming, outgoing in inner), 0.0)
    length = sum(x.length for x in strands) + sum(x.radius * angle for x, angle in zip(points, arcs, strict=True))
    return RopeRoute(sides, tuple(strands), arcs, length)


def find_route(mechanism: Mechanism, name: str, points: list[RopePoint]) -> RopeRoute:
    """Find the route of a rope: past the sides that are given, otherwise the shortest. Raises SolveError."""
    for k, (a, b) in enumerate(pairwise(points)):
        if a.radius and b.radius and not is_parallel(a.normal, b.normal):
            message = "the axes of this sheave and the previous one are not parallel: no strand lies in both planes"
            hint = "put a plain point between them, or replace one of them by a plain point"
            raise rope_error(name, k + 1, "rope-askew", message, hint)
    require_separate(name, points)
    unnamed = [k for k, x in enumerate(points) if x.radius and x.passage.side not in ("left", "right")]
    if len(unnamed) > MAX_OPEN_SIDES:
        message = (
            f"no side is given for {len(unnamed)} sheaves of the rope; at most {MAX_OPEN_SIDES} sides can be found"
        )
        raise rope_error(name, unnamed[0], "rope-side", message, f"side: {SIDES}")
    vertical = vertical_direction(mechanism)
    known = [{"left": 1, "right": -1}.get(x.passage.side or "", 0) if x.radius else 0 for x in points]
    routes = []
    for trial in product((1, -1), repeat=len(unnamed)):
        sides = list(known)
        for k, side in zip(unnamed, trial, strict=True):
            sides[k] = side
        route = make_route(points, tuple(sides))
        if route is not None and all(matches_side(points, route, k, vertical) for k in unnamed):
            routes.append(route)
    if not routes:
        message = "no route exists for the given sides: one of the sheaves blocks a strand"
        raise rope_error(name, None, "rope-side", message, f"side: {SIDES}")
    routes.sort(key=lambda route: route.length)
    if len(routes) > 1 and routes[1].length - routes[0].length <= tolerances.OPEN_GAP * routes[0].length:
        k = next(k for k in unnamed if routes[0].sides[k] != routes[1].sides[k])
        message = "no side is given for this sheave, and both routes are equally short"
        raise rope_error(name, k, "rope-side", message, f"side: over, under, {SIDES}")
    return routes[0]


def require_separate(name: str, points: Sequence[RopePoint]) -> None:
    """Raise SolveError where a point of a rope lies on, or inside, the sheave before or after it."""
    for k, (a, b) in enumerate(pairwise(points)):
        sheave, inner, index = (a, b, k + 1) if a.radius >= b.radius else (b, a, k)
        D = inner.place - sheave.place
        offset = D - (D @ sheave.normal) * sheave.normal
        distance = float(np.sqrt(offset @ offset))
        if sheave.radius and distance <= (sheave.radius - inner.radius) * (1.0 + tolerances.ON_AXIS):
            description = f"this sheave of radius {inner.radius:.6g} m" if inner.radius else "this point"
            where = "before" if sheave is a else "after"
            message = (
                f"{description} is {distance:.6g} m from the axis of the sheave {where} it, which has "
                f"radius {sheave.radius:.6g} "
                "m: no strand can reach it"
            )
            hint = (
                "move it outside the sheave; to wind rope on a sheave, end it with the sheave itself, with slip: none"
                if index in (0, len(points) - 1)
                else "move one of them, or make the sheave smaller"
            )
            raise rope_error(name, index, "rope-side", message, hint)


def require_directions(name: str, points: Sequence[RopePoint]) -> None:
    """Raise SolveError where two points of a taut rope coincide."""
    tolerance = tolerances.NO_LENGTH * max(float(np.abs(x.place).max()) for x in points)
    for k, (a, b) in enumerate(pairwise(points)):
        if not (a.radius or b.radius) and float(np.abs(b.place - a.place).max()) <= tolerance:
            message = "this point and the one before it coincide at the start: the strand between them has no direction"
            hint = "move one of them, or leave one out; if the rope is slack there, give tension_only and restitution"
            raise rope_error(name, k + 1, "no-length", message, hint)


def vertical_direction(mechanism: Mechanism) -> Array:
    """Return the upward direction: against gravity; without it y in a planar scene, else z."""
    g = mechanism.gravity
    if float(g @ g) > 0.0:
        return normalize(-g)
    return np.array([0.0, 1.0, 0.0]) if mechanism.planar else Z


def matches_side(points: Sequence[RopePoint], route: RopeRoute, k: int, vertical: Array) -> bool:
    """Return whether the rope runs over, or under, a sheave as given."""
    side = points[k].passage.side
    if side not in ("over", "under"):
        return True
    n, s = points[k].normal, route.sides[k]
    t = route.strands[max(k - 1, 0)].t
    half = 0.5 * route.arcs[k]
    t = math.cos(half) * t + s * math.sin(half) * np.cross(n, t)
    height = s * float(np.cross(t, n) @ vertical)
    return height > 0.0 if side == "over" else height < 0.0


# The conditions


def make_parts(
    start: Assembly, points: Sequence[RopePoint], route: RopeRoute, first: int, last: int
) -> tuple[CouplingPart, ...]:
    """Make the parts of the condition between two points where a rope is held."""
    count = last - first
    signed_radii = [s * x.radius for s, x in zip(route.sides, points, strict=True)]
    parts = [
        make_strand_part(points[k], points[k + 1], signed_radii[k], signed_radii[k + 1]) for k in range(first, last)
    ]
    for k in range(first + 1, last):
        x, strand = points[k], k - 1 - first
        if x.radius:
            arc = CouplingPart("arc", x.body, x.body, x.point, x.point, x.axis, radius=signed_radii[k], strand=strand)
            parts.append(arc)
    for k, strand, sense in ((first, 0, 1.0), (last, count - 1, -1.0)):
        if points[k].radius:
            parts.append(
                make_wound_part(start, points[k], sense * signed_radii[k], route.strands[first + strand].t, strand)
            )
    return tuple(parts)


def make_strand_part(a: RopePoint, b: RopePoint, at_a: float, at_b: float) -> CouplingPart:
    """Make the part of a strand: between two points, or relative to the sheave that it winds on."""
    if not a.radius and not b.radius:
        return CouplingPart("rod", a.body, b.body, a.point, b.point)
    if not a.radius:
        return CouplingPart("strand", b.body, a.body, b.point, a.point, b.axis, (-at_b, 0.0, -1.0))
    other = float(np.sign(a.normal @ b.normal)) if b.radius else 1.0
    axis_b = other * b.axis if b.radius else NO_VECTOR
    return CouplingPart(
        "strand", a.body, b.body, a.point, b.point, a.axis, (at_a, other * at_b, 1.0), other_axis=axis_b
    )  # fmt: skip


def make_wound_part(start: Assembly, x: RopePoint, signed_radius: float, t: Array, strand: int) -> CouplingPart:
    """Make the part of the length wound on a sheave on which the rope does not slip; zero at the start."""
    _, R = body_pose(start, x.carrier)
    turns = () if x.turn is None else (x.turn._replace(ratio=-signed_radius * x.turn.ratio),)
    return CouplingPart(
        "wound",
        x.body,
        x.body,
        x.point,
        x.point,
        t @ R,
        x.normal @ R,
        1.0,
        x.carrier,
        turns,
        radius=signed_radius,
        strand=strand,
    )


def route_length(points: Sequence[RopePoint], route: RopeRoute, first: int, last: int) -> float:
    """Length of the rope between two points where it is held."""
    length = sum(route.strands[k].length for k in range(first, last))
    return length + sum(points[k].radius * route.arcs[k] for k in range(first + 1, last))


def wound_length(mechanism: Mechanism, start: Assembly, parts: Sequence[CouplingPart]) -> float:
    """Contribution of the sheaves' rotations at the start to a condition's length."""
    coordinates = [turn for part in parts for turn in part.coordinates]
    return sum(x.ratio * compute_joint_start(mechanism, start, mechanism.joints[x.joint]).angle for x in coordinates)


# Couplings at start


def add_start_couplings(mechanism: Mechanism, start: Assembly, t0: float) -> Mechanism:
    """Add the conditions of such couplings, and the loads of elastic ropes, to the mechanism.

    Raises SolveError where they are impossible.
    """
    couplings = tuple(
        BUILDERS[coupling.entry.type](mechanism, start, coupling) if coupling.entry.type in BUILDERS else coupling
        for coupling in mechanism.couplings
    )
    loads = tuple(make_rope_load(coupling, t0) for coupling in couplings if coupling.stretched_row is not None)
    return replace(mechanism, couplings=couplings, loads=(*mechanism.loads, *loads))


def make_rope_load(coupling: Coupling, t0: float) -> RopeLoad:
    """Make the load of an elastic rope, with its unloaded length as given, or as assembled."""
    rope, row = coupling.entry, coupling.stretched_row
    assert isinstance(rope, spec.Rope) and row is not None and row.length is not None
    length = row.length if rope.law is None else rope.law.value(t0)
    return rope_load(coupling.name, rope, row, length)


BUILDERS = {"rope": route_rope}
