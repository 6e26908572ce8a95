"""Units of load cases: those of force, length, mass and time go together, for a solver knows none.

A force of 1 has to give a mass of 1 an acceleration of 1: N, mm, t, s do, N, mm, kg, s do not, and the stresses that
follow would be wrong by a thousand without a word.
"""

from __future__ import annotations

import numpy as np

from heuncli.analyses.load_cases.model import AccelerationField, LoadCase, LoadCases, LoadedBody, PointAction
from heuncli.base import units
from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.results.results import Array

POUND_FORCE = units.UNITS["lbf"][0]
# Masses that specs do not know, for there `t` is the time: what a force of 1 gives an acceleration of 1.
MASSES = {"t": 1e3, "slinch": POUND_FORCE / 0.0254, "slug": POUND_FORCE / 0.3048, "Gg": 1e6}
SUCH = "such as --units N,mm,t or N,m,kg or lbf,in,slinch; a fourth is the time, s or ms"
SAME = 1e-9  # of a unit: definitions agree to the last digit, what is no system is off by a factor


class UnitSystem(NamedTuple):
    """Units that go together: their words, and how much of SI each is."""

    words: tuple[str, str, str, str]
    force: float = 1.0
    length: float = 1.0
    mass: float = 1.0
    time: float = 1.0

    @property
    def acceleration(self) -> float:
        """One unit of it [m/s2]."""
        return self.length / self.time**2


SI = UnitSystem(("N", "m", "kg", "s"))
KINDS = (units.FORCE, units.LENGTH, units.MASS, units.TIME)


def asked(words: str) -> UnitSystem:
    """The units that `--units N,mm,t` asks for, in any order. Raises Finding."""
    own: dict[units.Dimension, tuple[str, float]] = {}
    for word in (part.strip() for part in words.split(",")):
        size, kind = (MASSES[word], units.MASS) if word in MASSES else units.parse_unit(word)
        if kind not in KINDS:
            raise Finding("bad-option", f"{word} is {units.describe(kind)}: what follows from the others", SUCH)
        if kind in own:
            raise Finding("bad-option", f"{own[kind][0]} and {word} are of the same kind", SUCH)
        own[kind] = word, size
    own.setdefault(units.TIME, ("s", 1.0))
    missing = [kind for kind in KINDS if kind not in own]
    if missing:
        raise Finding("bad-option", f"without {' and '.join(units.describe(kind) for kind in missing)}", _hint(own))
    force, length, mass, time = (own[kind] for kind in KINDS)
    found = UnitSystem((force[0], length[0], mass[0], time[0]), force[1], length[1], mass[1], time[1])
    made = found.mass * found.acceleration / found.force
    if abs(made - 1.0) > SAME:
        message = f"1 {mass[0]} at 1 {length[0]}/{time[0]}² takes {made:.6g} {force[0]}, not 1: no system of units"
        raise Finding("bad-option", message, _hint(own))
    return found


def _hint(own: dict[units.Dimension, tuple[str, float]]) -> str:
    """The mass that goes with a force and a length, where it has a name."""
    if units.FORCE not in own or units.LENGTH not in own:
        return SUCH
    (force, F), (length, l), (time, t) = (own[kind] for kind in (units.FORCE, units.LENGTH, units.TIME))
    masses = MASSES | {name: size for name, (size, kind) in units.UNITS.items() if kind == units.MASS}
    named = [name for name, size in masses.items() if abs(size * l / (t * t * F) - 1.0) <= SAME]
    if not named:
        return SUCH
    return f"--units {force},{length},{named[0]}" + (f",{time}" if time != "s" else "")


def in_units(cases: LoadCases, system: UnitSystem) -> LoadCases:
    """The same numbers in other units than SI."""
    if system.words == SI.words:
        return cases
    body = cases.body
    inertia = system.mass * system.length**2
    own = LoadedBody(body.name, body.mass / system.mass, body.center / system.length, body.inertia / inertia,
                     body.planar)  # fmt: skip
    return replace(cases, body=own, cases=tuple(_case(case, system) for case in cases.cases), units=system.words)


def _case(case: LoadCase, system: UnitSystem) -> LoadCase:
    # of a blow there is a time more in all of them
    pulse = system.time if case.struck else 1.0
    force, acceleration = system.force * pulse, system.acceleration * pulse
    rate, turn = 1.0 / system.time, pulse / system.time**2
    f = case.field
    field = AccelerationField(
        f.origin / acceleration, f.gravity / acceleration, f.angular_velocity / rate, f.angular_acceleration / turn
    )
    actions = tuple(_action(action, force, system) for action in case.actions)
    return replace(case, actions=actions, field=field)


def _action(action: PointAction, force: float, system: UnitSystem) -> PointAction:
    def over(vector: Array | None, size: float) -> Array | None:
        return None if vector is None else np.asarray(vector / size)

    return replace(
        action,
        at=action.at / system.length,
        force=action.force / force,
        moment=action.moment / (force * system.length),
        per_length=over(action.per_length, force / system.length),
    )
