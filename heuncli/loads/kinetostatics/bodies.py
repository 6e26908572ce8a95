"""Positions, velocities and accelerations of all bodies at the requested instants, from the kernel's results.

Rigid-body kinematics: v_P = v + σ × (P − O), a_P = a + σ̇ × (P − O) + σ × (σ × (P − O)); here σ is omega, σ̇ alpha.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from types import MappingProxyType

import numpy as np

from heuncli.base.records import record
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Joint
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import (
    bodies_contiguous,
    cross_components,
    cross_rows,
    instants_first,
    instants_last,
    rotate_components,
)

NO_SPINS: Mapping[int, Array] = MappingProxyType({})


@record
class BodyStates:
    """States of all bodies in world axes, in the order of the spec, SI.

    R (n_t, n, 3, 3): attitudes, body to world; all other fields of bodies are (n_t, n, 3)
    x, v, a: of the origin
    omega, alpha: angular velocity and acceleration
    centre, v_centre, a_centre: of the centre of mass
    path_directions (n_t, n_w, 3): derivative r' of each joint's path by its coordinate, at the joint's point; stored
    because the pose alone does not say which branch of a path that crosses itself it is on
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
    path_directions: Array

    def component_rows(self, name: str) -> Array:
        """Return a field by component, (n, 3, n_t); R (n, 3, 3, n_t)."""
        if name not in self._rows:
            self._rows[name] = self._compute_rows(name)
        return self._rows[name]

    @cached_property
    def _rows(self) -> dict[str, Array]:
        """The fields by component that were already computed."""
        return {}

    def _compute_rows(self, name: str) -> Array:
        """Compute a field by component."""
        return instants_last(getattr(self, name))

    @cached_property
    def turning(self) -> tuple[Array, Array]:
        """omega and alpha in the bodies' own axes, by component, (n, 3, n_t)."""
        w, u = (
            rotate_components(self.component_rows("R"), self.component_rows(name), back=True)
            for name in ("omega", "alpha")
        )
        return w, u

    def point_position(self, body: int, point: Array) -> Array:
        """Return the world position of a point in body axes, (n_t, 3); a ground point stays as it is."""
        if body == GROUND:
            return repeat_vector(point, self.x)
        return self.x[:, body] + self.R[:, body] @ point

    def point_positions(self, bodies: Sequence[int], points: Sequence[Array]) -> list[Array]:
        """Return the world positions of one point of each body, as `point_position` does."""
        if len(bodies) == 1:
            return [self.point_position(bodies[0], points[0])]
        moving_indices = [i for i, body in enumerate(bodies) if body != GROUND]
        body_numbers, q = (
            [bodies[i] for i in moving_indices],
            np.array([points[i] for i in moving_indices]).reshape(-1, 3, 1),
        )
        moving = self.x[:, body_numbers].swapaxes(0, 1) + (self.R[:, body_numbers].swapaxes(0, 1) @ q[:, None])[..., 0]
        positions = dict(zip(moving_indices, moving, strict=True))
        return [
            positions[i] if i in positions else self.point_position(GROUND, point) for i, point in enumerate(points)
        ]

    def point_velocity(self, body: int, position: Array) -> Array:
        """Return the velocity of the body's point at a world position, (n_t, 3)."""
        if body == GROUND:
            return np.zeros_like(position)
        return self.v[:, body] + cross_rows(self.omega[:, body], position - self.x[:, body])

    def point_acceleration(self, body: int, position: Array) -> Array:
        """Return the acceleration of the body's point at a world position, (n_t, 3)."""
        if body == GROUND:
            return np.zeros_like(position)
        arm = position - self.x[:, body]
        w = self.omega[:, body]
        return self.a[:, body] + cross_rows(self.alpha[:, body], arm) + cross_rows(w, cross_rows(w, arm))

    def world_direction(self, body: int, vector: Array) -> Array:
        """Return the world components of a direction fixed in a body, (n_t, 3)."""
        if body == GROUND:
            return repeat_vector(vector, self.R)
        return self.R[:, body] @ vector


class KernelBodyStates(BodyStates):
    """Body states from the kernel's values at the joint points; each quantity is computed when it is first read.

    Few runs need all of it: joint loads need only the kernel's results, the balance of a body its centre.
    """

    _table: Table
    _order: list[int] | None
    _gravity: Array
    _offsets: Mapping[str, Array]

    def __init__(
        self, table: Table, order: list[int], gravity: Array, offsets: Mapping[str, Array], path_directions: Array
    ) -> None:
        """table: the kernel's, tree order (accelerations minus g)
        order: each body's index in it
        offsets: from the joint points to the origins and the centres, body axes, (n, 3) each
        path_directions (n_t, n_w, 3): in the axes of the bodies in which the paths are fixed
        """
        reordering = None if order == [*range(table.shape[1])] else order
        self.__dict__.update(
            _table=table, _order=reordering, _gravity=gravity, _offsets=offsets, path_directions=path_directions
        )

    def select(self, instants: slice) -> KernelBodyStates:
        """Select some of the instants; what was computed by component is kept."""
        selection, present = object.__new__(KernelBodyStates), self.__dict__
        selection.__dict__.update(
            _table=self._table[instants], _order=self._order, _gravity=self._gravity, _offsets=self._offsets,
            path_directions=self.path_directions[instants],
            _rows={name: np.ascontiguousarray(found[..., instants]) for name, found in self._rows.items()},
        )  # fmt: skip
        if "turning" in present:
            w, u = self.turning
            selection.__dict__["turning"] = (
                np.ascontiguousarray(w[..., instants]),
                np.ascontiguousarray(u[..., instants]),
            )
        return selection

    def __getattr__(self, name: str) -> Array:
        """Compute a quantity that was not read before."""
        if name in DERIVED_FIELDS:
            # memory order in which sums over all bodies and instants read them
            arrange = bodies_contiguous if DERIVED_FIELDS[name][1] == "r" else instants_first
            values = arrange(self.component_rows(name))
        elif name in KERNEL_FIELDS:
            order = self._order
            values = self._table[name][:, [*range(self._table.shape[1])] if order is None else order]
        else:
            raise AttributeError(name)
        self.__dict__[name] = values
        return values

    def _compute_rows(self, name: str) -> Array:
        """Compute a field by component: from the kernel's value at the joint point, and the arm from there."""
        if name in self.__dict__:
            return super()._compute_rows(name)
        if name in KERNEL_FIELDS:
            return self._joint_point_rows(name)
        point, quantity = DERIVED_FIELDS[name]
        arm = rotate_components(self.component_rows("R"), self._offsets[point][:, :, None])
        if quantity == "r":
            return self._joint_point_rows("r") + arm
        turn = cross_components(self.component_rows("omega"), arm)
        if quantity == "v":
            return self._joint_point_rows("v") + turn
        a = self._joint_point_rows("a") + self._gravity[:, None]
        return (
            a
            + cross_components(self.component_rows("alpha"), arm)
            + cross_components(self.component_rows("omega"), turn)
        )

    def _joint_point_rows(self, name: str) -> Array:
        """Return one of the kernel's values by component."""
        values = self._table[name]
        return instants_last(values if self._order is None else values[:, self._order])


KERNEL_FIELDS = frozenset({"R", "omega", "alpha"})
# For each field of the body states: its point, and the quantity there.
DERIVED_FIELDS = {
    "x": ("origin", "r"), "v": ("origin", "v"), "a": ("origin", "a"),
    "centre": ("centre", "r"), "v_centre": ("centre", "v"), "a_centre": ("centre", "a"),
}  # fmt: skip


def repeat_vector(vector: Array, reference: Array) -> Array:
    """Repeat a vector (3,) for each instant of a reference array, (n_t, 3)."""
    repeated = np.empty((len(reference), 3))
    repeated[:] = vector
    return repeated


def make_body_states(
    layout: Layout, evaluation: Evaluation, steady: Mapping[int, Array] = NO_SPINS
) -> KernelBodyStates:
    """Make the body states at origins and centres of mass from the kernel's values at the joint points (accelerations
    minus g).

    steady: axes (body axes) about which the spins of bodies do not change: d/dt (omega . a) = alpha . a = 0. The
    kernel's value there is rounding of a moment over the inertia about the axis, which for a wire is nearly zero.
    """
    path_directions = np.zeros(
        (len(evaluation.bodies), sum(joint.path is not None for joint in layout.mechanism.joints), 3)
    )
    states = KernelBodyStates(
        evaluation.bodies, layout.order, layout.mechanism.gravity, layout.body_offsets, path_directions
    )
    if path_directions.shape[1]:
        set_path_directions(layout, evaluation, states)
    for i, axis in steady.items():
        n = states.R[:, i] @ axis
        states.alpha[:, i] -= np.sum(states.alpha[:, i] * n, axis=1, keepdims=True) * n
    return states


def set_path_directions(layout: Layout, evaluation: Evaluation, states: KernelBodyStates) -> None:
    """Set the directions of the paths at the joints along them."""
    for freedom, q in zip(layout.freedoms, evaluation.freedoms["q"].T, strict=True):
        joint = layout.mechanism.joints[freedom.joint] if freedom.joint >= 0 else None
        if joint is not None and joint.path is not None and freedom.quantity == "travel":
            slope = joint.path.evaluate(q)[1]
            set_path_direction(states, joint, slope)
    for k in layout.counters:
        joint = layout.mechanism.joints[k]
        if joint.path is not None:
            set_path_direction(states, joint, joint.path.evaluate(find_path_place(layout, evaluation, states, k)[0])[1])


def set_path_direction(states: BodyStates, joint: Joint, slope: Array) -> None:
    """Set the direction of a path, (n_t, 3), which is given in the axes of its body."""
    states.path_directions[:, joint.path_index] = (
        slope if joint.a == GROUND else (states.R[:, joint.a] @ slope[..., None])[..., 0]
    )


def find_path_place(layout: Layout, evaluation: Evaluation, states: BodyStates, k: int) -> tuple[Array, Array, Array]:
    """Return the path parameter s of a cut joint along a path, s' and s'', (n_t,) each.

    It is that of the path's nearest point, on the branch where the state counts it: (D - r) . r' = 0. The derivatives
    of this follow from D, v and a of the point relative to the path's body; the point may also lie off its path.
    """
    joint = layout.mechanism.joints[k]
    assert joint.path is not None
    Q = states.point_position(joint.b, joint.q)
    D = Q - states.point_position(joint.a, joint.p)
    v = states.point_velocity(joint.b, Q) - states.point_velocity(joint.a, Q)
    a = states.point_acceleration(joint.b, Q) - states.point_acceleration(joint.a, Q)
    if joint.a != GROUND:
        back = np.swapaxes(states.R[:, joint.a], 1, 2)
        a = a - 2.0 * cross_rows(states.omega[:, joint.a], v)
        D, v, a = ((back @ x[..., None])[..., 0] for x in (D, v, a))
    s = joint.path.track_parameters(D, evaluation.states[:, layout.counters[k]])
    r, slope, bend, twist = joint.path.evaluate_with_third(s)
    square = np.sum(slope * slope - bend * (D - r), axis=1)
    u = np.sum(slope * v, axis=1) / square
    rate_change = np.sum(twist * (D - r) - 3.0 * slope * bend, axis=1)
    return s, u, (np.sum(slope * a + 2.0 * u[:, None] * bend * v, axis=1) + u * u * rate_change) / square
