"""The results of couplings that a check run compares: more than the loads on the bodies.

A rope turns its drum by a moment about its centre, though no strand exerts one where it leaves the drum. The contact
point of a wheel moves over its rim. In a sum of wheel speeds with factors of a tenth, the coupling carries ten times
the torque.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.loads.kinetostatics.actions import Action
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.coupling_numbers import list_numbers
from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.multibody.mechanism.model import Joint
from heuncli.results.results import Array


def iter_coupling_results(
    couplings: Sequence[CouplingLoads], applied_actions: Sequence[Action], joints: Sequence[Joint], states: BodyStates
) -> Iterator[tuple[str, Array]]:
    """Yield all compared results; applied_actions: loads, some of which belong to couplings, as the pretension of belts
    does.
    """
    for coupling in couplings:
        own_loads = [
            action for action in applied_actions if coupling.coupling.has_load and action.name == coupling.coupling.name
        ]
        body_loads = coupling.body_loads(own_loads).values()
        for name, values in zip(("place", "force", "moment"), zip(*body_loads, strict=True), strict=True):
            yield name, np.stack(values, axis=1)
        for name, parts in find_coupling_numbers(coupling, joints, states).items():
            yield name, np.stack(parts, axis=1)[..., None]


def find_coupling_numbers(loads: CouplingLoads, joints: Sequence[Joint], states: BodyStates) -> dict[str, list[Array]]:
    """Return the numbers shown for a coupling, by the names of their quantities."""
    numbers_by_quantity: dict[str, list[Array]] = {}
    for number in list_numbers(loads):
        numbers_by_quantity.setdefault("moment" if number.is_moment else "force", []).append(number.values)
    spec_coupling = loads.coupling.entry
    if spec_coupling.type in ("gear", "screw", "belt"):
        from heuncli.loads.kinetostatics.coupling_numbers import DRIVE_ELEMENT_NUMBERS  # few scenes have them

        for name, values in DRIVE_ELEMENT_NUMBERS[spec_coupling.type](
            spec_coupling, loads.carried_load, is_impulse=False
        ).items():
            numbers_by_quantity.setdefault("moment" if name == "torque" else "force", []).append(values)
    if spec_coupling.type == "cam":
        from heuncli.loads.kinetostatics.coupling_numbers import pressure_angle  # few scenes have them

        numbers_by_quantity["angle"] = [pressure_angle(loads, joints, states)]
    return numbers_by_quantity
