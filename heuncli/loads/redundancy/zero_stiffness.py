"""Handle joints that give way in some directions (stiffness 0): they carry nothing there as soon as another joint
holds.

A direction in which a joint gives way is like a free one, except that the joint holds it where nothing else does. What
others can hold is what self-stresses reach: the load in such a direction vanishes if some self-stress removes it
without changing any other yielding load. That is no choice among splits; it follows from the model. What yielding
joints could only exchange among each other stays indeterminate.

    R: the loads of all such directions that self-stresses reach;  U: those of one joint, its forces or its moments
    the loads in R ∩ U vanish, exactly
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.reactions import constraint_map
from heuncli.loads.redundancy.self_stress import SelfStress
from heuncli.multibody.mechanism.model import Joint
from heuncli.results.results import Array


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
            yield_map = yield_map @ constraint_map(joint, states)
        maps.append(yield_map)
    return maps


def map_self_stresses(stress: SelfStress, maps: Sequence[Array]) -> Array:
    """Return the mapped wrenches of self-stresses of unit size, (n_t, 6 n_j, k)."""
    size = np.where(stress.largest > 0.0, stress.largest, 1.0)
    return np.concatenate([m @ s for m, s in zip(maps, stress.shares, strict=True)], axis=1) / size[:, None, :]


def find_vanishing(stress: SelfStress, maps: Sequence[Array]) -> list[Array]:
    """Return the maps of what vanishes: for each joint's forces and moments the directions that R contains."""
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
