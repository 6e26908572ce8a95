"""Load cases of one body: the actions on it at an instant and its inertia loads, which balance.
    F_i                          forces ON the body at its points x_i, M_i moments there
    a(x) = a + u x x + w x (w x x) - g    x from the body's origin: the acceleration that its mass resists
    sum F_i - m a(x_s) = 0,   sum (x_i x F_i + M_i) - sum m x x a(x) = 0                       d'Alembert
All in the body's axes, moments of sums about the body's origin. a: acceleration of the origin, g: gravity, w and u:
angular velocity and acceleration. For an impulse, impulses replace the forces, and jumps of velocity the accelerations.

Their units of force, length, mass and time must be consistent, because FE solvers know no units. A force of 1 must give
a mass of 1 an acceleration of 1: N, mm, t, s do, N, mm, kg, s do not, and the resulting stresses would silently be
wrong by a factor of a thousand.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from heuncli.base import units
from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.sections import compute_acceleration_matrix
from heuncli.results.results import Array
from heuncli.scene.shapes.inertia import pseudo_inertia
from heuncli.scene.shapes.rotations import cross_vectors

ORIGIN = np.zeros(3)
IN_PLANE, ACROSS = np.array([1.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])


@record
class PointAction:
    """A force and a moment ON the body at one of its points, body axes, (3,) each.

    kind: joint, drive, stop, or the type of the load in the spec
    name: the joint or load; source: who exerts it, a body, the ground or outside
    point: name of the point, if it has one; at: its position
    per_length: of a distributed load its density there, while the force is that of the adjacent pieces of its line;
    None for others
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


POUND_FORCE = units.UNITS["lbf"][0]
# Masses that specs do not know, for there `t` is the time: what a force of 1 gives an acceleration of 1.
MASSES = {"t": 1e3, "slinch": POUND_FORCE / 0.0254, "slug": POUND_FORCE / 0.3048, "Gg": 1e6}
UNITS_HINT = "for example --units N,mm,t or N,m,kg or lbf,in,slinch; a fourth unit sets the time, s or ms"
CONSISTENCY_TOLERANCE = 1e-9  # relative: definitions agree to the last digit, inconsistent units differ by a factor


class UnitSystem(NamedTuple):
    """Consistent units: their names, and the size of each in SI."""

    names: tuple[str, str, str, str]
    force: float = 1.0
    length: float = 1.0
    mass: float = 1.0
    time: float = 1.0

    @property
    def acceleration(self) -> float:
        """The unit of acceleration [m/s2]."""
        return self.length / self.time**2


SI = UnitSystem(("N", "m", "kg", "s"))
KINDS = (units.FORCE, units.LENGTH, units.MASS, units.TIME)


def parse_units(text: str) -> UnitSystem:
    """Return the units that `--units N,mm,t` requests, in any order. Raises Finding [bad-option]."""
    units_by_kind: dict[units.Dimension, tuple[str, float]] = {}
    for word in (part.strip() for part in text.split(",")):
        size, kind = (MASSES[word], units.MASS) if word in MASSES else units.parse_unit(word)
        if kind not in KINDS:
            raise Finding("bad-option", f"{word} is {units.describe(kind)}, which follows from the others", UNITS_HINT)
        if kind in units_by_kind:
            raise Finding("bad-option", f"{units_by_kind[kind][0]} and {word} are of the same kind", UNITS_HINT)
        units_by_kind[kind] = word, size
    units_by_kind.setdefault(units.TIME, ("s", 1.0))
    missing = [kind for kind in KINDS if kind not in units_by_kind]
    if missing:
        raise Finding(
            "bad-option",
            f"no unit for {' and '.join(units.describe(kind) for kind in missing)}",
            _suggest_units(units_by_kind),
        )
    force, length, mass, time = (units_by_kind[kind] for kind in KINDS)
    system = UnitSystem((force[0], length[0], mass[0], time[0]), force[1], length[1], mass[1], time[1])
    unit_force = system.mass * system.acceleration / system.force
    if abs(unit_force - 1.0) > CONSISTENCY_TOLERANCE:
        message = (
            f"1 {mass[0]} at 1 {length[0]}/{time[0]}² takes {unit_force:.6g} {force[0]}, not 1: units not consistent"
        )
        raise Finding("bad-option", message, _suggest_units(units_by_kind))
    return system


def _suggest_units(units_by_kind: dict[units.Dimension, tuple[str, float]]) -> str:
    """Suggest the mass unit that is consistent with a force and a length, if it has a name."""
    if units.FORCE not in units_by_kind or units.LENGTH not in units_by_kind:
        return UNITS_HINT
    (force, F), (length, l), (time, t) = (units_by_kind[kind] for kind in (units.FORCE, units.LENGTH, units.TIME))
    masses = MASSES | {name: size for name, (size, kind) in units.UNITS.items() if kind == units.MASS}
    matching = [name for name, size in masses.items() if abs(size * l / (t * t * F) - 1.0) <= CONSISTENCY_TOLERANCE]
    if not matching:
        return UNITS_HINT
    return f"--units {force},{length},{matching[0]}" + (f",{time}" if time != "s" else "")


def convert_load_cases(cases: LoadCases, system: UnitSystem) -> LoadCases:
    """Convert load cases from SI to other units."""
    if system.names == SI.names:
        return cases
    body = cases.body
    inertia = system.mass * system.length**2
    body_in_units = LoadedBody(body.name, body.mass / system.mass, body.center / system.length, body.inertia / inertia,
                     body.planar)  # fmt: skip
    return replace(
        cases, body=body_in_units, cases=tuple(_convert_case(case, system) for case in cases.cases), units=system.names
    )


def _convert_case(case: LoadCase, system: UnitSystem) -> LoadCase:
    """Convert a load case from SI to a unit system."""
    # impulses have one more factor of time
    impulse_time = system.time if case.is_impulse else 1.0
    force, acceleration = system.force * impulse_time, system.acceleration * impulse_time
    rate, turn = 1.0 / system.time, impulse_time / system.time**2
    f = case.field
    field = AccelerationField(
        f.origin / acceleration, f.gravity / acceleration, f.angular_velocity / rate, f.angular_acceleration / turn
    )
    actions = tuple(_convert_action(action, force, system) for action in case.actions)
    return replace(case, actions=actions, field=field)


def _convert_action(action: PointAction, force: float, system: UnitSystem) -> PointAction:
    """Convert an action from SI; force: the unit of its force or impulse."""

    def divide(vector: Array | None, size: float) -> Array | None:
        """Divide a vector by a unit; None stays None."""
        return None if vector is None else np.asarray(vector / size)

    return replace(
        action,
        at=action.at / system.length,
        force=action.force / force,
        moment=action.moment / (force * system.length),
        per_length=divide(action.per_length, force / system.length),
    )
