"""Whether the laws of a scene have a slope in a state: where one jumps or bends, small oscillations are not linear.

An expression in coordinates is looked at on either side, by so little that only a branch that begins there can differ;
on the branches met its value and its slope must be those of the branches here. A force along
the line between two points has no direction where they coincide. A contact that touches and bears nothing is one-sided.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from heuncli import tolerances
from heuncli.kernel.choose import expressions as evaluator
from heuncli.kernel.choose import jets
from heuncli.linearisation.steady_motion import Looked
from heuncli.mechanism.model import PairLoad, path_of_load
from heuncli.response import variables_at
from heuncli.results import Array


def without_slope(here: Looked) -> Iterator[str]:
    """Sentences on what has none."""
    yield from coincident(here)
    yield from bent(here)
    yield from touching(here)


def coincident(here: Looked) -> Iterator[str]:
    """Springs and actuators whose two points coincide; but a spring without length, or damping, pulls back evenly."""
    for load, rows in here.layout.mechanism.load_rows():
        if not isinstance(load, PairLoad) or load.a == load.b:
            continue
        even = load.value is None and load.length == 0.0 and load.damping == 0.0
        if here.at.loads["span"][0, rows].min() <= tolerances.NO_LENGTH * here.layout.size and not even:
            yield f"forces.{load.name} has no direction, for its two points coincide"


def bent(here: Looked) -> Iterator[str]:
    """Loads whose expressions jump or bend there."""
    if not here.layout.pack.held:
        return
    programs = expressions(here)
    variables = values(here)
    own = branches(programs, here, variables)
    for k in range(1, len(variables)):
        for sign in (1.0, -1.0):
            beside = variables.copy()
            beside[k] += sign * tolerances.KINK * max(1.0, abs(beside[k]))
            met = branches(programs, here, beside)
            if met != own:
                yield from differing(programs, here, variables, own, met)


def differing(programs: Any, here: Looked, variables: Array, own: list[float], met: list[float]) -> Iterator[str]:
    """Loads that have another value or slope on other branches."""
    for load, start, count in programs_of(here):
        (value, slope), (other, turned) = (on_branches(programs, start, count, variables, b) for b in (own, met))
        size = 1.0 + abs(value) + np.abs(slope).max()
        if not max(abs(value - other), np.abs(slope - turned).max()) <= tolerances.KINK * size:
            yield f"{load} jumps or bends there"


def expressions(here: Looked) -> Any:
    """The scene's programs, in a memory of their own."""
    pack = here.layout.pack
    return evaluator.Expressions(pack.code, pack.constants, len(pack.variables), pack.held, pack.starts, pack.tables)


def values(here: Looked) -> Array:
    """What the expressions' variables are: t, then coordinates and rates, of joints and of points."""
    return np.array(variables_at(here.layout, here.t, here.at.states[0]))


def programs_of(here: Looked) -> list[tuple[str, int, int]]:
    """The programs of all loads: whose, and where they stand."""
    table = here.layout.tables["loads"]
    return [
        (path_of_load(load), int(row[part]["start"]), int(row[part]["count"]))
        for load, rows in here.layout.mechanism.load_rows()
        for row in table[rows]
        for part in "xyz"
        if row[part]["count"]
    ]


def branches(programs: Any, here: Looked, variables: Array) -> list[float]:
    """The branches on which the loads' expressions find these variables."""
    programs.hold(evaluator.HOLDING["taken"])
    for _, start, count in programs_of(here):
        programs.evaluate(start, count, variables.tolist())
    return list(programs.branches())


def on_branches(programs: Any, start: int, count: int, variables: Array, held: list[float]) -> tuple[float, Array]:
    """Value and slope of a program on branches that are held."""
    programs.hold(evaluator.HOLDING["held"])
    programs.hold_branches(held)
    x = variables.tolist()
    return programs.evaluate(start, count, x), np.array(jets.gradient(programs, start, count, x))


def touching(here: Looked) -> Iterator[str]:
    """Ropes and stops that touch and bear nothing: what they do depends on which way they are moved."""
    layout, rows = here.layout, here.at.rows
    latched = {layout.contacts[k].joint for k in layout.latches if here.holding[k] > 0.0}
    for k, contact in enumerate(layout.contacts):
        if contact.sense == 0 or contact.joint in latched:
            continue
        name = f"joints.{contact.name}" if contact.is_rope else f"stops.{contact.name}"
        if here.holding[k] > 0.0:
            bears = abs(float(rows["multiplier"][0, contact.row])) * unit_load(here, contact.row)
            if bears <= tolerances.FREELY_PUSHED * here.system.loads:
                yield f"{name} touches and bears nothing"
        elif abs(float(rows["gap"][0, contact.row])) <= tolerances.OFF_BALANCE * layout.size:
            yield f"{name} touches and bears nothing"


def unit_load(here: Looked, row: int) -> float:
    """What a closure row's multiplier of 1 does along the motions of the bodies, in the reduced equations' measure."""
    return float(np.sqrt(np.sum(here.at.rows["f"][0, row] ** 2) + np.sum(here.at.rows["m"][0, row] ** 2)))
