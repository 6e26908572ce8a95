"""Lay out the closure rows of couplings: sums of parts, each a condition between two bodies or coordinates."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.mechanism.couplings import GROUND, CoupledRow, CouplingPart
from heuncli.multibody.mechanism.model import Assembly
from heuncli.multibody.tree.starts import body_state
from heuncli.multibody.tree.tables import ZERO, Program, Vector

KINDS = {
    "guide": kernel.GUIDE, "dot": kernel.DOT, "rod": kernel.ROD, "turn": kernel.TURN, "mesh": kernel.MESH,
    "touches": kernel.TOUCHES, "rolls": kernel.ROLLS, "rolls_aside": kernel.ROLLS_ASIDE,
    "ball_touches": kernel.BALL_TOUCHES, "ball_rolls": kernel.BALL_ROLLS,
    "cam": kernel.CAM, "strand": kernel.STRAND, "arc": kernel.ARC, "wound": kernel.WOUND,
}  # fmt: skip

TreeIndex = Callable[[int], int]  # a body's place in the tree
Relative = Callable[[int, Vector], Vector]  # a body's point from its joint point


def make_part_row(
    part: CouplingPart, first_part: int, in_tree: TreeIndex, relative: Relative, freedoms: Mapping[tuple[int, str], int]
) -> kernel.Closure:
    """Make the kernel's row for a condition between two bodies.

    first_part: index of the first part of the row that it belongs to
    freedoms: index of the freedom of each joint coordinate
    """
    coordinates = [(freedoms[x.joint, x.quantity], x.ratio) for x in part.coordinates]
    (freedom, ratio), (freedom_b, ratio_b) = [*coordinates, (0, 0.0), (0, 0.0)][:2]
    return kernel.Closure(
        kind=KINDS[part.kind],
        a=in_tree(part.a),
        b=in_tree(part.b),
        p=relative(part.c if part.kind in ("mesh", "cam") else part.a, part.p),
        q=relative(part.b, part.q),
        weight=1.0,
        freedom=freedom,
        e=part.e,
        g=part.g,
        factor=part.factor,
        radius=part.radius,
        c=in_tree(part.c),
        ratio=ratio,
        freedom_b=freedom_b,
        ratio_b=ratio_b,
        part=first_part + part.strand,
    )


def add_lift(row: kernel.Closure, part: CouplingPart, first: int, relative: Relative) -> kernel.Closure:
    """Add the lift to the row of a cam, where its first piece is at `first`; other parts are returned unchanged."""
    cam = part.cam
    if cam is None:
        return row
    return row.replace(
        lift=first, pieces=len(cam.lift.coefficients), period=cam.lift.period, swings=int(cam.swings),
        faced=int(cam.face is not None), radius=cam.radius, pivot=relative(part.c, cam.pivot),
        h=ZERO if cam.face is None else cam.face,
    )  # fmt: skip


def assembled_length(row: CoupledRow, start: Assembly, coordinates: Mapping[tuple[int, str], float]) -> float:
    """Sum of the parts' gaps at the start; coordinates: of the joints there."""
    return sum(part.factor * _part_gap(part, start, coordinates) for part in row.parts)


def _part_gap(part: CouplingPart, start: Assembly, coordinates: Mapping[tuple[int, str], float]) -> float:
    if part.constrains_speed:
        return 0.0
    if part.coordinates:
        return sum(x.ratio * coordinates[x.joint, x.quantity] for x in part.coordinates)
    xa, Ra, _, _ = body_state(start, part.a)
    xb, Rb, _, _ = body_state(start, part.b)
    D, e = xb + Rb @ part.q - xa - Ra @ part.p, Ra @ part.e
    if part.kind == "rod":
        return math.sqrt(float(D @ D))
    return float(e @ (Rb @ part.g if part.kind == "dot" else D))


def make_sum_row(row: CoupledRow, length: float, first: int, size: float, program: Program) -> kernel.Closure:
    """Make the row that sums its parts, the first of which has index `first`; program: added to its length in time."""
    return kernel.Closure(
        kind=kernel.SUM,
        a=-1,
        b=-1,
        weight=row.weight or size,
        length=length,
        program=program,
        part=first,
        part_count=len(row.parts),
    )


def loaded_bodies(row: CoupledRow) -> set[int]:
    """Return the bodies that the row's load acts on."""
    return {i for part in row.parts for i in (part.a, part.b)} - {GROUND}
