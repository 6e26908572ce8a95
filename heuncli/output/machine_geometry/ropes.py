"""Ropes as they run at the instants of some poses: strands from where they touch, arcs about sheaves, and the sheaves.

w = ((l p + sigma n x p) / |p|^2) x n        where a strand touches: at_a w off the centre on a, at_b w on b
p: from centre to centre across the axis n;  sigma = at_a - at_b;  l^2 = |p|^2 - sigma^2
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.mechanism.couplings import Coupling, CouplingPart
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.rope_ways import Z, pins_at, unit
from heuncli.output.machine_geometry.discs import Disc
from heuncli.output.machine_geometry.poses import Poses
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import Rope
from heuncli.scene.file_format.names import GROUND

STEP = 0.1  # rad: of an arc as it is drawn


class StrandLook(NamedTuple):
    """A strand between two bodies' points: plain, axis None, or off the centres a and b by signed radii about the axis.

    way: 1 where it runs from a to b.
    """

    a: str
    p: Array
    b: str
    q: Array
    axis: Array | None = None
    at_a: float = 0.0
    at_b: float = 0.0
    way: float = 1.0


class ArcLook(NamedTuple):
    """What lies on a sheave between a strand, by its number, and the next.

    body, centre: the sheave's; axis: about which it runs counter-clockwise, in the axes of the body `along`.
    """

    before: int
    body: str
    centre: Array
    along: str
    axis: Array


class RopeLook(NamedTuple):
    """A rope: its strands from its first end to its last, and its arcs.

    standing: its ends on the ground, each a body and its point, with where the strand there comes from.
    """

    name: str
    strands: tuple[StrandLook, ...]
    arcs: tuple[ArcLook, ...]
    standing: tuple[tuple[tuple[str, Array], tuple[str, Array]], ...]


def ropes_of(mechanism: Mechanism) -> tuple[RopeLook, ...]:
    """The ropes of an assembled mechanism over sheaves and through points."""
    names = [body.name for body in mechanism.bodies]
    bodies = dict(enumerate(names)) | {-1: GROUND}
    return tuple(_rope(own, bodies) for own in mechanism.couplings if own.given.type == "rope")


def _rope(own: Coupling, bodies: Mapping[int, str]) -> RopeLook:
    """One of them; between two sheaves that hold it each condition has strands of its own."""
    ways: list[StrandLook] = []
    arcs: list[ArcLook] = []
    for row in own.carriers:
        first = len(ways)
        ways += [_strand(part, bodies) for part in row.parts if not part.lies]
        for part in row.parts:
            sense, ends = float(np.sign(part.radius)), (bodies[part.a], np.asarray(part.p))
            if part.kind == "arc":
                arcs.append(ArcLook(first + part.strand, *ends, bodies[part.a], sense * np.asarray(part.e)))
            elif part.kind == "wound" and part is row.parts[-1]:  # where it arrives, with the other sign
                arcs.append(ArcLook(len(ways) - 1, *ends, bodies[part.c], -sense * np.asarray(part.g)))
    assert isinstance(own.given, Rope)
    through = own.given.through[0], own.given.through[-1]
    runs = run_of(ways[0]), run_of(ways[-1])[::-1]
    standing = tuple(run for run, x in zip(runs, through, strict=True) if x.end.body == GROUND and not x.radius)
    return RopeLook(own.name, tuple(ways), tuple(arc for arc in arcs if arc.before + 1 < len(ways)), standing)


def _strand(part: CouplingPart, bodies: Mapping[int, str]) -> StrandLook:
    """A strand by its part (kernel/sheaves.py)."""
    ends = bodies[part.a], np.asarray(part.p), bodies[part.b], np.asarray(part.q)
    if part.kind == "rod":
        return StrandLook(*ends)
    at_a, at_b, way = (float(x) for x in part.g)
    return StrandLook(*ends, np.asarray(part.e), at_a, at_b, way)


def run_of(strand: StrandLook) -> tuple[tuple[str, Array], tuple[str, Array]]:
    """The points about which a strand begins and ends, as the rope runs."""
    ends = (strand.a, strand.p), (strand.b, strand.q)
    return ends if strand.way > 0.0 else (ends[1], ends[0])


def sheaves_of(mechanism: Mechanism) -> Iterator[tuple[str, Disc]]:
    """All sheaves, each with its body or the ground; where the rope slides the sheave's turning plays no part."""
    index = {body.name: i for i, body in enumerate(mechanism.bodies)} | {GROUND: -1}
    for own in mechanism.couplings:
        for given in own.given.through if isinstance(own.given, Rope) else ():
            if given.radius:
                point = np.array(given.end.point)
                axis = Z if given.axis is None else unit(np.array(given.axis))
                if given.axis is None and not mechanism.planar:
                    axis = pins_at(mechanism, index[given.end.body], point)[0][1]
                yield given.end.body, Disc(point, axis, given.radius, spins=given.grips)


def strand_ends(rope: RopeLook, poses: Poses) -> Array:
    """Where the strands of a rope begin and end at all instants, (n, strands, 2, 3), as the rope runs."""
    return np.stack([_ends(strand, poses) for strand in rope.strands], axis=1)


def _ends(strand: StrandLook, poses: Poses) -> Array:
    """A strand's two ends, (n, 2, 3)."""
    P, Q = poses.ways(strand.a, strand.p), poses.ways(strand.b, strand.q)
    if strand.axis is None:
        return np.stack([P, Q], axis=1)
    n = poses.directions(strand.a, strand.axis)
    D = Q - P
    p = D - np.sum(n * D, axis=1, keepdims=True) * n
    sigma, square = strand.at_a - strand.at_b, np.sum(p * p, axis=1, keepdims=True)
    l = np.sqrt(np.maximum(square - sigma**2, 0.0))
    w = np.cross((l * p + sigma * np.cross(n, p)) / np.where(square > 0.0, square, 1.0), n)
    ends = np.stack([P + strand.at_a * w, Q + strand.at_b * w], axis=1)
    return ends if strand.way > 0.0 else ends[:, ::-1]


def lines_of(rope: RopeLook, poses: Poses, k: int) -> Iterator[Array]:
    """A rope's strands and what lies on its sheaves at an instant, (n, 3) each."""
    ends = strand_ends(rope, poses)[k]
    yield from ends
    for arc in rope.arcs:
        centre, axis = poses.at(arc.body, arc.centre, k), poses.directions(arc.along, arc.axis)[k]
        yield _bent(centre, axis, ends[arc.before, 1], ends[arc.before + 1, 0])


def _bent(C: Array, n: Array, start: Array, end: Array) -> Array:
    """A line round an axis n through C from one place to another, counter-clockwise about it, (n, 3)."""
    r, to = start - C, end - C
    angle = np.arctan2(float(n @ np.cross(r, to)), float(r @ to)) % (2.0 * np.pi)
    steps = np.linspace(0.0, angle, max(2, int(np.ceil(angle / STEP)) + 1))[:, None]
    return np.asarray(C + np.cos(steps) * r + np.sin(steps) * np.cross(n, r))
