"""How the bodies move with each freedom of the tree, driven or not, and what follows: mass matrix and closure rows.

    (omega, v)_b = sum_k B_bk u_k          turn of body b and velocity of its centre of mass for the rate u_k
    M = sum_b m v' v + omega' I omega      B in the place of omega and v
    J_k = f . (v_b - v_a) + m . (omega_b - omega_a)      of a closure row with the unit load f, m at its point Q
The order is that of the layout's answers: three turns of a body on a ball about the world's axes, which are its own
angular velocity whatever it hangs on, one number of any other freedom.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.records import record
from heuncli.kernel.choose import scene as kernel
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.mechanism.model import GROUND
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import vectors
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_rows


@record
class Twists:
    """Of all bodies in tree order: turn, shift of the centre of mass (n_t, n_b, n, 3) by freedoms; where they are."""

    layout: Layout
    turn: Array
    shift: Array
    centre: Array  # (n_t, n_b, 3)
    R: Array  # (n_t, n_b, 3, 3)

    def of_point(self, body: int, place: Array) -> tuple[Array, Array]:
        """Turn of a body and shift of its point at a place of the world (n_t, 3), for each freedom (n_t, n, 3)."""
        if body == GROUND:
            nothing = np.zeros((len(place), self.turn.shape[2], 3))
            return nothing, nothing
        k = self.layout.place[body]
        turn = self.turn[:, k]
        arm = np.broadcast_to((place - self.centre[:, k])[:, None], turn.shape)
        return turn, self.shift[:, k] + cross_rows(turn, arm)

    def point(self, body: int, point: Array) -> Array:
        """Place of a body's point in the world, (n_t, 3)."""
        if body == GROUND:
            return np.broadcast_to(point, (len(self.turn), 3))
        k, own = self.layout.place[body], self.layout.mechanism.bodies[body]
        return np.asarray(self.centre[:, k] + self.R[:, k] @ (point - own.center))

    def direction(self, body: int, axis: Array) -> Array:
        """A direction fixed in a body, in the world, (n_t, 3)."""
        if body == GROUND:
            return np.broadcast_to(axis, (len(self.turn), 3))
        return np.asarray(self.R[:, self.layout.place[body]] @ axis)


def twists(layout: Layout, at: Recovered) -> Twists:
    """The twists at recovered instants."""
    R, r = at.bodies["R"], at.bodies["r"]
    n_t, n_b = R.shape[:2]
    turn, shift = np.zeros((2, n_t, n_b, layout.answer_count, 3))  # shift: of the joint point, at first
    table, directions = layout.tables["freedoms"], vectors(layout.tables["freedoms"]["direction"])
    for k, body in enumerate(layout.bodies):
        parent = int(body["parent"])
        if parent >= 0:
            arm = np.broadcast_to((r[:, k] - r[:, parent])[:, None], turn[:, parent].shape)
            shift[:, k] = shift[:, parent] + cross_rows(turn[:, parent], arm)
            turn[:, k] = 0.0 if body["ball"] else turn[:, parent]
        if body["ball"]:
            first = int(body["answer_at"])
            turn[:, k, first : first + 3] = np.eye(3)
        for j in range(int(body["first_freedom"]), int(body["end_freedom"])):
            kind, own = table["kind"][j], int(table["answer_at"][j])
            on = k if kind == kernel.TURN_IN_BODY else parent
            path = layout.mechanism.joints[joint].path if (joint := layout.freedoms[j].joint) >= 0 else None
            fixed = directions[j] if path is None or kind != kernel.SHIFT else path.at(at.freedoms["q"][:, j])[1]
            along = fixed if on < 0 else (R[:, on] @ fixed[..., None])[..., 0]
            (shift if kind == kernel.SHIFT else turn)[:, k, own] += along
    order = [hang.body for hang in layout.spanning.hangs]
    bodies = [layout.mechanism.bodies[i] for i in order]
    arms = np.array([b.center for b in bodies]).reshape(-1, 3) - layout.reference
    arms = np.einsum("tkij,kj->tki", R, arms)
    shift += cross_rows(turn, np.broadcast_to(arms[:, :, None], turn.shape))
    return Twists(layout, turn, shift, r + arms, R)


def mass_matrix(found: Twists) -> Array:
    """M of all freedoms of the tree, (n_t, n, n)."""
    bodies = [found.layout.mechanism.bodies[hang.body] for hang in found.layout.spanning.hangs]
    mass, inertia = np.array([b.mass for b in bodies]), np.array([b.inertia for b in bodies]).reshape(-1, 3, 3)
    own = np.einsum("tbki,tbij->tbkj", found.turn, found.R)
    M = of_all_bodies(mass[:, None, None] * found.shift) @ of_all_bodies(found.shift).transpose(0, 2, 1)
    return np.asarray(M + of_all_bodies(own @ inertia) @ of_all_bodies(own).transpose(0, 2, 1))


def of_all_bodies(rates: Array) -> Array:
    """Vectors by body and freedom, (n_t, n_b, n, 3), with those of all bodies side by side, (n_t, n, 3 n_b)."""
    n_t, n_b, n, _ = rates.shape
    return rates.transpose(0, 2, 1, 3).reshape(n_t, n, 3 * n_b)


def closure_rows(found: Twists, at: Recovered) -> Array:
    """J of all closure rows on all freedoms of the tree, driven ones among them, (n_t, rows, n)."""
    layout = found.layout
    closures = layout.tables["closures"]
    J = np.zeros((len(found.turn), len(closures), layout.answer_count))
    order = [hang.body for hang in layout.spanning.hangs]
    for i, row in enumerate(closures):
        a, b = (order[k] if k >= 0 else GROUND for k in (int(row["a"]), int(row["b"])))
        q = np.array(row["q"].tolist())
        Q = found.point(b, q + layout.reference[layout.place[b]]) if b != GROUND else np.broadcast_to(q, (len(J), 3))
        (turn_a, shift_a), (turn_b, shift_b) = found.of_point(a, Q), found.of_point(b, Q)
        J[:, i] = np.einsum("tni,ti->tn", shift_b - shift_a, at.rows["f"][:, i])
        J[:, i] += np.einsum("tni,ti->tn", turn_b - turn_a, at.rows["m"][:, i])
    return J
