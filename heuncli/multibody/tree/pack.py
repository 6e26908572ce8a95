"""The assembled mechanism as the kernel's tables (their fields: kernel/scene.py)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS, Direction
from heuncli.base.records import replace
from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.mechanism.model import (
    GROUND,
    Assembly,
    Joint,
    JointLoad,
    Mechanism,
    RopeLoad,
    Stop,
)
from heuncli.multibody.tree.closure_paths import places_of
from heuncli.multibody.tree.coupled_rows import as_assembled, ends, part_row, sum_row, with_lift
from heuncli.multibody.tree.flat import about_z, in_plane, moves_in_plane
from heuncli.multibody.tree.frame import LayoutFrame, frame_of
from heuncli.multibody.tree.islands import with_islands
from heuncli.multibody.tree.layout import Contact, Freedom, Layout
from heuncli.multibody.tree.load_rows import named_in, programs_of, with_loads
from heuncli.multibody.tree.rows import (
    NO_PROGRAM,
    ZERO,
    BodyRow,
    ClosureRow,
    ContactRow,
    CounterRow,
    FreedomRow,
    GroupRow,
    PieceRow,
    Program,
    Vector,
    table_of,
)
from heuncli.multibody.tree.spanning import Hang, Spanning, span
from heuncli.multibody.tree.starts import (
    GivenTree,
    JointStart,
    Z,
    bent_direction,
    distance,
    joint_frame,
    joint_start,
    pose,
    to_direction,
)
from heuncli.multibody.tree.tables import limits, symmetric
from heuncli.results.results import Array
from heuncli.scene.expressions.paths import Path
from heuncli.scene.expressions.programs import Pack
from heuncli.scene.shapes.rotations import cross_rows, to_quaternion

UNTURNED = np.eye(3)
Scalar = tuple[int, Array, str, float, float]  # of a freedom: kind, direction, quantity, coordinate, rate


def lay_out(
    mechanism: Mechanism,
    start: Assembly,
    inertias: Array,
    size: float,
    work: bool = True,
    tree: GivenTree | None = None,
) -> Layout:
    """Lay the scene out from its assembled start.

    inertias (n, 3, 3): about the centres of mass, body axes, with what was lent for the motion; size: of the scene [m];
    work: whether that of drives and of loads without potential joins the state; tree: of a larger scene, to be kept.
    """
    programs, named = programs_of(mechanism), named_in(mechanism)
    frame = framed(mechanism, start, inertias, size, work, named, programs.drives, tree)
    return with_loads(frame, mechanism, programs)


def lay_out_like(
    layout: Layout, mechanism: Mechanism, start: Assembly, inertias: Array, starts: Sequence[JointStart]
) -> Layout:
    """Lay out what is made of a scene that is laid out already, with its tree, size and programs; starts: as given.

    Programs that it has of its own come after those of the other, so that the branches of both are the same.
    """
    programs = programs_of(layout.mechanism).more(mechanism)
    tree = GivenTree(layout.spanning, tuple(starts))
    work = layout.work_at >= 0
    frame = framed(mechanism, start, inertias, layout.size, work, frozenset(), programs.drives, tree)
    return with_loads(frame, mechanism, programs)


def framed(
    mechanism: Mechanism,
    start: Assembly,
    inertias: Array,
    size: float,
    work: bool,
    named: frozenset[str],
    drives: tuple[Program, ...],
    tree: GivenTree | None,
) -> LayoutFrame:
    """A layout without its loads; named: joints and points that expressions name; drives: a program a joint, then a
    coupling."""
    spanning = span(mechanism, to_be_kept(mechanism, named)) if tree is None else tree.spanning
    if tree is not None and tree.starts is not None:
        starts = list(tree.starts)
    else:
        starts = [joint_start(mechanism, start, joint) for joint in mechanism.joints]
    return _Builder(mechanism, start, spanning, starts, inertias, size, drives).frame(work)


def to_be_kept(mechanism: Mechanism, named: frozenset[str]) -> set[int]:
    """The joints that are not to be cut."""
    kept = {k for k, j in enumerate(mechanism.joints) if j.name in named}
    kept |= {s.joint for s in mechanism.stops if s.quantity != "length"}
    kept |= {k for k, j in enumerate(mechanism.joints) if j.drive is not None and j.drive.quantity != "length"}
    # of a universal that is cut nothing tells the angle
    kept |= {k for coupling in mechanism.couplings for k in coupling.joints}
    return kept | {k for k in sprung(mechanism) if len(JOINTS[mechanism.joints[k].kind].turns) == 2}


def sprung(mechanism: Mechanism) -> set[int]:
    """The joints with springs about their axes."""
    return {load.joint for load in mechanism.loads if isinstance(load, JointLoad) and load.kind == "turn_spring"}


class _Builder:
    """Fills the kernel's arrays; lives for one call of framed."""

    def __init__(
        self,
        mechanism: Mechanism,
        start: Assembly,
        spanning: Spanning,
        starts: list[JointStart],
        inertias: Array,
        size: float,
        drives: tuple[Program, ...],
    ) -> None:
        self.mechanism, self.start, self.spanning, self.starts = mechanism, start, spanning, starts
        self.inertias, self.drives = inertias, drives
        self.place = {h.body: i for i, h in enumerate(spanning.hangs)}
        self.size = size
        self.reference = np.array([self._reference(h) for h in spanning.hangs]).reshape(-1, 3)
        self.body_rows: list[BodyRow] = []
        self.freedom_rows: list[FreedomRow] = []
        self.pieces: list[PieceRow] = []
        self.coordinates: dict[tuple[int, str], float] = {}  # at the start, of the tree's joints
        self.freedoms: list[Freedom] = []
        self.y: list[float] = []
        self.weights: list[float] = []
        self.groups: list[GroupRow] = []
        self.answer_count = 0

    def frame(self, work: bool) -> LayoutFrame:
        """All of it."""
        self.bodies()
        self.rows()
        return self.finish(work)

    def _reference(self, h: Hang) -> Array:
        body = self.mechanism.bodies[h.body]
        if h.joint < 0:
            return body.center
        joint = self.mechanism.joints[h.joint]
        return joint.p if h.reverse else joint.q

    def relative(self, body: int, point: Vector) -> Array:
        """A body's point from its joint point, body axes; a ground point as it is."""
        return np.asarray(point) if body == GROUND else point - self.reference[self.place[body]]

    def in_tree(self, body: int) -> int:
        """A body's place in the tree."""
        return body if body == GROUND else self.place[body]

    def bodies(self) -> None:
        """Bodies, freedoms and the start."""
        for i, h in enumerate(self.spanning.hangs):
            body = self.mechanism.bodies[h.body]
            joint_point, R_ref, ball, freedoms = self._hang(h)
            c = body.center - self.reference[i]
            J = self.inertias[h.body] + body.mass * ((c @ c) * UNTURNED - c[:, None] * c)
            first, group = len(self.freedoms), self._state_of(i, h, ball, freedoms)
            self.groups.append(group)
            self.body_rows.append(
                BodyRow(
                    parent=self.in_tree(h.parent),
                    ball=int(ball),
                    attitude_at=group.coordinates,
                    rate_at=group.rates,
                    first_freedom=first,
                    end_freedom=len(self.freedoms),
                    answer_at=self.answer_count,
                    framed=int(bool((R_ref != UNTURNED).any())),
                    mass=body.mass,
                    first_moment=body.mass * c,
                    inertia=symmetric(J),
                    joint_in_parent=joint_point,
                    frame=R_ref.ravel(),
                )
            )
            self.answer_count += 3 * ball + len(freedoms)

    def _state_of(self, i: int, h: Hang, ball: bool, freedoms: list[Scalar]) -> GroupRow:
        """Add a body's part of the state and its freedoms; where it stands.

        Of a ball the attitude comes first, then the coordinates; then the angular velocity and the rates.
        """
        _, R, _, w = pose(self.start, h.body)
        begin = len(self.y)
        programs = [self._driven(h, quantity) for _, _, quantity, _, _ in freedoms]
        rates_at = begin + 4 * ball + sum(program is None for program in programs)
        at_q, at_u = begin + 4 * ball, rates_at + 3 * ball
        coordinates, rates, weights = (to_quaternion(R).tolist(), w.tolist(), [1.0] * 3) if ball else ([], [], [])
        own: list[float] = []  # weights of the coordinates, and of the rates
        for k, ((kind, direction, quantity, x, u), program) in enumerate(zip(freedoms, programs, strict=True)):
            places = (-1, -1)
            if program is None:
                places, at_q, at_u = (at_q, at_u), at_q + 1, at_u + 1
                coordinates.append(x)
                rates.append(u)
                own.append(1.0 / self.size if kind == kernel.SHIFT else 1.0)
            answer = self.answer_count + 3 * ball + k
            driven, program = int(program is not None), program or NO_PROGRAM
            row = FreedomRow(kind, *places, driven, answer, i, program, direction)
            self.freedom_rows.append(self._on_path(h, quantity, row))
            self.freedoms.append(Freedom(h.joint, quantity, *places))
            self.coordinates[h.joint, quantity] = x
        self.y += coordinates + rates
        self.weights += [1.0] * (4 * ball) + own + weights + own
        return GroupRow(begin, rates_at, len(self.y))

    def _on_path(self, h: Hang, quantity: str, row: FreedomRow) -> FreedomRow:
        """The freedom of a point that runs along a path, whose pieces join the table; any other as it is."""
        path = self.mechanism.joints[h.joint].path if h.joint >= 0 else None
        if path is None or quantity != "travel":
            return row
        own = [stop for stop in self.mechanism.stops if stop.joint == h.joint]
        path = path.beyond(
            any(stop.low is not None and stop.low >= path.first for stop in own),
            any(stop.high is not None and stop.high <= path.last for stop in own),
        )
        reach, slope, bend = path.greatest
        return replace(
            row, path=self._put_path(path), pieces=len(path.coefficients), period=path.period, reach=reach, slope=slope,
            bend=bend, radius=path.radius, normal=path.normal,
        )  # fmt: skip

    def _put_path(self, path: Path) -> int:
        """Add the pieces of a path; which of all is the first."""
        first = len(self.pieces)
        self.pieces += [PieceRow(s, *c) for s, c in zip(path.knots[:-1].tolist(), path.coefficients, strict=True)]
        self.pieces.append(PieceRow(path.last, *np.zeros((4, 3))))
        return first

    def _driven(self, h: Hang, quantity: str) -> Program | None:
        drive = self.mechanism.joints[h.joint].drive if h.joint >= 0 else None
        return self.drives[h.joint] if drive is not None and drive.quantity == quantity else None

    def _hang(self, h: Hang) -> tuple[Array, Array, bool, list[Scalar]]:
        """Joint point in the parent, R_ref, ball, and freedoms (kind, direction, quantity, coordinate, rate)."""
        if h.joint < 0:
            return self._free(h)
        point, R_ref, ball, freedoms = self._jointed(h)
        if self.mechanism.planar:
            freedoms = [(kind, in_plane(kind, d), name, x, u) for kind, d, name, x, u in freedoms]
            R_ref = about_z(R_ref)
        return point, R_ref, ball, freedoms

    def _free(self, h: Hang) -> tuple[Array, Array, bool, list[Scalar]]:
        """A body that nothing carries: its centre of mass and its attitude, in the plane where that was declared."""
        x, R, v, w = pose(self.start, h.body)
        c = R @ self.mechanism.bodies[h.body].center
        place, speed = x + c, v + cross_rows(w, c)
        e = np.eye(3)
        names = ("x", "y", "z")
        shifts = [(kernel.SHIFT, e[k], names[k], float(place[k]), float(speed[k])) for k in range(3)]
        if self.mechanism.planar:
            base = np.array([0.0, 0.0, place[2]])
            return base, R, False, [(kernel.TURN_IN_PARENT, e[2], "turn", 0.0, float(w[2])), *shifts[:2]]
        return np.zeros(3), e, True, shifts

    def _jointed(self, h: Hang) -> tuple[Array, Array, bool, list[Scalar]]:
        joint, s = self.mechanism.joints[h.joint], self.starts[h.joint]
        kind = JOINTS[joint.kind]
        axes = {"axis": joint.axis, "to_axis": joint.to_axis, "z": Z}
        R_ref = s.R_ref
        freedoms: list[Scalar] = []
        sign = 1.0
        if h.reverse:
            axes = {"axis": joint.axis, "to_axis": joint.to_axis}
            if len(kind.turns) != 2:
                axes = {"axis": R_ref.T @ joint.axis, "z": Z}
            R_ref, sign = R_ref.T, -1.0
        turns = kind.turns[::-1] if h.reverse else kind.turns
        if len(turns) == 2:
            rates = self._universal_rates(joint)
            for where, name in zip((kernel.TURN_IN_PARENT, kernel.TURN_IN_BODY), turns, strict=True):
                freedoms.append((where, sign * axes[name], "first" if name == "axis" else "second", 0.0, rates[name]))
        else:
            freedoms += [(kernel.TURN_IN_PARENT, sign * axes[name], "angle", s.angle, s.rate) for name in turns]
        if "travel" in kind.coordinates:
            axis = sign * (R_ref @ joint.axis if h.reverse else joint.axis)
            freedoms.append((kernel.SHIFT, axis, "travel", s.travel, s.speed))
        else:
            freedoms += [(kernel.SHIFT, joint_frame(joint, d), d, *self._shift(joint, d)) for d in kind.shifts]
        point = joint.q if h.reverse else joint.p
        return self.relative(h.parent, point), R_ref, kind.ball_in_tree, freedoms

    def _universal_rates(self, joint: Joint) -> dict[str, float]:
        _, Ra, _, wa = pose(self.start, joint.a)
        _, Rb, _, wb = pose(self.start, joint.b)
        n1, n2 = Ra @ joint.axis, Rb @ joint.to_axis
        return {"axis": float(n1 @ (wb - wa)), "to_axis": float(n2 @ (wb - wa))}

    def _shift(self, joint: Joint, direction: Direction) -> tuple[float, float]:
        """Travel and speed of the `to` point along a direction of `from`, seen from `from`."""
        xa, Ra, va, wa = pose(self.start, joint.a)
        xb, Rb, vb, wb = pose(self.start, joint.b)
        f = Ra @ joint_frame(joint, direction)
        Q = xb + Rb @ joint.q
        v = vb + cross_rows(wb, Rb @ joint.q) - va - cross_rows(wa, Q - xa)
        return float(f @ (Q - xa - Ra @ joint.p)), float(f @ v)

    def rows(self) -> None:
        """Closure rows of the cut joints and of stops, their paths, freedoms and couplings, and counted angles."""
        self.row_joint: list[int] = []
        self.closure_rows: list[ClosureRow] = []
        self.paths: list[list[int]] = []
        self.counters: dict[int, int] = {}
        self.contacts: list[Contact] = []
        self.one_sided: list[ContactRow] = []
        self.part_rows: list[ClosureRow] = []
        loose = {stop.joint for stop in self.mechanism.stops if stop.quantity == "length"}
        for k in self.spanning.cut:
            joint, s = self.mechanism.joints[k], self.starts[k]
            kind = JOINTS[joint.kind]
            if kind.keeps_distance and k not in loose:
                program = self.drives[k]
                length = joint.length if joint.length is not None else distance(self.start, joint)
                length = 0.0 if program[1] else length  # a drive tells it in time
                if joint.tension_only:
                    self._rope(k)
                self._row(k, kernel.ROD, program=program, length=length)
            if joint.path is not None:
                self._track(k, joint.path)
            for d in () if kind.follows_path else kind.guides:
                self._row(k, kernel.GUIDE, e=joint_frame(joint, d))
            for d, e in kind.dots:
                f = to_direction(joint, s.R_ref, e)
                self._row(k, kernel.DOT, e=joint_frame(joint, d), g=f, weight=self.size)
            if "angle" in kind.coordinates:
                self.counters[k] = -1
        for k, joint in enumerate(self.mechanism.joints):
            if JOINTS[joint.kind].turns_alike:
                self._turning_alike(k)
        self.coupled_rows()
        for stop in self.mechanism.stops:
            for limit, sense in ((stop.low, -1), (stop.high, 1)):
                if limit is not None:
                    self._limit(stop, limit, sense)
        self._latches()

    def _turning_alike(self, k: int) -> None:
        """The row of a joint that is a sum of products of directions, cut or not."""
        joint = self.mechanism.joints[k]
        first = len(self.part_rows)
        terms = JOINTS[joint.kind].turn.sum_of_dots
        self._row(k, kernel.SUM, weight=self.size, part=first, part_count=len(terms))
        for factor, d, e in terms:
            own = {"e": joint_frame(joint, d), "g": bent_direction(joint, self.starts[k].R_ref, e)}
            dot = replace(
                self.closure_rows[-1], kind=kernel.DOT, weight=1.0, part=0, part_count=0, factor=factor, **own
            )
            self.part_rows.append(dot)

    def _track(self, k: int, path: Path) -> None:
        """The rows across the path of a joint that was cut, along which a counter counts."""
        joint, first = self.mechanism.joints[k], self._put_path(path)
        h = path.normal if path.normal.any() else Z if self.mechanism.planar else path.off_all_slopes
        side = (
            -1.0 if joint.one_sided else 1.0
        )  # what holds one way alone does so as a rope does: it must not be pushed
        for faced in range(2):
            if joint.one_sided and not faced:
                self._opening(k, joint.name, joint.restitution)
            self._row(k, kernel.TRACK)
            self.closure_rows[-1] = replace(
                self.closure_rows[-1], lift=first, pieces=len(path.coefficients), period=path.period,
                radius=side * path.radius, h=side * h, faced=faced, counter=len(self.counters),
            )  # fmt: skip
        self.counters[k] = -1

    def coupled_rows(self) -> None:
        """The rows of the couplings, which come after those of the cut joints."""
        freedoms = {(f.joint, f.quantity): i for i, f in enumerate(self.freedoms)}
        for owner, coupling in enumerate(self.mechanism.couplings, len(self.mechanism.joints)):
            for row in coupling.rows:
                if row.tension_only:
                    self._opening(owner, coupling.name, row.restitution)
                self.row_joint.append(owner)
                length = as_assembled(row, self.start, self.coordinates) if row.length is None else row.length
                program = NO_PROGRAM if row.law is None else self.drives[owner]
                self.closure_rows.append(sum_row(row, length, len(self.part_rows), self.size, program))
                first = len(self.part_rows)
                for part in row.parts:
                    made = part_row(part, first, self.in_tree, self.relative, freedoms)
                    self.part_rows.append(with_lift(made, part, len(self.pieces), self.relative))
                    if part.cam is not None:
                        self._put_path(part.cam.lift)
                paths = (self._path(self.in_tree(i)) for i in ends(row))
                self.paths.append(sorted({i for path in paths for i in path}, reverse=True))
        for load in self.mechanism.loads:
            if isinstance(load, RopeLoad):
                first = len(self.part_rows)
                self.part_rows += [part_row(part, first, self.in_tree, self.relative, freedoms) for part in load.parts]

    def _rope(self, k: int) -> None:
        """The row that comes next is that of a rope."""
        joint = self.mechanism.joints[k]
        self._opening(k, joint.name, joint.restitution)

    def _opening(self, owner: int, name: str, restitution: float | None) -> None:
        """The row that comes next pulls alone; without restitution the run ends where it would push."""
        row = len(self.row_joint)
        if restitution is not None:
            self.contacts.append(Contact(name, True, owner, row, 1, restitution))
        opens = len(self.contacts) if restitution is not None else 0
        self.one_sided.append(ContactRow(row, 1, opens, freedom=-1))

    def _latches(self) -> None:
        """The rows of all latches."""
        latches = [stop for stop in self.mechanism.stops if stop.latch is not None]
        count = len(self.contacts) + len(latches)
        for k, stop in enumerate(latches):
            assert stop.latch is not None
            self._limit(stop, stop.latch.at or 0.0, 0, held_at=count + k + 1)

    def _limit(self, stop: Stop, limit: float, sense: int, held_at: int = 0) -> None:
        """The row of one limit of a stop, or of a latch."""
        joint, row = self.mechanism.joints[stop.joint], len(self.row_joint)
        self.contacts.append(Contact(stop.name, False, stop.joint, row, sense, stop.restitution))
        own = (stop.joint, stop.quantity)
        limited = next((i for i, f in enumerate(self.freedoms) if (f.joint, f.quantity) == own), -1)
        self.one_sided.append(ContactRow(row, sense, len(self.contacts), limited, held_at))
        if stop.quantity == "length":
            self._row(stop.joint, kernel.ROD, length=limit)
        elif joint.path is not None:
            anywhere = stop.latch is not None and stop.latch.at is None
            slope = joint.path.at(self.starts[stop.joint].travel if anywhere else limit)[1]
            weight = math.sqrt(float(slope @ slope))
            self._row(stop.joint, kernel.ALONG, length=limit, freedom=limited, weight=weight)
        elif stop.quantity == "travel":
            self._row(stop.joint, kernel.GUIDE, length=limit, e=joint.axis)
        else:
            self._row(stop.joint, kernel.TURN, length=limit, e=joint.axis, freedom=limited, weight=self.size)

    def _row(
        self,
        joint: int,
        kind: int,
        *,
        e: Vector = ZERO,
        g: Vector = ZERO,
        length: float = 0.0,
        program: Program = NO_PROGRAM,
        freedom: int = 0,
        weight: float = 1.0,
        part: int = 0,
        part_count: int = 0,
    ) -> None:
        """A closure row of a joint; weight: of its gap [m per unit]."""
        own = self.mechanism.joints[joint]
        a, b = self.in_tree(own.a), self.in_tree(own.b)
        p, q = self.relative(own.a, own.p), self.relative(own.b, own.q)
        self.row_joint.append(joint)
        row = ClosureRow(kind, a, b, p, q, weight, freedom, program, e, g, length, part, part_count, factor=1.0)
        self.closure_rows.append(row)
        self.paths.append(sorted(set(self._path(a)) | set(self._path(b)), reverse=True))

    def _path(self, i: int) -> list[int]:
        path = []
        while i >= 0:
            path.append(i)
            i = self.body_rows[i].parent
        return path

    def finish(self, work: bool) -> LayoutFrame:
        """Counted angles and the work join the state; the tables are made."""
        driven = bool(self.mechanism.laws)
        energy_group = -1
        for k in self.counters:
            self.counters[k] = len(self.y)
            on_path = self.mechanism.joints[k].path is not None
            self.y.append(self.starts[k].travel if on_path else self.starts[k].angle)
            self.weights.append(0.0)
        work_at = len(self.y) if work else -1
        if work:
            self.y.append(0.0)
            self.weights.append(1.0 if driven else 0.0)
            if driven:
                # the drives' work may vary where the motion does not: it has a say in the step
                energy_group = len(self.groups)
                self.groups.append(GroupRow(work_at, work_at, work_at + 1))
        places, indices, column_count = places_of(self.paths, self.body_rows)
        tables = {
            "bodies": table_of(kernel.Body, self.body_rows),
            "freedoms": table_of(kernel.Freedom, self.freedom_rows),
            "closures": table_of(kernel.Closure, self.closure_rows, places),
            "pieces": table_of(kernel.PathPiece, self.pieces),
            "parts": table_of(kernel.Closure, self.part_rows),
            "counters": table_of(kernel.Counter, self._counter_rows()),
            "contacts": table_of(kernel.Contact, self.one_sided),
            "groups": table_of(kernel.Group, self.groups),
            "lents": table_of(kernel.Lent, []),
            "limits": limits(tolerances.KERNEL),
        }
        layout = Layout(
            mechanism=self.mechanism,
            spanning=self.spanning,
            place=self.place,
            reference=self.reference,
            freedoms=tuple(self.freedoms),
            rows=tuple(self.row_joint),
            starts=tuple(self.starts),
            counters=self.counters,
            size=self.size,
            y0=np.array(self.y),
            energy_group=energy_group,
            weights=np.array(self.weights),
            tables=tables,
            indices=indices,
            answer_count=self.answer_count,
            column_count=column_count,
            pack=Pack(),
            work_at=work_at,
            contacts=tuple(self.contacts),
            flat=self._is_flat() and moves_in_plane(tables["bodies"], tables["freedoms"]),
        )
        return frame_of(with_islands(layout))

    def _is_flat(self) -> bool:
        """Whether the kernel may move a scene declared planar in the plane: rows of paths need space."""
        kinds = {row.kind for row in self.closure_rows}
        return self.mechanism.planar and kinds.isdisjoint((kernel.TRACK, kernel.ALONG))

    def _counter_rows(self) -> list[CounterRow]:
        joints, owners = self.mechanism.joints, self.row_joint
        return [
            CounterRow(
                self.in_tree(joints[k].a), self.in_tree(joints[k].b), at, joints[k].axis,
                1 + owners.index(k) if joints[k].path is not None else 0,
            )
            for k, at in self.counters.items()
        ]  # fmt: skip
