"""Collect the differences of loads between runs: of reactions, couplings, sensors, foundation, sections and forces.

error_estimates.py says how errors follow from them, and motion_errors.py adds those of the motion and its energy.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import reduce

import numpy as np

from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.kinetostatics.actions import (
    Action,
    AppliedLoad,
    collect_applied_loads,
    list_joint_actions,
    list_whole_joint_actions,
)
from heuncli.loads.kinetostatics.bodies import BodyStates, KernelBodyStates, make_body_states
from heuncli.loads.kinetostatics.coupling_numbers import collect_by_quantity
from heuncli.loads.kinetostatics.couplings import (
    CouplingLoads,
    find_coupling_loads,
    list_coupling_actions,
    list_rope_actions,
)
from heuncli.loads.kinetostatics.foundation import find_central_axis, find_ground_loads, sum_ground_loads
from heuncli.loads.kinetostatics.reactions import JointLoads, find_joint_loads, project_to_plane, rotate_joint_loads
from heuncli.motion.integration.diagnosis.guide_departures import require_on_sheaves
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.model import Joint
from heuncli.results.path_words import BY_CAUSE
from heuncli.results.results import Array, Mask
from heuncli.scene.shapes.rotations import cross_rows
from heuncli.study.model.setup import Setup
from heuncli.study.solve.error_estimates import (
    ESTIMATED,
    BalanceTerms,
    Weights,
    compute_lengths,
    compute_norms,
)
from heuncli.study.solve.motion_errors import MotionErrors

ROW_CHANGE = 1e-6  # relative to the largest multiplier: a change of the chosen rows changes indeterminate loads by more
CUTS_AT_ONCE = 200_000  # instants times cuts whose loads are compared together
BLOCK = 8  # instants are compared in whole blocks of so many, as BLAS has them

Quantity = tuple[str, Array]  # name, a key of error_estimates.UNITS, and the couplings' values (n, k, 3) or (n, k, 1)


def iter_coupling_results(
    couplings: Sequence[CouplingLoads], applied_actions: Sequence[Action], joints: Sequence[Joint], states: BodyStates
) -> Iterator[tuple[str, Array]]:
    """Yield all compared results of couplings, which are more than their loads on the bodies.

    A rope turns its drum by a moment about its centre, though no strand exerts one where it leaves the drum. The
    contact point of a wheel moves over its rim. In a sum of wheel speeds with factors of a tenth, the coupling carries
    ten times the torque.

    applied_actions: loads, some of which belong to couplings, as the pretension of belts does
    """
    for coupling in couplings:
        own_loads = [
            action for action in applied_actions if coupling.coupling.has_load and action.name == coupling.coupling.name
        ]
        body_loads = coupling.body_loads(own_loads).values()
        for name, values in zip(("place", "force", "moment"), zip(*body_loads, strict=True), strict=True):
            yield name, np.stack(values, axis=1)
        for name, parts in collect_by_quantity(coupling, joints, states).items():
            yield name, np.stack(parts, axis=1)[..., None]


class ComparedInstants(NamedTuple):
    """Intermediate results of the instants whose errors were computed: the bodies' states, and the joint loads."""

    states: KernelBodyStates
    joints: tuple[JointLoads, ...] = ()


class LoadErrors(MotionErrors):
    """The differences of a motion's loads and energy between runs, for the kinds that are requested.

    add: adds instants; estimate, errors: return what follows from those added so far
    """

    def __init__(
        self, setup: Setup, by_cause: bool = False, weights: Weights = ESTIMATED, *, keep_instants: bool = False
    ) -> None:
        """keep_instants: store the intermediate results of the instants, which would be large for a whole run"""
        super().__init__(setup, weights)
        self.keep_instants, self.by_cause = keep_instants, by_cause
        self.last: ComparedInstants | None = None  # results of the instants that were added last

    def add(self, solutions: Evaluation, is_requested: Mask, is_claimed: Mask) -> None:
        """Add instants, each with the solution of the first run, then of the others.

        is_requested, is_claimed (n,): which of them are requested, and which are before the horizon
        """
        count = len(solutions.times) // max(len(is_requested), 1)
        # with other closure rows, indeterminate loads differ by more than their error: such instants are left out,
        # unless all are so
        same = (
            find_equal_rows(solutions, count)
            if self.setup.model["redundant"]
            else np.ones(len(is_requested), dtype=bool)
        )
        if same.any() and not same.all():
            solutions, is_requested, is_claimed = (
                solutions.select(np.repeat(same, count)),
                is_requested[same],
                is_claimed[same],
            )
        chunk_size = self.choose_chunk_size(count)
        if chunk_size >= len(is_requested):
            self.add_chunk(solutions, is_requested, is_claimed)
            return
        for i in range(0, len(is_requested), chunk_size):
            part = slice(i, i + chunk_size)
            self.add_chunk(solutions.select(slice(count * i, count * part.stop)), is_requested[part], is_claimed[part])

    def choose_chunk_size(self, count: int) -> int:
        """Return how many instants of `count` runs are compared together: cuts may need more memory than all else."""
        cuts = sum(len(cuts.side) for cuts in self.setup.cuts)
        return BLOCK * max(1, CUTS_AT_ONCE // (BLOCK * count * cuts + 1))

    def add_chunk(self, solutions: Evaluation, is_requested: Mask, is_claimed: Mask) -> None:
        """Add instants that are solved with the same closure rows in all runs."""
        self.is_requested, self.is_claimed = is_requested, is_claimed
        require_on_sheaves(self.setup.scene.layout, solutions, has_all_steps=True)
        states = make_body_states(self.setup.scene.layout, solutions)
        self.last = ComparedInstants(states) if self.keep_instants else None
        loads = collect_applied_loads(self.setup.scene.mechanism, states, solutions)
        if self.compared & {"reactions", "foundation", "sections", "forces"}:
            self.add_loads(solutions, states, loads)
        if "energy" in self.compared:
            self.add_energy(solutions, states)
        if "motion" in self.compared:
            self.add_motion(solutions, states)

    def add_loads(self, solutions: Evaluation, states: KernelBodyStates, loads: Sequence[AppliedLoad]) -> None:
        """Add loads of all kinds."""
        joints = find_joint_loads(self.setup.scene.layout, solutions, states)
        self.last = ComparedInstants(states, tuple(joints)) if self.keep_instants else None
        terms = BalanceTerms(self.setup, solutions, states, loads)
        applied = [load.action for load in loads]
        couplings = find_coupling_loads(self.setup.scene.layout, solutions, states)
        coupling_loads_on_bodies = list_coupling_actions(couplings)
        if couplings:
            from heuncli.loads.kinetostatics.couplings import add_separating_forces  # few scenes have gears

            joints = add_separating_forces(self.setup.scene.layout, joints, couplings)
        acting = [*applied, *coupling_loads_on_bodies]
        if "reactions" in self.compared:
            coupling_results: Sequence[Quantity] = ()
            if couplings:
                coupling_results = [
                    *iter_coupling_results(couplings, applied, self.setup.scene.mechanism.joints, states)
                ]
            self.add_joints(
                [rotate_joint_loads(load, states, self.setup.selection.axes) for load in joints],
                coupling_results,
                terms,
            )
            self.add_moved_reactions(states, joints, acting, terms)
        if "foundation" in self.compared:
            self.add_foundation(states, [*acting, *list_joint_actions(joints)], terms)
        if self.setup.cuts and "sections" in self.compared:
            self.add_sections(states, [*list_whole_joint_actions(joints), *acting], terms)
        if "forces" in self.compared:
            self.add_forces(loads, terms)
        if self.by_cause:
            from heuncli.study.solve.cause_shares import iter_compared_shares  # few runs need them

            pushing = [*applied, *list_rope_actions(couplings)]
            for kind, name, values, factor in iter_compared_shares(
                self.setup, solutions, states, pushing, self.compared, terms
            ):
                F, M = (rounding * factor for rounding in terms.rounding)
                rounding, magnitude = (M, terms.moment * factor) if name == "moment" else (F, terms.force * factor)
                self.add_values((f"{kind} {BY_CAUSE}", name), values, rounding, magnitude)

    def add_forces(self, loads: Sequence[AppliedLoad], terms: BalanceTerms) -> None:
        """Add applied loads, their power and their strains."""
        F, M = terms.rounding
        for load in loads:
            self.add_values(("forces", "N"), load.action.force, F, terms.force)
            self.add_values(("forces", "N·m"), load.action.moment, M, terms.moment)
            zeros = np.zeros(len(F))
            self.add_values(("forces", "W"), load.power, zeros, terms.force)
            if load.strain is not None:
                self.add_values(("strains", "m"), load.strain[:, 0], zeros, zeros)
                self.add_values(("strains", "rad"), load.strain[:, 1], zeros, zeros)

    def add_joints(
        self, joints: Sequence[JointLoads], coupling_results: Sequence[Quantity], terms: BalanceTerms
    ) -> None:
        """Add reactions in the axes in which they are shown, including those of couplings, and drives."""
        F, M = terms.rounding
        if joints:
            self.add_values(("reactions", "force"), np.stack([x.force for x in joints], axis=1), F, terms.force)
            self.add_values(("reactions", "moment"), np.stack([x.moment for x in joints], axis=1), M, terms.moment)
        zeros = np.zeros(len(F))
        if joints and (coupling_results or any(JOINTS[load.joint.kind].follows_path for load in joints)):
            self.add_values(("reactions", "place"), np.stack([x.point for x in joints], axis=1), zeros, zeros)
        terms_by_name = {
            "force": (F, terms.force),
            "moment": (M, terms.moment),
            "place": (zeros, zeros),
            "angle": (zeros, zeros),
        }
        for name, values in coupling_results:
            self.add_values(("reactions", name), values, *terms_by_name[name])
        for load in joints:
            if load.drive is not None and load.joint.drive is not None:
                turns = load.joint.drive.quantity == "angle"
                rounding, largest_term = (M, terms.moment) if turns else (F, terms.force)
                self.add_values(("drives", "torque" if turns else "thrust"), load.drive, rounding, largest_term)

    def add_moved_reactions(
        self, states: BodyStates, joints: Sequence[JointLoads], acting: Sequence[Action], terms: BalanceTerms
    ) -> None:
        """Add the loads of the bearings of joints, and what sensors read."""
        if not self.setup.sensors and all(load.joint.bearings is None for load in joints):
            return
        # few scenes have them
        from heuncli.loads.kinetostatics.moved_reactions import find_sensor_reaction, iter_bearing_terms

        F, M = terms.rounding
        for values, by_force, by_moment in iter_bearing_terms(joints):
            largest_term = by_force * terms.force + by_moment * terms.moment
            self.add_values(("bearings", "force"), values, by_force * F + by_moment * M, largest_term)
        mechanism = self.setup.scene.mechanism
        for sensor in self.setup.sensors:
            reaction = find_sensor_reaction(sensor, mechanism, self.setup.cuts, states, joints, acting)
            force, moment = sensor.read(states, reaction, mechanism.planar)
            # a component of d x F is a sum of two products: the largest component of d alone would be too little
            lever = np.abs(sensor.find_lever(states, reaction.origin)).sum(axis=1)
            self.add_values(("sensors", "force"), force, F, terms.force)
            self.add_values(("sensors", "moment"), moment, M + lever * F, terms.moment + lever * terms.force)

    def add_foundation(self, states: BodyStates, actions: Sequence[Action], terms: BalanceTerms) -> None:
        """Add the total of the foundation, its elements and the mass effects.

        The orbital and the spin part of a rolling wheel may have opposite errors: each is shown, so each is compared.
        The parts of an element are compared as they are shown, summed about the point of the first: a rope pulls at
        the ground by its drum and by sheaves that are far from it.
        """
        mechanism, origin = self.setup.scene.mechanism, self.setup.moment_point
        arm = states.centre - origin
        self.reach = max(self.reach, float(np.abs(arm).max()))
        # a component of d x F is a sum of two products: the largest component of d alone would be too little
        reach = np.abs(arm).sum(axis=2).max(axis=1)
        moments = terms.moment + reach * terms.force
        forces_rounding, moments_rounding = terms.rounding
        elements = [load for (kind, _), load in find_ground_loads(mechanism, actions).items() if kind == "elements"]
        total_wrench = sum_ground_loads(states, terms.weight - terms.ma, terms.spin, actions, origin)
        self.add_axis(*total_wrench)
        wrenches = [
            ("foundation", *total_wrench, reach),
            ("effects", terms.ma.sum(axis=1), np.sum(cross_rows(arm, terms.ma), axis=1), reach),
            ("effects", terms.ma.sum(axis=1), terms.spin.sum(axis=1), reach),
            *(("elements", *load[:2], reach + np.abs(load.point - origin).sum(axis=1)) for load in elements),
        ]
        for kind, force, moment, lever in wrenches:
            F, M = project_to_plane(force, moment) if mechanism.planar else (force, moment)
            self.add_values((kind, "force"), F, forces_rounding, terms.force)
            self.add_values((kind, "moment"), M, moments_rounding + lever * forces_rounding, moments)

    def add_axis(self, force: Array, moment: Array) -> None:
        """Add the central axis of the wrench at the requested instants: where the force is small, its error is far
        larger.
        """
        count = len(force) // len(self.is_requested)
        is_requested = np.repeat(self.is_requested, count)
        axis = find_central_axis(force[is_requested], moment[is_requested], self.setup.moment_point, 0.0)
        for unit, values in (("1", axis["direction"]), ("m", axis["point"]), ("m", axis["pitch"][:, None])):
            first_run = values[0::count]
            difference = np.max(
                [compute_norms((first_run - values[k::count])[:, None])[:, 0] for k in range(1, count)], axis=0
            )
            self.find_extent("axis", unit).add_difference(np.nan_to_num(difference), self.is_claimed[self.is_requested])

    def add_sections(self, states: BodyStates, actions: Sequence[Action], terms: BalanceTerms) -> None:
        """Add the cuts' loads in body axes, and the difference of the bodies' own orientation between the runs."""
        from heuncli.loads.kinetostatics.piece_loads import (  # only scenes with sections load it
            find_acceleration_matrix,
            find_attachments,
            find_piece_loads,
        )

        gravity = self.setup.scene.mechanism.gravity
        for cuts in self.setup.cuts:
            attached = find_attachments(cuts.body, states, actions)
            force, moment = find_piece_loads(cuts, find_acceleration_matrix(cuts.body, states, gravity), attached)
            R = states.R[:, cuts.body]
            count = len(R) // len(self.is_requested)
            first_run = R[0::count]
            turned = reduce(
                np.maximum, [np.sqrt(np.sum((first_run - R[k::count]) ** 2, axis=(1, 2))) for k in range(1, count)]
            )
            F, M = terms.rounding
            for quantity, values, rounding, magnitude in (
                ("force", force, F, terms.force), ("moment", moment, M, terms.moment),
            ):  # fmt: skip
                instants_first = values.transpose(1, 2, 0)
                turn_difference = turned * compute_lengths(instants_first[0::count])
                self.add_values(("sections", quantity), instants_first, rounding, magnitude, turn_difference)


def find_equal_rows(solutions: Evaluation, count: int) -> Mask:
    """Mark the instants that all of `count` runs solve with the same closure rows, (n,); other rows have no multiplier.

    A row with multiplier zero in one run and almost zero in another counts as chosen in both.
    """
    size = np.abs(solutions.rows["multiplier"])
    is_zero, first_run = size == 0.0, slice(0, None, count)
    same = np.ones(len(solutions.times) // count, dtype=bool)
    for k in range(1, count):
        other = slice(k, None, count)
        larger = np.maximum(size[first_run], size[other])
        is_large = larger > ROW_CHANGE * larger.max(axis=1, initial=0.0)[:, None]
        same &= ~((is_zero[first_run] != is_zero[other]) & is_large).any(axis=1)
    return same
