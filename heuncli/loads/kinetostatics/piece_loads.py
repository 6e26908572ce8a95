"""The loads that the piece of a body beyond a cut exerts on the remainder.

    s' = sum' k - sum' m x..             force of the piece on the remainder [N]
    M'(P) = sum' (x - P) x k + couples - sum' (x - P) x m x..     about P [N m]

sum' runs over the piece, n points into it; k is its weight, the loads and the joints on it. sigma is here the angular
velocity (in stress.py it is a stress). With the acceleration matrix Acc = [hat(sigma.) + hat(sigma)^2, x_o.. - g]
sum' m (x.. - g) of a piece of pseudo-inertia P is the last column of Acc P, its moment about the body's origin the skew
part of the rest. Heun (1901), (57)-(61), corrected.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base.records import record
from heuncli.loads.kinetostatics.actions import Action
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.cuts import Cuts
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_first_axis, cross_rows

# doubles from which NumPy asks for huge pages: first touch of fresh pages costs more than the products
HUGE_PAGE_DOUBLES = 1 << 19


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
