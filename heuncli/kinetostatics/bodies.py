"""Positions, velocities and accelerations of all bodies at the asked instants, from the kernel's answers.

Rigid-body kinematics: v_P = v + σ × (P − O), a_P = a + σ̇ × (P − O) + σ × (σ × (P − O)); here σ is omega, σ̇ alpha.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from types import MappingProxyType

import numpy as np

from heuncli.integration.evaluator import Recovered
from heuncli.mechanism.model import GROUND
from heuncli.records import record
from heuncli.results import Array
from heuncli.shapes.rotations import cross_rows
from heuncli.tree.layout import Layout

NONE: Mapping[int, Array] = MappingProxyType({})


@record
class BodyStates:
    """World axes; bodies in the order of the spec. x, v, a: of the origin; centre: of the centre of mass.

    R (n_t, n, 3, 3); all others (n_t, n, 3), SI.
    """

    R: Array
    x: Array
    v: Array
    a: Array
    omega: Array
    alpha: Array
    centre: Array
    v_centre: Array
    a_centre: Array

    @cached_property
    def turning(self) -> tuple[Array, Array]:
        """omega and alpha in the bodies' own axes, (n_t, n, 3)."""
        w, u = (np.einsum("tnji,tnj->tni", self.R, x) for x in (self.omega, self.alpha))
        return w, u

    def point_position(self, body: int, point: Array) -> Array:
        """World position of a point given in body axes, (n_t, 3); a ground point as it is."""
        if body == GROUND:
            return np.broadcast_to(point, (len(self.x), 3))
        return self.x[:, body] + self.R[:, body] @ point

    def point_positions(self, bodies: Sequence[int], points: Sequence[Array]) -> list[Array]:
        """World positions of a point each of bodies, as of `point_position`."""
        own = [i for i, body in enumerate(bodies) if body != GROUND]
        of, q = [bodies[i] for i in own], np.array([points[i] for i in own]).reshape(-1, 3, 1)
        moving = self.x[:, of].swapaxes(0, 1) + (self.R[:, of].swapaxes(0, 1) @ q[:, None])[..., 0]
        found = dict(zip(own, moving, strict=True))
        return [found[i] if i in found else self.point_position(GROUND, point) for i, point in enumerate(points)]

    def velocity(self, body: int, position: Array) -> Array:
        """Velocity of the body's point that is at a world position, (n_t, 3)."""
        if body == GROUND:
            return np.zeros_like(position)
        return self.v[:, body] + cross_rows(self.omega[:, body], position - self.x[:, body])

    def acceleration(self, body: int, position: Array) -> Array:
        """Acceleration of the body's point that is at a world position, (n_t, 3)."""
        if body == GROUND:
            return np.zeros_like(position)
        arm = position - self.x[:, body]
        w = self.omega[:, body]
        return self.a[:, body] + cross_rows(self.alpha[:, body], arm) + cross_rows(w, cross_rows(w, arm))

    def direction(self, body: int, vector: Array) -> Array:
        """World components of a direction fixed in a body, (n_t, 3)."""
        if body == GROUND:
            return np.broadcast_to(vector, (len(self.x), 3))
        return self.R[:, body] @ vector


def body_states(layout: Layout, recovered: Recovered, steady: Mapping[int, Array] = NONE) -> BodyStates:
    """From the kernel's values at the joint points (accelerations less g) to those of origins and centres of mass.

    steady: axes (body axes) about which the spins of bodies do not change: d/dt (omega . a) = alpha . a = 0. What of it
    the kernel finds is rounding of a moment over the inertia about the axis, of a wire next to none.
    """
    bodies = layout.mechanism.bodies
    order = [layout.place[i] for i in range(len(bodies))]
    rows = recovered.bodies[:, order]
    R, r, w, v, alpha = (rows[name] for name in ("R", "r", "omega", "v", "alpha"))
    a = rows["a"] + layout.mechanism.gravity
    for i, axis in steady.items():
        n = R[:, i] @ axis
        alpha[:, i] -= np.sum(alpha[:, i] * n, axis=1, keepdims=True) * n

    def of(points: Array) -> tuple[Array, Array, Array]:
        arm = np.einsum("tnij,nj->tni", R, points)
        turn = cross_rows(w, arm)
        return r + arm, v + turn, a + cross_rows(alpha, arm) + cross_rows(w, turn)

    x0, v0, a0 = of(-layout.reference[order])
    xc, vc, ac = of(np.array([b.center for b in bodies]) - layout.reference[order])
    return BodyStates(R, x0, v0, a0, w, alpha, xc, vc, ac)
