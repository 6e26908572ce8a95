"""The kernel's answers at some instants made into blocks of Results: reactions, verdicts, sums, sections, foundation.

Reads as the list of what is computed; each thing has its own module. Raises SolveError where no acceleration exists.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from heuncli.integration.evaluator import Recovered
from heuncli.integration.refusals.solvability import require_directions, require_solvable
from heuncli.kinetostatics.actions import Action, AppliedLoad, applied_loads, joint_actions, whole_joint_actions
from heuncli.kinetostatics.balance import balance_residual
from heuncli.kinetostatics.bodies import BodyStates, body_states
from heuncli.kinetostatics.coordinates import coordinates, points
from heuncli.kinetostatics.energy import energy, energy_drift, magnitude_of_work, power_imbalance, system_vector
from heuncli.kinetostatics.foundation import foundation
from heuncli.kinetostatics.joint_axes import axes_at, put_in_axes
from heuncli.kinetostatics.magnitudes import magnitudes
from heuncli.kinetostatics.reactions import JointLoads, joint_loads
from heuncli.mechanism.model import JointLoad, PairLoad
from heuncli.records import record, replace
from heuncli.results import Accuracy, Array, Block, CertainSum, Magnitudes, Mask
from heuncli.results_schema import BLOWS, SHARED, SHARES
from heuncli.study.ask.selection import chosen
from heuncli.study.solve.setup import Setup

if TYPE_CHECKING:  # loaded where a scene has closed chains, or sections, or loads are told by cause
    from heuncli.kinetostatics.shares import Shares
    from heuncli.redundancy.resolve import Resolution
    from heuncli.redundancy.self_stress import SelfStress


HUNG_ON_RANK = SHARED  # reports that ask for the rank of the closures
OF_ENERGY = frozenset({"energy", BLOWS})  # reports that tell energies


@record
class Recovery:
    """What follows from the kernel's answers at some instants; each thing is computed when it is first asked for.

    given: actions from outside that are no loads of the mechanism: the impulses of blows. causes: the names of the
    kernel's columns, where these are not those of the mechanism.
    """

    setup: Setup
    recovered: Recovered
    least_norm: bool
    given: tuple[Action, ...] = ()
    causes: tuple[str, ...] | None = None

    @cached_property
    def states(self) -> BodyStates:
        """Places, velocities and accelerations of the bodies."""
        return body_states(self.setup.scene.layout, self.recovered, self.setup.steady)

    @cached_property
    def decided(self) -> Resolution | None:
        """What redundant joints leave open, after the split that was asked for; None without closed chains."""
        layout = self.setup.scene.layout
        if not layout.rows:
            return None
        from heuncli.redundancy.resolve import resolve  # a tree starts faster without it

        return resolve(self.setup.runner, self.recovered, self.states, self.unsplit, self.least_norm)

    @property
    def verdicts(self) -> bool:
        """Whether it matters what redundant joints leave open: to what is asked for, or to how joints are split."""
        setup = self.setup
        may_share = bool(setup.model["redundant"] or setup.scene.layout.contacts)
        return may_share or bool(HUNG_ON_RANK & setup.asked.reports)

    @cached_property
    def joints(self) -> list[JointLoads]:
        """The joints' reactions."""
        if self.decided is not None:
            return self.decided.joints
        return self.unsplit

    @cached_property
    def unsplit(self) -> list[JointLoads]:
        """The joints' reactions as the kernel answers them: where some are redundant, one split of many."""
        return joint_loads(self.setup.scene.layout, self.recovered, self.states)

    @cached_property
    def loads(self) -> list[AppliedLoad]:
        """The applied loads; of a spring whose points coincide the rate at which they part: its line begins there."""
        found = applied_loads(self.setup.scene.mechanism, self.recovered)
        if not any(isinstance(own.load, PairLoad) and (own.length == 0.0).any() for own in found):
            return found
        from heuncli.integration.refusals.coincident_points import parting  # hardly any scene needs it

        layout, recovered = self.setup.scene.layout, self.recovered
        return [
            replace(own, rate=np.where(own.length == 0.0, speed(parting(layout, own.load, recovered)), own.rate))
            if isinstance(own.load, PairLoad)
            else own
            for own in found
        ]

    @cached_property
    def shares(self) -> Shares:
        """The joints' loads by their causes, after the same split; of instants that were recovered with causes."""
        from heuncli.kinetostatics.shares import members_of, shares_of  # few runs ask for them

        layout = self.setup.scene.layout
        own = None if self.causes is None else {name: [k] for k, name in enumerate(self.causes)}
        members = members_of(layout.mechanism) if own is None else own
        found = shares_of(layout, self.recovered, self.states, self.applied, members)
        if self.decided is None:
            return found
        return replace(found, joints=self.decided.chosen(found.joints, self.states))

    @property
    def applied(self) -> list[Action]:
        """The actions of the applied loads, and of what is given beside them."""
        return [*(load.action for load in self.loads), *self.given]

    @property
    def actions(self) -> list[Action]:
        """Everything that acts on the bodies but their weight; of a joint constraint and drive together."""
        return [*self.applied, *whole_joint_actions(self.joints if self.verdicts else self.unsplit)]

    @cached_property
    def energy(self) -> Block:
        """Kinetic and potential energy, and work."""
        return energy(self.setup.scene.layout, self.recovered, self.states, self.loads)

    @cached_property
    def magnitudes(self) -> Magnitudes:
        """What the numbers are summed from."""
        scene = self.setup.scene
        energy = self.energy if OF_ENERGY & self.setup.asked.reports else {}
        return magnitudes(scene.mechanism, self.states, self.actions, energy, scene.layout.size)

    @property
    def generic(self) -> Array:
        """How many self-stresses there are at most at each instant but for a singular pose, (n_t,).

        Those of the start, and one more for each contact that has closed since.
        """
        closed = (self.recovered.holding > 0.0) & ~(self.setup.runner.start_holding > 0.0)
        return np.asarray(self.setup.model["redundant"] + closed.sum(axis=1))

    @property
    def indeterminate(self) -> SelfStress | None:
        """The self-stresses that no split has resolved."""
        return self.decided.left if self.decided is not None else None


def speed(velocities: Array) -> Array:
    """The magnitudes of vectors (n_t, 3)."""
    return np.asarray(np.sqrt(np.sum(velocities**2, axis=-1)))


def recover(setup: Setup, recovered: Recovered, least_norm: bool) -> Recovery:
    """What follows from the kernel's answers. Raises SolveError where no acceleration exists."""
    require_solvable(setup.scene, recovered)
    require_directions(setup.scene, recovered)
    return Recovery(setup, recovered, least_norm)


def blocks(recovery: Recovery, wanted: Set[str]) -> dict[str, Any]:
    """The blocks of the reports that are wanted, as the fields of Results."""
    mechanism, layout = recovery.setup.scene.mechanism, recovery.setup.scene.layout
    recovered, states = recovery.recovered, recovery.states
    shown: dict[str, Any] = {}
    if "foundation" in wanted:
        actions = [*recovery.applied, *joint_actions(recovery.joints)]
        shown["foundation"] = foundation(mechanism, states, actions, about(recovery.setup))
    if "joints" in wanted:
        shown["joints"] = {j.joint.name: joint_block(j) for j in recovery.joints}
        shown["stops"] = stops(recovery.joints)
    if SHARES in wanted:
        from heuncli.study.solve.cause_shares import put_shares  # few runs ask for them

        put_shares(recovery, about(recovery.setup), shown)
    axes = recovery.setup.asked.axes
    for load in recovery.joints if axes != "world" and "joints" in shown else ():
        put_in_axes(shown["joints"][load.joint.name], axes_at(load.joint, states, axes))
    if shown and recovery.decided is not None:
        recovery.decided.show(states, shown, axes)
    if "energy" in wanted:
        shown["energy"] = recovery.energy
    if "motion" in wanted:
        from heuncli.kinetostatics.attitudes import quaternions  # tables do not show them

        turns = quaternions(layout, recovered)
        shown["bodies"] = {b.name: body_block(states, turns, i) for i, b in enumerate(mechanism.bodies)}
        shown["coordinates"] = coordinates(layout, recovered, states)
        shown["system_vector"] = system_vector(mechanism, states)
    if "points" in wanted:
        shown["points"] = points(mechanism, states)
    if "sections" in wanted:
        shown["sections"] = sections(recovery, SHARES in wanted)
    if "forces" in wanted:
        shown["forces"] = forces(recovery.loads)
    return shown


def asked_blocks(recovery: Recovery, wanted: Set[str]) -> dict[str, Any]:
    """The same, of reports with single entries that are asked for these alone."""
    return chosen(blocks(recovery, wanted), recovery.setup.asked)


def about(setup: Setup) -> Array:
    """The point about which the foundation's moment is taken, world axes."""
    given = setup.spec.foundation.about
    return np.array(given if given is not None else (0.0, 0.0, 0.0))


def certain_sums(recovery: Recovery) -> list[CertainSum]:
    """Sums of indeterminate components that are determined."""
    if recovery.decided is None:
        return []
    return recovery.decided.sums(recovery.setup.runner, recovery.recovered)


def accuracy(recovery: Recovery, kinetic: float = 0.0, struck: float = 0.0, span: float | None = None) -> Accuracy:
    """How well the instants balance: energy where it is asked for, closures, d'Alembert's principle.

    kinetic: the run's largest [J]; struck: the energy that given blows would bring to what nothing holds [J].
    span: how long a run is that was not integrated [s]: there the work is the gain of energy, and powers tell.
    """
    scene, recovered, found = recovery.setup.scene, recovery.recovered, Accuracy()
    mechanism, size = scene.mechanism, scene.layout.size
    if OF_ENERGY & recovery.setup.asked.reports:
        lift = sum(body.mass for body in mechanism.bodies) * float(np.abs(mechanism.gravity).max()) * size + struck
        imbalance = None
        if span is not None:
            imbalance = power_imbalance(scene.layout, recovery.states, recovery.loads, recovery.joints, span)
            lift += magnitude_of_work(mechanism, recovery.loads, size, span)
        found["energy_drift"] = energy_drift(recovery.energy, kinetic, lift, imbalance)
    found["constraint_gap"] = float(recovered.gap.max(initial=0.0))
    found["balance_residual"] = balance_residual(mechanism, recovery.states, recovery.actions, size)
    return found


def body_block(states: BodyStates, turns: Array, i: int) -> Block:
    """Motion of one body."""
    return {
        "position": states.x[:, i],
        "velocity": states.v[:, i],
        "rotation": states.R[:, i],
        "quaternion": turns[:, i],
        "center": states.centre[:, i],
        "center_velocity": states.v_centre[:, i],
        "center_acceleration": states.a_centre[:, i],
        "angular_velocity": states.omega[:, i],
        "angular_acceleration": states.alpha[:, i],
    }


def joint_block(load: JointLoads) -> Block:
    """Reaction of one joint, with its components along and across the axis."""
    block: Block = {"point": load.point, "force": load.force, "moment": load.moment, "open": []}
    if load.drive is not None:
        block["drive"] = load.drive
    if load.axis is not None:
        axial = np.sum(load.force * load.axis, axis=1)
        across = load.force - axial[:, None] * load.axis
        tilting = load.moment - np.sum(load.moment * load.axis, axis=1)[:, None] * load.axis
        block["axial"] = axial
        block["radial"] = np.sqrt(np.sum(across**2, axis=1))
        block["tilting"] = np.sqrt(np.sum(tilting**2, axis=1))
    if load.tension is not None:
        block["tension"] = load.tension
    return block


def stops(joints: Sequence[JointLoads]) -> Block:
    """What each stop exerts ON `to` along its coordinate."""
    return {
        own.stop.name: {"moment" if own.stop.quantity == "angle" else "force": own.value}
        for load in joints
        for own in load.stops
    }


def sections(recovery: Recovery, by_cause: bool = False) -> Block:
    """The blocks of all sections; by_cause: with their shares."""
    scene, states, stress = recovery.setup.scene, recovery.states, recovery.indeterminate
    block: Block = {}
    if not recovery.setup.cuts:
        return block
    # only scenes with sections load it
    from heuncli.kinetostatics.sections import attachments, section

    actions = [*whole_joint_actions(recovery.joints), *recovery.applied]
    for asked in recovery.setup.cuts:
        on = attachments(asked.body, states, actions)
        cuts = asked.laid_for(on)
        is_open: Mapping[str, Mask] = {}
        if stress is not None:
            from heuncli.redundancy.open_components import names_in_section, open_in_section

            is_open = open_in_section(cuts, states, recovery.joints, stress)
        own = section(cuts, states, scene.mechanism.gravity, on, is_open, scene.mechanism.planar)
        block[cuts.name] = own | ({"open": names_in_section(is_open)} if is_open else {})
        if by_cause:
            from heuncli.kinetostatics.section_shares import section_shares

            block[cuts.name]["shares"] = section_shares(cuts, scene.layout, states, recovery.shares, is_open)
    return block


def forces(loads: Sequence[AppliedLoad]) -> Block:
    """Values, lengths, rates and powers of the applied loads."""
    block: Block = {}
    for applied in loads:
        own: Block = {"value": applied.value}
        if isinstance(applied.load, PairLoad):
            own["length"] = applied.length
        if isinstance(applied.load, JointLoad) and applied.load.kind == "turn_spring":
            own["angle"] = applied.length
        if isinstance(applied.load, PairLoad | JointLoad):
            own["rate"] = applied.rate
        block[applied.load.name] = own | {"power": applied.power}
    return block
