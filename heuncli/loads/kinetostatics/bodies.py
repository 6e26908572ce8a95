"""Positions, velocities and accelerations of all bodies at the asked instants, from the kernel's answers.

Rigid-body kinematics: v_P = v + σ × (P − O), a_P = a + σ̇ × (P − O) + σ × (σ × (P − O)); here σ is omega, σ̇ alpha.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from types import MappingProxyType

import numpy as np

from heuncli.base.records import record
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.mechanism.model import GROUND, Joint
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array
from heuncli.scene.shapes.by_component import body_by_body, cross, instants_first, rows, turned, turned_back
from heuncli.scene.shapes.rotations import cross_rows

NONE: Mapping[int, Array] = MappingProxyType({})


@record
class BodyStates:
    """World axes; bodies in the order of the spec. x, v, a: of the origin; centre: of the centre of mass.

    R (n_t, n, 3, 3); all others (n_t, n, 3), SI. ways (n_t, n_w, 3): r' of the paths, where the points of their joints
    are: of where a path crosses itself the pose alone does not tell which branch it is.
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
    ways: Array

    def rows_of(self, name: str) -> Array:
        """A field by component, (n, 3, n_t); R (n, 3, 3, n_t)."""
        if name not in self._rows:
            self._rows[name] = self._found(name)
        return self._rows[name]

    @cached_property
    def _rows(self) -> dict[str, Array]:
        return {}

    def _found(self, name: str) -> Array:
        return rows(getattr(self, name))

    @cached_property
    def turning(self) -> tuple[Array, Array]:
        """omega and alpha in the bodies' own axes, by component, (n, 3, n_t)."""
        w, u = (turned_back(self.rows_of("R"), self.rows_of(name)) for name in ("omega", "alpha"))
        return w, u

    def point_position(self, body: int, point: Array) -> Array:
        """World position of a point given in body axes, (n_t, 3); a ground point as it is."""
        if body == GROUND:
            return at_each(point, self.x)
        return self.x[:, body] + self.R[:, body] @ point

    def point_positions(self, bodies: Sequence[int], points: Sequence[Array]) -> list[Array]:
        """World positions of a point each of bodies, as of `point_position`."""
        if len(bodies) == 1:
            return [self.point_position(bodies[0], points[0])]
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
            return at_each(vector, self.R)
        return self.R[:, body] @ vector


class CarriedStates(BodyStates):
    """Bodies by the kernel's values at their joint points; what is asked for is found when it is first asked for.

    Few runs need all of it: to load a joint the kernel's answers suffice, to balance a body its centre.
    """

    _table: Table
    _order: list[int] | None
    _gravity: Array
    _beside: Mapping[str, Array]

    def __init__(
        self, table: Table, order: list[int], gravity: Array, beside: Mapping[str, Array], ways: Array
    ) -> None:
        """table: the kernel's, tree order (accelerations less g); order: each body's place in it.

        beside: from the joint points to the origins and the centres, body axes, (n, 3) each. ways (n_t, n_w, 3): in the
        axes of the bodies in which the paths are fixed.
        """
        own = None if order == [*range(table.shape[1])] else order
        self.__dict__.update(_table=table, _order=own, _gravity=gravity, _beside=beside, ways=ways)

    def at(self, which: slice) -> CarriedStates:
        """At some of the instants; what was found by component is not found again."""
        made, own = object.__new__(CarriedStates), self.__dict__
        made.__dict__.update(
            _table=self._table[which], _order=self._order, _gravity=self._gravity, _beside=self._beside,
            ways=self.ways[which],
            _rows={name: np.ascontiguousarray(found[..., which]) for name, found in self._rows.items()},
        )  # fmt: skip
        if "turning" in own:
            w, u = self.turning
            made.__dict__["turning"] = np.ascontiguousarray(w[..., which]), np.ascontiguousarray(u[..., which])
        return made

    def __getattr__(self, name: str) -> Array:
        """What was not asked for before."""
        if name in CARRIED:
            # in this order sums over all bodies and instants add them up
            laid = body_by_body if CARRIED[name][1] == "r" else instants_first
            found = laid(self.rows_of(name))
        elif name in KNOWN:
            order = self._order
            found = self._table[name][:, [*range(self._table.shape[1])] if order is None else order]
        else:
            raise AttributeError(name)
        self.__dict__[name] = found
        return found

    def _found(self, name: str) -> Array:
        if name in self.__dict__:
            return super()._found(name)
        if name in KNOWN:
            return self._at_joint(name)
        point, quantity = CARRIED[name]
        arm = turned(self.rows_of("R"), self._beside[point][:, :, None])
        if quantity == "r":
            return self._at_joint("r") + arm
        turn = cross(self.rows_of("omega"), arm)
        if quantity == "v":
            return self._at_joint("v") + turn
        a = self._at_joint("a") + self._gravity[:, None]
        return a + cross(self.rows_of("alpha"), arm) + cross(self.rows_of("omega"), turn)

    def _at_joint(self, name: str) -> Array:
        """One of the kernel's values by component."""
        of_all = self._table[name]
        return rows(of_all if self._order is None else of_all[:, self._order])


KNOWN = frozenset({"R", "omega", "alpha"})
# Fields of bodies: of which point they are, and what of it.
CARRIED = {
    "x": ("origin", "r"), "v": ("origin", "v"), "a": ("origin", "a"),
    "centre": ("centre", "r"), "v_centre": ("centre", "v"), "a_centre": ("centre", "a"),
}  # fmt: skip


def at_each(vector: Array, like: Array) -> Array:
    """A vector (3,) at as many instants as there are of something else, (n_t, 3)."""
    found = np.empty((len(like), 3))
    found[:] = vector
    return found


def body_states(layout: Layout, recovered: Recovered, steady: Mapping[int, Array] = NONE) -> CarriedStates:
    """From the kernel's values at the joint points (accelerations less g) to those of origins and centres of mass.

    steady: axes (body axes) about which the spins of bodies do not change: d/dt (omega . a) = alpha . a = 0. What of it
    the kernel finds is rounding of a moment over the inertia about the axis, of a wire next to none.
    """
    ways = np.zeros((len(recovered.bodies), sum(joint.path is not None for joint in layout.mechanism.joints), 3))
    states = CarriedStates(recovered.bodies, layout.order, layout.mechanism.gravity, layout.beside, ways)
    if ways.shape[1]:
        put_ways(layout, recovered, states)
    for i, axis in steady.items():
        n = states.R[:, i] @ axis
        states.alpha[:, i] -= np.sum(states.alpha[:, i] * n, axis=1, keepdims=True) * n
    return states


def put_ways(layout: Layout, recovered: Recovered, states: CarriedStates) -> None:
    """The directions of the paths where their joints stand along them."""
    for freedom, q in zip(layout.freedoms, recovered.freedoms["q"].T, strict=True):
        joint = layout.mechanism.joints[freedom.joint] if freedom.joint >= 0 else None
        if joint is not None and joint.path is not None and freedom.quantity == "travel":
            slope = joint.path.at(q)[1]
            put_way(states, joint, slope)
    for k in layout.counters:
        joint = layout.mechanism.joints[k]
        if joint.path is not None:
            put_way(states, joint, joint.path.at(place_beside(layout, recovered, states, k)[0])[1])


def put_way(states: BodyStates, joint: Joint, slope: Array) -> None:
    """The direction of a path, (n_t, 3), which is given in the axes of its body."""
    states.ways[:, joint.way] = slope if joint.a == GROUND else (states.R[:, joint.a] @ slope[..., None])[..., 0]


def place_beside(layout: Layout, recovered: Recovered, states: BodyStates, k: int) -> tuple[Array, Array, Array]:
    """Of a joint along a path that was cut: its place s there, s' and s'', (n_t,) each.

    The place is that beside the point, on the branch of the path where the state counts it: (D - r) . r' = 0. Of that
    the derivatives, by D, v and a of the point as the path's body sees them; it may lie beside its path, too.
    """
    joint = layout.mechanism.joints[k]
    assert joint.path is not None
    Q = states.point_position(joint.b, joint.q)
    D = Q - states.point_position(joint.a, joint.p)
    v = states.velocity(joint.b, Q) - states.velocity(joint.a, Q)
    a = states.acceleration(joint.b, Q) - states.acceleration(joint.a, Q)
    if joint.a != GROUND:
        back = np.swapaxes(states.R[:, joint.a], 1, 2)
        a = a - 2.0 * cross_rows(states.omega[:, joint.a], v)
        D, v, a = ((back @ x[..., None])[..., 0] for x in (D, v, a))
    s = joint.path.along(D, recovered.states[:, layout.counters[k]])
    r, slope, bend, twist = joint.path.course(s)
    square = np.sum(slope * slope - bend * (D - r), axis=1)
    u = np.sum(slope * v, axis=1) / square
    again = np.sum(twist * (D - r) - 3.0 * slope * bend, axis=1)
    return s, u, (np.sum(slope * a + 2.0 * u[:, None] * bend * v, axis=1) + u * u * again) / square
