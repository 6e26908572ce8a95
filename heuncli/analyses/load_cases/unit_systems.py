"""Consistent units of load cases: read them from an option, and convert load cases from SI.

FE solvers know no units, so those of force, length, mass and time must be consistent: a force of 1 must give a mass of
1 an acceleration of 1. N, mm, t, s do; N, mm, kg, s do not, and the stresses would silently be wrong by a factor of a
thousand.
"""

from __future__ import annotations

import numpy as np

from heuncli.analyses.load_cases.model import AccelerationField, LoadCase, LoadCases, LoadedBody, PointAction
from heuncli.base import units
from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace

POUND_FORCE = units.UNITS["lbf"][0]
# masses that specs do not know, in kg: there `t` is the time
MASSES = {"t": 1e3, "slinch": POUND_FORCE / 0.0254, "slug": POUND_FORCE / 0.3048, "Gg": 1e6}
UNITS_HINT = "for example --units N,mm,t or N,m,kg or lbf,in,slinch; a fourth unit sets the time, s or ms"
CONSISTENCY_TOLERANCE = 1e-9  # relative: definitions agree to the last digit, inconsistent units differ by a factor


class UnitSystem(NamedTuple):
    """Consistent units: their names, and the size of each in SI.

    names: of the units of force, length, mass and time
    """

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
    body_in_units = LoadedBody(
        name=body.name,
        mass=body.mass / system.mass,
        center=body.center / system.length,
        inertia=body.inertia / inertia,
        planar=body.planar,
    )
    return replace(
        cases, body=body_in_units, cases=tuple(_convert_case(case, system) for case in cases.cases), units=system.names
    )


def _convert_case(case: LoadCase, system: UnitSystem) -> LoadCase:
    """Convert a load case from SI to a unit system."""
    # impulses have one more factor of time
    impulse_time = system.time if case.is_impulse else 1.0
    force, acceleration = system.force * impulse_time, system.acceleration * impulse_time
    rate, angular_acceleration = 1.0 / system.time, impulse_time / system.time**2
    field = AccelerationField(
        origin=case.field.origin / acceleration,
        gravity=case.field.gravity / acceleration,
        angular_velocity=case.field.angular_velocity / rate,
        angular_acceleration=case.field.angular_acceleration / angular_acceleration,
    )
    actions = tuple(_convert_action(action, force, system) for action in case.actions)
    return replace(case, actions=actions, field=field)


def _convert_action(action: PointAction, force: float, system: UnitSystem) -> PointAction:
    """Convert an action from SI; force: the unit of its force or impulse."""
    per_length = None if action.per_length is None else np.asarray(action.per_length / (force / system.length))
    return replace(
        action,
        at=action.at / system.length,
        force=action.force / force,
        moment=action.moment / (force * system.length),
        per_length=per_length,
    )
