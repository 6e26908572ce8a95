"""How velocities change with a displacement at fixed rates of the chosen coordinates: (dv/dq) q' of a state space.

    v = row(q) q',   dv = row dq' + (d row/dq q') dq
The kernel differentiates angular velocities and velocities of all bodies along displacements of the tree, at fixed
rates of the tree. What closed chains ask of these rates for the displacement comes on top (drift).
"""

from __future__ import annotations

import numpy as np

from heuncli.base.records import record
from heuncli.motion.linearisation.linearise import Linearised, motion_slopes
from heuncli.multibody.mechanism.model import GROUND, Joint
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array


@record
class RateSlopes:
    """Changes along f displacements at fixed rates of the chosen coordinates; n_b bodies in tree order, world axes.

    turns, shifts (n_b, 3, f): of attitudes, as small turns, and of centres of mass
    spins, speeds (n_b, 3, f): of angular velocities, and of the velocities of the centres
    """

    layout: Layout
    found: Linearised
    turns: Array
    shifts: Array
    spins: Array
    speeds: Array

    def of_point(self, body: int, place: Array, shift: Array | None = None) -> Array:
        """The change (3, f) of the velocity with which a body carries a world place.

        shift (3, f): how the place moves; by default with the body.
        """
        f = self.turns.shape[2]
        if body == GROUND:
            return np.zeros((3, f))
        k = self.layout.place[body]
        arm = (place - self.found.centres[k])[:, None]
        turned = np.cross(self.turns[k], arm, axis=0) if shift is None else shift - self.shifts[k]
        spin = self.found.omega[k][:, None]
        return np.asarray(self.speeds[k] + np.cross(self.spins[k], arm, axis=0) + np.cross(spin, turned, axis=0))

    def of_joint(self, joint: Joint, quantity: str) -> Array:
        """The change (f,) of the rate of an angle, or of the speed of a travel."""
        turn_a, spin_a, omega_a, attitude = self._carrier(joint.a)
        _, spin_b, omega_b, _ = self._carrier(joint.b)
        n = attitude @ joint.axis
        if quantity == "angle":
            return np.asarray(np.cross(turn_a, n[:, None], axis=0).T @ (omega_b - omega_a) + n @ (spin_b - spin_a))
        place = self._place(joint.b, joint.q)
        shift = self._carried(joint.b, place)
        change = self.of_point(joint.b, place) - self.of_point(joint.a, place, shift)
        speed = self._velocity(joint.b, place) - self._velocity(joint.a, place)
        seen = change - np.cross(turn_a, speed[:, None], axis=0)  # by what turns with the carrier
        if joint.path is None:
            return np.asarray(n @ seen)
        return self._along_path(joint, attitude, speed, seen, shift - self._carried(joint.a, place))

    def _along_path(self, joint: Joint, attitude: Array, speed: Array, seen: Array, shift: Array) -> Array:
        """Of the parameter s of a path r(s), v = r' s': r' . dv / r'^2 - s' (r' . r'') ds / r'^2; shift: past `from`.

        Zero where s is a freedom of the tree.
        """
        k = next(i for i, own in enumerate(self.layout.mechanism.joints) if own.name == joint.name)
        if k not in self.layout.counters:
            return np.zeros(seen.shape[1])
        assert joint.path is not None
        s = float(self.found.state[self.layout.counters[k]])
        _, slope, curving = (attitude @ part for part in joint.path.at(s)[:3])
        square = slope @ slope
        return np.asarray(
            (slope @ seen - (slope @ speed) / square * (slope @ curving) * (slope @ shift) / square) / square
        )

    def _carrier(self, body: int) -> tuple[Array, Array, Array, Array]:
        """Turns, changes of the angular velocity, the angular velocity and the attitude of a body or of the ground."""
        if body == GROUND:
            still = np.zeros(self.turns.shape[1:])
            return still, still, np.zeros(3), np.eye(3)
        k = self.layout.place[body]
        return self.turns[k], self.spins[k], self.found.omega[k], self.found.attitudes[k]

    def _place(self, body: int, point: Array) -> Array:
        if body == GROUND:
            return point
        k, own = self.layout.place[body], self.layout.mechanism.bodies[body]
        return np.asarray(self.found.centres[k] + self.found.attitudes[k] @ (point - own.center))

    def _velocity(self, body: int, place: Array) -> Array:
        if body == GROUND:
            return np.zeros(3)
        k = self.layout.place[body]
        return np.asarray(self.found.velocities[k] + np.cross(self.found.omega[k], place - self.found.centres[k]))

    def _carried(self, body: int, place: Array) -> Array:
        """How a body carries a world place, (3, f)."""
        if body == GROUND:
            return np.zeros(self.turns.shape[1:])
        k = self.layout.place[body]
        return np.asarray(self.shifts[k] + np.cross(self.turns[k], (place - self.found.centres[k])[:, None], axis=0))


def rate_slopes(
    layout: Layout, t: float, holding: Array, found: Linearised, partials: Array, drift: Array
) -> RateSlopes:
    """Slopes along displacements of the tree (n, f); drift (n, f): the rates of the tree that these need."""
    spins, speeds = motion_slopes(layout, t, found, holding)
    twists, needed = found.twists @ partials, found.twists @ drift
    return RateSlopes(
        layout, found, twists[:, :3], twists[:, 3:], spins @ partials + needed[:, :3], speeds @ partials + needed[:, 3:]
    )
