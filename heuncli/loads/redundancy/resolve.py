"""What redundant joints leave indeterminate, made visible: a split where one is chosen, open components, sums."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.bodies import BodyStates, body_states
from heuncli.loads.kinetostatics.coupling_numbers import components_of
from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.loads.kinetostatics.foundation import ElementKeys
from heuncli.loads.kinetostatics.joint_axes import axes_at, components_of_shares
from heuncli.loads.kinetostatics.reactions import JointLoads
from heuncli.loads.redundancy.certain_sums import certain_sums
from heuncli.loads.redundancy.neighbours import neighbours
from heuncli.loads.redundancy.open_components import (
    names_of,
    of_quantity,
    open_along,
    open_coupling,
    open_joint,
    open_support,
    opened,
    wrench_open,
)
from heuncli.loads.redundancy.self_stress import KnownStress, SelfStress, self_stress
from heuncli.loads.redundancy.split import Choice, chosen, split
from heuncli.motion.integration.evaluator import Recovered
from heuncli.motion.integration.run.runner import Runner
from heuncli.multibody.mechanism.model import GROUND
from heuncli.results.results import Array, Block, CertainSum, Indices

SUMS_FROM = 9  # instants whose self-stresses certain sums are read from


@record
class Resolution:
    """The joints' loads after a split, told in `words`, by its `choices`.

    stress: the self-stresses it chose from; left: those it left open; None where there are none of them.
    """

    joints: list[JointLoads]
    words: tuple[str, ...] = ()
    stress: SelfStress | None = None
    left: SelfStress | None = None
    choices: tuple[Choice, ...] = ()
    more: Array | None = None  # what the split adds to the multipliers of the closure rows, (n_t, rows)
    searched: SelfStress | None = None  # the search for them, also where there are none

    def chosen(self, joints: list[JointLoads], states: BodyStates) -> tuple[list[JointLoads], Array | None]:
        """Other loads of the joints, as their shares by cause, after the same split; what it adds to multipliers."""
        return chosen(self.choices, joints, states)

    def singular(self, times: Array, redundant: Array) -> list[str]:
        """Sentences on instants with more self-stresses than `redundant`, or nearly so."""
        return singular_poses(self.searched, times, redundant) if self.searched is not None else []

    @property
    def marks(self) -> bool:
        """Whether `show` marks anything."""
        return self.left is not None or bool(self.words)

    def show(
        self, states: BodyStates, shown: Block, couplings: Sequence[CouplingLoads], axes: str, keys: ElementKeys
    ) -> None:
        """Mark what is open, or was until a split was chosen, in the blocks of all that stands or carries, in place.

        axes: in which the joints' loads are told; keys: of what stands on the ground
        (loads/kinetostatics/foundation.py).
        """
        reactions = shown.get("joints")
        if self.left is not None:
            put_verdicts(self.left, self.joints, states, shown, axes, keys)
            put_verdicts_on_couplings(self.left, couplings, shown, keys)
        if self.words and self.stress is not None and reactions is not None:
            mark_chosen(self.stress, self.joints, states, reactions, axes)

    def sums(self, runner: Runner, recovered: Recovered, couplings: Sequence[CouplingLoads] = ()) -> list[CertainSum]:
        """Certain sums of what is open."""
        return sums_of(runner, recovered, self.joints, couplings, self.left) if self.left is not None else []


def resolve(
    runner: Runner,
    recovered: Recovered,
    states: BodyStates,
    joints: list[JointLoads],
    least_norm: bool,
    known: KnownStress | None = None,
) -> Resolution:
    """Find the self-stresses and apply the split that was asked for; known: those of poses that may be these."""
    stress = self_stress(runner, recovered, states, known)
    if stress is None or not stress.count.any():
        return Resolution(joints, searched=stress)
    found = split(joints, states, stress, least_norm)
    return Resolution(found.joints, found.words, found.undecided, found.stress, found.choices, found.more, stress)


def singular_poses(stress: SelfStress, times: Array, redundant: Array) -> list[str]:
    """Where the rank of the closures drops below the generic one, and where it comes near to that."""
    sentences = []
    more = np.flatnonzero(stress.count > redundant)
    if len(more):
        at = ", ".join(f"{t:.6g}" for t in times[more[:5]]) + (" ..." if len(more) > 5 else "")
        when = "this instant" if len(more) == 1 else "these instants"
        sentences.append(f"singular pose at t = {at} s: some components are indeterminate at {when} only")
    hardly = np.where(stress.count <= redundant, stress.left, 0.0)
    if hardly.max(initial=0.0) > tolerances.NOT_QUITE:
        sentences.append(
            f"some conditions of the joints depend on others within {hardly.max():.1e} only: they are taken as "
            "redundant; exactly as drawn, they would hold one freedom more"
        )
    near = np.flatnonzero((stress.least < tolerances.NEARLY_SINGULAR) & (stress.count <= redundant))
    if len(near):
        k = near[int(np.argmin(stress.least[near]))]
        sentences.append(
            f"nearly singular pose at t = {times[k]:.6g} s (smallest singular value {stress.least[k]:.1e}): "
            "reactions grow there without bound, their error by as much"
        )
    return sentences


def put_verdicts(
    stress: SelfStress, joints: Sequence[JointLoads], states: BodyStates, shown: Block, axes: str, keys: ElementKeys
) -> None:
    """Make the open components of joints, stops and what stands on the ground visible, in place."""
    base = shown.get("foundation", {})
    supports, elements = base.get("supports", {}), base.get("elements", {})
    for load, whole in zip(joints, stress.shares, strict=True):
        share, free = load.parts(states, whole)
        if "joints" in shown:
            block, along = shown["joints"][load.joint.name], axes_at(load.joint, states, axes)
            open_joint(block, load, (share, free), stress, along)
        if load.joint.name in supports:
            open_support(supports[load.joint.name], share, stress)
        drive = load.joint.drive
        for own in load.stops:
            touched = np.any(own.unit != 0.0, axis=1)  # or others of the joint are
            stop, beside = own.stop, np.where(touched[:, None, None], free, 0.0)
            if (element := elements.get(keys.get(("stops", stop.name), ""))) is not None:
                open_support(element, of_quantity(beside, stop.quantity), stress)
            if stop.name in shown.get("stops", {}):
                block = shown["stops"][stop.name]
                is_open = open_along(stop.quantity, beside, stress)
                block |= {name: opened(value, is_open) for name, value in block.items()}
        if drive is None or load.drive is None or load.axis is None:
            continue
        if (element := elements.get(keys.get(("drives", drive.name), ""))) is not None:
            open_support(element, of_quantity(free, drive.quantity), stress)


def put_verdicts_on_couplings(
    stress: SelfStress, couplings: Sequence[CouplingLoads], shown: Block, keys: ElementKeys
) -> None:
    """The same of couplings, and of their loads on the ground, in place."""
    elements = shown.get("foundation", {}).get("elements", {})
    for loads in couplings:
        name = loads.coupling.name
        if name in shown.get("couplings", {}):
            open_coupling(shown["couplings"][name], loads, stress)
        if (element := elements.get(keys.get(("couplings", name), ""))) is not None:
            on = [loads.of_multipliers(stress.multipliers[:, :, k]) for k in range(stress.largest.shape[1])]
            shares = [np.concatenate(own.on_bodies()[GROUND][1:], axis=1) for own in on]
            open_support(element, np.stack(shares, axis=-1), stress)


def mark_chosen(
    stress: SelfStress, joints: Sequence[JointLoads], states: BodyStates, reactions: Block, axes: str
) -> None:
    """Name the components that were open before a split was chosen, in place."""
    for load, whole in zip(joints, stress.shares, strict=True):
        share = components_of_shares(load.parts(states, whole)[0], axes_at(load.joint, states, axes))
        force, moment = wrench_open(stress, share)
        names = names_of({"force": force, "moment": moment})
        if names:
            reactions[load.joint.name]["chosen"] = names


def sums_of(
    runner: Runner,
    recovered: Recovered,
    joints: Sequence[JointLoads],
    couplings: Sequence[CouplingLoads],
    stress: SelfStress,
) -> list[CertainSum]:
    """Certain sums of the joints' open components, true at the asked instants and in neighbouring poses."""
    pick = np.unique(np.linspace(0, len(recovered.times) - 1, SUMS_FROM).astype(int))
    near = neighbours(
        runner, float(recovered.times[0]), recovered.states[0], tolerances.SUM_POSES, recovered.holding[0]
    )
    stress = of_constraints(stress, joints, body_states(runner.layout, recovered))
    beside = None
    if near is not None and all(j.joint.stiffness is None for j in joints):
        # what a stiffness leaves indeterminate is known at the asked instants only
        there = body_states(runner.layout, near)
        found = self_stress(runner, near, there)
        beside = of_constraints(found, joints, there) if found is not None else None
    reached = [np.concatenate(wrench_open(stress, share), axis=1).any(axis=0) for share in stress.shares]
    of, component = np.nonzero(np.reshape(reached, (-1, 6)))  # joint, component: of each that is open
    at_instants = relative_shares(stress, of, component)
    in_poses = at_instants[:, pick]
    if beside is not None:
        in_poses = one_after_the_other(in_poses, relative_shares(beside, of, component))
    poses, asked, values = dict[str, Array](), dict[str, Array](), dict[str, Array]()
    for n, (k, i) in enumerate(zip(of.tolist(), component.tolist(), strict=True)):
        load = joints[k]
        name = f"joints.{load.joint.name}.{'force' if i < 3 else 'moment'}.{'xyz'[i % 3]}"
        poses[name], asked[name] = in_poses[n], at_instants[n]
        values[name] = (load.force if i < 3 else load.moment)[:, i % 3]
    for loads, number in ((own, number) for own in couplings for number in components_of(own)):
        r = loads.rows[number.rows[0]]
        at = number.factor * relative_multipliers(stress, r)
        if np.abs(at).max(initial=0.0) * stress.coupled[r] <= tolerances.OPEN_SHARE:
            continue
        name = f"couplings.{loads.coupling.name}.{number.name}"
        picked = at[:, pick]
        if beside is not None:
            picked = one_after_the_other(picked, number.factor * relative_multipliers(beside, r))
        poses[name], asked[name] = picked[0], at[0]
        values[name] = number.values
    return certain_sums(poses, asked, values, stress.length)


def relative_multipliers(stress: SelfStress, r: int) -> Array:
    """Of every self-stress the multiplier of a closure row, relative to its largest share, (1, n_t, k)."""
    return np.asarray(stress.multipliers[None, :, r] / np.where(stress.largest > 0.0, stress.largest, 1.0))


def of_constraints(stress: SelfStress, joints: Sequence[JointLoads], states: BodyStates) -> SelfStress:
    """The self-stresses with their shares in the joints' constraints alone, without those in drives and stops."""
    shares = [load.parts(states, whole)[0] for load, whole in zip(joints, stress.shares, strict=True)]
    alone: SelfStress = replace(stress, shares=np.reshape(shares, stress.shares.shape))
    return alone


def relative_shares(stress: SelfStress, joints: Indices, components: Indices) -> Array:
    """Shares of every self-stress in one component of each of the joints, relative to its largest, (n, n_t, k)."""
    return np.asarray(stress.shares[joints, :, components] / np.where(stress.largest > 0.0, stress.largest, 1.0))


def one_after_the_other(a: Array, b: Array) -> Array:
    """Shares (n, n_t, k) in some poses and in others; where there are fewer self-stresses, zeros."""
    out = np.zeros((len(a), a.shape[1] + b.shape[1], max(a.shape[2], b.shape[2])))
    out[:, : a.shape[1], : a.shape[2]] = a
    out[:, a.shape[1] :, : b.shape[2]] = b
    return out
