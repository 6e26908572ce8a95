"""Load cases of one body: what acts on it at an instant, with its own inertia, so that all of it balances.

    F_i                          forces ON the body at its points x_i, M_i moments there
    a(x) = a + u x x + w x (w x x) - g    x from the body's origin: the acceleration that its mass resists
    sum F_i - m a(x_s) = 0,   sum (x_i x F_i + M_i) - sum m x x a(x) = 0                       d'Alembert
All in the body's axes, moments of sums about the body's origin. a: of the origin, g: of gravity, w and u: angular
velocity and acceleration. Of a blow the impulses stand for the forces, and the jumps of velocity for accelerations.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.sections import accelerations_as_matrix
from heuncli.results.results import Array
from heuncli.scene.shapes.inertia import pseudo_inertia
from heuncli.scene.shapes.rotations import cross

ORIGIN = np.zeros(3)
IN_PLANE, ACROSS = np.array([1.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])


@record
class PointAction:
    """A force and a moment ON the body at one of its points, body axes, (3,) each.

    kind: joint, drive, stop, or the type of the load in the spec; name: there; by: who exerts it, a body, the ground or
    outside; point: the name of the point, as far as it has one. per_length: of a distributed load what it is there,
    where the force is that of the pieces of its line beside the point; None of any other.
    """

    kind: str
    name: str
    by: str
    point: str
    at: Array
    force: Array
    moment: Array
    per_length: Array | None = None


@record
class AccelerationField:
    """a(x) of the body's points as its mass resists it: see above; (3,) each, body axes.

    origin: a, the acceleration of the body's origin; gravity: g.
    """

    origin: Array
    gravity: Array
    angular_velocity: Array
    angular_acceleration: Array

    @property
    def linear(self) -> Array:
        """a - g: what stands still at the origin of the body feels so much."""
        return self.origin - self.gravity

    def at(self, x: Array) -> Array:
        """a(x), (3,)."""
        w, u = self.angular_velocity, self.angular_acceleration
        return np.asarray(self.linear + cross(u, x) + cross(w, cross(w, x)))

    def inertia_loads(self, P: Array) -> tuple[Array, Array]:
        """Force and moment about the origin of all d'Alembert's loads and the weight; P: the pseudo-inertia (4, 4)."""
        w, u = self.angular_velocity[None], self.angular_acceleration[None]
        Q = accelerations_as_matrix(w, u, self.linear[None])[:, 0] @ P
        return -Q[:, 3], -np.array([Q[2, 1] - Q[1, 2], Q[0, 2] - Q[2, 0], Q[1, 0] - Q[0, 1]])

    def largest(self, P: Array) -> tuple[float, float]:
        """The largest force [N] and moment about the origin [N m] that its parts make of pieces of the body.

        A rotor that spins about its centre of mass has no resultant, but loads of its pieces. r^2 = sum m x^2 / m.
        """
        mass, r = float(P[3, 3]), float(np.sqrt(np.trace(P[:3, :3]) / P[3, 3]))
        a, g, w, u = (float(np.sqrt(v @ v)) for v in
                      (self.origin, self.gravity, self.angular_velocity, self.angular_acceleration))  # fmt: skip
        most = mass * max(a, g, r * u, r * w * w)
        return most, r * most


@record
class Sums:
    """What is left of the forces (3,) and of the moments about the origin (3,), and the largest terms of each."""

    force: Array
    moment: Array
    largest_force: float
    largest_moment: float

    @property
    def relative(self) -> float:
        """The larger of the two sums, of its largest term."""
        parts = ((self.force, self.largest_force), (self.moment, self.largest_moment))
        return max(float(np.abs(left).max()) / largest if largest > 0.0 else 0.0 for left, largest in parts)

    @property
    def in_plane(self) -> Sums:
        """What of them a scene has that moves in the plane: forces in x, y, the moment about z."""
        return replace(self, force=self.force * IN_PLANE, moment=self.moment * ACROSS)


@record
class LoadCase:
    """One load case: what asked for it, and when it is [s]; struck: a blow, in N s; over: taken as so long [s]."""

    name: str
    time: float
    actions: tuple[PointAction, ...]
    field: AccelerationField
    struck: bool = False
    over: float | None = None


@record
class LoadedBody:
    """A body: mass [kg], centre of mass (3,), inertia about it (3, 3), body axes; planar: in its xy plane alone."""

    name: str
    mass: float
    center: Array
    inertia: Array
    planar: bool

    @cached_property
    def pseudo_inertia(self) -> Array:
        """P about the origin, (4, 4)."""
        return pseudo_inertia(self.mass, self.center, self.inertia)

    def balance(self, case: LoadCase) -> Sums:
        """The sums that the scene tells: of one that moves in the plane those in it."""
        return self.sums(case).in_plane if self.planar else self.sums(case)

    def sums(self, case: LoadCase) -> Sums:
        """What the loads of a case and the body's inertia leave, and their largest terms."""
        inertia = case.field.inertia_loads(self.pseudo_inertia)
        forces = np.array([action.force for action in case.actions] + [inertia[0]])
        levers = np.array([cross(action.at, action.force) for action in case.actions] + [ORIGIN])
        moments = np.array([action.moment for action in case.actions] + [inertia[1]])
        force, moment = case.field.largest(self.pseudo_inertia)
        force = max(force, float(np.abs(forces).max()))
        moment = max(moment, float(np.abs(levers).max()), float(np.abs(moments).max()))
        return Sums(forces.sum(axis=0), (levers + moments).sum(axis=0), force, moment)


@record
class LoadCases:
    """The cases of a body, all of one run, in the units that are called so; what is to be told beside them.

    title, spec, digest, version: of the scene and of heun; estimate: of the run's error of reactions, of the largest;
    split: how open reactions were split, a sentence, or empty; units: the words of force, length, mass and time.
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

    def taken_over(self, duration: float) -> LoadCases:
        """The same with blows as the mean loads of so long a time [s]."""
        return replace(self, cases=tuple(_mean(case, duration) if case.struck else case for case in self.cases))


def _mean(case: LoadCase, duration: float) -> LoadCase:
    """A blow as forces and accelerations that make it in a time."""
    actions = tuple(replace(one, force=one.force / duration, moment=one.moment / duration) for one in case.actions)
    f = case.field
    field = replace(f, origin=f.origin / duration, angular_acceleration=f.angular_acceleration / duration)
    return replace(case, actions=actions, field=field, struck=False, over=duration)
