"""The numbers that a coupling is told by, beside what it exerts on each body: a row a type that has its own.

Each hangs on the multipliers of some of its conditions: where one of these is open, so is the number.
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
class CoupledNumber:
    """A number of a coupling, (..., n_t); rows: the places of the conditions that it hangs on, among the coupling's.

    factor: times which the multiplier of a single condition is the number; 0: it is no such multiple; linear: but one
    that changes in time.
    """

    name: str
    values: Array
    rows: tuple[int, ...]
    is_moment: bool = False
    factor: float = 0.0
    linear: bool = False

    @property
    def is_sum(self) -> bool:
        """Whether the shares of causes add up to it."""
        return self.linear or self.factor != 0.0


def numbers_of(loads: CouplingLoads) -> list[CoupledNumber]:
    """The numbers of a coupling: of most the load that it carries."""
    return NUMBERS.get(loads.coupling.given.type, carried)(loads)


def components_of(loads: CouplingLoads) -> list[CoupledNumber]:
    """Those that are the multiplier of one condition, of which sums may be certain."""
    return [number for number in numbers_of(loads) if number.factor != 0.0]


def coupling_block(loads: CouplingLoads, names: Sequence[str], beside: Sequence[Action] = ()) -> dict[str, object]:
    """A coupling's block of the results; names: of the bodies, beside: what it exerts besides, as a pretension."""
    on = {
        "ground" if body == GROUND else names[body]: {"point": place, "force": force, "moment": moment}
        for body, (place, force, moment) in loads.on_bodies(beside).items()
    }
    return {number.name: number.values for number in numbers_of(loads)} | {"on": on, "open": []}


def carried(loads: CouplingLoads) -> list[CoupledNumber]:
    """The multiplier of its first condition: the force or the moment for which the coupling is there."""
    name = loads.carries
    return [CoupledNumber(name, loads.carried, (0,), name == "moment", float(name in ("force", "moment")), linear=True)]


def of_wheel(loads: CouplingLoads) -> list[CoupledNumber]:
    """What the plane presses the wheel with, what keeps it from slipping, and both together; how much more would.

    friction = sqrt(along^2 + aside^2),  force = sqrt(normal^2 + friction^2),  grip = coefficient normal - friction
    """
    given = loads.coupling.given
    assert isinstance(given, RollingWheel)
    (_, *rolling), every = loads.coupling.rows, tuple(range(len(loads.multipliers)))
    normal = loads.multipliers[0]
    ways = {row.parts[0].kind: values for row, values in zip(rolling, loads.multipliers[1:], strict=True)}
    named = [("along", "rolls"), ("aside", "rolls_aside")]
    found = [CoupledNumber("normal", normal, every[:1], factor=1.0)]
    found += [
        CoupledNumber(name, ways[kind], (1 + list(ways).index(kind),), factor=1.0)
        for name, kind in named
        if kind in ways
    ]
    square = np.sum(np.square(np.array(loads.multipliers[1:])), axis=0)
    found.append(CoupledNumber("friction", np.sqrt(square), every[1:]))
    found.append(CoupledNumber("force", np.sqrt(square + np.square(normal)), every))
    if given.friction is not None:
        found.append(CoupledNumber("grip", given.friction * normal - np.sqrt(square), every))
    return found


def of_rope(loads: CouplingLoads) -> list[CoupledNumber]:
    """Its tension; where sheaves hold it that before the first of them, and that behind the last."""
    held = (0,) if loads.rows else ()  # that of one that stretches hangs on no condition
    found = [CoupledNumber("tension", 0.0 - loads.multipliers[0], held, factor=-1.0 if held else 0.0, linear=True)]
    if len(loads.multipliers) > 1:
        found.append(
            CoupledNumber("last_tension", 0.0 - loads.multipliers[-1], (len(loads.multipliers) - 1,), factor=-1.0)
        )
    return found


def of_screw(loads: CouplingLoads) -> list[CoupledNumber]:
    """Its thrust; with friction all of it, and the torque that this takes."""
    if loads.friction is None:
        return carried(loads)
    from heuncli.loads.kinetostatics.thread_friction import whole_load  # few scenes have it

    force, torque = whole_load(loads)
    return [
        CoupledNumber("force", force, (0,), linear=True),
        CoupledNumber("torque", torque, (0,), is_moment=True, linear=True),
    ]


NUMBERS: dict[str, Callable[[CouplingLoads], list[CoupledNumber]]] = {
    "wheel": of_wheel, "rope": of_rope, "screw": of_screw,
}  # fmt: skip
