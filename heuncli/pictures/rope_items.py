"""Ropes as they run at an instant: strands from where they touch, arcs about sheaves, and the sheaves' rims."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from heuncli.drawing.figure import Strokes
from heuncli.mechanism.couplings import Coupling, CouplingPart
from heuncli.pictures.machine_items import APPLIED, ARM, THIN, Stood
from heuncli.results import Array
from heuncli.scenery.machine import GROUND
from heuncli.shapes.rotations import perpendicular

STEP = 0.1  # rad: of an arc as it is drawn


def ropes(stood: Stood, k: int, *, thin: bool = False) -> Iterator[Strokes]:
    """All ropes at an instant; thin: one that is not the first."""
    for rope in stood.ropes:
        for line in lines_of(stood, rope, k):
            yield seen(stood, line, THIN if thin else ARM)
        for part in (part for row in rope.carriers for part in row.parts if part.lies and not thin):
            yield seen(stood, rim(stood, part, k), THIN)


def lines_of(stood: Stood, rope: Coupling, k: int) -> Iterator[Array]:
    """A rope's strands and what lies on its sheaves, (n, 3) each."""
    ways: list[Array] = []
    about: dict[int, CouplingPart] = {}  # the sheave behind a strand
    for row in rope.carriers:
        own = [strand(stood, part, k) for part in row.parts if not part.lies]
        arcs = {len(ways) + part.strand: part for part in row.parts if part.kind == "arc"}
        about |= arcs | {len(ways) + len(own) - 1: part for part in row.parts if part.kind == "wound" and part.strand}
        if len(own) == 1:
            about |= {len(ways): part for part in row.parts[-1:] if part.kind == "wound"}
        ways += own
    yield from ways
    for i, (before, behind) in enumerate(pairwise(ways)):
        if i in about:
            yield arc(stood, about[i], before[1], behind[0], k)


def seen(stood: Stood, places: Array, width: float) -> Strokes:
    """A line through places (n, 3), world axes."""
    flat = stood.size * stood.view.flat(places)
    return Strokes(np.stack([flat[:-1], flat[1:]], axis=1), APPLIED, width)


def placed(stood: Stood, body: int, point: Array, k: int) -> Array:
    """World place of a body's point."""
    name = GROUND if body < 0 else list(stood.spec.bodies)[body]
    return np.asarray(stood.poses.at(name, np.asarray(point, dtype=float), k))


def axis_of(stood: Stood, body: int, axis: Array, k: int) -> Array:
    """A direction of a body, world axes."""
    e = np.asarray(axis, dtype=float)
    return e if body < 0 else np.asarray(stood.poses.attitudes[list(stood.spec.bodies)[body]][k] @ e)


def strand(stood: Stood, part: CouplingPart, k: int) -> Array:
    """A strand's two ends, (2, 3), as the rope is listed."""
    P, Q = placed(stood, part.a, np.asarray(part.p), k), placed(stood, part.b, np.asarray(part.q), k)
    if part.kind == "rod":
        return np.array([P, Q])
    n = axis_of(stood, part.a, np.asarray(part.e), k)
    at_a, at_b, way = (float(x) for x in part.g)
    D = Q - P
    p = D - (n @ D) * n
    sigma, square = at_a - at_b, float(p @ p)
    l = np.sqrt(max(square - sigma**2, 0.0))
    w = np.cross((l * p + sigma * np.cross(n, p)) / (square or 1.0), n)
    ends = np.array([P + at_a * w, Q + at_b * w])
    return ends if way > 0.0 else ends[::-1]


def arc(stood: Stood, part: CouplingPart, start: Array, end: Array, k: int) -> Array:
    """What lies on a sheave between two places of its rim, (n, 3)."""
    C, n = placed(stood, part.a, np.asarray(part.p), k), normal(stood, part, k)
    sense = 1.0 if (part.radius > 0.0) == (part.kind == "arc") else -1.0  # wound where it arrives: the other sign
    r, to = start - C, end - C
    angle = np.arctan2(sense * float(n @ np.cross(r, to)), float(r @ to)) % (2.0 * np.pi)
    return turned(C, r, sense * n, float(angle))


def normal(stood: Stood, part: CouplingPart, k: int) -> Array:
    """A sheave's axis, world axes."""
    body, axis = (part.c, part.g) if part.kind == "wound" else (part.a, part.e)
    return axis_of(stood, body, np.asarray(axis), k)


def rim(stood: Stood, part: CouplingPart, k: int) -> Array:
    """A sheave's rim, (n, 3)."""
    n = normal(stood, part, k)
    return turned(placed(stood, part.a, np.asarray(part.p), k), abs(part.radius) * perpendicular(n)[0], n, 2.0 * np.pi)


def turned(C: Array, r: Array, n: Array, angle: float) -> Array:
    """Places from C + r on round an axis n through C, (n, 3)."""
    steps = np.linspace(0.0, angle, max(2, int(np.ceil(angle / STEP)) + 1))[:, None]
    return np.asarray(C + np.cos(steps) * r + np.sin(steps) * np.cross(n, r))
