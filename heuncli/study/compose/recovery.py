"""Recover from the kernel's solutions at some instants: positions, reactions, verdicts, applied loads, shares, energy.

The module reads as the list of what is computed; each quantity has its own module. Raises SolveError where no
acceleration exists.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.actions import (
    Action,
    AppliedLoad,
    collect_applied_loads,
    list_joint_actions,
    list_whole_joint_actions,
)
from heuncli.loads.kinetostatics.balance import energy_block, find_inertia_scale, find_load_magnitudes, find_magnitudes
from heuncli.loads.kinetostatics.bodies import BodyStates, make_body_states
from heuncli.loads.kinetostatics.couplings import (
    CouplingLoads,
    find_coupling_loads,
    list_coupling_actions,
    list_rope_actions,
)
from heuncli.loads.kinetostatics.reactions import JointLoads, find_joint_loads, select_instants
from heuncli.motion.integration.diagnosis.guide_departures import require_on_sheaves
from heuncli.motion.integration.diagnosis.solvability import require_directions, require_solvable
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.loads import GROUND, PairLoad
from heuncli.results.results import Array, Block, DeterminateSum, Magnitudes, Mask
from heuncli.results.results_schema import IMPULSES, SHARED_BLOCKS, SHARES
from heuncli.study.model.setup import Setup
from heuncli.study.solve.load_errors import ComparedInstants

if TYPE_CHECKING:  # loaded only for closed chains, sections, or loads by cause
    from heuncli.loads.kinetostatics.shares import Shares
    from heuncli.loads.redundancy.resolve import Resolution
    from heuncli.loads.redundancy.self_stress import SelfStress


RANK_REPORTS = SHARED_BLOCKS  # reports that need the rank of the closures
ENERGY_REPORTS = frozenset({"energy", IMPULSES})  # reports that show energies
# properties that do not depend on which components are indeterminate
INDEPENDENT_OF_VERDICTS = frozenset({"states", "kernel_joint_loads", "loads", "energy", "inertia"})
INDEPENDENT_OF_CUTS = INDEPENDENT_OF_VERDICTS | {"resolution", "couplings", "shares"}


@record
class Recovery:
    """The results that follow from the kernel's solutions at some instants; each is computed when it is first used.

    given_actions: actions from outside that are no loads of the mechanism: impulses
    causes: the names of the kernel's columns, where these are not those of the mechanism
    skips_indeterminacy_search: indeterminate components at these instants follow from those on either side
    (study/compose/unknown_numbers.py), and are not searched for
    state_instants: for a state and its perturbed copy, the intermediate results already known
    """

    setup: Setup
    solutions: Evaluation
    least_norm: bool
    given_actions: tuple[Action, ...] = ()
    causes: tuple[str, ...] | None = None
    skips_indeterminacy_search: bool = False
    state_instants: ComparedInstants | None = None

    def with_cuts(self, setup: Setup) -> Recovery:
        """Return the same with the cuts of another setup; what was computed stays."""
        return self._use_computed(replace(self, setup=setup), INDEPENDENT_OF_CUTS)

    def compute_loads(self) -> None:
        """Compute the loads that all cuts need, so that recoveries with other cuts share them."""
        _ = self.loads, self.joints, self.couplings

    def select(self, mask: Mask) -> Recovery:
        """Return the recovery of some of the instants."""
        found: Recovery = replace(self, solutions=self.solutions.select(mask), state_instants=None)
        return found

    def without_indeterminacy_search(self) -> Recovery:
        """Return the same without a search for indeterminate components; what was computed stays."""
        return self._use_computed(replace(self, skips_indeterminacy_search=True), INDEPENDENT_OF_VERDICTS)

    def _use_computed(self, other: Recovery, names: frozenset[str]) -> Recovery:
        """Hand over the properties of these names that are already computed."""
        other.__dict__.update({name: value for name, value in self.__dict__.items() if name in names})
        return other

    @cached_property
    def states(self) -> BodyStates:
        """The positions, velocities and accelerations of the bodies."""
        if self.state_instants is not None:
            return self.state_instants.states.select(slice(0, len(self.solutions.times)))
        return make_body_states(self.setup.scene.layout, self.solutions, self.setup.steady_spin_axes)

    @cached_property
    def resolution(self) -> Resolution | None:
        """What redundant joints leave indeterminate, after the requested split; None without closed chains."""
        layout = self.setup.scene.layout
        if not layout.rows:
            return None
        from heuncli.loads.redundancy.resolve import Resolution, resolve_redundancy  # a tree starts faster without it

        if self.skips_indeterminacy_search:
            return self._add_flanks(Resolution(self.kernel_joint_loads))
        setup = self.setup
        return self._add_flanks(
            resolve_redundancy(
                setup.runner, self.solutions, self.states, self.kernel_joint_loads, self.least_norm, setup.self_stress
            )
        )

    def _add_flanks(self, resolution: Resolution) -> Resolution:
        """Add the loads between the flanks of couplings, after the split."""
        layout = self.setup.scene.layout
        if not layout.mechanism.couplings:
            return resolution
        from heuncli.loads.kinetostatics.couplings import add_separating_forces  # few scenes have gears
        from heuncli.loads.redundancy.indeterminate_components import add_flank_columns

        couplings = self.find_couplings(resolution)
        remaining_stress, stress = (
            None if stress_part is None else add_flank_columns(stress_part, layout, resolution.joints, couplings)
            for stress_part in (resolution.remaining_self_stress, resolution.stress)
        )
        return replace(
            resolution,
            joints=add_separating_forces(layout, resolution.joints, couplings),
            remaining_self_stress=remaining_stress,
            stress=stress,
        )

    @property
    def needs_indeterminacy(self) -> bool:
        """Whether the requested results, or the split of the joints' loads, depend on what redundant joints leave
        indeterminate.
        """
        setup = self.setup
        may_share = bool(setup.model["redundant"] or setup.scene.layout.contacts)
        return may_share or bool(RANK_REPORTS & setup.selection.reports)

    @cached_property
    def joints(self) -> list[JointLoads]:
        """The joints' reactions."""
        if self.resolution is not None:
            return self.resolution.joints
        return self.kernel_joint_loads

    @cached_property
    def requested_joints(self) -> list[JointLoads]:
        """The reactions of the requested joints, and of those that a requested stop belongs to."""
        selection, resolution = self.setup.selection, self.resolution
        is_complete = "joints" not in selection.partial or IMPULSES in selection.reports  # impulses show all joints
        if is_complete or (resolution is not None and resolution.has_marks):
            return self.joints
        mechanism = self.setup.scene.mechanism
        stopped = {
            mechanism.joints[stop.joint].name for stop in mechanism.stops if stop.name in selection.names_in("stops")
        }
        names = selection.names_in("joints") | stopped
        if resolution is not None or self.state_instants is not None or "kernel_joint_loads" in self.__dict__:
            return [load for load in self.joints if load.joint.name in names]
        return find_joint_loads(self.setup.scene.layout, self.solutions, self.states, names)

    @cached_property
    def kernel_joint_loads(self) -> list[JointLoads]:
        """The joints' reactions as the kernel solves them; with redundant joints, one of many possible splits."""
        if self.state_instants is not None and self.state_instants.joints:
            return select_instants(self.state_instants.joints, slice(0, len(self.solutions.times)), self.states)
        return find_joint_loads(self.setup.scene.layout, self.solutions, self.states)

    @cached_property
    def couplings(self) -> list[CouplingLoads]:
        """The loads of couplings."""
        return self.find_couplings(self.resolution) if self.setup.scene.mechanism.couplings else []

    def find_couplings(self, resolution: Resolution | None) -> list[CouplingLoads]:
        """Return the loads of couplings after a split."""
        correction = resolution.added_multipliers if resolution is not None else None
        found = find_coupling_loads(self.setup.scene.layout, self.solutions, self.states)
        return [own.add_multipliers(correction).with_friction(self.applied_actions) for own in found]

    @cached_property
    def loads(self) -> list[AppliedLoad]:
        """The applied loads. Of a spring whose points coincide, the rate is that at which they separate: its line
        begins there.
        """
        found = collect_applied_loads(self.setup.scene.mechanism, self.states, self.solutions)
        if self.setup.scene.layout.friction_contacts:
            from heuncli.loads.redundancy.shared_friction import mark_values  # few scenes have such friction

            found = mark_values(self.setup.scene.layout, self.solutions, found)
        if not any(isinstance(own.load, PairLoad) and (own.length == 0.0).any() for own in found):
            return found
        # hardly any scene needs it
        from heuncli.motion.integration.diagnosis.ambiguous_laws import find_separation_velocity

        layout, solutions = self.setup.scene.layout, self.solutions
        return [
            replace(
                own,
                rate=np.where(
                    own.length == 0.0,
                    compute_vector_magnitudes(find_separation_velocity(layout, own.load, solutions)),
                    own.rate,
                ),
            )
            if isinstance(own.load, PairLoad)
            else own
            for own in found
        ]

    @cached_property
    def shares(self) -> Shares:
        """The joints' loads by their causes, after the same split; for solutions with causes."""
        from heuncli.loads.kinetostatics.couplings import add_separating_forces
        from heuncli.loads.kinetostatics.shares import (  # few runs ask for them
            find_cause_columns,
            find_shares,
            make_cause_action,
        )

        layout = self.setup.scene.layout
        own = None if self.causes is None else {name: [k] for k, name in enumerate(self.causes)}
        members = find_cause_columns(layout.mechanism) if own is None else own
        found = find_shares(layout, self.solutions, self.states, self.law_actions, members)
        if self.resolution is None:
            return found
        joints, correction = self.resolution.apply_choices(found.joints, self.states)
        friction_shares = [make_cause_action(found, action) for action in found.applied_actions]
        couplings = [own.add_multipliers(correction).with_friction(friction_shares) for own in found.couplings]
        return replace(found, joints=add_separating_forces(layout, joints, couplings), couplings=couplings)

    @property
    def applied_actions(self) -> list[Action]:
        """The actions of the applied loads, and the given ones."""
        return [*(load.action for load in self.loads), *self.given_actions]

    @property
    def law_actions(self) -> list[Action]:
        """The actions of all laws: the applied ones, and those of elastic ropes."""
        return [*self.applied_actions, *list_rope_actions(self.couplings)]

    @cached_property
    def actions(self) -> list[Action]:
        """All actions on the bodies except their weight; a joint's constraint and drive are one action."""
        may_differ = self.needs_indeterminacy or self.setup.scene.mechanism.couplings
        joints = list_whole_joint_actions(self.joints if may_differ else self.kernel_joint_loads)
        return [*self.applied_actions, *joints, *list_coupling_actions(self.couplings)]

    @property
    def separate_actions(self) -> list[Action]:
        """The same with each joint's constraint, drive and stops separate: those on the ground may be foundation
        elements.
        """
        return [*self.applied_actions, *list_joint_actions(self.joints), *list_coupling_actions(self.couplings)]

    @property
    def ground_actions(self) -> list[Action]:
        """The separate actions without those of joints between bodies, of which a foundation needs `inner_forces`
        alone.
        """
        joints = [load for load in self.joints if GROUND in (load.joint.a, load.joint.b)]
        return [*self.applied_actions, *list_joint_actions(joints), *list_coupling_actions(self.couplings)]

    @property
    def inner_forces(self) -> list[Array]:
        """The forces of constraints and stops in joints between bodies, (n_t, 3) each."""
        joints = [load for load in self.joints if GROUND not in (load.joint.a, load.joint.b)]
        return [force for load in joints for force in (load.force, *(stop.force for stop in load.stops))]

    @cached_property
    def energy(self) -> Block:
        """Kinetic and potential energy, and work."""
        return energy_block(self.setup.scene.layout, self.solutions, self.states)

    @cached_property
    def magnitudes(self) -> Magnitudes:
        """The magnitudes of the terms that results are sums of; rounding errors follow from these."""
        scene = self.setup.scene
        energy = self.energy if ENERGY_REPORTS & self.setup.selection.reports else {}
        return find_magnitudes(scene.mechanism, self.states, self.inertia, self.actions, energy, scene.layout.size)

    @cached_property
    def load_magnitudes(self) -> Magnitudes:
        """The part of the magnitudes that errors of loads depend on."""
        return find_load_magnitudes(self.states, self.inertia, self.actions, self.setup.scene.layout.size)

    @cached_property
    def inertia(self) -> Array:
        """The largest inertia load or weight of each body, (n_t, n) [N]."""
        return find_inertia_scale(self.setup.scene.mechanism, self.states)

    @property
    def generic_self_stress_count(self) -> Array:
        """The largest number of self-stresses at each instant outside singular poses, (n_t,).

        Those of the start, and one more for each contact that has closed since.
        """
        layout = self.setup.scene.layout
        own, start_holding = slice(len(layout.contacts)), layout.open_followers(self.setup.runner.start_holding)
        newly_closed = (self.solutions.holding[:, own] > 0.0) & ~(start_holding[own] > 0.0)
        return np.asarray(self.setup.model["redundant"] + newly_closed.sum(axis=1))

    def describe_singular_poses(self) -> list[str]:
        """Return sentences on instants at singular poses, or close to them, where the results depend on it."""
        if not self.needs_indeterminacy or self.resolution is None:
            return []
        return self.resolution.describe_singular_poses(
            self.setup.runner, self.solutions, self.states, self.generic_self_stress_count
        )

    @property
    def indeterminate(self) -> SelfStress | None:
        """The self-stresses that no split has resolved."""
        return self.resolution.remaining_self_stress if self.resolution is not None else None


def compute_vector_magnitudes(velocities: Array) -> Array:
    """Return the magnitudes of vectors (n_t, 3)."""
    return np.asarray(np.sqrt(np.sum(velocities**2, axis=-1)))


def recover(
    setup: Setup, solutions: Evaluation, least_norm: bool, state_instants: ComparedInstants | None = None
) -> Recovery:
    """Make the recovery of the kernel's solutions. Raises SolveError where no acceleration exists.

    state_instants: see `Recovery`
    """
    if state_instants is None:  # otherwise it was checked before
        require_solvable(setup.scene, solutions)
        require_on_sheaves(setup.scene.layout, solutions)
        require_directions(setup.scene, solutions)
    found = Recovery(setup, solutions, least_norm, state_instants=state_instants)
    if setup.scene.mechanism.joint_friction and found.resolution is not None:
        from heuncli.loads.redundancy.indeterminate_components import require_determinate_friction  # few scenes need it

        require_determinate_friction(
            setup.scene.layout, found.resolution.found_self_stress, found.states, solutions.times
        )
    if setup.scene.layout.friction_contacts:
        from heuncli.loads.redundancy.shared_friction import require_no_split  # few scenes need it

        splits = least_norm or any(joint.stiffness is not None for joint in setup.scene.mechanism.joints)
        if splits or SHARES in setup.selection.reports:
            what = "a split by stiffness or least norm" if splits else "a share by cause"
            require_no_split(setup.scene.layout, solutions, what)
    return found


def find_determinate_sums(recovery: Recovery) -> list[DeterminateSum]:
    """Return the sums of indeterminate components that are determinate."""
    layout = recovery.setup.scene.layout
    sums: list[DeterminateSum] = []
    if layout.friction_contacts:
        from heuncli.loads.redundancy.shared_friction import find_friction_sums  # few scenes have such friction

        sums = find_friction_sums(layout, recovery.solutions)
    if recovery.resolution is None:
        return sums
    return sums + recovery.resolution.find_sums(recovery.setup.runner, recovery.solutions, recovery.couplings)
