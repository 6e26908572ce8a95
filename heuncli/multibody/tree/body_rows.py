"""Lay out the tree: a row for each body and each freedom, their places in the state, and the start.

The fields of the rows: kernel/scene.py.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.joint_kinds import JOINTS, Direction
from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Assembly, Joint, Mechanism
from heuncli.multibody.tree.layout import Freedom
from heuncli.multibody.tree.spanning import SpanningTree, TreeLink
from heuncli.multibody.tree.starts import JointStart, Z, body_state, joint_direction
from heuncli.multibody.tree.tables import (
    NO_PROGRAM,
    ZERO,
    Program,
    Vector,
    remove_direction_tilt,
    remove_tilt,
    to_sym3,
)
from heuncli.results.results import Array
from heuncli.scene.expressions.paths import Path
from heuncli.scene.shapes.rotations import cross_rows, quaternion_from_matrix

IDENTITY = np.eye(3)
Scalar = tuple[int, Array, str, float, float]  # a freedom: kind, direction, quantity, coordinate, rate


class TreeRows:
    """The rows of the bodies and their freedoms, in the order of the tree, and the start.

    place: the index in the tree of each body of the mechanism
    reference (n, 3): the joint point of each body of the tree, in the body's axes from its origin
    coordinates: of the tree's joints at the start, by joint and quantity
    y, weights: the start's state, and the weight of each of its numbers in the error of a step
    """

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
        self.coordinates: dict[tuple[int, str], float] = {}
        self.freedoms: list[Freedom] = []
        self.y: list[float] = []
        self.weights: list[float] = []
        self.groups: list[kernel.Group] = []
        self.velocity_count = 0
        self.add_bodies()

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
            path=self.add_pieces(path),
            pieces=len(path.coefficients),
            period=path.period,
            reach=reach,
            slope=slope,
            bend=bend,
            radius=path.radius,
            normal=path.normal,
        )

    def add_pieces(self, path: Path) -> int:
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

    def path_to_root(self, i: int) -> list[int]:
        """Return the indices of the bodies from one of the tree to its root, itself first."""
        path = []
        while i >= 0:
            path.append(i)
            i = self.body_rows[i].parent
        return path
