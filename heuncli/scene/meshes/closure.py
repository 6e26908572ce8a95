"""Whether triangles close a surface, which side of it is inside, and of how many shells it consists.

Closed: every edge runs once one way and once the other. Then each shell has an inside, of positive volume if its
triangles are counter-clockwise from outside. A shell that lies in no other bounds material, one that lies in another a
hole; how often a point is enclosed is the solid angle of the shell there over 4 pi (van Oosterom, Strackee, 1983).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array
from heuncli.scene.meshes.model import Numbers, Soup, components, crossed, in_order, least, most, numbered

MOST_ANGLES = 50_000_000  # solid angles that are computed to see which shell lies in which
TRIED = 8  # triangles of a shell, the largest first, for a place that is clear of others
CLEAR = 0.1  # turns off a whole number: nearer, a place is clear of the other shells' faces
REPAIR = "repair it in the program that drew it, or export the solid with a finer tolerance"
ONE_SOLID = "export the solid alone, joined to one; solids that touch are shapes of their own"
OUTWARD = "recalculate its normals outward in the program that drew it"


class MeshEdges(NamedTuple):
    """The edges of triangles, 3 a triangle: ends (3 m, 2) as they run, and which of them are one, in order.

    order: edges put so that those of the same ends stand together; starts: where in it each begins, and counts.
    """

    ends: Numbers
    order: Numbers
    starts: Numbers
    counts: Numbers


def edges_of(triangles: Numbers) -> MeshEdges:
    """The edges; edge 3 k + i of triangle k runs from its corner i to the next."""
    ends = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
    low, high = np.minimum(ends[:, 0], ends[:, 1]), np.maximum(ends[:, 0], ends[:, 1])
    key = low * (int(triangles.max(initial=0)) + 1) + high
    order = in_order(key)
    ordered = key[order]
    starts = np.flatnonzero(np.append(True, ordered[1:] != ordered[:-1])) if len(key) else np.empty(0, np.intp)
    return MeshEdges(ends, order, starts, np.diff(np.append(starts, len(key))))


def loose_corners(edges: MeshEdges) -> Numbers:
    """The corners of edges that one triangle alone has."""
    return np.unique(edges.ends[edges.order[edges.starts[edges.counts == 1]]])


def neighbours(soup: Soup, edges: MeshEdges) -> tuple[Numbers, Numbers]:
    """The two triangles of each edge. Raises Finding: open, more than two triangles, or not oriented alike."""
    single = edges.counts == 1
    if single.any():
        own = edges.order[edges.starts[single]]
        message = f"{_edges(len(own))} open, {_holes(edges.ends[own], len(soup.corners))}"
        raise Finding("open-mesh", f"the surface is not closed: {message}: {_first(soup, edges.ends[own[0]])}", REPAIR)
    many = edges.counts > 2
    if many.any():
        own = edges.order[edges.starts[many]]
        message = f"{_edges(len(own))} shared by more than two triangles: {_first(soup, edges.ends[own[0]])}"
        raise Finding("mesh-crosses-itself", f"the surface touches itself: {message}", ONE_SOLID)
    one, other = edges.order[edges.starts], edges.order[edges.starts + 1]
    alike = edges.ends[one, 0] == edges.ends[other, 0]
    if alike.any():
        own = one[alike]
        message = f"beside {_edges(len(own), plain=True)} the triangles turn opposite ways: "
        raise Finding("mesh-orientation", message + _first(soup, edges.ends[own[0]]), OUTWARD)
    return one // 3, other // 3


def _edges(count: int, plain: bool = False) -> str:
    if plain:
        return f"{count} edge{'s' if count > 1 else ''}"
    return f"{count} edges are" if count > 1 else "1 edge is"


def _holes(ends: Numbers, corners: int) -> str:
    first = components(corners, ends[:, 0], ends[:, 1])
    holes = len(np.unique(first[ends[:, 0]]))
    return f"around {holes} hole{'s' if holes > 1 else ''}"


def _first(soup: Soup, ends: Numbers) -> str:
    one, other = (f"({', '.join(f'{x:.6g}' for x in soup.corners[end])})" for end in ends)
    return f"the first from {one} to {other} in the file's units"


class Shells(NamedTuple):
    """Of each triangle its shell (m,), from 0; volume of each (s,); the triangles turned so that all are outward."""

    number: Numbers
    volumes: Array
    triangles: Numbers
    turned: bool


def shells_of(soup: Soup, beside: tuple[Numbers, Numbers], V: Array) -> Shells:
    """The shells of a surface that does not cross itself. Raises Finding.

    beside: the two triangles of each edge; V (m,): the volumes that triangles enclose with the middle of all.
    """
    number = numbered(components(len(soup.triangles), *beside))[1]
    volumes: Array = np.asarray(np.bincount(number, V), dtype=np.float64)
    whole = float(volumes.sum())
    size = (0.5 * float(np.ptp(soup.corners, axis=0).max())) ** 3
    if not abs(whole) > size * np.finfo(float).eps * 64.0:
        raise Finding("mesh-orientation", "the surface encloses no volume", "a solid has a volume: is it flat?")
    if len(volumes) == 1:
        turned = whole < 0.0
    else:
        turned = _is_inward(soup, number, volumes)
    triangles: Numbers = soup.triangles[:, [0, 2, 1]] if turned else soup.triangles
    return Shells(number, -volumes if turned else volumes, triangles, turned)


def _is_inward(soup: Soup, number: Numbers, volumes: Array) -> bool:
    """Whether all shells are turned inside out. Raises Finding where some are and others not."""
    order = np.argsort(number, kind="stable")
    starts = np.searchsorted(number[order], np.arange(len(volumes)))
    own = np.split(order, starts[1:])
    places = soup.corners[soup.triangles]
    low = np.minimum.reduceat(least(places)[order], starts)
    high = np.maximum.reduceat(most(places)[order], starts)
    outer, wrong = [], []
    for k, enclosed in enumerate(_enclosed(places, own, low, high)):
        if enclosed == 0:
            outer.append(k)
        wrong.append((volumes[k] > 0.0) == (enclosed % 2 == 0))
    sign = volumes[outer[0]] < 0.0 if outer else False
    bad = [k for k, right in enumerate(wrong) if right == sign]
    if bad:
        where = ", ".join(f"{x:.6g}" for x in 0.5 * (low[bad[0]] + high[bad[0]]))
        message = (
            f"{len(bad)} of {len(volumes)} shells are turned inside out against where they lie, one about ({where})"
        )
        hint = f"a hole's surface is turned into the hole, a solid within another counts twice; {OUTWARD}"
        raise Finding("mesh-orientation", message, hint)
    return bool(sign)


def _enclosed(places: Array, own: list[Numbers], low: Array, high: Array) -> Iterator[int]:
    """In how many other shells each lies."""
    angles = 0
    for k, triangles in enumerate(own):
        around = ((low <= low[k]) & (high >= high[k])).all(axis=1)
        around[k] = False
        others = [own[j] for j in np.flatnonzero(around).tolist()]
        angles += sum(map(len, others))
        if angles > MOST_ANGLES:
            raise Finding("too-large", f"{len(own)} shells within each other are not told apart", "a file a solid")
        yield sum(_lies_in(places[triangles], places[other]) for other in others)


def _lies_in(shell: Array, other: Array) -> bool:
    """Whether a shell (m, 3, 3) lies in another that it does not cross: by places on it that are clear of the other."""
    normals = crossed(shell[:, 1] - shell[:, 0], shell[:, 2] - shell[:, 0])
    largest = np.argsort(-(normals**2).sum(axis=1), kind="stable")[:TRIED]
    turns = 0.0
    for middle in shell[largest].mean(axis=1):
        turns = abs(winding(other - middle))
        if abs(turns - round(turns)) < CLEAR:
            break
    return turns > 0.5 + CLEAR


def winding(places: Array) -> float:
    """How often triangles (m, 3, 3) enclose the origin: their solid angles over 4 pi."""
    a, b, c = places.transpose(1, 0, 2)
    la, lb, lc = (np.sqrt((x * x).sum(axis=1)) for x in (a, b, c))
    up = (a * crossed(b, c)).sum(axis=1)
    along = la * lb * lc + (a * b).sum(axis=1) * lc + (b * c).sum(axis=1) * la + (c * a).sum(axis=1) * lb
    return float(np.arctan2(up, along).sum() / (2.0 * np.pi))
