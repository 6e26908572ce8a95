"""Handle what redundant joints leave indeterminate: a split where one is chosen, marked components, determinate
sums.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.bodies import BodyStates, make_body_states
from heuncli.loads.kinetostatics.coupling_numbers import list_multiples
from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.loads.kinetostatics.foundation import ElementKeys
from heuncli.loads.kinetostatics.reactions import JointLoads, find_joint_axes, rotate_shares
from heuncli.loads.redundancy.determinate_sums import find_determinate_sums
from heuncli.loads.redundancy.indeterminate_components import (
    find_indeterminate_wrench,
    is_coordinate_indeterminate,
    list_indeterminate_names,
    mark_coupling,
    mark_ground_load,
    mark_joint,
    mask_indeterminate,
    select_coordinate_share,
)
from heuncli.loads.redundancy.self_stress import (
    CachedStress,
    RankMargins,
    SelfStress,
    find_margins,
    find_neighbour_poses,
    find_self_stress,
)
from heuncli.loads.redundancy.split import SelfStressChoice, apply_choices, split_self_stress
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.integration.run.runner import Runner
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.results.results import Array, Block, DeterminateSum, Indices

SUM_INSTANTS = 9  # instants whose self-stresses give the determinate sums


@record
class Resolution:
    """The joints' loads after a split of what redundancy leaves indeterminate.

    sentences: sentences on the split
    stress: the self-stresses that it chose from; None if there are none
    remaining_self_stress: those that it left indeterminate; None if there are none
    choices: the self-stresses that were added
    added_multipliers: what the split adds to the multipliers of the closure rows, (n_t, rows)
    found_self_stress: all self-stresses found before it, also where there are none; None if they were not looked for
    """

    joints: list[JointLoads]
    sentences: tuple[str, ...] = ()
    stress: SelfStress | None = None
    remaining_self_stress: SelfStress | None = None
    choices: tuple[SelfStressChoice, ...] = ()
    added_multipliers: Array | None = None
    found_self_stress: SelfStress | None = None

    def apply_choices(self, joints: list[JointLoads], states: BodyStates) -> tuple[list[JointLoads], Array | None]:
        """Apply the same split to other loads of the joints, such as shares by cause; also return what it adds to
        multipliers.
        """
        return apply_choices(self.choices, joints, states)

    def describe_singular_poses(
        self, runner: Runner, evaluation: Evaluation, states: BodyStates, redundant: Array
    ) -> list[str]:
        """Return sentences on instants with more self-stresses than `redundant`, or nearly so."""
        stress = self.found_self_stress
        if stress is None:
            return []
        margins = stress.margins or find_margins(runner, evaluation, states)
        return describe_singular_poses(stress.count, margins, evaluation.times, redundant)

    @property
    def has_marks(self) -> bool:
        """Whether `mark` marks anything."""
        return self.remaining_self_stress is not None or bool(self.sentences)

    def mark(
        self, states: BodyStates, blocks: Block, couplings: Sequence[CouplingLoads], axes: str, keys: ElementKeys
    ) -> None:
        """Mark in all blocks what is indeterminate, or was until a split was chosen, in place.

        axes: in which the joints' loads are reported
        keys: of loads on the ground (loads/kinetostatics/foundation.py)
        """
        reactions = blocks.get("joints")
        if self.remaining_self_stress is not None:
            mark_joints(self.remaining_self_stress, self.joints, states, blocks, axes, keys)
            mark_couplings(self.remaining_self_stress, couplings, blocks, keys)
        if self.sentences and self.stress is not None and reactions is not None:
            mark_chosen(self.stress, self.joints, states, reactions, axes)

    def find_sums(
        self, runner: Runner, evaluation: Evaluation, couplings: Sequence[CouplingLoads] = ()
    ) -> list[DeterminateSum]:
        """Find the determinate sums of indeterminate components."""
        return (
            find_sums(runner, evaluation, self.joints, couplings, self.remaining_self_stress)
            if self.remaining_self_stress is not None
            else []
        )


def resolve_redundancy(
    runner: Runner,
    evaluation: Evaluation,
    states: BodyStates,
    joints: list[JointLoads],
    least_norm: bool,
    cached_stress: CachedStress | None = None,
) -> Resolution:
    """Find the self-stresses and apply the requested split; cached_stress: those of poses that may be the same."""
    stress = find_self_stress(runner, evaluation, states, cached_stress)
    if stress is None or not stress.count.any():
        return Resolution(joints, found_self_stress=stress)
    chosen_split = split_self_stress(joints, states, stress, least_norm)
    return Resolution(
        joints=chosen_split.joints, sentences=chosen_split.sentences, stress=chosen_split.initial_stress,
        remaining_self_stress=chosen_split.remaining_stress, choices=chosen_split.choices,
        added_multipliers=chosen_split.added_multipliers, found_self_stress=stress,
    )  # fmt: skip


def describe_singular_poses(count: Array, margins: RankMargins, times: Array, redundant: Array) -> list[str]:
    """Describe where the rank of the closures drops below the generic one, and where it comes close to that.

    count, redundant (n_t,): numbers of self-stresses, and outside singular poses
    """
    sentences = []
    extra_instants = np.flatnonzero(count > redundant)
    if len(extra_instants):
        times_text = ", ".join(f"{t:.6g}" for t in times[extra_instants[:5]]) + (
            " ..." if len(extra_instants) > 5 else ""
        )
        when = "this instant" if len(extra_instants) == 1 else "these instants"
        sentences.append(f"singular position at t = {times_text} s: some components are indeterminate at {when} only")
    near_values = np.where(count <= redundant, margins.largest_dropped, 0.0)
    if near_values.max(initial=0.0) > tolerances.NEARLY_DEPENDENT:
        sentences.append(
            f"some joint constraints depend on others only to within {near_values.max():.1e}: treated as "
            "redundant; exactly as specified they would remove one more degree of freedom"
        )
    least = margins.smallest_kept
    near_instants = np.flatnonzero((least < tolerances.NEARLY_SINGULAR) & (count <= redundant))
    if len(near_instants):
        k = near_instants[int(np.argmin(least[near_instants]))]
        sentences.append(
            f"nearly singular position at t = {times[k]:.6g} s (smallest singular value {least[k]:.1e}): "
            "reactions and their errors grow without bound there"
        )
    return sentences


def mark_joints(
    stress: SelfStress, joints: Sequence[JointLoads], states: BodyStates, blocks: Block, axes: str, keys: ElementKeys
) -> None:
    """Mark the indeterminate components of joints, stops and loads on the ground, in place."""
    foundation_block = blocks.get("foundation", {})
    supports, elements = foundation_block.get("supports", {}), foundation_block.get("elements", {})
    for load, joint_share in zip(joints, stress.shares, strict=True):
        share, free_share = load.split_wrenches(states, joint_share)
        if "joints" in blocks:
            block, joint_axes = blocks["joints"][load.joint.name], find_joint_axes(load.joint, states, axes)
            mark_joint(block, load, (share, free_share), stress, joint_axes)
        if load.joint.name in supports:
            mark_ground_load(supports[load.joint.name], share, stress)
        drive = load.joint.drive
        for stop_load in load.stops:
            is_touched = np.any(stop_load.unit != 0.0, axis=1)  # other stops of the joint may be
            stop, stop_share = stop_load.stop, np.where(is_touched[:, None, None], free_share, 0.0)
            if (element := elements.get(keys.get(("stops", stop.name), ""))) is not None:
                mark_ground_load(element, select_coordinate_share(stop_share, stop.quantity), stress)
            if stop.name in blocks.get("stops", {}):
                block = blocks["stops"][stop.name]
                is_open = is_coordinate_indeterminate(stop.quantity, stop_share, stress)
                block |= {name: mask_indeterminate(value, is_open) for name, value in block.items()}
        if drive is None or load.drive is None or load.axis is None:
            continue
        if (element := elements.get(keys.get(("drives", drive.name), ""))) is not None:
            mark_ground_load(element, select_coordinate_share(free_share, drive.quantity), stress)


def mark_couplings(stress: SelfStress, couplings: Sequence[CouplingLoads], blocks: Block, keys: ElementKeys) -> None:
    """Mark the indeterminate components of couplings, and of their loads on the ground, in place."""
    elements = blocks.get("foundation", {}).get("elements", {})
    for loads in couplings:
        name = loads.coupling.name
        if name in blocks.get("couplings", {}):
            mark_coupling(blocks["couplings"][name], loads, stress)
        if (element := elements.get(keys.get(("couplings", name), ""))) is not None:
            stress_loads = [loads.with_multipliers(stress.multipliers[:, :, k]) for k in range(stress.largest.shape[1])]
            shares = [np.concatenate(own.body_loads()[GROUND][1:], axis=1) for own in stress_loads]
            mark_ground_load(element, np.stack(shares, axis=-1), stress)


def mark_chosen(
    stress: SelfStress, joints: Sequence[JointLoads], states: BodyStates, reactions: Block, axes: str
) -> None:
    """Name the components that were indeterminate before a split was chosen, in place."""
    for load, joint_share in zip(joints, stress.shares, strict=True):
        share = rotate_shares(load.split_wrenches(states, joint_share)[0], find_joint_axes(load.joint, states, axes))
        force, moment = find_indeterminate_wrench(stress, share)
        names = list_indeterminate_names({"force": force, "moment": moment})
        if names:
            reactions[load.joint.name]["chosen"] = names


class OpenComponent(NamedTuple):
    """An indeterminate component: its path, its values (n_t,), and its shares of every self-stress.

    in_poses (poses, k): where sums must hold
    at_instants (n_t, k): at the requested instants
    """

    path: str
    values: Array
    in_poses: Array
    at_instants: Array


def find_sums(
    runner: Runner,
    evaluation: Evaluation,
    joints: Sequence[JointLoads],
    couplings: Sequence[CouplingLoads],
    stress: SelfStress,
) -> list[DeterminateSum]:
    """Find determinate sums of indeterminate components, valid at the requested instants and in neighbouring poses."""
    selected = np.unique(np.linspace(0, len(evaluation.times) - 1, SUM_INSTANTS).astype(int))
    neighbour_stress = find_neighbour_stress(runner, evaluation, joints)
    stress = select_constraint_shares(stress, joints, make_body_states(runner.layout, evaluation))
    components = [
        *iter_joint_components(joints, stress, neighbour_stress, selected),
        *iter_coupling_components(couplings, stress, neighbour_stress, selected),
    ]
    return find_determinate_sums(
        {own.path: own.in_poses for own in components}, {own.path: own.at_instants for own in components},
        {own.path: own.values for own in components}, stress.length,
    )  # fmt: skip


def find_neighbour_stress(runner: Runner, evaluation: Evaluation, joints: Sequence[JointLoads]) -> SelfStress | None:
    """Find the self-stresses of poses next to the first one; None where there are none, or a stiffness splits loads.

    What a stiffness leaves indeterminate is known only at the requested instants.
    """
    poses = find_neighbour_poses(
        runner, float(evaluation.times[0]), evaluation.states[0], tolerances.SUM_POSES, evaluation.holding[0]
    )
    if poses is None or any(load.joint.stiffness is not None for load in joints):
        return None
    states = make_body_states(runner.layout, poses)
    stress = find_self_stress(runner, poses, states)
    return select_constraint_shares(stress, joints, states) if stress is not None else None


def iter_joint_components(
    joints: Sequence[JointLoads], stress: SelfStress, neighbour_stress: SelfStress | None, selected: Indices
) -> Iterator[OpenComponent]:
    """Yield the indeterminate components of joints; selected: the instants at which sums must hold."""
    is_indeterminate = [
        np.concatenate(find_indeterminate_wrench(stress, share), axis=1).any(axis=0) for share in stress.shares
    ]
    joint_numbers, component = np.nonzero(np.reshape(is_indeterminate, (-1, 6)))
    at_instants = find_relative_shares(stress, joint_numbers, component)
    in_poses = at_instants[:, selected]
    if neighbour_stress is not None:
        in_poses = concatenate_shares(in_poses, find_relative_shares(neighbour_stress, joint_numbers, component))
    for n, (k, i) in enumerate(zip(joint_numbers.tolist(), component.tolist(), strict=True)):
        load = joints[k]
        path = f"joints.{load.joint.name}.{'force' if i < 3 else 'moment'}.{'xyz'[i % 3]}"
        values = (load.force if i < 3 else load.moment)[:, i % 3]
        yield OpenComponent(path, values, in_poses[n], at_instants[n])


def iter_coupling_components(
    couplings: Sequence[CouplingLoads], stress: SelfStress, neighbour_stress: SelfStress | None, selected: Indices
) -> Iterator[OpenComponent]:
    """Yield the indeterminate numbers of couplings that are multiples of a multiplier; selected: as of joints."""
    for loads, number in ((own, number) for own in couplings for number in list_multiples(own)):
        r = loads.rows[number.rows[0]]
        at_instants = number.factor * find_relative_multipliers(stress, r)
        if np.abs(at_instants).max(initial=0.0) * stress.coupling_scale[r] <= tolerances.OPEN_SHARE:
            continue
        in_poses = at_instants[:, selected]
        if neighbour_stress is not None:
            in_poses = concatenate_shares(in_poses, number.factor * find_relative_multipliers(neighbour_stress, r))
        path = f"couplings.{loads.coupling.name}.{number.name}"
        yield OpenComponent(path, number.values, in_poses[0], at_instants[0])


def find_relative_multipliers(stress: SelfStress, r: int) -> Array:
    """Return for every self-stress the multiplier of a closure row, relative to its largest share, (1, n_t, k)."""
    return np.asarray(stress.multipliers[None, :, r] / np.where(stress.largest > 0.0, stress.largest, 1.0))


def select_constraint_shares(stress: SelfStress, joints: Sequence[JointLoads], states: BodyStates) -> SelfStress:
    """Return the self-stresses with their shares in the joints' constraints alone, without those in drives and
    stops.
    """
    shares = [
        load.split_wrenches(states, joint_share)[0] for load, joint_share in zip(joints, stress.shares, strict=True)
    ]
    result: SelfStress = replace(stress, shares=np.reshape(shares, stress.shares.shape))
    return result


def find_relative_shares(stress: SelfStress, joints: Indices, components: Indices) -> Array:
    """Return the shares of every self-stress in one component of each joint, relative to its largest, (n, n_t, k)."""
    return np.asarray(stress.shares[joints, :, components] / np.where(stress.largest > 0.0, stress.largest, 1.0))


def concatenate_shares(a: Array, b: Array) -> Array:
    """Concatenate shares (n, n_t, k) of two sets of poses; where there are fewer self-stresses, with zeros."""
    result = np.zeros((len(a), a.shape[1] + b.shape[1], max(a.shape[2], b.shape[2])))
    result[:, : a.shape[1], : a.shape[2]] = a
    result[:, a.shape[1] :, : b.shape[2]] = b
    return result
