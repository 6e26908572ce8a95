"""Section loads of a moving body.

    s' = sum' k - sum' m x..             force of the piece on the remainder [N]
    M'(P) = sum' (x - P) x k + couples - sum' (x - P) x m x..     about P [N m]
    N = s'.n (tension > 0), Q1 = s'.e1, Q2 = s'.e2, T = M'.n, M1 = M'.e1, M2 = M'.e2
sum' runs over the piece, n points into it; k is its weight, the loads and the joints on it. With the acceleration
matrix Acc = [hat(sigma.) + hat(sigma)^2, x_o.. - g] sum' m (x.. - g) of a piece of pseudo-inertia P is the last column
of Acc P, its moment about the body's origin the skew part of the rest. Heun (1901), (57)-(61), corrected.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.loads.kinetostatics.actions import Action
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.cuts import Cuts
from heuncli.loads.kinetostatics.stress import MODULI, stresses
from heuncli.results.results import Array, Block, Mask
from heuncli.scene.shapes.rotations import cross_rows


@record
class Attachment:
    """Force and couple ON a body, body axes, (n_t, 3); at: their point (3,), or (n_t, 3) if it moves over the body.

    to: the end of the line from `at` along which the force is spread, falling evenly to nothing; None where it is not.
    By causes: (n_c, n_t, 3).
    """

    at: Array
    force: Array
    moment: Array
    to: Array | None = None

    def beyond(self, cuts: Cuts) -> tuple[Array, Array]:
        """What part of it stands on the pieces, (k,), and that part times its place, (k, 3).

        (n_t, k) and (n_t, k, 3) where the point or the cuts move over the body.
        """
        if self.to is None:
            part = on_piece(cuts, self.at)
            return part, part[..., None] * self.at[..., None, :]
        return line_on_piece(cuts, self.at, self.to)


def attachments(body: int, states: BodyStates, actions: Sequence[Action]) -> list[Attachment]:
    """The loads of the actions on a body, each at its point of application."""
    R = states.R[:, body]
    attached: list[Attachment] = []
    for action in actions:
        for end, force, moment in action.on_bodies():
            if end.body != body:
                continue
            for along in action.spread:
                F = in_body_axes(R, along.force)
                attached.append(Attachment(along.spread.start, F, np.zeros_like(F), along.spread.end))
            if action.spread:
                continue
            F, M = in_body_axes(R, np.array([force, moment]))
            if end.point is None:
                attached.append(Attachment(in_body_axes(R, end.position - states.x[:, body]), F, M))
                continue
            if end.apart:
                M = M + cross_rows(in_body_axes(R, end.position - states.x[:, body]) - end.point, F)
            attached.append(Attachment(end.point, F, M))
    return attached


def in_body_axes(R: Array, v: Array) -> Array:
    """R' v: body components of vectors v (..., n_t, 3) in world axes; R (n_t, 3, 3), body to world."""
    components = np.empty(v.shape)
    for i in range(3):
        components[..., i] = R[:, 0, i] * v[..., 0] + R[:, 1, i] * v[..., 1] + R[:, 2, i] * v[..., 2]
    return components


HUGE = 1 << 19  # doubles from which NumPy asks for huge pages: first touch of fresh pages costs more than the products


def scratch(*shape: int) -> Array:
    """Uninitialised memory for arrays side by side."""
    size = math.prod(shape)
    return np.empty(max(size, HUGE) if size > HUGE // 8 else size)[:size].reshape(shape)


def on_piece(cuts: Cuts, at: Array) -> Array:
    """1 where a point lies on the piece of a cut, else 0: (k,), or (n_t, k) for a point that moves over the body."""
    beyond = at[..., None, :] @ cuts.n - cuts.points @ cuts.n
    mask: Array = np.where(np.abs(beyond) <= cuts.near, (cuts.side > 0.0), beyond > 0.0).astype(float)
    return mask


def line_on_piece(cuts: Cuts, start: Array, end: Array) -> tuple[Array, Array]:
    """What part of a force spread from start to end stands on the pieces, and that part times its place.

    From a to b of the line, parts of its length x = 0 to 1, where it is 2 (1 - x) dx at start + x (end - start):

        int 2 (1 - x) dx = (b - a)(2 - a - b),   int 2 (1 - x) x dx = (b^2 - a^2) - 2/3 (b^3 - a^3)

    A line in the plane of a cut is on one side of it, as a point is.
    """
    d = cuts.points @ cuts.n
    first, last = float(start @ cuts.n) - d, float(end @ cuts.n) - d
    cut = (first > 0.0) != (last > 0.0)
    at = np.where(cut, first, 0.0) / np.where(cut, first - last, 1.0)
    a = np.where(first > 0.0, 0.0, np.where(cut, at, 1.0))
    b = np.where(last > 0.0, 1.0, np.where(cut, at, a))
    in_plane = (np.abs(first) <= cuts.near) & (np.abs(last) <= cuts.near)
    a = np.where(in_plane, 0.0, a)
    b = np.where(in_plane, (np.broadcast_to(cuts.side, d.shape) > 0.0).astype(float), b)
    part = (b - a) * (2.0 - a - b)
    run = (b - a) * ((a + b) - 2.0 / 3.0 * (a * a + a * b + b * b))
    return part, part[..., None] * start + run[..., None] * (end - start)


def piece_energy(cuts: Cuts, states: BodyStates) -> Array:
    """E' = tr(V P V') / 2 of the pieces (n_t, k) [J], V = [hat(sigma), x_o.] in body axes, P their pseudo-inertias."""
    R = states.R[:, cuts.body]
    w, v = in_body_axes(R, np.array([states.omega[:, cuts.body], states.v[:, cuts.body]]))
    V = np.zeros((len(w), 3, 4))
    for i in range(3):
        V[:, i, (i + 1) % 3] = -w[:, (i + 2) % 3]
        V[:, i, (i + 2) % 3] = w[:, (i + 1) % 3]
    V[:, :, 3] = v
    pieces = "tkab" if cuts.pieces.ndim == 4 else "kab"
    return np.asarray(0.5 * np.einsum(f"tia,{pieces},tib->tk", V, cuts.pieces, V))


def acceleration_matrix(body: int, states: BodyStates, gravity: Array) -> Array:
    """Acc = [hat(sigma.) + hat(sigma)^2, x_o.. - g] in body axes, rows first: (3, n_t, 4)."""
    R = states.R[:, body]
    vectors = np.array([states.omega[:, body], states.alpha[:, body], states.a[:, body] - gravity])
    return accelerations_as_matrix(*in_body_axes(R, vectors))


def accelerations_as_matrix(w: Array, u: Array, a: Array) -> Array:
    """Acc (3, ..., n_t, 4) of angular velocity w, its rate u and the acceleration a of the origin, all in body axes."""
    A = np.empty((3, *u.shape[:-1], 4))
    square = np.sum(w * w, axis=-1)
    for i in range(3):
        for j in range(3):
            A[i, ..., j] = w[..., i] * w[..., j]
        A[i, ..., i] -= square
        A[i, ..., (i + 1) % 3] -= u[..., (i + 2) % 3]
        A[i, ..., (i + 2) % 3] += u[..., (i + 1) % 3]
    for i in range(3):
        A[i, ..., 3] = a[..., i]
    return A


def piece_loads(cuts: Cuts, A: Array, on: Sequence[Attachment]) -> tuple[Array, Array]:
    """s' and M' about the cuts' own points, body axes, (3, n_t, k) each; A (3, n_t, 4): see acceleration_matrix.

    Inertia and the loads at fixed points are one product of instants and cuts a component, (n_t, 4 + m) (4 + m, k); the
    levers from the cut's point are in the second factor. A load whose point moves over the body may change pieces and
    is added by itself. By causes: (3, n_c, n_t, k), of A (3, n_c, n_t, 4).
    """
    if cuts.points.ndim == 3:
        return moving_piece_loads(cuts, A, on)
    P, p = cuts.pieces.transpose(1, 2, 0), cuts.points.T
    fixed = [a for a in on if a.at.ndim == 1]
    beyond = [a.beyond(cuts) for a in fixed]
    mask = np.array([part for part, _ in beyond]).reshape(-1, len(cuts.points))
    first = np.array([moment for _, moment in beyond]).reshape(-1, len(cuts.points), 3)
    B = [np.concatenate([A[i], *(a.force[..., i : i + 1] for a in fixed)], axis=-1) for i in range(3)]
    C = np.concatenate([-P[:, 3], mask])
    force, moment = scratch(2, 3, *A.shape[1:-1], len(cuts.points))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        np.matmul(B[i], C, out=force[i])
        left = np.concatenate([B[j], B[k], *(a.moment[..., i : i + 1] for a in fixed)], axis=-1)
        right = (
            np.concatenate([P[:, k], -first[..., k]]) + p[k] * C,
            np.concatenate([-P[:, j], first[..., j]]) - p[j] * C,
            mask,
        )
        np.matmul(left, np.concatenate(right), out=moment[i])
    for a in on:
        if a.at.ndim == 2:
            there = on_piece(cuts, a.at)
            for i in range(3):
                j, k = (i + 1) % 3, (i + 2) % 3
                lever_j, lever_k = a.at[:, j, None] - p[j], a.at[:, k, None] - p[k]
                force[i] += a.force[..., i, None] * there
                moment[i] += (
                    a.moment[..., i, None] + lever_j * a.force[..., k, None] - lever_k * a.force[..., j, None]
                ) * there
    return force, moment


def moving_piece_loads(cuts: Cuts, A: Array, on: Sequence[Attachment]) -> tuple[Array, Array]:
    """`piece_loads` of cuts that move along the body: pieces (n_t, k, 4, 4), points (n_t, k, 3)."""
    p = cuts.points.transpose(2, 0, 1)
    inertia = -np.einsum("i...tj,tkjl->il...tk", A, cuts.pieces)
    force = inertia[:, 3].copy()
    moment = np.stack([inertia[2, 1] - inertia[1, 2], inertia[0, 2] - inertia[2, 0], inertia[1, 0] - inertia[0, 1]])
    moment -= crossed(p, force)
    for a in on:
        part, first = a.beyond(cuts)
        F, M = (np.moveaxis(x, -1, 0)[..., None] for x in (a.force, a.moment))
        force += F * part
        moment += crossed(np.moveaxis(first, -1, 0) - p * part, F)
        moment += M * part
    return force, moment


def crossed(a: Array, b: Array) -> Array:
    """a x b of vectors (3, ...)."""
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def shifted(force: Array, moment: Array, by: Array) -> Array:
    """Moments about points that lie `by` from the old one, (3, n_t, k): M - by x s."""
    return moment - crossed(by, force)


@record
class CutPlaces:
    """Where the cuts of a body are and where their moments are taken: at, about, centre (3, n_t, k), body axes [m].

    at: the cuts' own points; about: where moments are told; centre: the centroids, where there are shapes, else `at`.
    R (n_t, 3, 3), origin (n_t, 3): the body's attitude and place.
    """

    cuts: Cuts
    R: Array
    origin: Array
    at: Array
    about: Array
    centre: Array

    def in_world_axes(self, v: Array, out: Array | None = None, is_position: bool = False) -> Array:
        """World components (n_t, k, 3) of a vector (3, n_t, k) in body axes, or of a position from the origin."""
        world = np.empty(v.shape) if out is None else out
        if v.ndim == 3 and v.strides[1] == 0:  # the same at all instants: one product
            np.matmul(self.R.transpose(1, 0, 2), v[:, 0], out=world)
        else:
            before_cuts = (*range(1, v.ndim - 1), 0, v.ndim - 1)
            np.matmul(self.R, v.transpose(before_cuts), out=world.transpose(before_cuts))
        if is_position:
            world += self.origin.T[:, :, None]
        return world.transpose(*range(1, v.ndim), 0)

    def wrench(self, force: Array, moment: Array) -> tuple[Array, Array]:
        """Loads given about the cuts' points, with moments where they are asked for, body axes."""
        return force, moment if self.about is self.at else shifted(force, moment, self.about - self.at)

    def components(self, force: Array, moment: Array) -> Block:
        """All components of loads given about the cuts' points; T0, M10, M20 about the centroid, for stresses."""
        _, about = self.wrench(force, moment)
        c = self.cuts
        space = scratch(15, *force.shape[1:])
        block: Block = {
            "force": self.in_world_axes(force, space[9:12]),
            "moment": self.in_world_axes(about, space[12:15]),
        }
        rows = [
            ("N", c.n, force),
            ("Q1", c.e1, force),
            ("Q2", c.e2, force),
            ("T", c.n, about),
            ("M1", c.e1, about),
            ("M2", c.e2, about),
        ]
        if c.properties is not None:
            centre = moment if self.centre is self.at else shifted(force, moment, self.centre - self.at)
            rows += [("T0", c.n, centre), ("M10", c.e1, centre), ("M20", c.e2, centre)]
        for out, (name, axis, v) in zip(space, rows, strict=False):
            block[name] = along(axis, v, out)
        return block


def along(axis: Array, v: Array, out: Array | None = None) -> Array:
    """axis . v of vectors (3, n_t, k), (n_t, k); terms with a zero in axis are skipped."""
    (first, x), *rest = [(i, x) for i, x in enumerate(axis.tolist()) if x != 0.0]
    component: Array = np.multiply(v[first], x, out=out)
    for i, x in rest:
        component += x * v[i]
    return component


def planes(cuts: Cuts, states: BodyStates) -> CutPlaces:
    """Points of the cuts, of their moments and their centroids at the asked instants."""
    R, x = states.R[:, cuts.body], states.x[:, cuts.body]
    shape = (3, len(R), cuts.points.shape[-2])

    def over_instants(points: Array) -> Array:
        moves = points.ndim == 3
        return np.broadcast_to(points.transpose(2, 0, 1) if moves else points.T[:, None], shape)

    at = over_instants(cuts.points)
    centre = at if cuts.centroids is None else over_instants(cuts.centroids)
    about = centre if cuts.about == "centroid" else at
    if not isinstance(cuts.about, str):
        owner, point = cuts.about
        about = np.broadcast_to(in_body_axes(R, states.point_position(owner, point) - x).T[:, :, None], shape)
    return CutPlaces(cuts, R, x, at, about, centre)


MOMENTS = frozenset({"moment", "T", "M1", "M2", "T0", "M10", "M20"})
ABOUT_CENTROID = ("T0", "M10", "M20")


def components_at_rest(cuts: Cuts, states: BodyStates, on: Sequence[Attachment]) -> Block:
    """Section loads of the attached loads alone, without weight and inertia: (n_t, k), (n_t, k, 3)."""
    return planes(cuts, states).components(*piece_loads(cuts, np.zeros((3, len(states.x), 4)), on))


def section(
    cuts: Cuts,
    states: BodyStates,
    gravity: Array,
    on: Sequence[Attachment],
    is_open: Mapping[str, Mask],
    planar: bool = False,
) -> Block:
    """The block of one section: a single cut without its axis of cuts, a run with `s` and `side`.

    is_open: masks of the indeterminate among the components of `CutPlaces.components`: they become nan.
    """
    where = planes(cuts, states)
    force, moment = piece_loads(cuts, acceleration_matrix(cuts.body, states, gravity), on)
    if planar:
        force[2], moment[:2] = 0.0, 0.0
    components = {
        name: np.where(is_open[name], np.nan, value) if name in is_open else value
        for name, value in where.components(force, moment).items()
    }
    about_centroid = {name[:-1]: components.pop(name) for name in ABOUT_CENTROID if name in components}
    block: Block = {
        "point": where.in_world_axes(where.about, is_position=True),
        "normal": where.R @ cuts.n,
        "first_axis": where.R @ cuts.e1,
        "open": [],
    } | components
    if not cuts.struck:
        block["energy"] = piece_energy(cuts, states)
    if cuts.properties is not None:
        block["stress"] = stress(cuts, {name: components[name] for name in ("N", "Q1", "Q2")} | about_centroid)
    if cuts.line:
        sure = np.isfinite(np.sum([components[name] for name in ("N", "Q1", "Q2", "T", "M1", "M2")], axis=0))
        line = reduction_line(where, force, moment)
        block["line"] = {k: np.where(sure[..., None] if v.ndim == 3 else sure, v, np.nan) for k, v in line.items()}
    if cuts.s is None:
        for key in ({"point", "energy"} & block.keys()) | components.keys():
            block[key] = block[key][:, 0]
        for part in {"line", "stress"} & block.keys():
            block[part] = {key: value[:, 0] for key, value in block[part].items()}
        return block
    words = {1.0: "before", -1.0: "beyond", 0.0: None}
    return {"s": cuts.s, "side": [words[x] for x in cuts.side.tolist()]} | block


def stress(cuts: Cuts, loads: Mapping[str, Array]) -> Block:
    """The stresses of all cuts, by the properties given or by those of the shapes."""
    assert cuts.properties is not None
    if cuts.properties.kind == "auto":
        from heuncli.loads.kinetostatics.auto_properties import stress_block

        return stress_block(cuts.taken, cuts.points.shape[:-1], loads, cuts.strength)
    return stresses(MODULI[cuts.properties.kind](cuts.properties.values), loads, cuts.strength)


def reduction_line(where: CutPlaces, force: Array, moment: Array) -> Block:
    """Points of the plane where force and moment in it are parallel: Q.p = -n.(Q x M_t)/N, direction n x Q.

    moment is about the cut's own point. point: the one nearest to that; pressure_centre: where the moment in the plane
    is zero. nan where N = 0 (no such points, or all) or Q = 0 (all points); `kind` says which: 0 a line, 1 none, 2 all.
    manual/theory.md, "Reduction line".
    """
    cuts, local, in_world_axes = where.cuts, where.at, where.in_world_axes
    n = cuts.n[:, None, None]
    N, T = along(cuts.n, force), along(cuts.n, moment)
    Q, M_t = force - n * N, moment - n * T
    points = cuts.points.reshape(-1, 3)
    reach = float(np.abs(points - points.mean(axis=0)).max())
    reach = reach or float(np.sqrt(np.abs(cuts.pieces[..., :3, :3]).max() / cuts.pieces[..., 3, 3].max()))
    size = np.sqrt(np.sum(force**2, axis=0)) + np.sqrt(np.sum(moment**2, axis=0)) / reach
    q = np.sqrt(np.sum(Q**2, axis=0))
    no_N, no_Q = np.abs(N) <= tolerances.NO_FORCE * size, q <= tolerances.NO_FORCE * size
    twist = along(cuts.n, crossed(Q, M_t))
    free_N = np.where(no_N, np.nan, N)
    free_Q = np.where(no_Q | no_N, np.nan, q)
    n = np.broadcast_to(n, Q.shape)
    point = local - twist / (free_N * free_Q**2) * Q
    direction = crossed(n, Q) / free_Q
    pressure = local + crossed(n, M_t) / free_N
    parallel = np.abs(twist) <= tolerances.NO_FORCE * size * size * reach
    kind = np.where(no_N, np.where(parallel, 2.0, 1.0), np.where(no_Q, 2.0, 0.0))
    return {
        "point": in_world_axes(point, is_position=True), "direction": in_world_axes(direction),
        "pressure_centre": in_world_axes(pressure, is_position=True), "kind": kind,
    }  # fmt: skip
