"""Lay out the assembled mechanism as the kernel's tables (their fields: kernel/scene.py)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS, Direction
from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.mechanism.loads import GROUND, JointLoad, RopeLoad
from heuncli.multibody.mechanism.model import Assembly, Joint, Mechanism, Stop
from heuncli.multibody.tree.closure_rows import (
    add_lift,
    assembled_length,
    index_rows,
    loaded_bodies,
    make_part_row,
    make_sum_row,
)
from heuncli.multibody.tree.islands import add_islands
from heuncli.multibody.tree.layout import Contact, Freedom, Layout, LayoutFrame, make_frame
from heuncli.multibody.tree.load_rows import find_used_names, lay_out_loads, make_programs
from heuncli.multibody.tree.spanning import SpanningTree, TreeLink, find_spanning_tree
from heuncli.multibody.tree.starts import (
    JointStart,
    PresetTree,
    Z,
    bent_direction,
    body_state,
    compute_joint_start,
    joint_direction,
    point_distance,
    to_direction,
)
from heuncli.multibody.tree.tables import (
    NO_PROGRAM,
    ZERO,
    FieldValue,
    Program,
    Vector,
    limits_table,
    make_table,
    moves_in_plane,
    remove_direction_tilt,
    remove_tilt,
    to_sym3,
)
from heuncli.results.results import Array
from heuncli.scene.expressions.paths import Path
from heuncli.scene.expressions.programs import Pack
from heuncli.scene.shapes.rotations import cross_rows, quaternion_from_matrix

IDENTITY = np.eye(3)
Scalar = tuple[int, Array, str, float, float]  # of a freedom: kind, direction, quantity, coordinate, rate


def lay_out(
    mechanism: Mechanism,
    start: Assembly,
    inertias: Array,
    size: float,
    work: bool = True,
    tree: PresetTree | None = None,
) -> Layout:
    """Lay the scene out from its assembled start.

    inertias (n, 3, 3): about the centres of mass, body axes, with the artificial inertia
    size: of the scene [m]
    work: whether the work of drives and of loads without potential is part of the state
    tree: of a larger scene, to be kept
    """
    programs, used_names = make_programs(mechanism), find_used_names(mechanism)
    frame = build_frame(mechanism, start, inertias, size, work, used_names, programs.drives, tree)
    return lay_out_loads(frame, mechanism, programs)


def lay_out_like(
    layout: Layout, mechanism: Mechanism, start: Assembly, inertias: Array, starts: Sequence[JointStart]
) -> Layout:
    """Lay out a scene that was made from one laid out already, with its tree, size and programs; starts: of the joints.

    Its own programs come after those of the other scene, so that the branches of both are the same.
    """
    programs = make_programs(layout.mechanism).extend(mechanism)
    tree = PresetTree(layout.spanning, tuple(starts))
    work = layout.work_at >= 0
    frame = build_frame(mechanism, start, inertias, layout.size, work, frozenset(), programs.drives, tree)
    return lay_out_loads(frame, mechanism, programs)


def build_frame(
    mechanism: Mechanism,
    start: Assembly,
    inertias: Array,
    size: float,
    work: bool,
    used_names: frozenset[str],
    drives: tuple[Program, ...],
    tree: PresetTree | None,
) -> LayoutFrame:
    """Build a layout without its loads.

    used_names: joints and points that expressions use
    drives: a program for each joint, then for each coupling
    """
    spanning = (
        find_spanning_tree(mechanism, find_uncut_joints(mechanism, used_names)) if tree is None else tree.spanning
    )
    if tree is not None and tree.starts is not None:
        starts = list(tree.starts)
    else:
        starts = [compute_joint_start(mechanism, start, joint) for joint in mechanism.joints]
    return _LayoutBuilder(mechanism, start, spanning, starts, inertias, size, drives).build(work)


def find_uncut_joints(mechanism: Mechanism, used_names: frozenset[str]) -> set[int]:
    """Return the joints that must not be cut."""
    uncut = {k for k, j in enumerate(mechanism.joints) if j.name in used_names}
    uncut |= {s.joint for s in mechanism.stops if s.quantity != "length"}
    uncut |= {k for k, j in enumerate(mechanism.joints) if j.drive is not None and j.drive.quantity != "length"}
    # the angle of a cut universal cannot be determined
    uncut |= {k for coupling in mechanism.couplings for k in coupling.joints}
    return uncut | {k for k in find_sprung_joints(mechanism) if len(JOINTS[mechanism.joints[k].kind].turns) == 2}


def find_sprung_joints(mechanism: Mechanism) -> set[int]:
    """Return the joints with springs about their axes."""
    return {load.joint for load in mechanism.loads if isinstance(load, JointLoad) and load.row.has_potential}


class _LayoutBuilder:
    """Builds the kernel's arrays; used for one call of build_frame."""

    def __init__(
        self,
        mechanism: Mechanism,
        start: Assembly,
        spanning: SpanningTree,
        starts: list[JointStart],
        inertias: Array,
        size: float,
        drives: tuple[Program, ...],
    ) -> None:
        self.mechanism, self.start, self.spanning, self.starts = mechanism, start, spanning, starts
        self.inertias, self.drives = inertias, drives
        self.place = {h.body: i for i, h in enumerate(spanning.links)}
        self.size = size
        self.reference = np.array([self._joint_point(h) for h in spanning.links]).reshape(-1, 3)
        self.body_rows: list[kernel.Body] = []
        self.freedom_rows: list[kernel.Freedom] = []
        self.pieces: list[kernel.PathPiece] = []
        self.coordinates: dict[tuple[int, str], float] = {}  # at the start, of the tree's joints
        self.freedoms: list[Freedom] = []
        self.y: list[float] = []
        self.weights: list[float] = []
        self.groups: list[kernel.Group] = []
        self.velocity_count = 0

    def build(self, work: bool) -> LayoutFrame:
        """Build the whole frame."""
        self.add_bodies()
        self.add_closure_rows()
        return self.finish(work)

    def _joint_point(self, link: TreeLink) -> Array:
        body = self.mechanism.bodies[link.body]
        if link.joint < 0:
            return body.center
        joint = self.mechanism.joints[link.joint]
        return joint.p if link.reverse else joint.q

    def relative(self, body: int, point: Vector) -> Array:
        """Return a body's point relative to its joint point, body axes; a ground point is returned unchanged."""
        return np.asarray(point) if body == GROUND else point - self.reference[self.place[body]]

    def in_tree(self, body: int) -> int:
        """Return a body's index in the tree."""
        return body if body == GROUND else self.place[body]

    def add_bodies(self) -> None:
        """Add the bodies, their freedoms and the start."""
        for i, link in enumerate(self.spanning.links):
            body = self.mechanism.bodies[link.body]
            joint_point, R_ref, ball, freedoms = self._link_data(link)
            c = body.center - self.reference[i]
            J = self.inertias[link.body] + body.mass * ((c @ c) * IDENTITY - c[:, None] * c)
            first, group = len(self.freedoms), self._add_state(i, link, ball, freedoms)
            self.groups.append(group)
            self.body_rows.append(
                kernel.Body(
                    parent=self.in_tree(link.parent),
                    ball=int(ball),
                    attitude_at=group.coordinates,
                    rate_at=group.rates,
                    first_freedom=first,
                    end_freedom=len(self.freedoms),
                    velocity_at=self.velocity_count,
                    has_frame=int(bool((R_ref != IDENTITY).any())),
                    mass=body.mass,
                    first_moment=body.mass * c,
                    inertia=to_sym3(J),
                    joint_in_parent=joint_point,
                    frame=R_ref.ravel(),
                )
            )
            self.velocity_count += 3 * ball + len(freedoms)

    def _add_state(self, i: int, link: TreeLink, ball: bool, freedoms: list[Scalar]) -> kernel.Group:
        """Add a body's part of the state and its freedoms; return its position in the state.

        For a ball the attitude comes first, then the coordinates; then the angular velocity and the rates.
        """
        _, R, _, w = body_state(self.start, link.body)
        begin = len(self.y)
        programs = [self._find_drive_program(link, quantity) for _, _, quantity, _, _ in freedoms]
        rates_at = begin + 4 * ball + sum(program is None for program in programs)
        at_q, at_u = begin + 4 * ball, rates_at + 3 * ball
        coordinates, rates, weights = (
            (quaternion_from_matrix(R).tolist(), w.tolist(), [1.0] * 3) if ball else ([], [], [])
        )
        scalar_weights: list[float] = []  # weights of the coordinates, and of the rates
        for k, ((kind, direction, quantity, x, u), program) in enumerate(zip(freedoms, programs, strict=True)):
            places = (-1, -1)
            if program is None:
                places, at_q, at_u = (at_q, at_u), at_q + 1, at_u + 1
                coordinates.append(x)
                rates.append(u)
                scalar_weights.append(1.0 / self.size if kind == kernel.SHIFT else 1.0)
            row = kernel.Freedom(
                kind=kind,
                q_at=places[0],
                u_at=places[1],
                driven=int(program is not None),
                velocity_at=self.velocity_count + 3 * ball + k,
                body=i,
                program=program or NO_PROGRAM,
                direction=direction,
            )
            self.freedom_rows.append(self._add_path(link, quantity, row))
            self.freedoms.append(Freedom(link.joint, quantity, *places))
            self.coordinates[link.joint, quantity] = x
        self.y += coordinates + rates
        self.weights += [1.0] * (4 * ball) + scalar_weights + weights + scalar_weights
        return kernel.Group(coordinates=begin, rates=rates_at, end=len(self.y))

    def _add_path(self, link: TreeLink, quantity: str, row: kernel.Freedom) -> kernel.Freedom:
        """Add the path of a freedom that runs along one to the table of pieces; other freedoms are returned
        unchanged.
        """
        path = self.mechanism.joints[link.joint].path if link.joint >= 0 else None
        if path is None or quantity != "travel":
            return row
        stops = [stop for stop in self.mechanism.stops if stop.joint == link.joint]
        path = path.extend(
            any(stop.low is not None and stop.low >= path.first for stop in stops),
            any(stop.high is not None and stop.high <= path.last for stop in stops),
        )
        reach, slope, bend = path.bounds
        return row.replace(
            path=self._add_pieces(path),
            pieces=len(path.coefficients),
            period=path.period,
            reach=reach,
            slope=slope,
            bend=bend,
            radius=path.radius,
            normal=path.normal,
        )

    def _add_pieces(self, path: Path) -> int:
        """Add the pieces of a path; return the index of the first."""
        first = len(self.pieces)
        for begin, (c0, c1, c2, c3) in zip(path.knots[:-1].tolist(), path.coefficients, strict=True):
            self.pieces.append(kernel.PathPiece(begin=begin, c0=c0, c1=c1, c2=c2, c3=c3))
        self.pieces.append(kernel.PathPiece(begin=path.last, c0=ZERO, c1=ZERO, c2=ZERO, c3=ZERO))
        return first

    def _find_drive_program(self, link: TreeLink, quantity: str) -> Program | None:
        drive = self.mechanism.joints[link.joint].drive if link.joint >= 0 else None
        return self.drives[link.joint] if drive is not None and drive.quantity == quantity else None

    def _link_data(self, link: TreeLink) -> tuple[Array, Array, bool, list[Scalar]]:
        """Return the joint point in the parent, R_ref, ball, and freedoms (kind, direction, quantity, coordinate,
        rate).
        """
        if link.joint < 0:
            return self._free_body_data(link)
        point, R_ref, ball, freedoms = self._joint_data(link)
        if self.mechanism.planar:
            freedoms = [(kind, remove_direction_tilt(kind, d), name, x, u) for kind, d, name, x, u in freedoms]
            R_ref = remove_tilt(R_ref)
        return point, R_ref, ball, freedoms

    def _free_body_data(self, link: TreeLink) -> tuple[Array, Array, bool, list[Scalar]]:
        """Return the data of a body without joint: its centre of mass and its attitude, in the plane if that was
        declared.
        """
        x, R, v, w = body_state(self.start, link.body)
        c = R @ self.mechanism.bodies[link.body].center
        place, speed = x + c, v + cross_rows(w, c)
        e = np.eye(3)
        names = ("x", "y", "z")
        shifts = [(kernel.SHIFT, e[k], names[k], float(place[k]), float(speed[k])) for k in range(3)]
        if self.mechanism.planar:
            base = np.array([0.0, 0.0, place[2]])
            return base, R, False, [(kernel.TURN_IN_PARENT, e[2], "turn", 0.0, float(w[2])), *shifts[:2]]
        return np.zeros(3), e, True, shifts

    def _joint_data(self, link: TreeLink) -> tuple[Array, Array, bool, list[Scalar]]:
        joint, start = self.mechanism.joints[link.joint], self.starts[link.joint]
        kind = JOINTS[joint.kind]
        axes = {"axis": joint.axis, "to_axis": joint.to_axis, "z": Z}
        R_ref = start.R_ref
        freedoms: list[Scalar] = []
        sign = 1.0
        if link.reverse:
            axes = {"axis": joint.axis, "to_axis": joint.to_axis}
            if len(kind.turns) != 2:
                axes = {"axis": R_ref.T @ joint.axis, "z": Z}
            R_ref, sign = R_ref.T, -1.0
        turns = kind.turns[::-1] if link.reverse else kind.turns
        if len(turns) == 2:
            rates = self._universal_rates(joint)
            for where, name in zip((kernel.TURN_IN_PARENT, kernel.TURN_IN_BODY), turns, strict=True):
                freedoms.append((where, sign * axes[name], "first" if name == "axis" else "second", 0.0, rates[name]))
        else:
            freedoms += [(kernel.TURN_IN_PARENT, sign * axes[name], "angle", start.angle, start.rate) for name in turns]
        if "travel" in kind.coordinates:
            axis = sign * (R_ref @ joint.axis if link.reverse else joint.axis)
            freedoms.append((kernel.SHIFT, axis, "travel", start.travel, start.speed))
        else:
            freedoms += [
                (kernel.SHIFT, joint_direction(joint, d), d, *self._shift_and_speed(joint, d)) for d in kind.shifts
            ]
        point = joint.q if link.reverse else joint.p
        return self.relative(link.parent, point), R_ref, kind.is_ball_in_tree, freedoms

    def _universal_rates(self, joint: Joint) -> dict[str, float]:
        _, Ra, _, wa = body_state(self.start, joint.a)
        _, Rb, _, wb = body_state(self.start, joint.b)
        n1, n2 = Ra @ joint.axis, Rb @ joint.to_axis
        return {"axis": float(n1 @ (wb - wa)), "to_axis": float(n2 @ (wb - wa))}

    def _shift_and_speed(self, joint: Joint, direction: Direction) -> tuple[float, float]:
        """Return travel and speed of the `to` point along a direction of `from`, relative to `from`."""
        xa, Ra, va, wa = body_state(self.start, joint.a)
        xb, Rb, vb, wb = body_state(self.start, joint.b)
        f = Ra @ joint_direction(joint, direction)
        Q = xb + Rb @ joint.q
        v = vb + cross_rows(wb, Rb @ joint.q) - va - cross_rows(wa, Q - xa)
        return float(f @ (Q - xa - Ra @ joint.p)), float(f @ v)

    def add_closure_rows(self) -> None:
        """Add the closure rows of the cut joints and of stops, their paths, freedoms and couplings, and counted
        angles.
        """
        self.row_joint: list[int] = []
        self.closure_rows: list[kernel.Closure] = []
        self.paths: list[list[int]] = []
        self.counters: dict[int, int] = {}
        self.contacts: list[Contact] = []
        self.one_sided: list[kernel.Contact] = []
        self.part_rows: list[kernel.Closure] = []
        length_limited = {stop.joint for stop in self.mechanism.stops if stop.quantity == "length"}
        for k in self.spanning.cut:
            joint, start = self.mechanism.joints[k], self.starts[k]
            kind = JOINTS[joint.kind]
            if kind.keeps_distance and k not in length_limited:
                program = self.drives[k]
                length = joint.length if joint.length is not None else point_distance(self.start, joint)
                length = 0.0 if program[1] else length  # a drive gives it in time
                if joint.tension_only:
                    self._mark_rope(k)
                self._add_row(k, kernel.ROD, program=program, length=length)
            if joint.path is not None:
                self._add_track_rows(k, joint.path)
            for d in () if kind.follows_path else kind.guides:
                self._add_row(k, kernel.GUIDE, e=joint_direction(joint, d))
            for d, e in kind.dots:
                f = to_direction(joint, start.R_ref, e)
                self._add_row(k, kernel.DOT, e=joint_direction(joint, d), g=f, weight=self.size)
            if "angle" in kind.coordinates:
                self.counters[k] = -1
        for k, joint in enumerate(self.mechanism.joints):
            if JOINTS[joint.kind].is_constant_velocity:
                self._add_constant_velocity_row(k)
        self.add_coupling_rows()
        for stop in self.mechanism.stops:
            for limit, sense in ((stop.low, -1), (stop.high, 1)):
                if limit is not None:
                    self._add_limit(stop, limit, sense)
        self._add_latches()

    def _add_constant_velocity_row(self, k: int) -> None:
        """Add the row of a constant-velocity joint: a sum of products of directions, whether the joint is cut or
        not.
        """
        joint = self.mechanism.joints[k]
        first = len(self.part_rows)
        terms = JOINTS[joint.kind].turn.sum_of_dots
        self._add_row(k, kernel.SUM, weight=self.size, part=first, part_count=len(terms))
        for factor, d, e in terms:
            directions = {"e": joint_direction(joint, d), "g": bent_direction(joint, self.starts[k].R_ref, e)}
            dot = self.closure_rows[-1].replace(
                kind=kernel.DOT, weight=1.0, part=0, part_count=0, factor=factor, **directions
            )
            self.part_rows.append(dot)

    def _add_track_rows(self, k: int, path: Path) -> None:
        """Add the rows across the path of a cut joint, along which a counter counts."""
        joint, first = self.mechanism.joints[k], self._add_pieces(path)
        h = path.normal if path.normal.any() else Z if self.mechanism.planar else path.direction_off_slopes
        # what holds one way alone does so as a rope does: it must not be pushed
        side = -1.0 if joint.one_sided else 1.0
        for faced in range(2):
            if joint.one_sided and not faced:
                self._mark_one_sided(k, joint.name, joint.restitution)
            self._add_row(k, kernel.TRACK)
            self.closure_rows[-1] = self.closure_rows[-1].replace(
                lift=first, pieces=len(path.coefficients), period=path.period,
                radius=side * path.radius, h=side * h, faced=faced, counter=len(self.counters),
            )  # fmt: skip
        self.counters[k] = -1

    def add_coupling_rows(self) -> None:
        """Add the rows of the couplings, which come after those of the cut joints."""
        freedoms = {(f.joint, f.quantity): i for i, f in enumerate(self.freedoms)}
        for owner, coupling in enumerate(self.mechanism.couplings, len(self.mechanism.joints)):
            for row in coupling.rows:
                if row.tension_only:
                    self._mark_one_sided(owner, coupling.name, row.restitution)
                self.row_joint.append(owner)
                length = assembled_length(row, self.start, self.coordinates) if row.length is None else row.length
                program = NO_PROGRAM if row.law is None else self.drives[owner]
                self.closure_rows.append(make_sum_row(row, length, len(self.part_rows), self.size, program))
                first = len(self.part_rows)
                for part in row.parts:
                    kernel_row = make_part_row(part, first, self.in_tree, self.relative, freedoms)
                    self.part_rows.append(add_lift(kernel_row, part, len(self.pieces), self.relative))
                    if part.cam is not None:
                        self._add_pieces(part.cam.lift)
                paths = (self._path_to_root(self.in_tree(i)) for i in loaded_bodies(row))
                self.paths.append(sorted({i for path in paths for i in path}, reverse=True))
        for load in self.mechanism.loads:
            if isinstance(load, RopeLoad):
                first = len(self.part_rows)
                self.part_rows += [
                    make_part_row(part, first, self.in_tree, self.relative, freedoms) for part in load.parts
                ]

    def _mark_rope(self, k: int) -> None:
        """Mark the next row as that of a rope."""
        joint = self.mechanism.joints[k]
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
        latches = [stop for stop in self.mechanism.stops if stop.latch is not None]
        count = len(self.contacts) + len(latches)
        for k, stop in enumerate(latches):
            assert stop.latch is not None
            self._add_limit(stop, stop.latch.position or 0.0, 0, held_at=count + k + 1)

    def _add_limit(self, stop: Stop, limit: float, sense: int, held_at: int = 0) -> None:
        """Add the row of one limit of a stop, or of a latch."""
        joint, row = self.mechanism.joints[stop.joint], len(self.row_joint)
        self.contacts.append(Contact(stop.name, False, stop.joint, row, sense, stop.restitution))
        coordinate = (stop.joint, stop.quantity)
        limited = next((i for i, f in enumerate(self.freedoms) if (f.joint, f.quantity) == coordinate), -1)
        self.one_sided.append(
            kernel.Contact(row=row, sense=sense, mode_index=len(self.contacts), freedom=limited, latch_index=held_at)
        )
        if stop.quantity == "length":
            self._add_row(stop.joint, kernel.ROD, length=limit)
        elif joint.path is not None:
            anywhere = stop.latch is not None and stop.latch.position is None
            slope = joint.path.evaluate(self.starts[stop.joint].travel if anywhere else limit)[1]
            weight = math.sqrt(float(slope @ slope))
            self._add_row(stop.joint, kernel.ALONG, length=limit, freedom=limited, weight=weight)
        elif stop.quantity == "travel":
            self._add_row(stop.joint, kernel.GUIDE, length=limit, e=joint.axis)
        else:
            self._add_row(stop.joint, kernel.TURN, length=limit, e=joint.axis, freedom=limited, weight=self.size)

    def _add_row(self, joint: int, kind: int, weight: float = 1.0, **fields: FieldValue) -> None:
        """Add a closure row of a joint; weight: of its gap [m per unit]; fields: the others that its kind needs."""
        joint_data = self.mechanism.joints[joint]
        a, b = self.in_tree(joint_data.a), self.in_tree(joint_data.b)
        p, q = self.relative(joint_data.a, joint_data.p), self.relative(joint_data.b, joint_data.q)
        self.row_joint.append(joint)
        self.closure_rows.append(kernel.Closure(kind=kind, a=a, b=b, p=p, q=q, weight=weight, factor=1.0, **fields))
        self.paths.append(sorted(set(self._path_to_root(a)) | set(self._path_to_root(b)), reverse=True))

    def _path_to_root(self, i: int) -> list[int]:
        path = []
        while i >= 0:
            path.append(i)
            i = self.body_rows[i].parent
        return path

    def finish(self, work: bool) -> LayoutFrame:
        """Add counted angles and the work to the state, and make the tables."""
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
                self.groups.append(kernel.Group(coordinates=work_at, rates=work_at, end=work_at + 1))
        closure_rows, indices, column_count = index_rows(self.closure_rows, self.paths, self.body_rows)
        tables = {
            "bodies": make_table(kernel.Body, self.body_rows),
            "freedoms": make_table(kernel.Freedom, self.freedom_rows),
            "closures": make_table(kernel.Closure, closure_rows),
            "pieces": make_table(kernel.PathPiece, self.pieces),
            "parts": make_table(kernel.Closure, self.part_rows),
            "counters": make_table(kernel.Counter, self._make_counter_rows()),
            "contacts": make_table(kernel.Contact, self.one_sided),
            "groups": make_table(kernel.Group, self.groups),
            "artificial_inertias": make_table(kernel.ArtificialInertia, []),
            "limits": limits_table(tolerances.KERNEL),
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
            velocity_count=self.velocity_count,
            column_count=column_count,
            pack=Pack(),
            work_at=work_at,
            islands=(),
            contacts=tuple(self.contacts),
            velocity_scale=np.zeros(0),
            flat=self._is_flat() and moves_in_plane(tables["bodies"], tables["freedoms"]),
        )
        return make_frame(add_islands(layout))

    def _is_flat(self) -> bool:
        """Whether the kernel may move a scene declared planar in the plane: rows of paths need space."""
        kinds = {row.kind for row in self.closure_rows}
        return self.mechanism.planar and kinds.isdisjoint((kernel.TRACK, kernel.ALONG))

    def _make_counter_rows(self) -> list[kernel.Counter]:
        joints, owners = self.mechanism.joints, self.row_joint
        return [
            kernel.Counter(
                a=self.in_tree(joints[k].a),
                b=self.in_tree(joints[k].b),
                state_at=at,
                axis=joints[k].axis,
                track=1 + owners.index(k) if joints[k].path is not None else 0,
            )
            for k, at in self.counters.items()
        ]
