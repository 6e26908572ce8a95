"""The equations of motion linearised at a state: accelerations with their derivatives, exact to rounding.

    a(q, u),   da = A_q dq + A_u du         J dq = 0,  J du + R_q dq = 0: what closures and their rates admit
dq are small displacements of the undriven freedoms of the tree, du changes of their rates, each in the order of the
layout's answers: a ball's three turns (and its angular velocity) about the world's axes, one number of any other. The
kernel's own equations are run on dual numbers; closure rows are chosen at the state and then held.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.linearisation.dual_kernel import dual_module
from heuncli.linearisation.duals import Dual, gradient_of, value_of
from heuncli.records import record
from heuncli.response import numbers_of
from heuncli.results import Array
from heuncli.tree.layout import Layout, places_of_rates


@record
class Linearised:
    """The linear equations at a state, n undriven freedoms of the tree, f of them left free by the closures.

    The motion within the closures goes on with tangent x for displacements, tangent x' + drift x for rates.
    """

    state: Array  # settled on the closures
    accelerations: Array  # (n,) of the undriven freedoms: a ball's three about world axes, one each of the others
    by_place: Array  # (n, n) d accelerations / d small displacements, at fixed rates
    by_rate: Array  # (n, n) d accelerations / d rates
    tangent: Array  # (n, f) orthonormal, by the layout's weights: displacements that the closures admit
    drift: Array  # (n, f) change of rates that a displacement along the tangent needs: 0 where nothing moves
    twists: Array  # (n_b, 6, n) of each body, tree order: turn, and shift of its centre of mass; world axes
    attitudes: Array  # (n_b, 3, 3) body to world, tree order
    centres: Array  # (n_b, 3) of mass
    arms: Array  # (n_b,) how far they are from the bodies' joint points [m]
    omega: Array  # (n_b, 3)
    velocities: Array  # (n_b, 3) of the centres
    mass: Array  # (n, n) mass matrix of the tree, without what is lent


def linearised(layout: Layout, t: float, state: Array, holding: Array | None = None) -> Linearised:
    """Linearise at a state, which is brought onto the closures first.

    holding (contacts,): which contacts are closed; none if it is not given.
    """
    kernel = DualKernel(layout, t, state, holding)
    place = places_of_rates(layout)
    place = place[place >= 0]
    n = len(place)
    y = kernel.state
    moving: list[Any] = list(y)
    for k, at in enumerate(place.tolist()):
        moving[at] = Dual(y[at], unit(2 * n, n + k))
    displace(layout, moving, place.tolist())
    dy: list[Any] = [0.0] * layout.n_state
    kernel.evaluate(t, moving, dy)
    gradients = np.array([gradient_of(dy[at], 2 * n) for at in place]).reshape(n, 2 * n)
    tangent, drift = kernel.admitted(n, layout.weights[place])
    bodies = kernel.bodies(layout, n)
    return Linearised(
        state=np.array(y),
        accelerations=np.array([value_of(dy[at]) for at in place]),
        by_place=gradients[:, :n],
        by_rate=gradients[:, n:],
        tangent=tangent,
        drift=drift,
        **bodies,
    )


def unit(size: int, k: int) -> Array:
    """The k-th unit vector."""
    found = np.zeros(size)
    found[k] = 1.0
    return found


def displace(layout: Layout, y: list[Any], places: list[int]) -> None:
    """Let the coordinates of a state move by their own displacements: q of a ball by (0, turn) q / 2."""
    order = {at: k for k, at in enumerate(places)}
    size = 2 * len(places)
    for freedom in layout.tables["freedoms"]:
        if not freedom["driven"]:
            at = int(freedom["q_at"])
            y[at] = Dual(y[at], unit(size, order[int(freedom["u_at"])]))
    for body in layout.bodies:
        if body["ball"]:
            at, first = int(body["attitude_at"]), order[int(body["rate_at"])]
            w, x, y_, z = y[at : at + 4]
            by_turn = 0.5 * np.array([[-x, -y_, -z], [w, z, -y_], [-z, w, x], [y_, -x, w]])
            for i in range(4):
                gradient = np.zeros(size)
                gradient[first : first + 3] = by_turn[i]
                y[at + i] = Dual(y[at + i], gradient)


class DualKernel:
    """The plain kernel's workspace on dual numbers, its closure rows chosen at a state."""

    def __init__(self, layout: Layout, t: float, state: Array, holding: Array | None) -> None:
        pack = layout.pack
        programs = dual_module("expressions").Expressions(
            pack.code, pack.constants, len(pack.variables), pack.depth, pack.held
        )
        workspace = dual_module("workspace").Workspace(layout.tables, layout.indices, programs, numbers_of(layout))
        closed = np.zeros(len(layout.contacts)) if holding is None else np.asarray(holding, dtype=float)
        workspace.hold((closed > 0.0).astype(float).tolist())
        workspace.start(0.0, layout.y0.tolist())
        self.scene = workspace.scene
        self.response = dual_module("response")
        self.state: list[float] = np.asarray(state, dtype=float).tolist()
        if self.scene.closure_count:
            dual_module("chosen").choose_afresh(self.scene, t, self.state)
        self.response.settle(self.scene, t, self.state)

    def evaluate(self, t: float, y: list[Any], dy: list[Any]) -> None:
        """The time derivative dy of a state that moves."""
        self.response.evaluate(self.scene, t, y, dy)

    @property
    def rows(self) -> list[Any]:
        """The closure rows that carry the motion."""
        return [self.scene.closures[i] for i in self.scene.selected[: self.scene.selected_count]]

    def admitted(self, n: int, weights: Array) -> tuple[Array, Array]:
        """The displacements that the closures admit, orthonormal by weights (n, f), and the rates that these need."""
        rows = self.rows
        if not rows:
            return np.diag(1.0 / weights), np.zeros((n, n))
        J = np.array([gradient_of(row.gap, 2 * n)[:n] for row in rows])
        turned = np.array([gradient_of(row.rate, 2 * n)[:n] for row in rows])
        U, s, V = np.linalg.svd(J / weights, full_matrices=True)
        m = len(s)
        tangent = V[m:].T / weights[:, None]
        by_rows = U.T @ (turned @ tangent)
        return tangent, -(V[:m].T @ (by_rows / s[:, None])) / weights[:, None]

    def bodies(self, layout: Layout, n: int) -> dict[str, Array]:
        """Where the bodies are, how they turn and their centres shift with the freedoms; the mass matrix of that."""
        names = ("twists", "attitudes", "centres", "arms", "omega", "velocities")
        parts: dict[str, list[Any]] = {name: [] for name in names}
        mass = np.zeros((n, n))
        for k, hang in enumerate(layout.spanning.hangs):
            body, own = self.scene.bodies[k], layout.mechanism.bodies[hang.body]
            R = np.array([[value_of(getattr(body.R, i + j)) for j in "xyz"] for i in "xyz"])
            arm = R @ (own.center - layout.reference[k])
            turn, shift = (
                np.array([gradient_of(getattr(v, i), 2 * n)[n:] for i in "xyz"]) for v in (body.omega, body.v)
            )
            shift = shift + np.cross(turn, arm, axis=0)
            mass += own.mass * shift.T @ shift + turn.T @ (R @ own.inertia @ R.T) @ turn
            parts["twists"].append(np.concatenate([turn, shift]))
            parts["attitudes"].append(R)
            parts["centres"].append(np.array([value_of(getattr(body.r, i)) for i in "xyz"]) + arm)
            parts["arms"].append(np.sqrt(arm @ arm))
            omega, v = (np.array([value_of(getattr(u, i)) for i in "xyz"]) for u in (body.omega, body.v))
            parts["omega"].append(omega)
            parts["velocities"].append(v + np.cross(omega, arm))
        return {name: np.array(values) for name, values in parts.items()} | {"mass": mass}
