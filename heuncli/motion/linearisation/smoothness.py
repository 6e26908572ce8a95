"""Find laws of a scene without a slope in a state: where one jumps or bends, small oscillations are not linear.

An expression in coordinates is evaluated on either side, so close that only a branch that begins there can differ. On
the branches found, its value and slope must equal those of the branches at the state. Near a root there is no branch,
but the slope differs at every step towards it. A force along the line between two coincident points has no direction. A
contact that touches and bears nothing is unilateral.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.kernel.choose import expressions as evaluator
from heuncli.kernel.choose import jets
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.linearisation.steady_motion import LinearisedState
from heuncli.multibody.mechanism.loads import PairLoad
from heuncli.multibody.response import evaluate_variables
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

HALVINGS = 0.5 ** np.arange(16)
SAMPLE_OFFSETS = np.concatenate([[0.0], HALVINGS, -HALVINGS])  # relative to the width; finds a root anywhere
IS_CLOSE = np.abs(SAMPLE_OFFSETS) <= 0.125


def iter_without_slope(linear_state: LinearisedState) -> Iterator[str]:
    """Yield sentences on what has no slope."""
    yield from iter_without_derivative(linear_state.layout, linear_state.t, linear_state.evaluation)
    yield from iter_unloaded_contacts(linear_state)


def iter_without_derivative(layout: Layout, t: float, evaluation: Evaluation) -> Iterator[str]:
    """Yield sentences on the loads that have no derivative in the one state of the evaluation."""
    yield from iter_coincident(layout, evaluation)
    examined_laws = examine_laws(layout, t, evaluation.states[0])
    yield from find_kinks(examined_laws)
    yield from find_roots(examined_laws)


def iter_coincident(layout: Layout, evaluation: Evaluation) -> Iterator[str]:
    """Yield springs and actuators with coincident points, except springs without length and damping, which are linear
    there.
    """
    for load, rows in layout.mechanism.iter_load_rows():
        if not isinstance(load, PairLoad) or load.a == load.b:
            continue
        if evaluation.loads["span"][0, rows].min() <= tolerances.NO_LENGTH * layout.size and not load.is_linear:
            yield f"forces.{load.name} has no direction, because its two points coincide"


class LoadLaw(NamedTuple):
    """A program of a load: its load, its position in the code, and its variables."""

    load: str
    start: int
    length: int
    variables: frozenset[int]


class ExaminedLaws(NamedTuple):
    """The laws of all loads in one state: their programs, the variables there, and the branches of these."""

    programs: Any
    laws: list[LoadLaw]
    variables: Array
    branches: list[float]


def examine_laws(layout: Layout, t: float, state: Array) -> ExaminedLaws:
    """Examine the laws of a scene's loads in a state."""
    programs, laws = make_programs(layout), list_laws(layout)
    variables = np.array(evaluate_variables(layout, t, state))
    return ExaminedLaws(programs, laws, variables, find_branches(programs, laws, variables))


def find_kinks(examined_laws: ExaminedLaws) -> Iterator[str]:
    """Yield loads whose expressions jump or bend in the state."""
    for k in range(1, len(examined_laws.variables)):  # the first is the time
        for sign in (1.0, -1.0):
            neighbour = examined_laws.variables.copy()
            neighbour[k] += sign * tolerances.KINK * max(1.0, abs(neighbour[k]))
            neighbour_branches = find_branches(examined_laws.programs, examined_laws.laws, neighbour)
            if neighbour_branches != examined_laws.branches:
                yield from iter_differing(examined_laws, neighbour_branches)


def find_roots(examined_laws: ExaminedLaws) -> Iterator[str]:
    """Yield loads that have a root so near that the state has no slope."""
    for law in examined_laws.laws:
        if any(is_steep(examined_laws, law, k) for k in sorted(law.variables - {0})):
            yield f"{law.load} has no derivative there (a root at 0, the angle of a point on the axis)"


def iter_differing(examined_laws: ExaminedLaws, neighbour_branches: list[float]) -> Iterator[str]:
    """Yield loads that have another value or slope on the neighbouring branches."""
    for law in examined_laws.laws:
        (value, slope), (other_value, other_slope) = (
            evaluate_on_branches(examined_laws.programs, law, examined_laws.variables, branch)
            for branch in (examined_laws.branches, neighbour_branches)
        )
        size = 1.0 + abs(value) + np.abs(slope).max()
        if not max(abs(value - other_value), np.abs(slope - other_slope).max()) <= tolerances.KINK * size:
            yield f"{law.load} has a jump or kink there"


def is_steep(examined_laws: ExaminedLaws, law: LoadLaw, k: int) -> bool:
    """Return whether a law's slope along a variable, on its present branches, varies or is not finite within KINK of
    the pose.

    A slope that is almost zero in the pose and grows evenly around it, like that of a square, does not count.
    """
    samples = np.tile(examined_laws.variables, (len(SAMPLE_OFFSETS), 1))
    samples[:, k] += SAMPLE_OFFSETS * tolerances.KINK * max(1.0, abs(examined_laws.variables[k]))
    slopes = np.array(
        [evaluate_on_branches(examined_laws.programs, law, x, examined_laws.branches)[1][k] for x in samples]
    )
    if not np.isfinite(slopes).all():
        return True
    most, spread = np.abs(slopes).max(), np.ptp(slopes)
    is_flat = abs(slopes[0]) <= tolerances.STEEP * most and np.ptp(slopes[IS_CLOSE]) <= tolerances.STEEP * spread
    return bool(spread > tolerances.STEEP * most) and not is_flat


def make_programs(layout: Layout) -> Any:
    """Return the scene's programs with a memory of their own."""
    pack = layout.pack
    return evaluator.Expressions(
        pack.code, pack.constants, len(pack.variables), pack.branch_count, pack.starts, pack.tables
    )


def list_laws(layout: Layout) -> list[LoadLaw]:
    """List the programs of all loads."""
    table, places = layout.tables["loads"], {use: k for k, use in enumerate(layout.pack.variables)}
    return [
        LoadLaw(load.path, int(row[part]["start"]), int(row[part]["count"]), variables_used)
        for load, rows in layout.mechanism.iter_load_rows()
        for variables_used in [frozenset(places[use] for law in load.values for use in law.uses)]
        for row in table[rows]
        for part in "xyz"
        if row[part]["count"]
    ]


def find_branches(programs: Any, laws: list[LoadLaw], variables: Array) -> list[float]:
    """Return the branches that the loads' expressions take for these variables."""
    programs.hold(evaluator.HOLDING["taken"])
    for law in laws:
        programs.evaluate(law.start, law.length, variables.tolist())
    return list(programs.branches())


def evaluate_on_branches(
    programs: Any, law: LoadLaw, variables: Array, held_branches: list[float]
) -> tuple[float, Array]:
    """Return value and slope of a program on given branches."""
    programs.hold(evaluator.HOLDING["held"])
    programs.hold_branches(held_branches)
    x = variables.tolist()
    return programs.evaluate(law.start, law.length, x), np.array(jets.find_gradient(programs, law.start, law.length, x))


def iter_unloaded_contacts(linear_state: LinearisedState) -> Iterator[str]:
    """Yield ropes and stops that touch and bear nothing: their effect depends on the direction of motion."""
    layout, rows = linear_state.layout, linear_state.evaluation.rows
    latched = {layout.contacts[k].joint for k in layout.latches if linear_state.holding[k] > 0.0}
    for k, contact in enumerate(layout.contacts):
        if contact.sense == 0 or contact.joint in latched:
            continue
        name = f"joints.{contact.name}" if contact.is_rope else f"stops.{contact.name}"
        if linear_state.holding[k] > 0.0:
            load_size = abs(float(rows["multiplier"][0, contact.row])) * unit_load_size(linear_state, contact.row)
            if load_size <= tolerances.FREELY_PUSHED * linear_state.system.load_scale:
                yield f"{name} touches without load"
        elif abs(float(rows["gap"][0, contact.row])) <= tolerances.OFF_BALANCE * layout.size:
            yield f"{name} touches without load"


def unit_load_size(linear_state: LinearisedState, row: int) -> float:
    """Return the magnitude of the load for a closure row's multiplier of 1, in the measure of the reduced equations."""
    return float(
        np.sqrt(
            np.sum(linear_state.evaluation.rows["f"][0, row] ** 2)
            + np.sum(linear_state.evaluation.rows["m"][0, row] ** 2)
        )
    )
