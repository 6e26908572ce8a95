"""The assembled mechanism as the kernel's flat arrays (layouts: kernel/tree.py, kernel/loops.py, kernel/step.py).

The one place that knows both names and offsets.
"""

from __future__ import annotations

import math
from array import array

import numpy as np

from heuncli.expressions.programs import Expression, Pack
from heuncli.joint_kinds import JOINTS, Direction
from heuncli.mechanism.model import GROUND, Assembly, Joint, JointLoad, Mechanism, PairLoad, PointLoad
from heuncli.mechanism.size import size_of_scene
from heuncli.results import Array
from heuncli.shapes.rotations import to_quaternion
from heuncli.tree.layout import Freedom, Layout
from heuncli.tree.spanning import Hang, Spanning, span
from heuncli.tree.starts import JointStart, Z, joint_frame, joint_start, pose, to_direction

HEADER = 48
NEARLY_SINGULAR = 0.2  # least pivot of the scaled closures below which the stages of a step are settled too
JOINT_LOADS = {"torque": (4, 5), "damper": (6, 7), "friction": (8, 9)}  # of the turning, of the sliding


def lay_out(mechanism: Mechanism, start: Assembly, inertias: Array, work: bool = True) -> Layout:
    """Lay the scene out. inertias (n, 3, 3): about the centres of mass, body axes, as the motion shall use them."""
    pack = Pack()
    programs, uses = _programs(mechanism, pack)
    names = {j.name: k for k, j in enumerate(mechanism.joints)}
    kept = {names[joint] for joint, _ in uses} | {
        k for k, j in enumerate(mechanism.joints) if j.drive is not None and j.drive.quantity != "length"
    }
    spanning = span(mechanism, kept)
    starts = [joint_start(mechanism, start, joint) for joint in mechanism.joints]
    builder = _Builder(mechanism, start, spanning, starts, inertias, pack, programs)
    builder.bodies()
    builder.rows()
    builder.loads()
    return builder.finish(work)


def _programs(mechanism: Mechanism, pack: Pack) -> tuple[dict[int, tuple[int, int]], set[tuple[str, str]]]:
    """Put every expression in time into the pack; where each stands, by identity, and the coordinates they name."""
    expressions = [value for load in mechanism.loads for value in load.values]
    driven = [j.drive.value for j in mechanism.joints if j.drive is not None]
    programs = {id(e): pack.add(e) for e in expressions if e.constant is None} | {id(e): pack.add(e) for e in driven}
    return programs, {use for e in expressions for use in e.uses}


class _Builder:
    """Fills the kernel's arrays; lives for one call of lay_out."""

    def __init__(
        self,
        mechanism: Mechanism,
        start: Assembly,
        spanning: Spanning,
        starts: list[JointStart],
        inertias: Array,
        pack: Pack,
        programs: dict[int, tuple[int, int]],
    ) -> None:
        self.mechanism, self.start, self.spanning, self.starts = mechanism, start, spanning, starts
        self.inertias, self.pack, self.programs = inertias, pack, programs
        self.place = {h.body: i for i, h in enumerate(spanning.hangs)}
        self.size = size_of_scene(mechanism, start)
        self.reference = np.array([self._reference(h) for h in spanning.hangs])
        self.body_ints: list[int] = []
        self.body_floats: list[float] = []
        self.freedom_ints: list[int] = []
        self.freedom_floats: list[float] = []
        self.freedoms: list[Freedom] = []
        self.y: list[float] = []
        self.weights: list[float] = []
        self.groups: list[int] = []
        self.n_sweep = 0
        self.sweep_start: list[int] = []
        self.sweep_count: list[int] = []

    def _reference(self, h: Hang) -> Array:
        body = self.mechanism.bodies[h.body]
        if h.joint < 0:
            return body.center
        joint = self.mechanism.joints[h.joint]
        return joint.p if h.reverse else joint.q

    def relative(self, body: int, point: Array) -> Array:
        """A body's point from its joint point, body axes; a ground point as it is."""
        return point if body == GROUND else point - self.reference[self.place[body]]

    def sweep(self, body: int) -> int:
        return body if body == GROUND else self.place[body]

    def bodies(self) -> None:
        """Bodies, freedoms and the start."""
        for i, h in enumerate(self.spanning.hangs):
            body = self.mechanism.bodies[h.body]
            _, R, _, w = pose(self.start, h.body)
            joint_point, R_ref, ball, freedoms = self._hang(h)
            c = body.center - self.reference[i]
            J = self.inertias[h.body] + body.mass * ((c @ c) * np.eye(3) - np.outer(c, c))
            f0, g0 = len(self.freedoms), len(self.y)
            driven = [self._driven(h, quantity) for _, _, quantity, _, _ in freedoms]
            q = 4 * ball + len([d for d in driven if d is None])
            if ball:
                self.y += to_quaternion(R).tolist()
                self.weights += [1.0] * 4
            n_q = g0 + 4 * ball
            n_u = g0 + q + 3 * ball
            rates: list[float] = []
            weights: list[float] = []
            for (kind, direction, quantity, x, u), drive in zip(freedoms, driven, strict=True):
                weight = 1.0 / self.size if kind == 2 else 1.0
                at_q = at_u = -1
                if drive is None:
                    at_q, at_u = n_q, n_u
                    n_q, n_u = n_q + 1, n_u + 1
                    self.y.append(x)
                    self.weights.append(weight)
                    rates.append(u)
                    weights.append(weight)
                place = self.n_sweep + 3 * ball + len(self.freedoms) - f0
                self.freedom_ints += [kind, at_q, at_u, int(drive is not None), *(drive or (0, 0)), place, i]
                self.freedom_floats += [*direction.tolist(), 0.0]
                self.freedoms.append(Freedom(h.joint, quantity, at_q, at_u))
            if ball:
                self.y += w.tolist()
                self.weights += [1.0] * 3
            self.y += rates
            self.weights += weights
            self.groups += [g0, g0 + q, len(self.y)]
            has_ref = int(not np.array_equal(R_ref, np.eye(3)))
            self.body_ints += [self.sweep(h.parent), int(ball), f0, len(freedoms), g0, g0 + q, self.n_sweep, has_ref]
            self.body_floats += [
                body.mass, *(body.mass * c).tolist(), J[0, 0], J[0, 1], J[0, 2], J[1, 1], J[1, 2], J[2, 2],
                *joint_point.tolist(), *R_ref.ravel().tolist(), *self.reference[i].tolist(), *([0.0] * 15),
            ]  # fmt: skip
            self.sweep_start.append(self.n_sweep)
            self.sweep_count.append(3 * ball + len(freedoms))
            self.n_sweep += 3 * ball + len(freedoms)

    def _driven(self, h: Hang, quantity: str) -> tuple[int, int] | None:
        drive = self.mechanism.joints[h.joint].drive if h.joint >= 0 else None
        return self.programs[id(drive.value)] if drive is not None and drive.quantity == quantity else None

    def _hang(self, h: Hang) -> tuple[Array, Array, bool, list[tuple[int, Array, str, float, float]]]:
        """Joint point in the parent, R_ref, ball, and freedoms (kind, direction, quantity, coordinate, rate)."""
        if h.joint < 0:
            return self._free(h)
        return self._jointed(h)

    def _free(self, h: Hang) -> tuple[Array, Array, bool, list[tuple[int, Array, str, float, float]]]:
        """A body that nothing carries: its centre of mass and its attitude, in the plane where that was declared."""
        x, R, v, w = pose(self.start, h.body)
        c = R @ self.mechanism.bodies[h.body].center
        place, speed = x + c, v + np.cross(w, c)
        e = np.eye(3)
        names = ("x", "y", "z")
        shifts = [(2, e[k], names[k], float(place[k]), float(speed[k])) for k in range(3)]
        if self.mechanism.planar:
            base = np.array([0.0, 0.0, place[2]])
            return base, R, False, [(0, e[2], "turn", 0.0, float(w[2])), *shifts[:2]]
        return np.zeros(3), e, True, shifts

    def _jointed(self, h: Hang) -> tuple[Array, Array, bool, list[tuple[int, Array, str, float, float]]]:
        joint, s = self.mechanism.joints[h.joint], self.starts[h.joint]
        kind = JOINTS[joint.kind]
        axes = {"axis": joint.axis, "to_axis": joint.to_axis, "z": Z}
        R_ref = s.R_ref
        freedoms: list[tuple[int, Array, str, float, float]] = []
        sign = 1.0
        if h.reverse:
            axes = {"axis": joint.axis, "to_axis": joint.to_axis}
            if len(kind.turns) != 2:
                axes = {"axis": R_ref.T @ joint.axis}
            R_ref, sign = R_ref.T, -1.0
        turns = kind.turns[::-1] if h.reverse else kind.turns
        if len(turns) == 2:
            rates = self._universal_rates(joint)
            for k, name in enumerate(turns):
                freedoms.append((k, sign * axes[name], "first" if name == "axis" else "second", 0.0, rates[name]))
        else:
            freedoms += [(0, sign * axes[name], "angle", s.angle, s.rate) for name in turns]
        if "travel" in kind.coordinates:
            freedoms.append((2, sign * (R_ref @ joint.axis if h.reverse else joint.axis), "travel", s.travel, s.speed))
        else:
            freedoms += [(2, joint_frame(joint, d), d, *self._shift(joint, d)) for d in kind.shifts]
        point = joint.q if h.reverse else joint.p
        return self.relative(h.parent, point), R_ref, kind.ball, freedoms

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
        v = vb + np.cross(wb, Rb @ joint.q) - va - np.cross(wa, Q - xa)
        return float(f @ (Q - xa - Ra @ joint.p)), float(f @ v)

    def rows(self) -> None:
        """Closure rows of the cut joints, their paths, freedoms and couplings, and counted angles."""
        self.row_joint: list[int] = []
        self.row_ints: list[list[int]] = []
        self.row_floats: list[float] = []
        self.paths: list[list[int]] = []
        self.counters: dict[int, int] = {}
        for k in self.spanning.cut:
            joint, s = self.mechanism.joints[k], self.starts[k]
            kind = JOINTS[joint.kind]
            P, Q = self.relative(joint.a, joint.p), self.relative(joint.b, joint.q)
            a, b = self.sweep(joint.a), self.sweep(joint.b)
            path = sorted(set(self._path(a)) | set(self._path(b)), reverse=True)
            zero = np.zeros(3)
            if kind.keeps_distance:
                drive = self.programs[id(joint.drive.value)] if joint.drive is not None else (0, 0)
                xa, Ra, _, _ = pose(self.start, joint.a)
                xb, Rb, _, _ = pose(self.start, joint.b)
                D = xb + Rb @ joint.q - xa - Ra @ joint.p
                length = joint.length if joint.length is not None else math.sqrt(float(D @ D))
                self._row(k, [2, a, b], drive, path, [zero, zero, P, Q], length if not drive[1] else 0.0, 1.0)
            for d in kind.guides:
                self._row(k, [0, a, b], (0, 0), path, [joint_frame(joint, d), zero, P, Q], 0.0, 1.0)
            for d, e in kind.dots:
                pair = [joint_frame(joint, d), to_direction(joint, s.R_ref, e)]
                self._row(k, [1, a, b], (0, 0), path, [*pair, P, Q], 0.0, self.size)
            if "angle" in kind.coordinates:
                self.counters[k] = -1

    def _row(
        self,
        joint: int,
        head: list[int],
        drive: tuple[int, int],
        path: list[int],
        vectors: list[Array],
        length: float,
        weight: float,
    ) -> None:
        self.row_joint.append(joint)
        self.row_ints.append([*head, joint, *drive])
        self.paths.append(path)
        self.row_floats += [x for v in vectors for x in v.tolist()] + [length, weight, *([0.0] * 10)]

    def _path(self, i: int) -> list[int]:
        path = []
        while i >= 0:
            path.append(i)
            i = self.body_ints[8 * i]
        return path

    def loads(self) -> None:
        """Applied loads."""
        self.load_ints: list[int] = []
        self.load_floats: list[float] = []
        for load in self.mechanism.loads:
            if isinstance(load, PointLoad):
                self._point_load(load)
            elif isinstance(load, PairLoad):
                self._pair_load(load)
            else:
                self._joint_load(load)

    def _load(self, head: list[int], values: list[Expression | float], p: Array, q: Array, tail: list[float]) -> None:
        programs: list[int] = []
        constants: list[float] = []
        for value in [*values, *([0.0] * (3 - len(values)))]:
            constant = value if isinstance(value, float) else value.constant
            programs += (0, 0) if constant is not None or isinstance(value, float) else self.programs[id(value)]
            constants.append(constant if constant is not None else 0.0)
        self.load_ints += [*head, *programs, *([0] * 6)]
        self.load_floats += [*p.tolist(), *q.tolist(), *constants, *tail]

    def _point_load(self, load: PointLoad) -> None:
        q = np.zeros(3) if load.point is None else self.relative(load.body, load.point)
        kind = 0 if load.kind == "force" else 1
        head = [kind, GROUND, self.sweep(load.body), int(load.in_body)]
        self._load(head, list(load.vector), np.zeros(3), q, [0.0] * 7)

    def _pair_load(self, load: PairLoad) -> None:
        head = [2 if load.value is None else 3, self.sweep(load.a), self.sweep(load.b), 0]
        p, q = self.relative(load.a, load.p), self.relative(load.b, load.q)
        values: list[Expression | float] = [] if load.value is None else [load.value]
        self._load(head, values, p, q, [load.stiffness, load.length, load.damping, 0.0, 0.0, 0.0, 0.0])

    def _joint_load(self, load: JointLoad) -> None:
        joint = self.mechanism.joints[load.joint]
        kind = JOINTS[joint.kind]
        ends = [self.sweep(joint.a), self.sweep(joint.b), int(kind.has_one_axis)]
        p, q = self.relative(joint.a, joint.p), self.relative(joint.b, joint.q)
        values: list[Expression | float] = [] if load.value is None else [load.value]
        turns, slides = JOINT_LOADS[load.kind]
        parts = {"turning": (turns, load.turning), "sliding": (slides, load.sliding)}
        for motion in kind.motions:
            number, coefficient = parts[motion]
            self._load([number, *ends], values, p, q, [0.0, 0.0, coefficient, *joint.axis.tolist(), load.speed])

    def finish(self, work: bool) -> Layout:
        """Lay the parts end to end, set the header."""
        n, n_f, n_l, n_r = len(self.spanning.hangs), len(self.freedoms), len(self.load_ints) // 16, len(self.row_joint)
        controlled, D_work = len(self.y), -1
        for k in self.counters:
            self.counters[k] = len(self.y)
            self.y.append(self.starts[k].angle)
            self.weights.append(0.0)
        if work:
            self.y.append(0.0)
            self.weights.append(0.0)
            if any(j.drive is not None for j in self.mechanism.joints):
                # the drives' work may vary where the motion does not: it has a say in the step
                D_work = len(self.groups) // 3
                self.weights[-1] = 1.0
                self.groups += [len(self.y) - 1, len(self.y) - 1, len(self.y)]
        H = [0] * HEADER
        H[:9] = [n, n_f, self.n_sweep, n_l, n_r, controlled, 0, int(work), len(self.y) - 1]
        ints = [*H]

        def put(data: list[int]) -> int:
            at = len(ints)
            ints.extend(data)
            return at

        H[10] = put(self.body_ints)
        H[11] = put(self.freedom_ints)
        H[12] = put(self.load_ints)
        variables = [0, 0]
        joints = self.mechanism.joints
        by_name = {(joints[f.joint].name, f.quantity): i for i, f in enumerate(self.freedoms) if f.joint >= 0}
        for name, quantity in (use for use in self.pack.variables if not isinstance(use, str)):
            base = {"rate": "angle", "speed": "travel"}.get(quantity, quantity)
            variables += [by_name[name, base], int(base != quantity)]
        H[14], H[15] = put(variables), len(variables) // 2
        # rows with their paths and lists
        e_start = 0
        row_at = len(ints)
        H[13] = row_at
        ints.extend([0] * (16 * n_r))
        dofs: dict[tuple[int, ...], tuple[int, int, int]] = {}
        for r, (head, path) in enumerate(zip(self.row_ints, self.paths, strict=True)):
            key = tuple(path)
            if key not in dofs:
                at_path = put(path)
                places = [self.sweep_start[i] + m for i in path for m in range(self.sweep_count[i])]
                dofs[key] = (at_path, put(places), len(places))
            at_path, at_dofs, count = dofs[key]
            ints[row_at + 16 * r : row_at + 16 * r + 11] = [*head, at_path, len(path), e_start, at_dofs, count]
            e_start += count
        for r, coupled in enumerate(couplings(self.paths)):
            rope = self.mechanism.joints[self.row_joint[r]].tension_only
            ints[row_at + 16 * r + 11 : row_at + 16 * r + 15] = [put(coupled), len(coupled), -1, int(rope)]
        H[28], H[30] = put([0] * max(n_r, 1)), put([0] * max(n_r, 1))
        counted = [(self.sweep(joints[k].a), self.sweep(joints[k].b), at, 0) for k, at in self.counters.items()]
        H[32], H[33] = put([x for counter in counted for x in counter]), len(counted)

        floats = [*self.mechanism.gravity.tolist(), self.size, 1.0, 1.0, 1.0, NEARLY_SINGULAR]
        H[16] = len(floats)
        floats += self.body_floats
        H[17] = len(floats)
        floats += self.freedom_floats
        H[18] = len(floats)
        floats += self.load_floats
        H[19] = len(floats)
        floats += self.row_floats
        H[35] = len(floats)
        floats += [x for k in self.counters for x in (*self.mechanism.joints[k].axis.tolist(), 0.0)]

        lengths = {20: 80 * n, 21: 16 * n_f, 22: self.n_sweep, 23: 16 * n_l, 25: 40, 24: 16 * n_r, 26: e_start,
                   27: n_r * n_r, 34: 6 * n if n_r else 0, 36: self.n_sweep, 37: 3 * n_r}  # fmt: skip
        for slot, at in zip(lengths, np.cumsum([0, *lengths.values()]).tolist(), strict=False):
            H[slot] = at
        H[39] = int(any(j.drive is not None for j in self.mechanism.joints))
        ints[:HEADER] = H
        groups = [len(self.y), len(self.groups) // 3, 0, D_work, *([0] * 4), *self.groups]
        return Layout(
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
            groups=array("i", groups),
            weights=np.array(self.weights),
            I=array("i", ints),
            P=array("d", floats),
            W=array("d", bytes(8 * (sum(lengths.values()) + 1))),
            pack=self.pack,
            work=work,
        )


def couplings(paths: list[list[int]]) -> list[list[int]]:
    """For each row the earlier rows (and itself) whose paths share a body with its own."""
    through: dict[int, list[int]] = {}
    found: list[list[int]] = []
    for r, path in enumerate(paths):
        seen: set[int] = {r}
        for i in path:
            rows = through.setdefault(i, [])
            seen.update(rows)
            rows.append(r)
        found.append(sorted(seen))
    return found
