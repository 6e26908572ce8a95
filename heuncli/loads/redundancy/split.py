"""Split what redundancy leaves indeterminate, on request: by the joints' stiffness, or by the least norm.

Neither follows from the laws of rigid bodies; both add self-stresses to one solution. Before either, joints that give
way do so, which is no choice. Stiffness: least sum of F^2/k + M^2/k over the joints that have one,
components in `from` axes, including a drive's load; what does not strain them stays indeterminate. Least norm: least
sum F^2 + (M/length)^2 over all joints, independent of the units. manual/theory.md, "Redundancy".

A direction in which a joint gives way (stiffness 0) is like a free one, except that the joint holds it where nothing
else does. What others can hold is what self-stresses reach: the load in such a direction vanishes if some self-stress
removes it without changing any other yielding load. That is no choice among splits; it follows from the model. What
yielding joints could only exchange among each other stays indeterminate.

    R: the loads of all such directions that self-stresses reach;  U: those of one joint, its forces or its moments
    the loads in R ∩ U vanish, exactly
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.reactions import JointLoads, StopLoad, make_constraint_map, remove_free_components
from heuncli.loads.redundancy.self_stress import SelfStress
from heuncli.multibody.mechanism.model import Joint
from heuncli.results.results import Array

# Zero stiffness


def has_zero_stiffness(joint: Joint) -> bool:
    """Return whether the joint has a stiffness of 0 somewhere."""
    return joint.stiffness is not None and any(bool((part == 0.0).any()) for part in joint.stiffness)


def make_yield_maps(joints: Sequence[Joint], states: BodyStates, length: float) -> list[Array]:
    """Return for each joint the map of its wrench to the part where it gives way, (n_t, 6, 6): `from` axes, F,
    M/length.

    Rows of other directions are zero.
    """
    maps = []
    for joint in joints:
        yield_map = np.zeros((len(states.x), 6, 6))
        if joint.stiffness is not None and has_zero_stiffness(joint):
            axes = np.stack([states.world_direction(joint.a, e) for e in np.eye(3)], axis=1)
            for part, k in enumerate(joint.stiffness):
                rows = slice(3 * part, 3 * part + 3)
                yield_map[:, rows, rows] = axes * (k == 0.0)[:, None] / (length if part else 1.0)
            yield_map = yield_map @ make_constraint_map(joint, states)
        maps.append(yield_map)
    return maps


def map_self_stresses(stress: SelfStress, maps: Sequence[Array]) -> Array:
    """Return the mapped wrenches of self-stresses of unit size, (n_t, 6 n_j, k)."""
    size = np.where(stress.largest > 0.0, stress.largest, 1.0)
    return np.concatenate([m @ s for m, s in zip(maps, stress.shares, strict=True)], axis=1) / size[:, None, :]


def find_vanishing(stress: SelfStress, maps: Sequence[Array]) -> list[Array]:
    """Return the maps of what vanishes: for each joint's forces and moments the directions that R contains."""
    if not any(yield_map.any() for yield_map in maps):
        return [np.zeros_like(yield_map) for yield_map in maps]
    U, sigma, _ = np.linalg.svd(map_self_stresses(stress, maps), full_matrices=False)
    Q = U * (sigma > tolerances.OPEN_SHARE)[:, None, :]
    maps_found = []
    for n, yield_map in enumerate(maps):
        vanishing_map = np.zeros_like(yield_map)
        for rows in (slice(0, 3), slice(3, 6)):
            if not yield_map[:, rows].any():
                continue
            X, cosine, _ = np.linalg.svd(Q[:, 6 * n : 6 * n + 6][:, rows], full_matrices=False)
            X = X * (1.0 - cosine * cosine <= tolerances.HELD_BY_OTHERS)[:, None, :]
            vanishing_map[:, rows] = X @ X.transpose(0, 2, 1) @ yield_map[:, rows]
        maps_found.append(vanishing_map)
    return maps_found


def describe_yielding(joints: Sequence[Joint], maps: Sequence[Array]) -> tuple[str, ...]:
    """Describe what joints that give way do, in sentences; maps: of what vanishes."""
    sentences = []
    for joint, vanishing_map in zip(joints, maps, strict=True):
        if joint.stiffness is None:
            continue
        for name, k, rows in zip(
            ("force", "moment"), joint.stiffness, (vanishing_map[:, :3], vanishing_map[:, 3:]), strict=True
        ):
            if rows.any():
                sentences.append(f"{joint.name} transmits no {name} in its directions of zero stiffness")
            elif (k == 0.0).any():
                sentences.append(f"{joint.name} transmits {name}s despite zero stiffness, because no other joint does")
    return tuple(sentences)


# Split


@record
class SelfStressChoice:
    """The self-stresses added to joint loads; linear in these, so a load's shares by cause are split likewise.

    shares (n_j, n_t, 6, k): of the self-stresses in the joints
    responses (n_t, k, 6 n_j): amount of each self-stress added per unit of every component of the joints' wrenches
    multipliers (n_t, rows, k): of the self-stresses
    """

    shares: Array
    responses: Array
    multipliers: Array

    def apply(self, joints: Sequence[JointLoads], states: BodyStates) -> tuple[list[JointLoads], Array]:
        """Return the joint loads with the self-stresses, and what these add to the multipliers, (..., n_t, rows)."""
        W = np.concatenate([_wrench(j) for j in joints], axis=-1)
        c = np.einsum("tkj,...tj->...tk", self.responses, W)
        loads = [
            _add_wrench(j, states, np.einsum("tik,...tk->...ti", s, c))
            for j, s in zip(joints, self.shares, strict=True)
        ]
        return loads, np.einsum("trk,...tk->...tr", self.multipliers, c)


def apply_choices(
    choices: Sequence[SelfStressChoice], joints: list[JointLoads], states: BodyStates
) -> tuple[list[JointLoads], Array | None]:
    """Return joint loads after some choices, and what these add to the multipliers of the closure rows; None:
    nothing.
    """
    added_multipliers = None
    for choice in choices:
        joints, added = choice.apply(joints, states)
        added_multipliers = added if added_multipliers is None else added_multipliers + added
    return joints, added_multipliers


@record
class SelfStressSplit:
    """Joint loads after some choices.

    added_multipliers (n_t, rows): what the choices add to the multipliers of the closure rows
    initial_stress: the self-stresses before any choice, without those that yielding joints remove
    remaining_stress: those left; None if there are none
    sentences: sentences on the choices
    """

    joints: list[JointLoads]
    added_multipliers: Array | None
    initial_stress: SelfStress | None
    remaining_stress: SelfStress | None
    choices: tuple[SelfStressChoice, ...]
    sentences: tuple[str, ...]


def split_self_stress(
    joints: list[JointLoads], states: BodyStates, stress: SelfStress, least_norm: bool
) -> SelfStressSplit:
    """Split what is indeterminate: remove loads from yielding joints, then by stiffness where it is given, then by
    least norm if requested.
    """
    sentences: list[str] = []
    choices: list[SelfStressChoice] = []
    remaining: SelfStress | None = stress
    exchanged: SelfStress | None = None  # what yielding joints exchange among each other
    if any(has_zero_stiffness(j.joint) for j in joints):
        yield_maps = make_yield_maps([j.joint for j in joints], states, stress.length)
        choice, remaining = minimise_strain(stress, find_vanishing(stress, yield_maps))
        choices.append(choice)
        if remaining is not None:
            remaining, exchanged = separate_yielding(remaining, yield_maps)
    initial = join_stresses(remaining, exchanged)
    maps = [make_stiffness_map(j, states) for j in joints]
    if remaining is not None and any(m.any() for m in maps):
        choice, remaining = minimise_strain(remaining, maps)
        choices.append(choice)
        sentences.append("chosen by stiffness")
    remaining = join_stresses(remaining, exchanged)
    if least_norm and remaining is not None and joints:  # without joints there is nothing to minimise
        maps = [np.broadcast_to(np.diag([1.0] * 3 + [1.0 / stress.length] * 3), (len(states.x), 6, 6)) for _ in joints]
        choice, remaining = minimise_strain(remaining, maps)
        choices.append(choice)
        sentences.append(f"chosen by least norm, moments divided by {stress.length:.4g} m")
    joints, added_multipliers = apply_choices(choices, joints, states)
    return SelfStressSplit(joints, added_multipliers, initial, remaining, tuple(choices), tuple(sentences))


def make_stiffness_map(load: JointLoads, states: BodyStates) -> Array:
    """Return the map of a wrench (world axes) to strains F/sqrt(k), M/sqrt(k) in `from` axes, (n_t, 6, 6).

    Zero where the joint is rigid, and where it gives way.
    """
    n_t = len(load.force)
    strains = np.zeros((n_t, 6, 6))
    if load.joint.stiffness is None:
        return strains
    axes = np.stack([states.world_direction(load.joint.a, e) for e in np.eye(3)], axis=1)
    for part, k in enumerate(load.joint.stiffness):
        strain = 1.0 / np.sqrt(np.where(k == 0.0, np.inf, k))
        strains[:, 3 * part : 3 * part + 3, 3 * part : 3 * part + 3] = axes * strain[:, None]
    return strains


def minimise_strain(stress: SelfStress, maps: Sequence[Array]) -> tuple[SelfStressChoice, SelfStress | None]:
    """Find the self-stresses that minimise the sum of squares of the mapped wrenches; those without effect stay."""
    S = np.concatenate([np.einsum("tij,tjk->tik", m, s) for m, s in zip(maps, stress.shares, strict=True)], axis=1)
    size = np.where(stress.largest > 0.0, stress.largest, 1.0)
    U, sigma, V = np.linalg.svd(S / size[:, None, :], full_matrices=False)
    is_strained = sigma > tolerances.STRAINED_SELF_STRESS * np.maximum(sigma.max(axis=1, initial=0.0), 1e-300)[:, None]
    inverse = np.where(is_strained, 1.0 / np.where(is_strained, sigma, 1.0), 0.0)
    responses = -(V.transpose(0, 2, 1) * inverse[:, None, :]) @ U.transpose(0, 2, 1) / size[:, :, None]
    responses = np.concatenate([responses[:, :, 6 * n : 6 * n + 6] @ m for n, m in enumerate(maps)], axis=2)
    choice = SelfStressChoice(stress.shares, responses, stress.multipliers)
    # what strains nothing: the self-stresses' part outside the rows of V that strain something
    unstrained = np.eye(S.shape[2]) - np.einsum("tki,tk,tkj->tij", V, is_strained.astype(float), V)
    return choice, select_part(stress, unstrained, stress.count - is_strained.sum(axis=1))


def select_part(stress: SelfStress, part: Array, count: Array) -> SelfStress | None:
    """Return a part (n_t, k, k) of self-stresses of unit size, `count` (n_t,) of them; None if there are none."""
    if not (count > 0).any():
        return None
    is_present = stress.largest > 0.0
    size = np.where(is_present, stress.largest, 1.0)
    unit_part = np.einsum("tij,tj->tij", part, is_present.astype(float)) / size[:, :, None]
    shares = np.stack([np.einsum("tik,tkj->tij", s, unit_part) for s in stress.shares])
    parts = [np.maximum(np.abs(s[:, :3]).max(axis=1), np.abs(s[:, 3:]).max(axis=1) / stress.length) for s in shares]
    multipliers = np.einsum("trk,tkj->trj", stress.multipliers, unit_part)
    coupling_shares = np.abs(multipliers * stress.coupling_scale[:, None]).max(axis=1, initial=0.0)
    largest = np.maximum(np.max(parts, axis=0), coupling_shares)
    largest = np.where(largest > tolerances.OPEN_AFTER_SPLIT, largest, 0.0)
    result: SelfStress = replace(stress, shares=shares, largest=largest, count=count, multipliers=multipliers)
    return result


def separate_yielding(stress: SelfStress, yield_maps: Sequence[Array]) -> tuple[SelfStress | None, SelfStress | None]:
    """Return the self-stresses that load no yielding direction, and those that do."""
    _, sigma, V = np.linalg.svd(map_self_stresses(stress, yield_maps), full_matrices=False)
    is_loading = sigma > tolerances.OPEN_SHARE
    part = np.einsum("tki,tk,tkj->tij", V, is_loading.astype(float), V)
    count = is_loading.sum(axis=1)
    return select_part(stress, np.eye(V.shape[2]) - part, stress.count - count), select_part(stress, part, count)


def join_stresses(a: SelfStress | None, b: SelfStress | None) -> SelfStress | None:
    """Return the self-stresses of both."""
    if a is None or b is None:
        return a if b is None else b
    both: SelfStress = replace(
        a, shares=np.concatenate([a.shares, b.shares], axis=3), count=a.count + b.count,
        largest=np.concatenate([a.largest, b.largest], axis=1),
        multipliers=np.concatenate([a.multipliers, b.multipliers], axis=2),
    )  # fmt: skip
    return both


def _wrench(load: JointLoads) -> Array:
    """Return force and moment of a joint as one array, (..., 6)."""
    F, M = load.total
    return np.concatenate([F, M], axis=-1)


def _add_wrench(load: JointLoads, states: BodyStates, added_wrench: Array) -> JointLoads:
    """Add force and moment to a joint's load, and share them among its stops and its drive."""
    F, M = load.total
    F, M = F + added_wrench[..., :3], M + added_wrench[..., 3:]
    force, moment = remove_free_components(load.joint, states, F, M)
    stops = tuple(_add_to_stop(stop_load, added_wrench) for stop_load in load.stops)
    if stops and load.axis is None:  # a rod with limits carries load only at these
        force, moment = load.force, load.moment
    drive = load.drive
    if drive is not None and load.axis is not None and load.joint.drive is not None:
        total = M if load.joint.drive.quantity == "angle" else F
        drive = np.sum(total * load.axis, axis=-1)
    tension = load.tension
    if tension is not None:
        line = states.point_position(load.joint.b, load.joint.q) - states.point_position(load.joint.a, load.joint.p)
        axial = np.sum(added_wrench[..., :3] * line, axis=-1) / np.sqrt(np.sum(line * line, axis=-1))
        tension = tension - axial
        drive = -tension if load.joint.drive is not None else None
    return replace(load, force=force, moment=moment, drive=drive, tension=tension, stops=stops)


def _add_to_stop(stop_load: StopLoad, added_wrench: Array) -> StopLoad:
    """Return a stop load with its part of what is added to its joint, along its coordinate, where it is touched."""
    return replace(stop_load, value=stop_load.value + np.sum(added_wrench * stop_load.unit, axis=-1))
