"""Make the impulses of a run as blocks of the results: the same sums as of forces, over velocity jumps and impulses.

    r = sum h - sum m (x'+ - x'-),   M_r likewise                                         (50), (54)

An impulse is solved like loads at rest and without weight: velocity jumps replace accelerations, impulses replace
forces. So reactions, verdicts, sums, foundation and sections come from the same modules.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from heuncli.base.records import fields, record, replace
from heuncli.loads.kinetostatics.actions import Action, ActionEnd
from heuncli.loads.kinetostatics.balance import balance_residual, find_magnitudes
from heuncli.motion.integration.check.run_comparison import match_impulses
from heuncli.motion.integration.contacts.impulses import DRIVES, ImpulseEvent
from heuncli.motion.integration.diagnosis.solvability import ErrorWording, require_solvable
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.response import Columns
from heuncli.results.path_words import BY_CAUSE, IMPULSE_UNITS
from heuncli.results.results import Array, Block, DeterminateSum
from heuncli.results.results_schema import IMPULSES, ROWS, SECTION_FORCES, SECTION_MOMENTS, SHARES
from heuncli.study.compose.blocks import make_blocks
from heuncli.study.compose.recovery import Recovery, find_determinate_sums
from heuncli.study.model.setup import Setup
from heuncli.study.solve.history import History

UNTIMED = frozenset({"about", "s", "side"})  # keys of blocks that are the same at all impulses
OPEN_KEY = "open"  # the key of a block under which its open components are listed
IMPULSE_BLOCKS = frozenset({"foundation", "joints", "sections"})
WRENCH = {"N·s": ("force", *SECTION_FORCES), "N·m·s": ("moment", *SECTION_MOMENTS)}
COUPLING_QUANTITIES = {
    struck: tuple(
        {row.path.rpartition(".")[2] for row in ROWS if row.path.startswith("couplings.") and unit in row.units}
    )
    for unit, struck in IMPULSE_UNITS.items()
}
# Kind of estimated error, block of the results, and the block's numbers by unit; a drive's unit is its joint's.
ERROR_KINDS = (
    ("foundation", "foundation", WRENCH),
    ("reactions", "joints", WRENCH),
    ("reactions", "couplings", COUPLING_QUANTITIES),
    ("sections", "sections", WRENCH),
    ("sensors", "sensors", WRENCH),
    ("bearings", "joints", {"N·s": ("radial_force", "axial")}),
    ("drives", "joints", {"N·s": ("drive",), "N·m·s": ("drive",)}),
)


def make_impulse_setup(setup: Setup) -> Setup:
    """Return the setup that an impulse is solved with: without weight and loads, and without stresses of its cuts."""
    scene = setup.scene
    joints = tuple(replace(joint, bearing=None) for joint in scene.mechanism.joints)
    mechanism = replace(scene.mechanism, gravity=np.zeros(3), loads=(), joints=joints)
    cuts = tuple(cuts.for_impulse for cuts in setup.cuts)
    scene = replace(scene, mechanism=mechanism, layout=replace(scene.layout, mechanism=mechanism))
    return replace(setup, scene=scene, cuts=cuts)


def make_rest_solution(jump: ImpulseEvent) -> Evaluation:
    """Return the solution of an impulse as one at rest: velocity jumps as accelerations, impulses as joint loads."""
    state_before, causes = jump.evaluation, jump.evaluation.causes
    assert causes is not None
    column = causes.take(0).sum()
    bodies, freedoms, rows = state_before.bodies.copy(), state_before.freedoms.copy(), state_before.rows.copy()
    bodies["omega"], bodies["v"], freedoms["u"] = 0.0, 0.0, 0.0
    for name in ("alpha", "a", "joint_moment", "joint_force"):
        bodies[name][0] = column.bodies[name]
    for name in ("udot", "drive"):
        freedoms[name][0] = column.freedoms[name]
    rows["multiplier"][0], rows["doubt"] = column.multipliers, 0.0
    return replace(
        state_before, bodies=bodies, freedoms=freedoms, rows=rows, loads=state_before.loads[:, :0], causes=None
    )


def make_cause_columns(jumps: Sequence[ImpulseEvent]) -> tuple[tuple[str, ...], Columns]:
    """Return the names of all causes of the impulses, the drives last, and the columns of jumps of each, (n, n_c)."""
    names = sorted(dict.fromkeys(name for jump in jumps for name in jump.causes), key=lambda name: name == DRIVES)
    found = []
    for jump in jumps:
        jump_causes = jump.evaluation.causes
        assert jump_causes is not None
        columns, causes = jump_causes.take(0), np.array(jump.causes)
        found.append([columns.select(np.flatnonzero(causes == name)).sum() for name in names])

    def stack_rows(attribute: str) -> Any:
        return np.stack([np.stack([getattr(column, attribute) for column in row]) for row in found])

    return tuple(names), Columns(stack_rows("bodies"), stack_rows("freedoms"), stack_rows("multipliers"))


def concatenate_solutions(solutions: Sequence[Evaluation]) -> Evaluation:
    """Concatenate solutions at several instants."""
    fields_by_name: dict[str, Any] = {
        name: np.concatenate([getattr(one, name) for one in solutions])
        for name, value in fields(solutions[0]).items()
        if value is not None
    }
    return Evaluation(**fields_by_name)


@record
class Impulses:
    """All impulses of a run; each result is computed when it is first used."""

    setup: Setup  # at rest
    jumps: tuple[ImpulseEvent, ...]
    recovery: Recovery
    errors: dict[tuple[str, str], float]  # estimated, by kind and unit

    @cached_property
    def all_blocks(self) -> dict[str, Any]:
        """The blocks of foundation, joints and sections, arrays (n, ...) over the impulses."""
        return make_blocks(
            self.recovery, IMPULSE_BLOCKS | {SHARES} if self.recovery.causes is not None else IMPULSE_BLOCKS
        )

    @cached_property
    def sums(self) -> list[DeterminateSum]:
        """The determinate sums of indeterminate components."""
        return find_determinate_sums(self.recovery)

    @cached_property
    def magnitudes_by_unit(self) -> dict[str, float]:
        """The size of the terms that the impulses are summed from, by unit."""
        recovery = self.recovery
        mechanism, size = self.setup.scene.mechanism, self.setup.scene.layout.size
        rest_magnitudes = find_magnitudes(
            mechanism, recovery.states, recovery.inertia, recovery.actions, recovery.energy, size
        ).by_unit
        return {impulse_unit: rest_magnitudes[unit] for unit, impulse_unit in IMPULSE_UNITS.items()}

    @property
    def residual(self) -> float:
        """The residual of d'Alembert's principle, relative to the largest impulse."""
        mechanism, size = self.setup.scene.mechanism, self.setup.scene.layout.size
        own = self.recovery
        return balance_residual(mechanism, own.states, own.inertia, own.actions, size)

    def make_blocks(self) -> list[Block]:
        """Make the blocks of all impulses."""
        return [self.make_block(k) for k in range(len(self.jumps))]

    def with_cuts(self, setup: Setup) -> Impulses:
        """Return the impulses with the cuts of another setup of the same scene."""
        rest_setup = make_impulse_setup(setup)
        return replace(self, setup=rest_setup, recovery=replace(self.recovery, setup=rest_setup))

    def make_block(self, k: int) -> Block:
        """Make the block of one impulse."""
        jump, states = self.jumps[k], self.recovery.states
        bodies = {
            body.name: {"center_velocity_jump": states.a_centre[k, i], "angular_velocity_jump": states.alpha[k, i]}
            for i, body in enumerate(self.setup.scene.mechanism.bodies)
        }
        before, after = jump.kinetic
        block: Block = {"time": jump.reported_time, "names": list(jump.names), "bodies": bodies}
        block |= select_causes(pick_impulse(self.all_blocks, k), jump.causes)
        block |= {"energy_jump": after - before, "energy_before": before, "energy_after": after}
        if self.sums:
            block["certain_sums"] = [pick_impulse(dict(one), k) for one in self.sums]
        return block


def make_impulses(setup: Setup, history: History, least_norm: bool, by_cause: bool = False) -> Impulses:
    """Return the impulses of a run, at least one. Raises SolveError if one has no solution.

    by_cause: with the share of each cause
    """
    run_impulses = make_run_impulses(setup, history.impulses, least_norm, by_cause)
    if IMPULSES not in setup.selection.reports:
        return run_impulses  # the impulses are solved and balanced, but not shown
    others = [make_run_impulses(setup, jumps, least_norm, by_cause) for jumps in history.check_impulses if jumps]
    return replace(run_impulses, errors=estimate_errors(run_impulses, others))


def make_run_impulses(setup: Setup, jumps: tuple[ImpulseEvent, ...], least_norm: bool, by_cause: bool) -> Impulses:
    """Return the impulses of one run."""
    rest_setup = make_impulse_setup(setup)
    solutions = concatenate_solutions([make_rest_solution(jump) for jump in jumps])
    given_actions = tuple(make_actions(setup.scene.mechanism, jumps))
    size = rest_setup.scene.layout.size
    sizes = [*(float(np.abs(a.force).max() * size + np.abs(a.moment).max()) for a in given_actions), 0.0]
    largest = max(sizes) + float(np.abs(solutions.rows["multiplier"]).max(initial=0.0)) * size
    require_solvable(rest_setup.scene, solutions, ErrorWording("velocity jumps", "couple", "N m s", largest))
    names, columns = make_cause_columns(jumps) if by_cause else (None, None)
    return Impulses(
        rest_setup,
        jumps,
        Recovery(rest_setup, replace(solutions, causes=columns), least_norm, given_actions, names),
        {},
    )


def make_actions(mechanism: Mechanism, jumps: Sequence[ImpulseEvent]) -> list[Action]:
    """Return the given impulses as actions over all impulses of the run, zero at those at which they do not act."""
    found = []
    for i, impulse in enumerate(mechanism.impulses):
        force, moment, position = np.zeros((3, len(jumps), 3))
        for k, jump in enumerate(jumps):
            for applied_impulse in jump.impulses:
                if applied_impulse.number == i:
                    force[k], moment[k], position[k] = (
                        applied_impulse.force,
                        applied_impulse.moment,
                        applied_impulse.position,
                    )
        point = impulse.point if impulse.point is not None else mechanism.bodies[impulse.body].center
        found.append(Action("load", impulse.name, ActionEnd(impulse.body, position, point), None, force, moment))
    return found


def pick_impulse(block: Block, k: int) -> Block:
    """Return the block of impulse k, from a block over all impulses; `open` lists what is indeterminate at this one."""
    picked: Block = {}
    for name, value in block.items():
        if isinstance(value, dict):
            picked[name] = pick_impulse(value, k)
        elif isinstance(value, np.ndarray) and (name not in UNTIMED or value.ndim > 1):  # nodes may move with a load
            picked[name] = value[k]
        else:
            picked[name] = value
    if isinstance(picked.get(OPEN_KEY), list):  # a stop, joint or section may have this name, too: it leads to a block
        picked[OPEN_KEY] = [path for path in picked[OPEN_KEY] if is_indeterminate(picked, path)]
    return picked


def select_causes(block: Block, causes: Sequence[str]) -> Block:
    """Return a block with the shares of these causes alone; before, each impulse has a share of every cause in the
    run.
    """
    return {
        name: {cause: value[cause] for cause in causes} if are_shares(name, value)
        else select_causes(value, causes) if isinstance(value, dict) else value
        for name, value in block.items()
    }  # fmt: skip


def is_indeterminate(block: Block, path: str) -> bool:
    """Return whether a component named by its path within a block is indeterminate: nan."""
    *names, last = path.split(".")
    value: Any = block
    for name in names if last in {*"xyz"} else (*names, last):
        value = value[name]
    return bool(np.isnan(value[..., "xyz".index(last)] if last in {*"xyz"} else value).any())


def estimate_errors(impulses_of_run: Impulses, others: Sequence[Impulses]) -> dict[tuple[str, str], float]:
    """Estimate the errors of the impulses by kind and unit: twice the largest difference from a check run.

    An impulse that a check run does not have is wrong by all of its numbers.
    """
    errors: dict[tuple[str, str], float] = {}
    parts = (
        {"": drop_shares, f" {BY_CAUSE}": select_shares}
        if impulses_of_run.recovery.causes is not None
        else {"": drop_shares}
    )
    matches = [match_impulses(impulses_of_run.jumps, other.jumps) for other in others]
    for suffix, select_part in parts.items():
        for kind, block, units in ERROR_KINDS:
            for unit, names in units.items():
                differences = [
                    find_largest_difference(values, check_values, matched_pairs)
                    for other, matched_pairs in zip(others, matches, strict=True)
                    for values, check_values in find_array_pairs(
                        select_part(impulses_of_run.all_blocks.get(block, {})),
                        select_part(other.all_blocks.get(block, {})),
                        names,
                    )
                ]
                name = f"{kind}{suffix}", unit
                errors[name] = max(errors.get(name, 0.0), 2.0 * max(differences, default=0.0))
    return errors


def drop_shares(block: Block) -> Block:
    """Return a block without its shares by cause."""
    return {k: drop_shares(v) if isinstance(v, dict) else v for k, v in block.items() if not are_shares(k, v)}


def select_shares(block: Block) -> Block:
    """Return the shares of a block, and of its sub-blocks."""
    return {k: v if are_shares(k, v) else select_shares(v) for k, v in block.items() if isinstance(v, dict)}


def are_shares(name: str, value: Any) -> bool:
    """Return whether these are blocks by cause, and not a joint of that name."""
    return name == SHARES and isinstance(value, dict) and all(isinstance(own, dict) for own in value.values())


def find_largest_difference(values: Array, check_values: Array, matched_pairs: Sequence[tuple[int, int]]) -> float:
    """Return the largest difference of numbers between two runs over the impulses; a missing number counts as 0."""
    reference = np.zeros_like(values)
    for i, k in matched_pairs:
        reference[i] = check_values[k]
    largest = float(np.fmax.reduce(np.abs(values - reference), axis=None, initial=0.0))  # without indeterminate numbers
    return min(largest, sys.float_info.max)


def find_array_pairs(a: Block, b: Block, names: Sequence[str]) -> list[tuple[Array, Array]]:
    """Return the arrays of these names in two blocks, where both have them."""
    found = []
    for name, value in a.items():
        if isinstance(value, dict):
            found += find_array_pairs(value, b.get(name, {}), names)
        elif name in names and name in b and np.shape(value)[1:] == np.shape(b[name])[1:]:
            found.append((value, b[name]))
    return found
