"""Lay out the closures: a row for each condition of cut joints, couplings, stops and latches (fields: kernel/scene.py).

A row of the closure Jacobian has numbers for the freedoms of the bodies on its path, which is between its two ends and
the ground. Eliminating earlier rows from it fills in those of the bodies that they reach.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Mapping, Sequence

from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import replace
from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.mechanism.couplings import GROUND, CoupledRow, CouplingPart
from heuncli.multibody.mechanism.loads import RopeLoad, ThreadLoad
from heuncli.multibody.mechanism.model import Assembly, Stop
from heuncli.multibody.tree.body_rows import TreeRows
from heuncli.multibody.tree.layout import Contact
from heuncli.multibody.tree.starts import Z, bent_direction, body_state, joint_direction, point_distance, to_direction
from heuncli.multibody.tree.tables import NO_PROGRAM, ZERO, FieldValue, Program, Vector
from heuncli.scene.expressions.paths import Path
from heuncli.scene.shapes.rotations import perpendicular_pair

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


class ClosureRows:
    """The closure rows of the cut joints and of stops, with their paths through the tree, parts and counted angles.

    row_joint: the owner of each row: a joint, or a coupling, which are numbered after the joints
    paths: of each row, the bodies of the tree that move its gap
    counters: where the counted coordinates of cut joints stand in the state, by joint
    contacts, one_sided: the contacts, and the rows of their unilateral conditions
    """

    def __init__(self, tree: TreeRows) -> None:
        self.tree = tree
        self.row_joint: list[int] = []
        self.rows: list[kernel.Closure] = []
        self.paths: list[list[int]] = []
        self.counters: dict[int, int] = {}
        self.contacts: list[Contact] = []
        self.one_sided: list[kernel.Contact] = []
        self.part_rows: list[kernel.Closure] = []
        self.add_rows()

    def add_rows(self) -> None:
        """Add the rows of joints, couplings, stops and latches, in this order."""
        length_limited = {stop.joint for stop in self.tree.mechanism.stops if stop.quantity == "length"}
        for k in self.tree.spanning.cut:
            joint, start = self.tree.mechanism.joints[k], self.tree.starts[k]
            kind = JOINTS[joint.kind]
            if kind.keeps_distance and k not in length_limited:
                program = self.tree.drives[k]
                length = joint.length if joint.length is not None else point_distance(self.tree.start, joint)
                length = 0.0 if program[1] else length  # a drive gives it in time
                if joint.tension_only:
                    self._mark_rope(k)
                self._add_row(k, kernel.ROD, program=program, length=length)
            if joint.path is not None:
                self._add_track_rows(k, joint.path)
            for d in () if kind.follows_path else kind.held_directions:
                self._add_row(k, kernel.GUIDE, e=joint_direction(joint, d))
            for d, e in kind.perpendicular_pairs:
                f = to_direction(joint, start.R_ref, e)
                self._add_row(k, kernel.DOT, e=joint_direction(joint, d), g=f, weight=self.tree.size)
            if "angle" in kind.coordinates:
                self.counters[k] = -1
        for k, joint in enumerate(self.tree.mechanism.joints):
            if JOINTS[joint.kind].is_constant_velocity:
                self._add_constant_velocity_row(k)
        self.add_coupling_rows()
        for stop in self.tree.mechanism.stops:
            for limit, sense in ((stop.low, -1), (stop.high, 1)):
                if limit is not None:
                    self._add_limit(stop, limit, sense)
        self._add_latches()
        self._add_frictions()

    def _add_constant_velocity_row(self, k: int) -> None:
        """Add the row of a constant-velocity joint: a sum of products of directions, whether the joint is cut or
        not.
        """
        joint = self.tree.mechanism.joints[k]
        first = len(self.part_rows)
        terms = JOINTS[joint.kind].turn.weighted_pairs
        self._add_row(k, kernel.SUM, weight=self.tree.size, part=first, part_count=len(terms))
        for factor, d, e in terms:
            directions = {"e": joint_direction(joint, d), "g": bent_direction(joint, self.tree.starts[k].R_ref, e)}
            dot = self.rows[-1].replace(kind=kernel.DOT, weight=1.0, part=0, part_count=0, factor=factor, **directions)
            self.part_rows.append(dot)

    def _add_track_rows(self, k: int, path: Path) -> None:
        """Add the rows across the path of a cut joint, along which a counter counts."""
        joint, first = self.tree.mechanism.joints[k], self.tree.add_pieces(path)
        h = path.normal if path.normal.any() else Z if self.tree.mechanism.planar else path.direction_off_slopes
        # what holds one way alone does so as a rope does: it must not be pushed
        side = -1.0 if joint.one_sided else 1.0
        for faced in range(2):
            if joint.one_sided and not faced:
                self._mark_one_sided(k, joint.name, joint.restitution)
            self._add_row(k, kernel.TRACK)
            self.rows[-1] = self.rows[-1].replace(
                lift=first, pieces=len(path.coefficients), period=path.period,
                radius=side * path.radius, h=side * h, faced=faced, counter=len(self.counters),
            )  # fmt: skip
        self.counters[k] = -1

    def add_coupling_rows(self) -> None:
        """Add the rows of the couplings, which come after those of the cut joints."""
        freedoms = self.number_freedoms()
        for owner, coupling in enumerate(self.tree.mechanism.couplings, len(self.tree.mechanism.joints)):
            for row in coupling.rows:
                if row.tension_only:
                    self._mark_one_sided(owner, coupling.name, row.restitution)
                length = (
                    assembled_length(row, self.tree.start, self.tree.coordinates) if row.length is None else row.length
                )
                program = NO_PROGRAM if row.law is None else self.tree.drives[owner]
                self._add_sum_row(owner, row, length, program, freedoms)
        for load in self.tree.mechanism.loads:
            if isinstance(load, RopeLoad):
                first = len(self.part_rows)
                self.part_rows += [
                    make_part_row(part, first, self.tree.in_tree, self.tree.relative, freedoms) for part in load.parts
                ]

    def number_freedoms(self) -> dict[tuple[int, str], int]:
        """Return the index of the freedom of each joint coordinate."""
        return {(f.joint, f.quantity): i for i, f in enumerate(self.tree.freedoms)}

    def _add_sum_row(
        self, owner: int, row: CoupledRow, length: float, program: Program, freedoms: Mapping[tuple[int, str], int]
    ) -> None:
        """Add the row of a coupling, with its parts."""
        self.row_joint.append(owner)
        self.rows.append(make_sum_row(row, length, len(self.part_rows), self.tree.size, program))
        first = len(self.part_rows)
        for part in row.parts:
            kernel_row = make_part_row(part, first, self.tree.in_tree, self.tree.relative, freedoms)
            self.part_rows.append(add_lift(kernel_row, part, len(self.tree.pieces), self.tree.relative))
            if part.cam is not None:
                self.tree.add_pieces(part.cam.lift)
        paths = (self.tree.path_to_root(self.tree.in_tree(i)) for i in loaded_bodies(row))
        self.paths.append(sorted({i for path in paths for i in path}, reverse=True))

    def _mark_rope(self, k: int) -> None:
        """Mark the next row as that of a rope."""
        joint = self.tree.mechanism.joints[k]
        self._mark_one_sided(k, joint.name, joint.restitution)

    def _mark_one_sided(self, owner: int, name: str, restitution: float | None) -> None:
        """Mark the next row as one that only pulls; without restitution the run ends where it would push."""
        row = len(self.row_joint)
        if restitution is not None:
            self.contacts.append(Contact(name, True, owner, row, 1, restitution))
        opens = len(self.contacts) if restitution is not None else 0
        self.one_sided.append(kernel.Contact(row=row, sense=1, mode_index=opens, freedom=-1))

    def _add_latches(self) -> None:
        """Add the rows of all latches."""
        latches = [stop for stop in self.tree.mechanism.stops if stop.latch is not None]
        count = len(self.contacts) + len(latches) + sum(1 for _ in self.tree.mechanism.iter_sticking())
        for k, stop in enumerate(latches):
            assert stop.latch is not None
            self._add_limit(stop, stop.latch.position or 0.0, 0, held_at=count + k + 1)

    def _add_frictions(self) -> None:
        """Add the rows of all frictions that may stick, after those of the latches."""
        frictions = list(self.tree.mechanism.iter_sticking())
        latches = sum(stop.latch is not None for stop in self.tree.mechanism.stops)
        count = len(self.contacts) + len(frictions) + latches
        for k, (load, load_row, quantity) in enumerate(frictions):
            if isinstance(load, ThreadLoad):
                self._add_thread_friction(load, held_at=count + k + 1)
            else:
                assert quantity != "thread"
                stop = Stop(load.path, load.joint, quantity, None, None)
                self._add_limit(stop, 0.0, 0, held_at=count + k + 1)
            self.contacts[-1] = replace(self.contacts[-1], load_row=load_row)
            group_index = count + len(frictions) + 2 * k + 1
            self.one_sided[-1] = self.one_sided[-1].replace(friction=load_row + 1, group_index=group_index)

    def _add_thread_friction(self, load: ThreadLoad, held_at: int) -> None:
        """Add the row of friction that may stick in a thread."""
        mechanism, row = self.tree.mechanism, len(self.row_joint)
        owner, held_row = len(mechanism.joints) + load.coupling, mechanism.couplings[load.coupling].friction_row
        assert held_row is not None
        self.contacts.append(Contact(load.path, False, owner, row, 0, 0.0))
        self.one_sided.append(
            kernel.Contact(row=row, sense=0, mode_index=len(self.contacts), freedom=-1, latch_index=held_at)
        )
        self._add_sum_row(owner, held_row, 0.0, NO_PROGRAM, self.number_freedoms())

    def _add_limit(self, stop: Stop, limit: float, sense: int, held_at: int = 0) -> None:
        """Add the row of one limit of a stop, or of a latch."""
        joint, row = self.tree.mechanism.joints[stop.joint], len(self.row_joint)
        self.contacts.append(Contact(stop.name, False, stop.joint, row, sense, stop.restitution))
        coordinate = (stop.joint, stop.quantity)
        limited = next((i for i, f in enumerate(self.tree.freedoms) if (f.joint, f.quantity) == coordinate), -1)
        self.one_sided.append(
            kernel.Contact(row=row, sense=sense, mode_index=len(self.contacts), freedom=limited, latch_index=held_at)
        )
        if stop.quantity == "length":
            self._add_row(stop.joint, kernel.ROD, length=limit)
        elif joint.path is not None:
            anywhere = stop.latch is not None and stop.latch.position is None
            slope = joint.path.evaluate(self.tree.starts[stop.joint].travel if anywhere else limit)[1]
            weight = math.sqrt(float(slope @ slope))
            self._add_row(stop.joint, kernel.ALONG, length=limit, freedom=limited, weight=weight)
        elif stop.quantity == "travel":
            self._add_row(stop.joint, kernel.GUIDE, length=limit, e=joint.axis)
        else:
            mark = self.tree.starts[stop.joint].R_ref.T @ perpendicular_pair(joint.axis)[0]
            self._add_row(
                stop.joint, kernel.TURN, length=limit, e=joint.axis, g=mark, freedom=limited, weight=self.tree.size
            )

    def _add_row(self, joint: int, kind: int, weight: float = 1.0, **fields: FieldValue) -> None:
        """Add a closure row of a joint; weight: of its gap [m per unit]; fields: the others that its kind needs."""
        joint_data = self.tree.mechanism.joints[joint]
        a, b = self.tree.in_tree(joint_data.a), self.tree.in_tree(joint_data.b)
        p, q = self.tree.relative(joint_data.a, joint_data.p), self.tree.relative(joint_data.b, joint_data.q)
        self.row_joint.append(joint)
        self.rows.append(kernel.Closure(kind=kind, a=a, b=b, p=p, q=q, weight=weight, factor=1.0, **fields))
        self.paths.append(sorted(set(self.tree.path_to_root(a)) | set(self.tree.path_to_root(b)), reverse=True))

    @property
    def is_flat(self) -> bool:
        """Whether the kernel may move a scene declared planar in the plane: rows of paths need space."""
        kinds = {row.kind for row in self.rows}
        return self.tree.mechanism.planar and kinds.isdisjoint((kernel.TRACK, kernel.ALONG))

    def make_counter_rows(self) -> list[kernel.Counter]:
        """Make the rows of the counted coordinates."""
        joints, owners = self.tree.mechanism.joints, self.row_joint
        return [
            kernel.Counter(
                a=self.tree.in_tree(joints[k].a),
                b=self.tree.in_tree(joints[k].b),
                state_at=state_index,
                axis=joints[k].axis,
                track=1 + owners.index(k) if joints[k].path is not None else 0,
            )
            for k, state_index in self.counters.items()
        ]


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
