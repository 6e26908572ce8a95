"""Whether the laws of a scene have a slope in a state: where one jumps or bends, small oscillations are not linear.

An expression in coordinates is looked at on either side, by so little that only a branch that begins there can differ;
on the branches met its value and its slope must be those of the branches here. A root close by has no branch, but a
slope that is another one at every step towards it. A force along the line between two points has no direction where
they coincide. A contact that touches and bears nothing is one-sided.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.kernel.choose import expressions as evaluator
from heuncli.kernel.choose import jets
from heuncli.motion.integration.evaluator import Recovered
from heuncli.motion.linearisation.steady_motion import Looked
from heuncli.multibody.mechanism.model import PairLoad, path_of_load
from heuncli.multibody.response import variables_at
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

HALVED = 0.5 ** np.arange(16)
BESIDE = np.concatenate([[0.0], HALVED, -HALVED])  # of the width looked at: near a root, wherever it lies in it
CLOSE = np.abs(BESIDE) <= 0.125


def without_slope(here: Looked) -> Iterator[str]:
    """Sentences on what has none."""
    yield from without_derivative(here.layout, here.t, here.at)
    yield from touching(here)


def without_derivative(layout: Layout, t: float, at: Recovered) -> Iterator[str]:
    """Sentences on the loads that have none in the one state of at."""
    yield from coincident(layout, at)
    here = examine_laws(layout, t, at.states[0])
    yield from find_kinks(here)
    yield from find_roots(here)


def coincident(layout: Layout, at: Recovered) -> Iterator[str]:
    """Springs and actuators whose two points coincide; but a spring without length, or damping, pulls back evenly."""
    for load, rows in layout.mechanism.load_rows():
        if not isinstance(load, PairLoad) or load.a == load.b:
            continue
        even = load.value is None and load.length == 0.0 and load.damping == 0.0
        if at.loads["span"][0, rows].min() <= tolerances.NO_LENGTH * layout.size and not even:
            yield f"forces.{load.name} has no direction, for its two points coincide"


class LoadLaw(NamedTuple):
    """A program of a load: whose it is, where it stands, and the variables that the load has."""

    load: str
    start: int
    length: int
    variables: frozenset[int]


class ExaminedLaws(NamedTuple):
    """The laws of all loads in one state: their programs, the variables there, and the branches that these are on."""

    programs: Any
    laws: list[LoadLaw]
    variables: Array
    branches: list[float]


def examine_laws(layout: Layout, t: float, state: Array) -> ExaminedLaws:
    """The laws of a scene's loads in a state."""
    programs, laws = expressions(layout), list_laws(layout)
    variables = np.array(variables_at(layout, t, state))
    return ExaminedLaws(programs, laws, variables, branches(programs, laws, variables))


def find_kinks(here: ExaminedLaws) -> Iterator[str]:
    """Loads whose expressions jump or bend in the state."""
    for k in range(1, len(here.variables)):  # the first is the time
        for sign in (1.0, -1.0):
            beside = here.variables.copy()
            beside[k] += sign * tolerances.KINK * max(1.0, abs(beside[k]))
            met = branches(here.programs, here.laws, beside)
            if met != here.branches:
                yield from differing(here, met)


def find_roots(here: ExaminedLaws) -> Iterator[str]:
    """Loads that have a root so near the state that no slope is that of the state."""
    for law in here.laws:
        if any(is_steep(here, law, k) for k in sorted(law.variables - {0})):
            yield f"{law.load} has no slope there (a root at 0, an angle of a point that lies on the axis)"


def differing(here: ExaminedLaws, met: list[float]) -> Iterator[str]:
    """Loads that have another value or slope on the branches met."""
    for law in here.laws:
        (value, slope), (other, turned) = (
            on_branches(here.programs, law, here.variables, branch) for branch in (here.branches, met)
        )
        size = 1.0 + abs(value) + np.abs(slope).max()
        if not max(abs(value - other), np.abs(slope - turned).max()) <= tolerances.KINK * size:
            yield f"{law.load} jumps or bends there"


def is_steep(here: ExaminedLaws, law: LoadLaw, k: int) -> bool:
    """Whether a law's slope along a variable, on its branches here, is another one, or none, within KINK of the pose.

    A slope that is next to none in the pose, and grows evenly beside it, is one: that of a square.
    """
    around = np.tile(here.variables, (len(BESIDE), 1))
    around[:, k] += BESIDE * tolerances.KINK * max(1.0, abs(here.variables[k]))
    slopes = np.array([on_branches(here.programs, law, x, here.branches)[1][k] for x in around])
    if not np.isfinite(slopes).all():
        return True
    most, spread = np.abs(slopes).max(), np.ptp(slopes)
    is_flat = abs(slopes[0]) <= tolerances.STEEP * most and np.ptp(slopes[CLOSE]) <= tolerances.STEEP * spread
    return bool(spread > tolerances.STEEP * most) and not is_flat


def expressions(layout: Layout) -> Any:
    """The scene's programs, in a memory of their own."""
    pack = layout.pack
    return evaluator.Expressions(pack.code, pack.constants, len(pack.variables), pack.held, pack.starts, pack.tables)


def list_laws(layout: Layout) -> list[LoadLaw]:
    """The programs of all loads."""
    table, places = layout.tables["loads"], {use: k for k, use in enumerate(layout.pack.variables)}
    return [
        LoadLaw(path_of_load(load), int(row[part]["start"]), int(row[part]["count"]), used)
        for load, rows in layout.mechanism.load_rows()
        for used in [frozenset(places[use] for law in load.values for use in law.uses)]
        for row in table[rows]
        for part in "xyz"
        if row[part]["count"]
    ]


def branches(programs: Any, laws: list[LoadLaw], variables: Array) -> list[float]:
    """The branches on which the loads' expressions find these variables."""
    programs.hold(evaluator.HOLDING["taken"])
    for law in laws:
        programs.evaluate(law.start, law.length, variables.tolist())
    return list(programs.branches())


def on_branches(programs: Any, law: LoadLaw, variables: Array, held: list[float]) -> tuple[float, Array]:
    """Value and slope of a program on branches that are held."""
    programs.hold(evaluator.HOLDING["held"])
    programs.hold_branches(held)
    x = variables.tolist()
    return programs.evaluate(law.start, law.length, x), np.array(jets.gradient(programs, law.start, law.length, x))


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
