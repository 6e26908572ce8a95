"""Transform couplings to a smaller scene: the same conditions, between the bodies that theirs are part of there.

Each of a part's points and directions is fixed in one of its bodies, and is transformed as that body is. A condition
that keeps its value at the start keeps it here, too: its length stays.
"""

from __future__ import annotations

from collections.abc import Callable

from heuncli.base.records import record, replace
from heuncli.multibody.mechanism.couplings import CamShape, CoupledRow, Coupling, CouplingPart, Place
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

CARRIED = frozenset(("mesh", "cam"))  # kinds whose points and directions are of a third body
SECOND_IN_B = frozenset(("dot", "touches", "rolls", "rolls_aside"))  # and those whose second direction is of b


def point_body(part: CouplingPart) -> int:
    """Return the body in which a part's point p is fixed."""
    return part.c if part.kind in CARRIED else part.a


def first_direction_body(part: CouplingPart) -> int:
    """Return the body in which its direction e is fixed."""
    return part.c if part.kind in CARRIED or part.kind == "wound" else part.a


def second_direction_body(part: CouplingPart) -> int:
    """Return the body in which its direction g is fixed."""
    return part.b if part.kind in SECOND_IN_B else first_direction_body(part)


@record
class SceneTransform:
    """The transformation to a smaller scene of what is fixed in bodies of the larger one.

    body, joint: the smaller scene's numbers from the larger one's
    point, direction: transform a body's point or direction
    """

    body: Callable[[int], int]
    joint: Callable[[int], int]
    point: Callable[[int, Place], Array]
    direction: Callable[[int, Place], Array]


def transform_couplings(layout: Layout, transform_for: Callable[[Coupling], SceneTransform]) -> tuple[Coupling, ...]:
    """Transform the couplings of a scene; transform_for: returns the transformation for a coupling."""
    mechanism = layout.mechanism
    lengths = layout.tables["closures"]["length"].tolist() if mechanism.couplings else []
    couplings = []
    for owner, coupling in enumerate(mechanism.couplings, len(mechanism.joints)):
        first_row, transform = layout.rows.index(owner), transform_for(coupling)
        rows = tuple(_transform_row(row, lengths[first_row + k], transform) for k, row in enumerate(coupling.rows))
        couplings.append(replace(coupling, rows=rows))
    return tuple(couplings)


def _transform_row(row: CoupledRow, length: float, transform: SceneTransform) -> CoupledRow:
    return replace(row, length=length, parts=tuple(transform_part(part, transform) for part in row.parts))


def transform_part(part: CouplingPart, transform: SceneTransform) -> CouplingPart:
    """Transform a part of a coupling."""
    cam = None if part.cam is None else _transform_cam(part.cam, part, transform)
    return replace(
        part,
        a=transform.body(part.a),
        b=transform.body(part.b),
        c=transform.body(part.c),
        p=transform.point(point_body(part), part.p),
        q=transform.point(part.b, part.q),
        e=transform.direction(first_direction_body(part), part.e),
        g=part.g
        if part.kind == "strand"
        else transform.direction(second_direction_body(part), part.g),  # of a strand no direction
        coordinates=tuple(x._replace(joint=transform.joint(x.joint)) for x in part.coordinates),
        separating_force=transform.direction(part.c, part.separating_force),
        other_axis=transform.direction(part.b, part.other_axis),
        on_a=None if part.on_a is None else transform.point(part.c, part.on_a),
        cam=cam,
    )


def _transform_cam(cam: CamShape, part: CouplingPart, transform: SceneTransform) -> CamShape:
    face = None if cam.face is None else transform.direction(part.b, cam.face)
    return replace(cam, pivot=transform.point(part.c, cam.pivot), face=face)
