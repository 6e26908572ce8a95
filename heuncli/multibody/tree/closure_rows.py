"""The closure rows of the kernel: the numbers on their paths, and the rows of couplings.

A row of the closure Jacobian has numbers for the freedoms of the bodies on its path, which is between its two ends and
the ground. Eliminating earlier rows from it fills in those of the bodies that they reach.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Mapping, Sequence

from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.mechanism.couplings import GROUND, CoupledRow, CouplingPart
from heuncli.multibody.mechanism.model import Assembly
from heuncli.multibody.tree.starts import body_state
from heuncli.multibody.tree.tables import ZERO, Program, Vector

# Closure paths


def index_rows(
    rows: Sequence[kernel.Closure], paths: Sequence[list[int]], bodies: Sequence[kernel.Body]
) -> tuple[list[kernel.Closure], array[int], int]:
    """Return the closure rows with the positions of their paths, velocities and couplings; the indices that these point
    into; and the total length of all columns.

    paths: tree indices, tips first, of each row

    Rows with the same path share their indices.
    """
    indices = array("i")
    shared: dict[tuple[int, ...], dict[str, int]] = {}
    indexed: list[kernel.Closure] = []
    column = 0

    def append_data(data: Sequence[int]) -> int:
        indices.extend(data)
        return len(indices) - len(data)

    for row, path, coupled, filled in zip(rows, paths, *find_fill_in(paths), strict=True):
        key = (*path, -1, *filled)
        if key not in shared:
            velocities = [n for i in path for n in list_velocities(bodies[i])]
            more = [n for i in filled for n in list_velocities(bodies[i])]
            shared[key] = {
                "path": append_data(path),
                "path_count": len(path),
                "velocities": append_data(velocities + more),
                "velocity_count": len(velocities),
                "filled_count": len(velocities) + len(more),
            }
        indexed.append(
            row.replace(
                column=column, couplings=append_data(coupled), coupling_count=len(coupled), rank=-1, **shared[key]
            )
        )
        column += shared[key]["filled_count"]
    return indexed, indices, column


def list_velocities(body: kernel.Body) -> range:
    """Return the indices of a body's generalised velocities."""
    return range(body.velocity_at, body.velocity_at + 3 * body.ball + body.end_freedom - body.first_freedom)


def find_fill_in(paths: Sequence[list[int]]) -> tuple[list[list[int]], list[list[int]]]:
    """Return for each row the earlier rows (and itself) whose elimination may fill it, and the bodies that they fill.

    A row meets the earlier ones whose bodies are on its path, or among those filled before. Filled bodies are those not
    on its own path, tips first.
    """
    group: dict[int, int] = {}  # body -> the group of rows that reaches it
    rows: dict[int, list[int]] = {}
    bodies: dict[int, set[int]] = {}
    coupled: list[list[int]] = []
    filled: list[list[int]] = []
    for r, path in enumerate(paths):
        met_groups = sorted({group[i] for i in path if i in group})
        target = met_groups[0] if met_groups else r
        rows.setdefault(target, [])
        bodies.setdefault(target, set())
        for other in met_groups[1:]:
            rows[target] += rows.pop(other)
            bodies[target] |= bodies.pop(other)
        rows[target].append(r)
        bodies[target] |= set(path)
        for i in bodies[target]:
            group[i] = target
        coupled.append(sorted(rows[target]))
        filled.append(sorted(bodies[target] - set(path), reverse=True))
    return coupled, filled


# Coupled rows

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
    """Make the row that is the sum of its parts, from the first one on; program: added to its length in time."""
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
