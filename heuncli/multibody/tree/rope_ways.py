"""How ropes run at the start: round which sides of their sheaves, how long they are, and the conditions this makes.

Between two places where a rope is held, its ends and the sheaves on which it does not slip, one tension runs through
all strands: one condition, whose parts are the strands, the arcs on the sheaves where it slides, and what is wound on
those where it does not (kernel/sheaves.py). Which way round a sheave is meant can only be told where the bodies stand.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise, product

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record, replace
from heuncli.multibody.mechanism.couplings import NOWHERE, Coordinate, CoupledRow, Coupling, CouplingPart
from heuncli.multibody.mechanism.model import GROUND, Assembly, Mechanism
from heuncli.multibody.tree.starts import joint_start
from heuncli.results.results import Array
from heuncli.scene.file_format import couplings as spec

Z = np.array([0.0, 0.0, 1.0])
SIDES = "left (counter-clockwise about the axis) or right"
MOST_SIDES = 10  # sheaves of a rope whose sides are found by trying all: a thousand ways


@record
class Stay:
    """Where a rope passes, at the start: in body axes point and axis, in world axes place and normal.

    carrier: the body that the sheave turns on, its own where none is known; turn: the pin's coordinate, times what
    makes it the sheave's turn about its axis.
    """

    given: spec.Passage
    body: int
    point: Array
    axis: Array
    place: Array
    normal: Array
    carrier: int
    turn: Coordinate | None

    @property
    def radius(self) -> float:
        """Of the sheave; 0: a point."""
        return self.given.radius


@record
class StrandLine:
    """A strand at the start: its direction across the sheaves' axis, and its length."""

    t: Array
    length: float
    slant: float  # along the axis, of the length


@record
class RopeWay:
    """A way round the sheaves: sides, 1 counter-clockwise about each axis, 0 of points; the strands; angles of arcs."""

    sides: tuple[int, ...]
    strands: tuple[StrandLine, ...]
    arcs: tuple[float, ...]
    length: float


def routed(mechanism: Mechanism, start: Assembly, coupling: Coupling) -> Coupling:
    """A rope with its conditions; one that stretches with what a load pulls along."""
    rope = coupling.given
    assert isinstance(rope, spec.Rope)
    stays = [stay(mechanism, start, coupling.name, k, given) for k, given in enumerate(rope.through)]
    way = way_round(mechanism, coupling.name, stays)
    if not (rope.tension_only and rope.restitution is not None):  # else it may be slack there
        require_directions(coupling.name, stays)
    held = [k for k, x in enumerate(stays) if k in (0, len(stays) - 1) or x.given.grips]
    rows = []
    for first, last in pairwise(held):
        parts = parts_between(start, stays, way, first, last)
        length = length_between(stays, way, first, last) + wound_at_start(mechanism, start, parts)
        if rope.length is not None:
            length = rope.length  # the start is moved to it (coupled_start), or the rope is slack
        elif rope.law is not None:
            length = 0.0  # the law tells all of it, and moves the start
        rows.append(CoupledRow(parts, length, 1.0, rope.tension_only, rope.restitution, rope.law))
    if rope.stretches:
        return replace(coupling, stretched=rows[0])  # no sheave holds it
    return replace(coupling, rows=tuple(rows))


# Where it passes


def stay(mechanism: Mechanism, start: Assembly, name: str, k: int, given: spec.Passage) -> Stay:
    """One place of a rope."""
    names = [body.name for body in mechanism.bodies]
    body = GROUND if given.end.body == "ground" else names.index(given.end.body)
    point = np.array(given.end.point)
    x, R = pose_of(start, body)
    pins = pins_at(mechanism, body, point) if given.radius else []
    axis = Z if given.axis is None else unit(np.array(given.axis))
    if given.radius and given.axis is None and not mechanism.planar:
        if not pins or not all(parallel(a, pins[0][1]) for _, a, _, _ in pins):
            message = f"the sheave has no axis: {'more than one pin' if pins else 'no pin'} stands at its centre"
            raise refused(name, k, "rope-axis", message, "axis: [x, y, z], in the axes of its body")
        axis = pins[0][1]
        if given.side in ("left", "right") and any(float(a @ axis) < 0.0 for _, a, _, _ in pins):
            message = "the axes of the pins at the sheave's centre point opposite ways: which side is left is not told"
            raise refused(name, k, "rope-axis", message, "axis: [x, y, z], in the axes of its body")
    along = [(carrier, joint, sign * float(np.sign(a @ axis))) for joint, a, carrier, sign in pins if parallel(a, axis)]
    carrier, turn = body, None
    if along:
        carrier, joint, sign = along[0]
        turn = Coordinate(joint, "angle", sign)
    elif given.grips:
        message = "the sheave stands on no pin about its axis, whose turn would tell what is wound on it"
        raise refused(name, k, "rope-grip", message, "a pin of its body through the sheave's centre, or slip: free")
    return Stay(given, body, point, axis, x + R @ point, R @ axis, carrier, turn)


def pose_of(start: Assembly, body: int) -> tuple[Array, Array]:
    """Place of a body's origin and its attitude."""
    if body == GROUND:
        return np.zeros(3), np.eye(3)
    return start.position[body], start.rotation[body]


def pins_at(mechanism: Mechanism, body: int, point: Array) -> list[tuple[int, Array, int, float]]:
    """The pins of a body on whose axes a point lies: joint, axis in the body's axes, the other body, sense of its turn.

    The sense is 1 where the pin's angle is the body's turn about that axis, seen from the other.
    """
    found = []
    for k, joint in enumerate(mechanism.joints):
        if joint.kind not in ("pin", "spun pin") or body not in (joint.a, joint.b):
            continue
        to = joint.b == body
        q, other, sign = (joint.q, joint.a, 1.0) if to else (joint.p, joint.b, -1.0)
        axis = joint.to_axis if to else joint.axis
        if mechanism.planar:  # the pin's own angle runs about z or about -z
            axis = math.copysign(1.0, float(axis[2])) * Z
        arm = point - q
        off = arm - (arm @ axis) * axis
        if off @ off <= (tolerances.ON_AXIS * (1.0 + math.sqrt(float(arm @ arm)))) ** 2:
            found.append((k, axis, other, sign))
    return found


def parallel(a: Array, b: Array) -> bool:
    """Whether two unit vectors stand along one line."""
    off = np.cross(a, b)
    return bool(off @ off <= tolerances.ON_AXIS**2)


def unit(a: Array) -> Array:
    """The direction of a vector that is not zero."""
    a = a / np.abs(a).max()
    return np.asarray(a / np.sqrt(a @ a))


def refused(name: str, k: int | None, code: str, message: str, hint: str) -> SolveError:
    """The error of a rope, or of one of its places."""
    path = f"couplings.{name}" if k is None else f"couplings.{name}.through.{k}"
    return SolveError(Problem(code, message, None, hint, path))


# Which way it runs


def strand_line(a: Stay, b: Stay, side_a: int, side_b: int) -> StrandLine | None:
    """The strand from one place to the next, round given sides; None where a sheave is in its way."""
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


def angle_of_arc(x: Stay, side: int, before: Array, behind: Array) -> float:
    """The angle through which a rope runs round a sheave, at least 0 and less than a whole turn."""
    if not x.radius:
        return 0.0
    angle = math.atan2(side * float(x.normal @ np.cross(before, behind)), float(before @ behind))
    return angle if angle >= -tolerances.ON_AXIS else angle + 2.0 * math.pi


def way_of(stays: Sequence[Stay], sides: tuple[int, ...]) -> RopeWay | None:
    """The way round given sides; None where there is none."""
    strands = []
    for (a, side_a), (b, side_b) in pairwise(zip(stays, sides, strict=True)):
        found = strand_line(a, b, side_a, side_b)
        if found is None:
            return None
        strands.append(found)
    inner = zip(stays[1:-1], sides[1:-1], strands[:-1], strands[1:], strict=True)
    arcs = (0.0, *(angle_of_arc(x, s, before.t, behind.t) for x, s, before, behind in inner), 0.0)
    length = sum(x.length for x in strands) + sum(x.radius * angle for x, angle in zip(stays, arcs, strict=True))
    return RopeWay(sides, tuple(strands), arcs, length)


def way_round(mechanism: Mechanism, name: str, stays: list[Stay]) -> RopeWay:
    """The way that a rope runs: past the sides that are named, else the shortest. Raises SolveError."""
    for k, (a, b) in enumerate(pairwise(stays)):
        if a.radius and b.radius and not parallel(a.normal, b.normal):
            message = "the axes of this sheave and of the one before are not parallel, so that no strand lies in both"
            hint = "a plain point between them, or in place of one of them"
            raise refused(name, k + 1, "rope-askew", message, hint)
    require_apart(name, stays)
    open_ = [k for k, x in enumerate(stays) if x.radius and x.given.side not in ("left", "right")]
    if len(open_) > MOST_SIDES:
        message = f"past which sides of {len(open_)} sheaves the rope runs is not said"
        raise refused(name, open_[0], "rope-side", message, f"side: {SIDES}")
    up = up_in(mechanism)
    known = [{"left": 1, "right": -1}.get(x.given.side or "", 0) if x.radius else 0 for x in stays]
    found = []
    for tried in product((1, -1), repeat=len(open_)):
        sides = list(known)
        for k, side in zip(open_, tried, strict=True):
            sides[k] = side
        way = way_of(stays, tuple(sides))
        if way is not None and all(fits(stays, way, k, up) for k in open_):
            found.append(way)
    if not found:
        message = "no way round the sheaves as their sides are named: one of them is in the way of a strand"
        raise refused(name, None, "rope-side", message, f"side: {SIDES}")
    found.sort(key=lambda way: way.length)
    if len(found) > 1 and found[1].length - found[0].length <= tolerances.OPEN_GAP * found[0].length:
        k = next(k for k in open_ if found[0].sides[k] != found[1].sides[k])
        message = "past which side of this sheave the rope runs is not said, and both are as short"
        raise refused(name, k, "rope-side", message, f"side: over, under, {SIDES}")
    return found[0]


def require_apart(name: str, stays: Sequence[Stay]) -> None:
    """Raise SolveError where one place of a rope lies on, or within, the sheave before it or behind it."""
    for k, (a, b) in enumerate(pairwise(stays)):
        sheave, inner, at = (a, b, k + 1) if a.radius >= b.radius else (b, a, k)
        D = inner.place - sheave.place
        off = D - (D @ sheave.normal) * sheave.normal
        distance = float(np.sqrt(off @ off))
        if sheave.radius and distance <= (sheave.radius - inner.radius) * (1.0 + tolerances.ON_AXIS):
            own = f"this sheave of radius {inner.radius:.6g} m" if inner.radius else "this point"
            where = "before" if sheave is a else "behind"
            message = (
                f"{own} stands {distance:.6g} m from the axis of the sheave {where} it, of radius {sheave.radius:.6g} "
                "m: no strand leads there"
            )
            hint = (
                "move it out of the sheave; what is wound on a sheave ends with the sheave itself, with slip: none"
                if at in (0, len(stays) - 1)
                else "move one of them, or make the sheave smaller"
            )
            raise refused(name, at, "rope-side", message, hint)


def require_directions(name: str, stays: Sequence[Stay]) -> None:
    """Raise SolveError where two points of a taut rope coincide."""
    near = tolerances.NO_LENGTH * max(float(np.abs(x.place).max()) for x in stays)
    for k, (a, b) in enumerate(pairwise(stays)):
        if not (a.radius or b.radius) and float(np.abs(b.place - a.place).max()) <= near:
            message = "this point and the one before it coincide at the start: the strand between has no direction"
            hint = "move one of them, or leave one out; a rope that is slack there has tension_only and restitution"
            raise refused(name, k + 1, "no-length", message, hint)


def up_in(mechanism: Mechanism) -> Array:
    """Which way is up: against gravity; without it y in a planar scene, else z."""
    g = mechanism.gravity
    if float(g @ g) > 0.0:
        return unit(-g)
    return np.array([0.0, 1.0, 0.0]) if mechanism.planar else Z


def fits(stays: Sequence[Stay], way: RopeWay, k: int, up: Array) -> bool:
    """Whether the rope runs over, or under, a sheave as it was said to."""
    side = stays[k].given.side
    if side not in ("over", "under"):
        return True
    n, s = stays[k].normal, way.sides[k]
    t = way.strands[max(k - 1, 0)].t
    half = 0.5 * way.arcs[k]
    t = math.cos(half) * t + s * math.sin(half) * np.cross(n, t)
    height = s * float(np.cross(t, n) @ up)
    return height > 0.0 if side == "over" else height < 0.0


# The conditions


def parts_between(
    start: Assembly, stays: Sequence[Stay], way: RopeWay, first: int, last: int
) -> tuple[CouplingPart, ...]:
    """The parts of the condition between two places where a rope is held."""
    count = last - first
    signed = [s * x.radius for s, x in zip(way.sides, stays, strict=True)]
    parts = [strand_part(stays[k], stays[k + 1], signed[k], signed[k + 1]) for k in range(first, last)]
    for k in range(first + 1, last):
        x, strand = stays[k], k - 1 - first
        if x.radius:
            own = CouplingPart("arc", x.body, x.body, x.point, x.point, x.axis, radius=signed[k], strand=strand)
            parts.append(own)
    for k, strand, sense in ((first, 0, 1.0), (last, count - 1, -1.0)):
        if stays[k].radius:
            parts.append(wound_part(start, stays[k], sense * signed[k], way.strands[first + strand].t, strand))
    return tuple(parts)


def strand_part(a: Stay, b: Stay, at_a: float, at_b: float) -> CouplingPart:
    """A strand; seen from a sheave, where there is one."""
    if not a.radius and not b.radius:
        return CouplingPart("rod", a.body, b.body, a.point, b.point)
    if not a.radius:
        return CouplingPart("strand", b.body, a.body, b.point, a.point, b.axis, (-at_b, 0.0, -1.0))
    other = float(np.sign(a.normal @ b.normal)) if b.radius else 1.0
    axis_b = other * b.axis if b.radius else NOWHERE
    return CouplingPart(
        "strand", a.body, b.body, a.point, b.point, a.axis, (at_a, other * at_b, 1.0), other_axis=axis_b
    )  # fmt: skip


def wound_part(start: Assembly, x: Stay, signed: float, t: Array, strand: int) -> CouplingPart:
    """What is wound on a sheave on which the rope does not slip; none at the start."""
    _, R = pose_of(start, x.carrier)
    turns = () if x.turn is None else (x.turn._replace(ratio=-signed * x.turn.ratio),)
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
        radius=signed,
        strand=strand,
    )


def length_between(stays: Sequence[Stay], way: RopeWay, first: int, last: int) -> float:
    """How long the rope is between two places where it is held."""
    length = sum(way.strands[k].length for k in range(first, last))
    return length + sum(stays[k].radius * way.arcs[k] for k in range(first + 1, last))


def wound_at_start(mechanism: Mechanism, start: Assembly, parts: Sequence[CouplingPart]) -> float:
    """What the turns of sheaves at the start make of a condition's length."""
    counted = [turn for part in parts for turn in part.coordinates]
    return sum(x.ratio * joint_start(mechanism, start, mechanism.joints[x.joint]).angle for x in counted)
