"""A split of what redundancy leaves indeterminate, on request: by the joints' stiffness, by the least norm.

Neither follows from the laws of rigid bodies; both add self-stresses to one solution. Before either, joints that give
way do so (zero_stiffness.py): that is no choice. Stiffness: least sum of F^2/k + M^2/k over the joints that have one,
components in `from` axes, a drive's effort among them; what they do not feel stays open. Least norm: least sum
F^2 + (M/length)^2 over all joints; independent of the units. manual/theory.md, "Redundancy".
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.reactions import JointLoads, StopLoad, constrained_part
from heuncli.loads.redundancy.self_stress import SelfStress
from heuncli.loads.redundancy.zero_stiffness import gives_way, reached, soft_maps, vanishing
from heuncli.results.results import Array


@record
class Choice:
    """Which self-stresses are added to joint loads: linear in these, so a load's shares by cause are split likewise.

    shares (n_j, n_t, 6, k): of the self-stresses in the joints; answers (n_t, k, 6 n_j): how much of each is added for
    a unit of every component of the joints' wrenches; multipliers (n_t, rows, k): of the self-stresses.
    """

    shares: Array
    answers: Array
    multipliers: Array

    def added(self, joints: Sequence[JointLoads], states: BodyStates) -> tuple[list[JointLoads], Array]:
        """The joint loads with the self-stresses, and what these add to the multipliers, (..., n_t, rows)."""
        W = np.concatenate([_wrench(j) for j in joints], axis=-1)
        c = np.einsum("tkj,...tj->...tk", self.answers, W)
        loads = [
            _added(j, states, np.einsum("tik,...tk->...ti", s, c)) for j, s in zip(joints, self.shares, strict=True)
        ]
        return loads, np.einsum("trk,...tk->...tr", self.multipliers, c)


def chosen(
    choices: Sequence[Choice], joints: list[JointLoads], states: BodyStates
) -> tuple[list[JointLoads], Array | None]:
    """Joint loads after some choices, and what these add to the multipliers of the closure rows; None: nothing."""
    more = None
    for choice in choices:
        joints, own = choice.added(joints, states)
        more = own if more is None else more + own
    return joints, more


@record
class Split:
    """Joint loads after some choices, the self-stresses these left (None: none), and how they were made, in words.

    undecided: the self-stresses that were there to choose from, once joints have given way.
    """

    joints: list[JointLoads]
    more: Array | None  # what they add to the multipliers of the closure rows, (n_t, rows)
    undecided: SelfStress | None
    stress: SelfStress | None
    choices: tuple[Choice, ...]
    words: tuple[str, ...]


def split(joints: list[JointLoads], states: BodyStates, stress: SelfStress, least_norm: bool) -> Split:
    """Let joints give way, apply their stiffness where it is given, then the least norm if asked for."""
    words: list[str] = []
    choices: list[Choice] = []
    left: SelfStress | None = stress
    among: SelfStress | None = None  # what joints that give way hand over to one another
    if any(gives_way(j.joint) for j in joints):
        soft = soft_maps([j.joint for j in joints], states, stress.length)
        choice, left = with_least_strain(stress, vanishing(stress, soft))
        choices.append(choice)
        if left is not None:
            left, among = apart(left, soft)
    undecided = together(left, among)
    maps = [stiffness_map(j, states) for j in joints]
    if left is not None and any(m.any() for m in maps):
        choice, left = with_least_strain(left, maps)
        choices.append(choice)
        words.append("chosen by stiffness")
    left = together(left, among)
    if least_norm and left is not None and joints:  # between wheels and couplings alone nothing is weighed
        maps = [np.broadcast_to(np.diag([1.0] * 3 + [1.0 / stress.length] * 3), (len(states.x), 6, 6)) for _ in joints]
        choice, left = with_least_strain(left, maps)
        choices.append(choice)
        words.append(f"chosen by least norm, moments divided by {stress.length:.4g} m")
    joints, more = chosen(choices, joints, states)
    return Split(joints, more, undecided, left, tuple(choices), tuple(words))


def stiffness_map(load: JointLoads, states: BodyStates) -> Array:
    """Map of a wrench (world axes) to strains F/sqrt(k), M/sqrt(k) in `from` axes, (n_t, 6, 6).

    Zero where it is rigid, and where it gives way.
    """
    n_t = len(load.force)
    strains = np.zeros((n_t, 6, 6))
    if load.joint.stiffness is None:
        return strains
    axes = np.stack([states.direction(load.joint.a, e) for e in np.eye(3)], axis=1)
    for part, k in enumerate(load.joint.stiffness):
        strain = 1.0 / np.sqrt(np.where(k == 0.0, np.inf, k))
        strains[:, 3 * part : 3 * part + 3, 3 * part : 3 * part + 3] = axes * strain[:, None]
    return strains


def with_least_strain(stress: SelfStress, maps: Sequence[Array]) -> tuple[Choice, SelfStress | None]:
    """The self-stresses that make the sum of squares of the mapped wrenches least; those without effect stay."""
    S = np.concatenate([np.einsum("tij,tjk->tik", m, s) for m, s in zip(maps, stress.shares, strict=True)], axis=1)
    size = np.where(stress.largest > 0.0, stress.largest, 1.0)
    U, sigma, V = np.linalg.svd(S / size[:, None, :], full_matrices=False)
    strained = sigma > tolerances.STRAINED * np.maximum(sigma.max(axis=1, initial=0.0), 1e-300)[:, None]
    inverse = np.where(strained, 1.0 / np.where(strained, sigma, 1.0), 0.0)
    answers = -(V.transpose(0, 2, 1) * inverse[:, None, :]) @ U.transpose(0, 2, 1) / size[:, :, None]
    answers = np.concatenate([answers[:, :, 6 * n : 6 * n + 6] @ m for n, m in enumerate(maps)], axis=2)
    choice = Choice(stress.shares, answers, stress.multipliers)
    # what strains nothing: the self-stresses' part outside the rows of V that strain something
    rest = np.eye(S.shape[2]) - np.einsum("tki,tk,tkj->tij", V, strained.astype(float), V)
    return choice, part_of(stress, rest, stress.count - strained.sum(axis=1))


def part_of(stress: SelfStress, part: Array, count: Array) -> SelfStress | None:
    """A part (n_t, k, k) of self-stresses of unit size, `count` (n_t,) of them; None where there are none."""
    if not (count > 0).any():
        return None
    alive = stress.largest > 0.0
    size = np.where(alive, stress.largest, 1.0)
    of_unit = np.einsum("tij,tj->tij", part, alive.astype(float)) / size[:, :, None]
    shares = np.stack([np.einsum("tik,tkj->tij", s, of_unit) for s in stress.shares])
    parts = [np.maximum(np.abs(s[:, :3]).max(axis=1), np.abs(s[:, 3:]).max(axis=1) / stress.length) for s in shares]
    multipliers = np.einsum("trk,tkj->trj", stress.multipliers, of_unit)
    coupled = np.abs(multipliers * stress.coupled[:, None]).max(axis=1, initial=0.0)
    largest = np.maximum(np.max(parts, axis=0), coupled)
    largest = np.where(largest > tolerances.STILL_OPEN, largest, 0.0)
    found: SelfStress = replace(stress, shares=shares, largest=largest, count=count, multipliers=multipliers)
    return found


def apart(stress: SelfStress, soft: Sequence[Array]) -> tuple[SelfStress | None, SelfStress | None]:
    """The self-stresses that load nothing where it gives way, and those that do."""
    _, sigma, V = np.linalg.svd(reached(stress, soft), full_matrices=False)
    loading = sigma > tolerances.OPEN_SHARE
    part = np.einsum("tki,tk,tkj->tij", V, loading.astype(float), V)
    count = loading.sum(axis=1)
    return part_of(stress, np.eye(V.shape[2]) - part, stress.count - count), part_of(stress, part, count)


def together(a: SelfStress | None, b: SelfStress | None) -> SelfStress | None:
    """The self-stresses of both."""
    if a is None or b is None:
        return a if b is None else b
    both: SelfStress = replace(
        a, shares=np.concatenate([a.shares, b.shares], axis=3), count=a.count + b.count,
        largest=np.concatenate([a.largest, b.largest], axis=1),
        multipliers=np.concatenate([a.multipliers, b.multipliers], axis=2),
    )  # fmt: skip
    return both


def _wrench(load: JointLoads) -> Array:
    F, M = load.whole
    return np.concatenate([F, M], axis=-1)


def _added(load: JointLoads, states: BodyStates, more: Array) -> JointLoads:
    F, M = load.whole
    F, M = F + more[..., :3], M + more[..., 3:]
    force, moment = constrained_part(load.joint, states, F, M)
    stops = tuple(_stop(own, more) for own in load.stops)
    if stops and load.axis is None:  # a rod between limits carries nothing but at them
        force, moment = load.force, load.moment
    drive = load.drive
    if drive is not None and load.axis is not None and load.joint.drive is not None:
        whole = M if load.joint.drive.quantity == "angle" else F
        drive = np.sum(whole * load.axis, axis=-1)
    tension = load.tension
    if tension is not None:
        line = states.point_position(load.joint.b, load.joint.q) - states.point_position(load.joint.a, load.joint.p)
        along = np.sum(more[..., :3] * line, axis=-1) / np.sqrt(np.sum(line * line, axis=-1))
        tension = tension - along
        drive = -tension if load.joint.drive is not None else None
    return replace(load, force=force, moment=moment, drive=drive, tension=tension, stops=stops)


def _stop(own: StopLoad, more: Array) -> StopLoad:
    """A stop with its part of what is added to its joint, along its coordinate, where it is touched."""
    return replace(own, value=own.value + np.sum(more * own.unit, axis=-1))
