"""The numbers reported for a coupling, besides its load on each body; one entry for each type with numbers of its own.

Each depends on the multipliers of some of its conditions: where one of these is indeterminate, so is the number.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from heuncli.base.records import record
from heuncli.loads.kinetostatics.actions import Action
from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.multibody.mechanism.model import GROUND
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import RollingWheel


@record
class CouplingNumber:
    """A number of a coupling, (..., n_t).

    rows: the conditions that it depends on, by their numbers in the coupling
    factor: the number divided by the multiplier of its single condition; 0 if it is no such multiple
    is_linear: linear in the multipliers with a factor that changes in time
    """

    name: str
    values: Array
    rows: tuple[int, ...]
    is_moment: bool = False
    factor: float = 0.0
    is_linear: bool = False

    @property
    def is_sum(self) -> bool:
        """Whether the shares of causes add up to it."""
        return self.is_linear or self.factor != 0.0


def list_numbers(loads: CouplingLoads) -> list[CouplingNumber]:
    """Return the numbers of a coupling; for most types, the load that it carries."""
    return NUMBERS.get(loads.coupling.entry.type, list_carried_load)(loads)


def list_multiples(loads: CouplingLoads) -> list[CouplingNumber]:
    """Return the numbers that are a multiple of one condition's multiplier, of which sums may be determinate."""
    return [number for number in list_numbers(loads) if number.factor != 0.0]


def make_coupling_block(
    loads: CouplingLoads, names: Sequence[str], extra_actions: Sequence[Action] = ()
) -> dict[str, object]:
    """Return a coupling's block of the results; names: of the bodies; extra_actions: such as a pretension."""
    body_loads = {
        "ground" if body == GROUND else names[body]: {"point": place, "force": force, "moment": moment}
        for body, (place, force, moment) in loads.body_loads(extra_actions).items()
    }
    return {number.name: number.values for number in list_numbers(loads)} | {"on": body_loads, "open": []}


def list_carried_load(loads: CouplingLoads) -> list[CouplingNumber]:
    """Return the multiplier of its first condition: the force or the moment that the coupling transmits."""
    name = loads.load_name
    return [
        CouplingNumber(
            name, loads.carried_load, (0,), name == "moment", float(name in ("force", "moment")), is_linear=True
        )
    ]


def list_wheel_numbers(loads: CouplingLoads) -> list[CouplingNumber]:
    """Return the normal force of a wheel, the forces that prevent slip, and both together; and the remaining grip.

    friction = sqrt(along^2 + aside^2),  force = sqrt(normal^2 + friction^2),  grip = coefficient normal - friction
    """
    wheel = loads.coupling.entry
    assert isinstance(wheel, RollingWheel)
    (_, *rolling), all_rows = loads.coupling.rows, tuple(range(len(loads.multipliers)))
    normal = loads.multipliers[0]
    tangential = {row.parts[0].kind: values for row, values in zip(rolling, loads.multipliers[1:], strict=True)}
    tangential_names = [("along", "rolls"), ("aside", "rolls_aside")]
    numbers = [CouplingNumber("normal", normal, all_rows[:1], factor=1.0)]
    numbers += [
        CouplingNumber(name, tangential[kind], (1 + list(tangential).index(kind),), factor=1.0)
        for name, kind in tangential_names
        if kind in tangential
    ]
    squared_friction = np.sum(np.square(np.array(loads.multipliers[1:])), axis=0)
    numbers.append(CouplingNumber("friction", np.sqrt(squared_friction), all_rows[1:]))
    numbers.append(CouplingNumber("force", np.sqrt(squared_friction + np.square(normal)), all_rows))
    if wheel.friction is not None:
        numbers.append(CouplingNumber("grip", wheel.friction * normal - np.sqrt(squared_friction), all_rows))
    return numbers


def list_rope_numbers(loads: CouplingLoads) -> list[CouplingNumber]:
    """Return a rope's tension; with fixed sheaves, that before the first of them, and that after the last."""
    rows = (0,) if loads.rows else ()  # the tension of a stretching rope depends on no condition
    numbers = [
        CouplingNumber("tension", 0.0 - loads.multipliers[0], rows, factor=-1.0 if rows else 0.0, is_linear=True)
    ]
    if len(loads.multipliers) > 1:
        numbers.append(
            CouplingNumber("last_tension", 0.0 - loads.multipliers[-1], (len(loads.multipliers) - 1,), factor=-1.0)
        )
    return numbers


def list_screw_numbers(loads: CouplingLoads) -> list[CouplingNumber]:
    """Return a screw's thrust; with friction, the total thrust and the torque that it takes."""
    if loads.friction is None:
        return list_carried_load(loads)
    from heuncli.loads.kinetostatics.thread_friction import total_screw_load  # few scenes have it

    force, torque = total_screw_load(loads)
    return [
        CouplingNumber("force", force, (0,), is_linear=True),
        CouplingNumber("torque", torque, (0,), is_moment=True, is_linear=True),
    ]


NUMBERS: dict[str, Callable[[CouplingLoads], list[CouplingNumber]]] = {
    "wheel": list_wheel_numbers, "rope": list_rope_numbers, "screw": list_screw_numbers,
}  # fmt: skip
