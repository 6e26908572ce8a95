"""The blows of a run as blocks of the results: the same sums as of forces, taken of jumps and impulses.

    r = sum h - sum m (x'+ - x'-),   M_r likewise                                         (50), (54)
A blow is answered as loads are at rest and without weight: jumps of velocities stand for accelerations, impulses for
forces. So reactions, verdicts, sums, foundation and sections are those of the same modules.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from heuncli.base.records import fields, record, replace
from heuncli.loads.kinetostatics.actions import Action, ActionEnd
from heuncli.loads.kinetostatics.balance import balance_residual
from heuncli.loads.kinetostatics.magnitudes import magnitudes
from heuncli.motion.integration.check.shared_blows import matched
from heuncli.motion.integration.contacts.blows import DRIVES, Jump
from heuncli.motion.integration.diagnosis.solvability import Wording, require_solvable
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.response import Columns
from heuncli.results.results import Array, Block, CertainSum
from heuncli.results.results_schema import AT_A_BLOW, BLOWS, BY_CAUSE, ROWS, SECTION_FORCES, SECTION_MOMENTS, SHARES
from heuncli.study.compose.blocks import blocks
from heuncli.study.compose.recovery import Recovery, certain_sums
from heuncli.study.model.setup import Setup
from heuncli.study.solve.history import History

UNTIMED = frozenset({"about", "s", "side"})  # of the blocks: the same at all blows
OPEN = "open"  # of a block: the list of its open components
STRUCK = frozenset({"foundation", "joints", "sections"})
WRENCH = {"N·s": ("force", *SECTION_FORCES), "N·m·s": ("moment", *SECTION_MOMENTS)}
OF_COUPLINGS = {
    struck: tuple(
        {row.path.rpartition(".")[2] for row in ROWS if row.path.startswith("couplings.") and unit in row.units}
    )
    for unit, struck in AT_A_BLOW.items()
}
KINDS = (  # of estimated errors, the block they are of, and its numbers by unit; a drive's unit is its joint's
    ("foundation", "foundation", WRENCH),
    ("reactions", "joints", WRENCH),
    ("reactions", "couplings", OF_COUPLINGS),
    ("sections", "sections", WRENCH),
    ("drives", "joints", {"N·s": ("drive",), "N·m·s": ("drive",)}),
)


def at_rest(setup: Setup) -> Setup:
    """The scene without weight and loads: what a blow meets; its cuts have no stresses."""
    scene = setup.scene
    joints = tuple(replace(joint, bearing=None) for joint in scene.mechanism.joints)
    mechanism = replace(scene.mechanism, gravity=np.zeros(3), loads=(), joints=joints)
    cuts = tuple(cuts.without_stresses for cuts in setup.cuts)
    scene = replace(scene, mechanism=mechanism, layout=replace(scene.layout, mechanism=mechanism))
    return replace(setup, scene=scene, cuts=cuts)


def answered(jump: Jump) -> Recovered:
    """The answers to a blow as answers at rest: jumps of velocities as accelerations, impulses as joint loads."""
    still, whole = jump.recovered, jump.recovered.causes
    assert whole is not None
    column = whole.only(0).sum()
    bodies, freedoms, rows = still.bodies.copy(), still.freedoms.copy(), still.rows.copy()
    bodies["omega"], bodies["v"], freedoms["u"] = 0.0, 0.0, 0.0
    for name in ("alpha", "a", "joint_moment", "joint_force"):
        bodies[name][0] = column.bodies[name]
    for name in ("udot", "drive"):
        freedoms[name][0] = column.freedoms[name]
    rows["multiplier"][0], rows["doubt"] = column.multipliers, 0.0
    return replace(still, bodies=bodies, freedoms=freedoms, rows=rows, loads=still.loads[:, :0], causes=None)


def columns_of(jumps: Sequence[Jump]) -> tuple[tuple[str, ...], Columns]:
    """All that strikes at some blow, the drives last, and the columns of jumps that it makes at each, (n, n_c)."""
    names = sorted(dict.fromkeys(name for jump in jumps for name in jump.causes), key=lambda name: name == DRIVES)
    found = []
    for jump in jumps:
        own = jump.recovered.causes
        assert own is not None
        columns, causes = own.only(0), np.array(jump.causes)
        found.append([columns.at(np.flatnonzero(causes == name)).sum() for name in names])

    def stacked(of: str) -> Any:
        return np.stack([np.stack([getattr(column, of) for column in row]) for row in found])

    return tuple(names), Columns(stacked("bodies"), stacked("freedoms"), stacked("multipliers"))


def together(answers: Sequence[Recovered]) -> Recovered:
    """Answers at several instants as one."""
    own: dict[str, Any] = {
        name: np.concatenate([getattr(one, name) for one in answers])
        for name, value in fields(answers[0]).items()
        if value is not None
    }
    return Recovered(**own)


@record
class Impulses:
    """All blows of a run; each thing is computed when it is first asked for."""

    setup: Setup  # at rest
    jumps: tuple[Jump, ...]
    recovery: Recovery
    errors: dict[tuple[str, str], float]  # estimated, by kind and unit

    @cached_property
    def shown(self) -> dict[str, Any]:
        """The blocks of foundation, joints and sections, arrays (n, ...) over the blows."""
        return blocks(self.recovery, STRUCK | {SHARES} if self.recovery.causes is not None else STRUCK)

    @cached_property
    def sums(self) -> list[CertainSum]:
        """Certain sums of what is open."""
        return certain_sums(self.recovery)

    @cached_property
    def by_unit(self) -> dict[str, float]:
        """What the impulses are summed from, by unit."""
        recovery = self.recovery
        mechanism, size = self.setup.scene.mechanism, self.setup.scene.layout.size
        own = magnitudes(mechanism, recovery.states, recovery.inertia, recovery.actions, recovery.energy, size).by_unit
        return {struck: own[unit] for unit, struck in AT_A_BLOW.items()}

    @property
    def residual(self) -> float:
        """What of d'Alembert's principle the impulses leave unmet, of the largest."""
        mechanism, size = self.setup.scene.mechanism, self.setup.scene.layout.size
        own = self.recovery
        return balance_residual(mechanism, own.states, own.inertia, own.actions, size)

    def blocks(self) -> list[Block]:
        """The blocks of all blows."""
        return [self.block(k) for k in range(len(self.jumps))]

    def cut_by(self, setup: Setup) -> Impulses:
        """The blows as they meet the cuts of another setup of the same scene."""
        still = at_rest(setup)
        return replace(self, setup=still, recovery=replace(self.recovery, setup=still))

    def block(self, k: int) -> Block:
        """The block of one blow."""
        jump, states = self.jumps[k], self.recovery.states
        bodies = {
            body.name: {"center_velocity_jump": states.a_centre[k, i], "angular_velocity_jump": states.alpha[k, i]}
            for i, body in enumerate(self.setup.scene.mechanism.bodies)
        }
        before, after = jump.kinetic
        block: Block = {"time": jump.told_time, "names": list(jump.names), "bodies": bodies}
        block |= only_of(of_one(self.shown, k), jump.causes)
        block |= {"energy_jump": after - before, "energy_before": before, "energy_after": after}
        if self.sums:
            block["certain_sums"] = [of_one(dict(one), k) for one in self.sums]
        return block


def impulses(setup: Setup, history: History, least_norm: bool, by_cause: bool = False) -> Impulses:
    """The blows of a run, of which there is one at least. Raises SolveError for one that nothing answers.

    by_cause: with the shares of each that strikes.
    """
    own = of_run(setup, history.blows, least_norm, by_cause)
    if BLOWS not in setup.asked.reports:
        return own  # which is answered and balances, but not told
    others = [of_run(setup, jumps, least_norm, by_cause) for jumps in history.beside if jumps]
    return replace(own, errors=apart(own, others))


def of_run(setup: Setup, jumps: tuple[Jump, ...], least_norm: bool, by_cause: bool) -> Impulses:
    """The blows of one run."""
    still = at_rest(setup)
    answers = together([answered(jump) for jump in jumps])
    given = tuple(actions(setup.scene.mechanism, jumps))
    size = still.scene.layout.size
    impulses = [*(float(np.abs(a.force).max() * size + np.abs(a.moment).max()) for a in given), 0.0]
    largest = max(impulses) + float(np.abs(answers.rows["multiplier"]).max(initial=0.0)) * size
    require_solvable(still.scene, answers, Wording("jumps of velocities", "couple", "N m s", largest))
    names, columns = columns_of(jumps) if by_cause else (None, None)
    return Impulses(still, jumps, Recovery(still, replace(answers, causes=columns), least_norm, given, names), {})


def actions(mechanism: Mechanism, jumps: Sequence[Jump]) -> list[Action]:
    """The given impulses as actions over the blows, zero at those at which they do not act."""
    found = []
    for i, blow in enumerate(mechanism.blows):
        force, moment, at = np.zeros((3, len(jumps), 3))
        for k, jump in enumerate(jumps):
            for given in jump.impulses:
                if given.blow == i:
                    force[k], moment[k], at[k] = given.force, given.moment, given.at
        point = blow.point if blow.point is not None else mechanism.bodies[blow.body].center
        found.append(Action("load", blow.name, ActionEnd(blow.body, at, point), None, force, moment))
    return found


def of_one(block: Block, k: int) -> Block:
    """The block of blow k, from a block over all blows; `open` names what is open at this one."""
    own: Block = {}
    for name, value in block.items():
        if isinstance(value, dict):
            own[name] = of_one(value, k)
        elif isinstance(value, np.ndarray) and (name not in UNTIMED or value.ndim > 1):  # nodes may move with a load
            own[name] = value[k]
        else:
            own[name] = value
    if isinstance(own.get(OPEN), list):  # a stop, joint or section may have this name, too: it leads to a block
        own[OPEN] = [path for path in own[OPEN] if is_open(own, path)]
    return own


def only_of(block: Block, causes: Sequence[str]) -> Block:
    """A block with the shares of these causes alone; one blow has at first a share of all that strikes in the run."""
    return {
        name: {cause: value[cause] for cause in causes} if are_shares(name, value)
        else only_of(value, causes) if isinstance(value, dict) else value
        for name, value in block.items()
    }  # fmt: skip


def is_open(block: Block, path: str) -> bool:
    """Whether a component named by its path within a block is open: nan."""
    *names, last = path.split(".")
    value: Any = block
    for name in names if last in {*"xyz"} else (*names, last):
        value = value[name]
    return bool(np.isnan(value[..., "xyz".index(last)] if last in {*"xyz"} else value).any())


def apart(own: Impulses, others: Sequence[Impulses]) -> dict[tuple[str, str], float]:
    """Estimated errors of the impulses by kind and unit: twice the largest difference from a check run.

    A blow that a check run does not have errs by the whole of its numbers.
    """
    found: dict[tuple[str, str], float] = {}
    parts = {"": whole_of, f" {BY_CAUSE}": shares_of} if own.recovery.causes is not None else {"": whole_of}
    same = [matched(own.jumps, other.jumps) for other in others]
    for end, part in parts.items():
        for kind, block, units in KINDS:
            for unit, names in units.items():
                differences = [
                    difference(mine, its, shared)
                    for other, shared in zip(others, same, strict=True)
                    for mine, its in pairs(part(own.shown.get(block, {})), part(other.shown.get(block, {})), names)
                ]
                name = f"{kind}{end}", unit
                found[name] = max(found.get(name, 0.0), 2.0 * max(differences, default=0.0))
    return found


def whole_of(block: Block) -> Block:
    """A block without its shares by cause."""
    return {k: whole_of(v) if isinstance(v, dict) else v for k, v in block.items() if not are_shares(k, v)}


def shares_of(block: Block) -> Block:
    """The shares of a block, and of those in it."""
    return {k: v if are_shares(k, v) else shares_of(v) for k, v in block.items() if isinstance(v, dict)}


def are_shares(name: str, value: Any) -> bool:
    """Whether these are blocks by cause, and no joint of that name."""
    return name == SHARES and isinstance(value, dict) and all(isinstance(own, dict) for own in value.values())


def difference(mine: Array, its: Array, same: Sequence[tuple[int, int]]) -> float:
    """The largest difference of numbers over the blows that are the same; of others the number itself."""
    reference = np.zeros_like(mine)
    for i, k in same:
        reference[i] = its[k]
    largest = float(np.fmax.reduce(np.abs(mine - reference), axis=None, initial=0.0))  # of what is not open
    return min(largest, sys.float_info.max)


def pairs(a: Block, b: Block, names: Sequence[str]) -> list[tuple[Array, Array]]:
    """The arrays of these names in two blocks, where both have them."""
    found = []
    for name, value in a.items():
        if isinstance(value, dict):
            found += pairs(value, b.get(name, {}), names)
        elif name in names and name in b and np.shape(value)[1:] == np.shape(b[name])[1:]:
            found.append((value, b[name]))
    return found
