"""Couplings seen from a smaller scene: the same conditions, between what their bodies are part of there.

Each of a part's points and directions is fixed in one of its bodies, and is seen as the smaller scene sees that body.
What a condition holds at the start it holds there, too: its length stays.
"""

from __future__ import annotations

from collections.abc import Callable

from heuncli.base.records import record, replace
from heuncli.multibody.mechanism.couplings import CamShape, CoupledRow, Coupling, CouplingPart, Place
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

CARRIED = frozenset(("mesh", "cam"))  # kinds whose points and directions are of a third body
SECOND_IN_B = frozenset(("dot", "touches", "rolls", "rolls_aside"))  # and those whose second direction is of b


def point_in(part: CouplingPart) -> int:
    """The body in which a part's point p is fixed."""
    return part.c if part.kind in CARRIED else part.a


def first_in(part: CouplingPart) -> int:
    """The body in which its direction e is."""
    return part.c if part.kind in CARRIED or part.kind == "wound" else part.a


def second_in(part: CouplingPart) -> int:
    """The body in which its direction g is."""
    return part.b if part.kind in SECOND_IN_B else first_in(part)


@record
class SeenFrom:
    """How a smaller scene sees what is fixed in bodies of the larger one.

    body, joint: the smaller scene's numbers by the larger one's; point, direction: of a body's point or direction.
    """

    body: Callable[[int], int]
    joint: Callable[[int], int]
    point: Callable[[int, Place], Array]
    direction: Callable[[int, Place], Array]


def couplings_seen(layout: Layout, seen: Callable[[Coupling], SeenFrom]) -> tuple[Coupling, ...]:
    """The couplings of a scene as a smaller one has them; seen: how that sees what a coupling looks at."""
    mechanism = layout.mechanism
    lengths = layout.tables["closures"]["length"].tolist() if mechanism.couplings else []
    found = []
    for owner, own in enumerate(mechanism.couplings, len(mechanism.joints)):
        at, there = layout.rows.index(owner), seen(own)
        rows = tuple(_row(row, lengths[at + k], there) for k, row in enumerate(own.rows))
        found.append(replace(own, rows=rows))
    return tuple(found)


def _row(row: CoupledRow, length: float, seen: SeenFrom) -> CoupledRow:
    return replace(row, length=length, parts=tuple(part_seen(part, seen) for part in row.parts))


def part_seen(part: CouplingPart, seen: SeenFrom) -> CouplingPart:
    """A part as a smaller scene has it."""
    cam = None if part.cam is None else _cam(part.cam, part, seen)
    return replace(
        part, a=seen.body(part.a), b=seen.body(part.b), c=seen.body(part.c),
        p=seen.point(point_in(part), part.p), q=seen.point(part.b, part.q), e=seen.direction(first_in(part), part.e),
        g=part.g if part.kind == "strand" else seen.direction(second_in(part), part.g),  # of a strand no direction
        coordinates=tuple(x._replace(joint=seen.joint(x.joint)) for x in part.coordinates),
        apart=seen.direction(part.c, part.apart), other_axis=seen.direction(part.b, part.other_axis),
        on_a=None if part.on_a is None else seen.point(part.c, part.on_a), cam=cam,
    )  # fmt: skip


def _cam(cam: CamShape, part: CouplingPart, seen: SeenFrom) -> CamShape:
    face = None if cam.face is None else seen.direction(part.b, cam.face)
    return replace(cam, pivot=seen.point(part.c, cam.pivot), face=face)
