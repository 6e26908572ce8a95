"""Load cases of one body: the actions on it at an instant and its inertia loads, which balance.
    F_i                          forces ON the body at its points x_i, M_i moments there
    a(x) = a + u x x + w x (w x x) - g    x from the body's origin: the acceleration that its mass resists
    sum F_i - m a(x_s) = 0,   sum (x_i x F_i + M_i) - sum m x x a(x) = 0                       d'Alembert
All in the body's axes, moments of sums about the body's origin. a: acceleration of the origin, g: gravity, w and u:
angular velocity and acceleration. For an impulse, impulses replace the forces, and jumps of velocity the accelerations.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.piece_loads import compute_acceleration_matrix
from heuncli.results.results import Array
from heuncli.scene.shapes.inertia import pseudo_inertia
from heuncli.scene.shapes.rotations import cross_vectors

ORIGIN = np.zeros(3)
IN_PLANE, ACROSS = np.array([1.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])


@record
class PointAction:
    """A force and a moment ON the body at one of its points, body axes, (3,) each.

    kind: joint, drive, stop, or the type of the load in the spec
    name: the joint or load
    source: who exerts it: a body, the ground, or `outside`
    point: name of the point, empty if it has none
    at: position of the point
    per_length: density of a distributed load there; its `force` is that of the adjacent pieces of its line. None for
    other loads
    """

    kind: str
    name: str
    source: str
    point: str
    at: Array
    force: Array
    moment: Array
    per_length: Array | None = None


@record
class AccelerationField:
    """a(x) of the body's points as its mass resists it (see above); (3,) each, body axes.

    origin: a, the acceleration of the body's origin
    gravity: g
    """

    origin: Array
    gravity: Array
    angular_velocity: Array
    angular_acceleration: Array

    @property
    def linear(self) -> Array:
        """a - g: the apparent acceleration at the body's origin."""
        return self.origin - self.gravity

    def acceleration_at(self, x: Array) -> Array:
        """Return a(x), (3,)."""
        w, u = self.angular_velocity, self.angular_acceleration
        return np.asarray(self.linear + cross_vectors(u, x) + cross_vectors(w, cross_vectors(w, x)))

    def inertia_loads(self, P: Array) -> tuple[Array, Array]:
        """Return force and moment about the origin of d'Alembert's loads and the weight; P: the pseudo-inertia (4,
        4).
        """
        w, u = self.angular_velocity[None], self.angular_acceleration[None]
        Q = compute_acceleration_matrix(w, u, self.linear[None])[:, 0] @ P
        return -Q[:, 3], -np.array([Q[2, 1] - Q[1, 2], Q[0, 2] - Q[2, 0], Q[1, 0] - Q[0, 1]])

    def estimate_largest_loads(self, P: Array) -> tuple[float, float]:
        """Return the largest force [N] and moment about the origin [N m] on parts of the body.

        A rotor that spins about its centre of mass has no resultant, but its parts have loads. r^2 = sum m x^2 / m.
        """
        mass, r = float(P[3, 3]), float(np.sqrt(np.trace(P[:3, :3]) / P[3, 3]))
        a, g, w, u = (float(np.sqrt(v @ v)) for v in
                      (self.origin, self.gravity, self.angular_velocity, self.angular_acceleration))  # fmt: skip
        force = mass * max(a, g, r * u, r * w * w)
        return force, r * force


@record
class LoadBalance:
    """The sums of all forces (3,) and of all moments about the origin (3,), which should vanish, and their largest
    terms.
    """

    force: Array
    moment: Array
    largest_force: float
    largest_moment: float

    @property
    def relative(self) -> float:
        """The larger of the two sums, relative to its largest term."""
        parts = ((self.force, self.largest_force), (self.moment, self.largest_moment))
        return max(float(np.abs(remainder).max()) / largest if largest > 0.0 else 0.0 for remainder, largest in parts)

    @property
    def in_plane(self) -> LoadBalance:
        """The in-plane components: forces in x and y, the moment about z."""
        return replace(self, force=self.force * IN_PLANE, moment=self.moment * ACROSS)


@record
class LoadCase:
    """One load case: the request that named it, and its time [s].

    is_impulse: whether it is an impulse, in N s
    averaging_time [s]: duration over which an impulse was averaged, None otherwise
    """

    name: str
    time: float
    actions: tuple[PointAction, ...]
    field: AccelerationField
    is_impulse: bool = False
    averaging_time: float | None = None


@record
class LoadedBody:
    """A body: mass [kg], centre of mass (3,), inertia about it (3, 3), body axes.

    planar: whether it moves in its xy plane only
    """

    name: str
    mass: float
    center: Array
    inertia: Array
    planar: bool

    @cached_property
    def pseudo_inertia(self) -> Array:
        """P about the origin, (4, 4)."""
        return pseudo_inertia(self.mass, self.center, self.inertia)

    def balance(self, case: LoadCase) -> LoadBalance:
        """Return the sums of a case; for planar motion the in-plane ones."""
        return self.compute_sums(case).in_plane if self.planar else self.compute_sums(case)

    def compute_sums(self, case: LoadCase) -> LoadBalance:
        """Return the sums of a case's loads and the body's inertia loads, and their largest terms."""
        inertia = case.field.inertia_loads(self.pseudo_inertia)
        forces = np.array([action.force for action in case.actions] + [inertia[0]])
        levers = np.array([cross_vectors(action.at, action.force) for action in case.actions] + [ORIGIN])
        moments = np.array([action.moment for action in case.actions] + [inertia[1]])
        force, moment = case.field.estimate_largest_loads(self.pseudo_inertia)
        force = max(force, float(np.abs(forces).max()))
        moment = max(moment, float(np.abs(levers).max()), float(np.abs(moments).max()))
        return LoadBalance(forces.sum(axis=0), (levers + moments).sum(axis=0), force, moment)


@record
class LoadCases:
    """The load cases of a body, all from one run, in the given units.

    title, spec, digest, version: of the scene and of heun
    estimate: relative error of the run's reactions
    split: sentence on how indeterminate reactions were split, or empty
    units: names of the units of force, length, mass and time
    """

    body: LoadedBody
    cases: tuple[LoadCase, ...]
    title: str
    spec: str
    digest: str
    version: str
    estimate: float
    split: str
    units: tuple[str, str, str, str] = ("N", "m", "kg", "s")

    def average_impulses(self, duration: float) -> LoadCases:
        """Replace impulses by their mean loads over a duration [s]."""
        return replace(
            self, cases=tuple(_average_impulse(case, duration) if case.is_impulse else case for case in self.cases)
        )


def _average_impulse(case: LoadCase, duration: float) -> LoadCase:
    """Return an impulse as mean forces and accelerations over a duration."""
    actions = tuple(replace(one, force=one.force / duration, moment=one.moment / duration) for one in case.actions)
    f = case.field
    field = replace(f, origin=f.origin / duration, angular_acceleration=f.angular_acceleration / duration)
    return replace(case, actions=actions, field=field, is_impulse=False, averaging_time=duration)
