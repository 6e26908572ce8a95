"""What is told of couplings, as it is compared between two runs: it is more than what acts.

What a rope pulls its drum with turns it about its centre, which no strand does where it leaves it. Where a wheel
touches moves over its rim. A sum whose factors are tenths carries ten times the couples that it makes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.loads.kinetostatics.actions import Action
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.coupling_numbers import numbers_of
from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.multibody.mechanism.model import Joint
from heuncli.results.results import Array


def told_of(
    couplings: Sequence[CouplingLoads], applied: Sequence[Action], joints: Sequence[Joint], states: BodyStates
) -> Iterator[tuple[str, Array]]:
    """All of it; applied: loads, of which some are couplings', as the pretension of belts."""
    for own in couplings:
        beside = [action for action in applied if own.coupling.has_load and action.name == own.coupling.name]
        on = own.on_bodies(beside).values()
        for name, values in zip(("place", "force", "moment"), zip(*on, strict=True), strict=True):
            yield name, np.stack(values, axis=1)
        for name, several in numbers(own, joints, states).items():
            yield name, np.stack(several, axis=1)[..., None]


def numbers(loads: CouplingLoads, joints: Sequence[Joint], states: BodyStates) -> dict[str, list[Array]]:
    """The numbers that a coupling is told by, by the names of their quantities."""
    found: dict[str, list[Array]] = {}
    for number in numbers_of(loads):
        found.setdefault("moment" if number.is_moment else "force", []).append(number.values)
    given = loads.coupling.given
    if given.type in ("gear", "screw", "belt"):
        from heuncli.loads.kinetostatics.drives_told import TOLD  # few scenes have them

        for name, values in TOLD[given.type](given, loads.carried, struck=False).items():
            found.setdefault("moment" if name == "torque" else "force", []).append(values)
    if given.type == "cam":
        from heuncli.loads.kinetostatics.cams import pressure_angle  # few scenes have them

        found["angle"] = [pressure_angle(loads, joints, states)]
    return found
