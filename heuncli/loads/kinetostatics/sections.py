"""Section loads of a moving body.

    s' = sum' k - sum' m x..             force of the piece on the remainder [N]
    M'(P) = sum' (x - P) x k + couples - sum' (x - P) x m x..     about P [N m]
    N = s'.n (tension > 0), Q1 = s'.e1, Q2 = s'.e2, T = M'.n, M1 = M'.e1, M2 = M'.e2

sum' runs over the piece, n points into it; k is its weight, the loads and the joints on it. sigma is here the angular
velocity (in stress.py it is a stress). With the acceleration matrix Acc = [hat(sigma.) + hat(sigma)^2, x_o.. - g]
sum' m (x.. - g) of a piece of pseudo-inertia P is the last column of Acc P, its moment about the body's origin the skew
part of the rest. Heun (1901), (57)-(61), corrected.
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
from heuncli.loads.kinetostatics.stress import MODULI, compute_stresses
from heuncli.results.results import SIDE_WORDS, Array, Block, Mask
from heuncli.scene.file_format.profiles import FAMILIES
from heuncli.scene.shapes.rotations import cross_first_axis, cross_rows


@record
class AttachedLoad:
    """A force and couple ON a body at one place, body axes, (n_t, 3); by causes: (n_c, n_t, 3).

    point: where they act (3,), or (n_t, 3) if it moves over the body
    line_end: end of the line from `point` along which the force is distributed, decreasing linearly to zero; None for a
    concentrated force
    """

    point: Array
    force: Array
    moment: Array
    line_end: Array | None = None

    def find_fraction_on_pieces(self, cuts: Cuts) -> tuple[Array, Array]:
        """Return the fraction of it that acts on each piece, (k,), and that fraction times its place, (k, 3).

        (n_t, k) and (n_t, k, 3) where the point or the cuts move over the body.
        """
        if self.line_end is None:
            fraction = mark_points_on_pieces(cuts, self.point)
            return fraction, fraction[..., None] * self.point[..., None, :]
        return find_line_fraction_on_pieces(cuts, self.point, self.line_end)


def find_attachments(body: int, states: BodyStates, actions: Sequence[Action]) -> list[AttachedLoad]:
    """Return the loads that actions exert on a body, each at its point of application."""
    R = states.R[:, body]
    result: list[AttachedLoad] = []
    for action in actions:
        for end, force, moment in action.iter_ends():
            if end.body != body:
                continue
            for distributed_force in action.spread:
                F = to_body_axes(R, distributed_force.force)
                result.append(
                    AttachedLoad(distributed_force.spread.start, F, np.zeros_like(F), distributed_force.spread.end)
                )
            if action.spread:
                continue
            F, M = to_body_axes(R, np.array([force, moment]))
            if end.point is None:
                result.append(AttachedLoad(to_body_axes(R, end.position - states.x[:, body]), F, M))
                continue
            if end.is_offset:
                M = M + cross_rows(to_body_axes(R, end.position - states.x[:, body]) - end.point, F)
            result.append(AttachedLoad(end.point, F, M))
    return result


def to_body_axes(R: Array, v: Array) -> Array:
    """Return R' v: body components of vectors v (..., n_t, 3) in world axes; R (n_t, 3, 3), body to world."""
    components = np.empty(v.shape)
    for i in range(3):
        components[..., i] = R[:, 0, i] * v[..., 0] + R[:, 1, i] * v[..., 1] + R[:, 2, i] * v[..., 2]
    return components


# doubles from which NumPy asks for huge pages: first touch of fresh pages costs more than the products
HUGE_PAGE_DOUBLES = 1 << 19


def allocate(*shape: int) -> Array:
    """Return uninitialised memory for adjacent arrays."""
    size = math.prod(shape)
    return np.empty(max(size, HUGE_PAGE_DOUBLES) if size > HUGE_PAGE_DOUBLES // 8 else size)[:size].reshape(shape)


def mark_points_on_pieces(cuts: Cuts, point: Array) -> Array:
    """Return 1.0 where a point lies on the piece of a cut, else 0.0: (k,), or (n_t, k) for a point that moves over the
    body.

    A point in the plane lies on the piece if the cut is just before it.
    """
    height = point[..., None, :] @ cuts.n - cuts.points @ cuts.n
    mask: Array = np.where(np.abs(height) <= cuts.plane_tolerance, (cuts.side > 0.0), height > 0.0).astype(float)
    return mask


def find_line_fraction_on_pieces(cuts: Cuts, start: Array, end: Array) -> tuple[Array, Array]:
    """Return the share of a force distributed from start to end that acts on the pieces, and that share times its
    place.

    From a to b of the line, parts of its length x = 0 to 1, where it is 2 (1 - x) dx at start + x (end - start):

        int 2 (1 - x) dx = (b - a)(2 - a - b),   int 2 (1 - x) x dx = (b^2 - a^2) - 2/3 (b^3 - a^3)

    A line in the plane of a cut is on one side of it, as a point is.
    """
    d = cuts.points @ cuts.n
    first, last = float(start @ cuts.n) - d, float(end @ cuts.n) - d
    is_cut = (first > 0.0) != (last > 0.0)
    crossing = np.where(is_cut, first, 0.0) / np.where(is_cut, first - last, 1.0)
    a = np.where(first > 0.0, 0.0, np.where(is_cut, crossing, 1.0))
    b = np.where(last > 0.0, 1.0, np.where(is_cut, crossing, a))
    in_plane = (np.abs(first) <= cuts.plane_tolerance) & (np.abs(last) <= cuts.plane_tolerance)
    a = np.where(in_plane, 0.0, a)
    b = np.where(in_plane, (np.broadcast_to(cuts.side, d.shape) > 0.0).astype(float), b)
    fraction = (b - a) * (2.0 - a - b)
    line_moment = (b - a) * ((a + b) - 2.0 / 3.0 * (a * a + a * b + b * b))
    return fraction, fraction[..., None] * start + line_moment[..., None] * (end - start)


def compute_piece_energy(cuts: Cuts, states: BodyStates) -> Array:
    """Return E' = tr(V P V') / 2 of the pieces (n_t, k) [J], V = [hat(sigma), x_o.] in body axes, P their
    pseudo-inertias.
    """
    R = states.R[:, cuts.body]
    w, v = to_body_axes(R, np.array([states.omega[:, cuts.body], states.v[:, cuts.body]]))
    V = np.zeros((len(w), 3, 4))
    for i in range(3):
        V[:, i, (i + 1) % 3] = -w[:, (i + 2) % 3]
        V[:, i, (i + 2) % 3] = w[:, (i + 1) % 3]
    V[:, :, 3] = v
    pieces = "tkab" if cuts.pieces.ndim == 4 else "kab"
    return np.asarray(0.5 * np.einsum(f"tia,{pieces},tib->tk", V, cuts.pieces, V))


def find_acceleration_matrix(body: int, states: BodyStates, gravity: Array) -> Array:
    """Return Acc = [hat(sigma.) + hat(sigma)^2, x_o.. - g] in body axes, rows first: (3, n_t, 4)."""
    R = states.R[:, body]
    vectors = np.array([states.omega[:, body], states.alpha[:, body], states.a[:, body] - gravity])
    return compute_acceleration_matrix(*to_body_axes(R, vectors))


def compute_acceleration_matrix(w: Array, u: Array, a: Array) -> Array:
    """Return Acc (3, ..., n_t, 4) of angular velocity w, its rate u and the acceleration a of the origin, in body
    axes.
    """
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


def find_piece_loads(cuts: Cuts, A: Array, attached_loads: Sequence[AttachedLoad]) -> tuple[Array, Array]:
    """Return s' and M' about the cuts' own points, body axes, (3, n_t, k) each.

    A (3, n_t, 4): see find_acceleration_matrix

    Inertia and the loads at fixed points are one product of instants and cuts for each component, (n_t, 4 + m) (4 + m,
    k); the levers from the cut's point are in the second factor. A load whose point moves over the body may change
    pieces and is added separately. By causes: (3, n_c, n_t, k), with A (3, n_c, n_t, 4).
    """
    if cuts.points.ndim == 3:
        return find_moving_piece_loads(cuts, A, attached_loads)
    P, p = cuts.pieces.transpose(1, 2, 0), cuts.points.T
    fixed_loads = [a for a in attached_loads if a.point.ndim == 1]
    fractions_and_moments = [a.find_fraction_on_pieces(cuts) for a in fixed_loads]
    fractions = np.array([fraction for fraction, _ in fractions_and_moments]).reshape(-1, len(cuts.points))
    first_moments = np.array([moment for _, moment in fractions_and_moments]).reshape(-1, len(cuts.points), 3)
    # s'_i = [A_i, F_i] [-P_3; fraction];  M'_i = [A_j, F_j, A_k, F_k, M_i] [levers; fraction],  (i, j, k) cyclic
    left_factor = [np.concatenate([A[i], *(a.force[..., i : i + 1] for a in fixed_loads)], axis=-1) for i in range(3)]
    right_factor = np.concatenate([-P[:, 3], fractions])
    force, moment = allocate(2, 3, *A.shape[1:-1], len(cuts.points))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        np.matmul(left_factor[i], right_factor, out=force[i])
        left = np.concatenate(
            [left_factor[j], left_factor[k], *(a.moment[..., i : i + 1] for a in fixed_loads)], axis=-1
        )
        right = (
            np.concatenate([P[:, k], -first_moments[..., k]]) + p[k] * right_factor,
            np.concatenate([-P[:, j], first_moments[..., j]]) - p[j] * right_factor,
            fractions,
        )
        np.matmul(left, np.concatenate(right), out=moment[i])
    for a in attached_loads:
        if a.point.ndim == 2:
            piece_mask = mark_points_on_pieces(cuts, a.point)
            for i in range(3):
                j, k = (i + 1) % 3, (i + 2) % 3
                lever_j, lever_k = a.point[:, j, None] - p[j], a.point[:, k, None] - p[k]
                force[i] += a.force[..., i, None] * piece_mask
                moment[i] += (
                    a.moment[..., i, None] + lever_j * a.force[..., k, None] - lever_k * a.force[..., j, None]
                ) * piece_mask
    return force, moment


def find_moving_piece_loads(cuts: Cuts, A: Array, attached_loads: Sequence[AttachedLoad]) -> tuple[Array, Array]:
    """Return the piece loads of cuts that move along the body: pieces (n_t, k, 4, 4), points (n_t, k, 3)."""
    p = cuts.points.transpose(2, 0, 1)
    inertia = -np.einsum("i...tj,tkjl->il...tk", A, cuts.pieces)
    force = inertia[:, 3].copy()
    moment = np.stack([inertia[2, 1] - inertia[1, 2], inertia[0, 2] - inertia[2, 0], inertia[1, 0] - inertia[0, 1]])
    moment -= cross_first_axis(p, force)
    for a in attached_loads:
        fraction, first = a.find_fraction_on_pieces(cuts)
        F, M = (np.moveaxis(x, -1, 0)[..., None] for x in (a.force, a.moment))
        force += F * fraction
        moment += cross_first_axis(np.moveaxis(first, -1, 0) - p * fraction, F)
        moment += M * fraction
    return force, moment


def shift_moment(force: Array, moment: Array, offset: Array) -> Array:
    """Return moments about points at an `offset` from the old one, (3, n_t, k): M - offset x s."""
    return moment - cross_first_axis(offset, force)


@record
class CutPlaces:
    """Where the cuts of a body are and where their moments are taken, (3, n_t, k), body axes [m].

    cut_points: the cuts' own points
    moment_points: where moments are reported
    centroids: the centroids, where there are shapes, else `cut_points`
    R (n_t, 3, 3), origin (n_t, 3): the body's attitude and position
    """

    cuts: Cuts
    R: Array
    origin: Array
    cut_points: Array
    moment_points: Array
    centroids: Array

    def to_world_axes(self, v: Array, output: Array | None = None, is_position: bool = False) -> Array:
        """Return world components (n_t, k, 3) of a vector (3, n_t, k) in body axes, or of a position from the
        origin.
        """
        world = np.empty(v.shape) if output is None else output
        if v.ndim == 3 and v.strides[1] == 0:  # the same at all instants: one product
            np.matmul(self.R.transpose(1, 0, 2), v[:, 0], out=world)
        else:
            before_cuts = (*range(1, v.ndim - 1), 0, v.ndim - 1)
            np.matmul(self.R, v.transpose(before_cuts), out=world.transpose(before_cuts))
        if is_position:
            world += self.origin.T[:, :, None]
        return world.transpose(*range(1, v.ndim), 0)

    def shift_wrench(self, force: Array, moment: Array) -> tuple[Array, Array]:
        """Return loads given about the cuts' points, with moments about the reported points, body axes."""
        return force, moment if self.moment_points is self.cut_points else shift_moment(
            force, moment, self.moment_points - self.cut_points
        )

    def compute_components(self, force: Array, moment: Array) -> Block:
        """Return all components of loads given about the cuts' points; T0, M10, M20 about the centroid, for
        stresses.
        """
        _, moments = self.shift_wrench(force, moment)
        cuts = self.cuts
        space = allocate(15, *force.shape[1:])
        block: Block = {
            "force": self.to_world_axes(force, space[9:12]),
            "moment": self.to_world_axes(moments, space[12:15]),
        }
        rows = [
            ("N", cuts.n, force),
            ("Q1", cuts.e1, force),
            ("Q2", cuts.e2, force),
            ("T", cuts.n, moments),
            ("M1", cuts.e1, moments),
            ("M2", cuts.e2, moments),
        ]
        if cuts.properties is not None:
            centroid_moments = (
                moment
                if self.centroids is self.cut_points
                else shift_moment(force, moment, self.centroids - self.cut_points)
            )
            rows += [
                ("T0", cuts.n, centroid_moments),
                ("M10", cuts.e1, centroid_moments),
                ("M20", cuts.e2, centroid_moments),
            ]
        for output, (name, axis, v) in zip(space, rows, strict=False):
            block[name] = compute_axis_component(axis, v, output)
        return block


def compute_axis_component(axis: Array, v: Array, output: Array | None = None) -> Array:
    """Return axis . v of vectors (3, n_t, k), (n_t, k); terms with a zero in axis are skipped."""
    (first, x), *rest = [(i, x) for i, x in enumerate(axis.tolist()) if x != 0.0]
    component: Array = np.multiply(v[first], x, out=output)
    for i, x in rest:
        component += x * v[i]
    return component


def make_cut_places(cuts: Cuts, states: BodyStates) -> CutPlaces:
    """Return the points of the cuts, of their moments and their centroids at the requested instants."""
    R, x = states.R[:, cuts.body], states.x[:, cuts.body]
    shape = (3, len(R), cuts.points.shape[-2])

    def over_instants(points: Array) -> Array:
        moves = points.ndim == 3
        return np.broadcast_to(points.transpose(2, 0, 1) if moves else points.T[:, None], shape)

    cut_points = over_instants(cuts.points)
    centroids = cut_points if cuts.centroids is None else over_instants(cuts.centroids)
    moment_points = centroids if cuts.moment_reference == "centroid" else cut_points
    if not isinstance(cuts.moment_reference, str):
        owner, point = cuts.moment_reference
        moment_points = np.broadcast_to(to_body_axes(R, states.point_position(owner, point) - x).T[:, :, None], shape)
    return CutPlaces(cuts, R, x, cut_points, moment_points, centroids)


MOMENTS = frozenset({"moment", "T", "M1", "M2", "T0", "M10", "M20"})
ABOUT_CENTROID = ("T0", "M10", "M20")


def compute_static_components(cuts: Cuts, states: BodyStates, attached_loads: Sequence[AttachedLoad]) -> Block:
    """Return section loads of the attached loads alone, without weight and inertia: (n_t, k), (n_t, k, 3)."""
    return make_cut_places(cuts, states).compute_components(
        *find_piece_loads(cuts, np.zeros((3, len(states.x), 4)), attached_loads)
    )


def make_section_block(
    cuts: Cuts,
    states: BodyStates,
    gravity: Array,
    attached_loads: Sequence[AttachedLoad],
    indeterminate_masks: Mapping[str, Mask],
    planar: bool = False,
) -> Block:
    """Make the block of one section: of a single cut without an axis of cuts, of a series with `s` and `side`.

    indeterminate_masks: by names of `CutPlaces.compute_components`; their values become nan
    """
    cut_places = make_cut_places(cuts, states)
    force, moment = find_piece_loads(cuts, find_acceleration_matrix(cuts.body, states, gravity), attached_loads)
    if planar:
        force[2], moment[:2] = 0.0, 0.0
    components = {
        name: np.where(indeterminate_masks[name], np.nan, value) if name in indeterminate_masks else value
        for name, value in cut_places.compute_components(force, moment).items()
    }
    about_centroid = {name[:-1]: components.pop(name) for name in ABOUT_CENTROID if name in components}
    block: Block = {
        "point": cut_places.to_world_axes(cut_places.moment_points, is_position=True),
        "normal": cut_places.R @ cuts.n,
        "first_axis": cut_places.R @ cuts.e1,
        "open": [],
    } | components
    if not cuts.is_impulse:
        block["energy"] = compute_piece_energy(cuts, states)
    if cuts.properties is not None:
        block["stress"] = compute_stresses_of_cuts(
            cuts, {name: components[name] for name in ("N", "Q1", "Q2")} | about_centroid
        )
    if cuts.line:
        is_determinate = np.isfinite(np.sum([components[name] for name in ("N", "Q1", "Q2", "T", "M1", "M2")], axis=0))
        line = find_reduction_line(cut_places, force, moment)
        block["line"] = {
            k: np.where(is_determinate[..., None] if v.ndim == 3 else is_determinate, v, np.nan)
            for k, v in line.items()
        }
    if cuts.s is None:
        for key in ({"point", "energy"} & block.keys()) | components.keys():
            block[key] = block[key][:, 0]
        for part in {"line", "stress"} & block.keys():
            block[part] = take_first_cut(block[part])
        return block
    return {"s": cuts.s, "side": [SIDE_WORDS[x] for x in cuts.side.tolist()]} | block


def take_first_cut(block: Block) -> Block:
    """Return the numbers of a single cut without the axis of cuts."""
    return {key: take_first_cut(value) if isinstance(value, dict) else value[:, 0] for key, value in block.items()}


def compute_stresses_of_cuts(cuts: Cuts, loads: Mapping[str, Array]) -> Block:
    """Return the stresses of all cuts, from the given properties or from those of the shapes."""
    assert cuts.properties is not None
    if cuts.properties.kind == "auto":
        from heuncli.loads.kinetostatics.auto_properties import make_stress_block

        return make_stress_block(cuts.auto_properties, cuts.points.shape[:-1], loads, cuts.strength)
    kind, values = cuts.properties
    if kind in FAMILIES:
        from heuncli.loads.kinetostatics.member_stress import compute_member_stresses, find_given_factors

        return compute_member_stresses(find_given_factors(kind, values), loads, cuts.strength)
    return compute_stresses(MODULI[kind](values), loads, cuts.strength)


def find_moment_arm(cuts: Cuts) -> float:
    """Return a length [m] that compares moments with forces: of the series of cuts; of a single one how far the mass
    beyond it reaches from the body's origin, or, without such mass, how far the body reaches.
    """
    points = cuts.points.reshape(-1, 3)
    length = float(np.abs(points - points.mean(axis=0)).max())
    mass = float(cuts.pieces[..., 3, 3].max())
    if length == 0.0 and mass > 0.0:
        length = float(np.sqrt(np.abs(cuts.pieces[..., :3, :3]).max() / mass))
    return length or cuts.plane_tolerance / tolerances.IN_PLANE


def find_reduction_line(cut_places: CutPlaces, force: Array, moment: Array) -> Block:
    """Find the points of the plane where force and moment in it are parallel: Q.p = -n.(Q x M_t)/N, direction n x Q.

    moment is about the cut's own point. point: the one nearest to that; pressure_centre: where the moment in the plane
    is zero. nan where N = 0 (no such points, or all) or Q = 0 (all points); `kind` says which: 0 a line, 1 none, 2 all.
    manual/theory.md, "Reduction line".
    """
    cuts, cut_points, to_world_axes = cut_places.cuts, cut_places.cut_points, cut_places.to_world_axes
    n = cuts.n[:, None, None]
    N, T = compute_axis_component(cuts.n, force), compute_axis_component(cuts.n, moment)
    Q, M_t = force - n * N, moment - n * T
    reach = find_moment_arm(cuts)
    size = np.sqrt(np.sum(force**2, axis=0)) + np.sqrt(np.sum(moment**2, axis=0)) / reach
    q = np.sqrt(np.sum(Q**2, axis=0))
    no_N, no_Q = np.abs(N) <= tolerances.NO_FORCE * size, q <= tolerances.NO_FORCE * size
    twist = compute_axis_component(cuts.n, cross_first_axis(Q, M_t))
    free_N = np.where(no_N, np.nan, N)
    free_Q = np.where(no_Q | no_N, np.nan, q)
    n = np.broadcast_to(n, Q.shape)
    point = cut_points - twist / (free_N * free_Q**2) * Q
    direction = cross_first_axis(n, Q) / free_Q
    pressure = cut_points + cross_first_axis(n, M_t) / free_N
    parallel = np.abs(twist) <= tolerances.NO_FORCE * size * size * reach
    kind = np.where(no_N, np.where(parallel, 2.0, 1.0), np.where(no_Q, 2.0, 0.0))
    return {
        "point": to_world_axes(point, is_position=True), "direction": to_world_axes(direction),
        "pressure_centre": to_world_axes(pressure, is_position=True), "kind": kind,
    }  # fmt: skip
