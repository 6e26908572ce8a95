"""Twists of the bodies per freedom of the tree, and the conditions of the mass matrix and of the closures from them."""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.kernel.choose import scene as kernel
from heuncli.loads.equilibrium.coordinates import Coordinates
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import vector_array
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_rows


@record
class Twists:
    """Twists and poses of all bodies, in tree order, at n_t instants.

    turn, shift (n_t, n_b, n, 3): rotation, and displacement of the centre of mass, per freedom of the tree
    centre (n_t, n_b, 3), R (n_t, n_b, 3, 3): centres of mass and attitudes
    """

    layout: Layout
    turn: Array
    shift: Array
    centre: Array
    R: Array

    def point_twist(self, body: int, position: Array) -> tuple[Array, Array]:
        """Return a body's rotation and the displacement of its point at a world position (n_t, 3), per freedom (n_t, n,
        3).
        """
        if body == GROUND:
            zero = np.zeros((len(position), self.turn.shape[2], 3))
            return zero, zero
        k = self.layout.place[body]
        turn = self.turn[:, k]
        arm = np.broadcast_to((position - self.centre[:, k])[:, None], turn.shape)
        return turn, self.shift[:, k] + cross_rows(turn, arm)

    def locate_point(self, body: int, point: Array) -> Array:
        """Return the world position of a body's point, (n_t, 3)."""
        if body == GROUND:
            return np.broadcast_to(point, (len(self.turn), 3))
        k, center = self.layout.place[body], self.layout.mechanism.bodies[body].center
        return np.asarray(self.centre[:, k] + self.R[:, k] @ (point - center))

    def to_world(self, body: int, axis: Array) -> Array:
        """Return a direction fixed in a body, in world axes, (n_t, 3)."""
        if body == GROUND:
            return np.broadcast_to(axis, (len(self.turn), 3))
        return np.asarray(self.R[:, self.layout.place[body]] @ axis)


def compute_twists(layout: Layout, recovered: Evaluation) -> Twists:
    """Return the twists at recovered instants."""
    R, r = recovered.bodies["R"], recovered.bodies["r"]
    n_t, n_b = R.shape[:2]
    turn, shift = np.zeros((2, n_t, n_b, layout.velocity_count, 3))  # shift: of the joint point, at first
    table, directions = layout.tables["freedoms"], vector_array(layout.tables["freedoms"]["direction"])
    for k, body in enumerate(layout.bodies):
        parent = int(body["parent"])
        if parent >= 0:
            arm = np.broadcast_to((r[:, k] - r[:, parent])[:, None], turn[:, parent].shape)
            shift[:, k] = shift[:, parent] + cross_rows(turn[:, parent], arm)
            turn[:, k] = 0.0 if body["ball"] else turn[:, parent]
        if body["ball"]:
            first = int(body["velocity_at"])
            turn[:, k, first : first + 3] = np.eye(3)
        for j in range(int(body["first_freedom"]), int(body["end_freedom"])):
            kind, column = table["kind"][j], int(table["velocity_at"][j])
            axis_body = k if kind == kernel.TURN_IN_BODY else parent
            path = layout.mechanism.joints[joint].path if (joint := layout.freedoms[j].joint) >= 0 else None
            local_direction = (
                directions[j]
                if path is None or kind != kernel.SHIFT
                else path.evaluate(recovered.freedoms["q"][:, j])[1]
            )
            along = local_direction if axis_body < 0 else (R[:, axis_body] @ local_direction[..., None])[..., 0]
            (shift if kind == kernel.SHIFT else turn)[:, k, column] += along
    order = [link.body for link in layout.spanning.links]
    bodies = [layout.mechanism.bodies[i] for i in order]
    arms = np.array([b.center for b in bodies]).reshape(-1, 3) - layout.reference
    arms = np.einsum("tkij,kj->tki", R, arms)
    shift += cross_rows(turn, np.broadcast_to(arms[:, :, None], turn.shape))
    return Twists(layout, turn, shift, r + arms, R)


def mass_matrix(body_twists: Twists) -> Array:
    """Return M of all freedoms of the tree, (n_t, n, n)."""
    bodies = [body_twists.layout.mechanism.bodies[link.body] for link in body_twists.layout.spanning.links]
    mass, inertia = np.array([b.mass for b in bodies]), np.array([b.inertia for b in bodies]).reshape(-1, 3, 3)
    local_turns = np.einsum("tbki,tbij->tbkj", body_twists.turn, body_twists.R)
    M = flatten_bodies(mass[:, None, None] * body_twists.shift) @ flatten_bodies(body_twists.shift).transpose(0, 2, 1)
    return np.asarray(M + flatten_bodies(local_turns @ inertia) @ flatten_bodies(local_turns).transpose(0, 2, 1))


def flatten_bodies(rates: Array) -> Array:
    """Reshape vectors by body and freedom (n_t, n_b, n, 3) to (n_t, n, 3 n_b)."""
    n_t, n_b, n, _ = rates.shape
    return rates.transpose(0, 2, 1, 3).reshape(n_t, n, 3 * n_b)


def closure_rows(body_twists: Twists, recovered: Evaluation) -> Array:
    """Return J of all closure rows on all freedoms of the tree, including driven ones, (n_t, rows, n)."""
    layout = body_twists.layout
    closures = layout.tables["closures"]
    J = np.zeros((len(body_twists.turn), len(closures), layout.velocity_count))
    for i, row in enumerate(closures):
        if row["part_count"]:
            for k in range(int(row["part"]), int(row["part"] + row["part_count"])):
                J[:, i] += compute_part_row(body_twists, recovered, k)
            continue
        a, b = find_bodies(layout, row)
        q = np.array(row["q"].tolist())
        Q = (
            body_twists.locate_point(b, q + layout.reference[layout.place[b]])
            if b != GROUND
            else np.broadcast_to(q, (len(J), 3))
        )
        J[:, i] = compute_power(body_twists, (a, b), Q, recovered.rows["f"][:, i], recovered.rows["m"][:, i])
    return J


def compute_part_row(body_twists: Twists, recovered: Evaluation, k: int) -> Array:
    """Return what part k of a coupling's row adds to it, (n_t, n): gear meshes, strands of ropes, cam contacts."""
    layout, parts = body_twists.layout, recovered.parts
    ends = find_bodies(layout, layout.tables["parts"][k])
    return compute_power(body_twists, ends, parts["Q"][:, k], parts["f"][:, k], parts["m"][:, k])


def compute_power(body_twists: Twists, ends: tuple[int, int], Q: Array, f: Array, m: Array) -> Array:
    """Return the power of a unit load f, m at Q on the second body, opposite on the first, per freedom (n_t, n)."""
    (turn_a, shift_a), (turn_b, shift_b) = (body_twists.point_twist(body, Q) for body in ends)
    return np.asarray(np.einsum("tni,ti->tn", shift_b - shift_a, f) + np.einsum("tni,ti->tn", turn_b - turn_a, m))


def find_bodies(layout: Layout, row: np.void) -> tuple[int, int]:
    """Return the two bodies of a closure row or a part, GROUND for the ground."""
    order = [link.body for link in layout.spanning.links]
    a, b = (order[k] if k >= 0 else GROUND for k in (int(row["a"]), int(row["b"])))
    return a, b


def find_free_motions(J: Array, weights: Array) -> tuple[list[Array], Array]:
    """Return for each instant a scaled orthonormal basis of the motions that closure rows (n_t, rows, n) admit, and the
    condition of the rows.

    Rows are scaled to the order of 1, as where their rank is decided.
    """
    J = J / weights
    size = np.sqrt(np.sum(J * J, axis=2, keepdims=True))
    _, s, V = np.linalg.svd(J / np.maximum(size, 1.0), full_matrices=True)
    rank = (s > tolerances.RANK * s.max(axis=1, initial=0.0)[:, None]).sum(axis=1)
    smallest = np.take_along_axis(s, np.maximum(rank - 1, 0)[:, None], axis=1)[:, 0]
    conditions = np.where(rank > 0, s.max(axis=1, initial=1.0) / np.where(rank > 0, smallest, 1.0), 1.0)
    return [v[r:].T for v, r in zip(V, rank.tolist(), strict=True)], conditions


class ConditionNumbers(NamedTuple):
    """Conditions of the mass matrix and of the closures (n_t,), and the motion with the least inertia (n_t, n)."""

    mass: Array
    closure: Array
    lightest_motion: Array


def compute_conditions(layout: Layout, layout_coordinates: Coordinates, recovered: Evaluation) -> ConditionNumbers:
    """Return the conditions at recovered instants; infinite if a motion moves no mass."""
    body_twists = compute_twists(layout, recovered)
    weights, freedoms = layout_coordinates.weights, layout_coordinates.result_indices
    M = mass_matrix(body_twists)[:, freedoms][:, :, freedoms] / np.outer(weights, weights)
    bases, closure = [np.eye(layout_coordinates.count)] * len(M), np.ones(len(M))
    if layout.rows:
        is_closed = recovered.rows["closed"] > 0.0
        J = closure_rows(body_twists, recovered)[:, :, freedoms] * is_closed[:, :, None]
        bases, closure = find_free_motions(J, weights)
    mass, lightest_motion = np.ones(len(M)), np.zeros((len(M), layout_coordinates.count))
    for t, (m, T) in enumerate(zip(M, bases, strict=True)):
        if T.shape[1]:
            w, v = np.linalg.eigh(T.T @ m @ T)
            mass[t] = np.inf if w[0] <= tolerances.NO_INERTIA * w[-1] else w[-1] / w[0]
            lightest_motion[t] = T @ v[:, 0]
    return ConditionNumbers(mass, closure, lightest_motion)
