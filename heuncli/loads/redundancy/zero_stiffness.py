"""Joints that give way in some directions, stiffness 0: there they carry nothing as soon as another joint holds.

A direction in which a joint gives way is like one that it leaves free, but that it holds where nothing else does. What
others can hold is what self-stresses reach: a load of such a direction that some self-stress takes away, changing no
other load that gives way, vanishes. That is no choice among splits; it follows from what was drawn. What joints that
give way could only hand over to one another stays open.

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


def gives_way(joint: Joint) -> bool:
    """Whether the joint has a stiffness of 0 somewhere."""
    return joint.stiffness is not None and any(bool((part == 0.0).any()) for part in joint.stiffness)


def soft_maps(joints: Sequence[Joint], states: BodyStates, length: float) -> list[Array]:
    """Of each joint the map of its wrench to what it carries where it gives way, (n_t, 6, 6): `from` axes, F, M/length.

    Rows of directions in which it does not are zero.
    """
    maps = []
    for joint in joints:
        soft = np.zeros((len(states.x), 6, 6))
        if joint.stiffness is not None and gives_way(joint):
            axes = np.stack([states.direction(joint.a, e) for e in np.eye(3)], axis=1)
            for part, k in enumerate(joint.stiffness):
                rows = slice(3 * part, 3 * part + 3)
                soft[:, rows, rows] = axes * (k == 0.0)[:, None] / (length if part else 1.0)
            soft = soft @ constraint_map(joint, states)
        maps.append(soft)
    return maps


def reached(stress: SelfStress, maps: Sequence[Array]) -> Array:
    """What self-stresses, each of unit size, reach of mapped wrenches, (n_t, 6 n_j, k)."""
    size = np.where(stress.largest > 0.0, stress.largest, 1.0)
    return np.concatenate([m @ s for m, s in zip(maps, stress.shares, strict=True)], axis=1) / size[:, None, :]


def vanishing(stress: SelfStress, maps: Sequence[Array]) -> list[Array]:
    """The maps of what vanishes of it: of each joint's forces and moments the directions that R contains."""
    U, sigma, _ = np.linalg.svd(reached(stress, maps), full_matrices=False)
    Q = U * (sigma > tolerances.OPEN_SHARE)[:, None, :]
    found = []
    for n, soft in enumerate(maps):
        own = np.zeros_like(soft)
        for rows in (slice(0, 3), slice(3, 6)):
            if not soft[:, rows].any():
                continue
            X, cosine, _ = np.linalg.svd(Q[:, 6 * n : 6 * n + 6][:, rows], full_matrices=False)
            X = X * (1.0 - cosine * cosine <= tolerances.HELD_BY_OTHERS)[:, None, :]
            own[:, rows] = X @ X.transpose(0, 2, 1) @ soft[:, rows]
        found.append(own)
    return found


def told(joints: Sequence[Joint], maps: Sequence[Array]) -> tuple[str, ...]:
    """What joints that give way do, in sentences; maps: of what vanishes."""
    sentences = []
    for joint, own in zip(joints, maps, strict=True):
        if joint.stiffness is None:
            continue
        for name, k, rows in zip(("force", "moment"), joint.stiffness, (own[:, :3], own[:, 3:]), strict=True):
            if rows.any():
                sentences.append(f"gives way, and carries no {name} there: {joint.name}")
            elif (k == 0.0).any():
                sentences.append(f"gives way to {name}s, but nothing else holds there: {joint.name} carries them")
    return tuple(sentences)
