"""Open components made visible: `nan` where a self-stress has a share, and the list of what is open at some instant.

A component in any direction c of a wrench is open where c . share is; so `axial` may be certain where x, y, z are not.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base import tolerances
from heuncli.loads.kinetostatics.actions import joint_action
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.coupling_numbers import numbers_of
from heuncli.loads.kinetostatics.couplings import CouplingLoads, coupling_actions
from heuncli.loads.kinetostatics.drives_told import TOLD
from heuncli.loads.kinetostatics.joint_axes import components_of_shares
from heuncli.loads.kinetostatics.reactions import JointLoads
from heuncli.loads.redundancy.self_stress import SelfStress
from heuncli.multibody.mechanism.couplings import Coupling
from heuncli.results.results import Array, Block, Mask

if TYPE_CHECKING:  # loaded where a scene has sections
    from heuncli.loads.kinetostatics.cuts import Cuts

WORLD = ("x", "y", "z")


def opened(values: Array, is_open: Mask) -> Array:
    """The values, nan where open."""
    found: Array = np.where(is_open, np.nan, values)
    return found


def wrench_open(stress: SelfStress, share: Array) -> tuple[Mask, Mask]:
    """Which of force and moment x, y, z are open, (n_t, 3) each, for a share (n_t, 6, k)."""
    return stress.reaches(share[:, :3]), stress.reaches(share[:, 3:], stress.length)


def names_of(parts: Mapping[str, Mask]) -> list[str]:
    """Names of the components open at some instant: "force.z" of (n_t, 3), "axial" of (n_t,)."""
    found = []
    for name, is_open in parts.items():
        if is_open.ndim == 1:
            found += [name] if is_open.any() else []
        else:
            found += [f"{name}.{WORLD[i]}" for i in range(3) if is_open[:, i].any()]
    return found


def open_joint(
    block: Block, load: JointLoads, shares: tuple[Array, Array], stress: SelfStress, along: Array | None = None
) -> None:
    """Open components of a joint's block, in place; shares (n_t, 6, k) of its constraint, and of its drive.

    along (n_t, 3, 3): the axes in which its force and moment are told, if not the world's.
    """
    share, free = shares
    force, moment = wrench_open(stress, components_of_shares(share, along))
    parts: dict[str, Mask] = {"force": force, "moment": moment}
    if load.axis is not None:
        n = load.axis
        F, M = share[:, :3], share[:, 3:]
        axial = np.einsum("ti,tik->tk", n, F)[:, None]
        across = F - n[:, :, None] * axial
        about = np.einsum("ti,tik->tk", n, M)[:, None]
        parts["axial"] = stress.reaches(axial)[:, 0]
        parts["radial"] = np.asarray(stress.reaches(across).any(axis=1))
        tilting = stress.reaches(M - n[:, :, None] * about, stress.length)
        parts["tilting"] = np.asarray(tilting.any(axis=1))
        parts["torque"] = stress.reaches(about, stress.length)[:, 0]
        if load.drive is not None and load.joint.drive is not None:
            parts["drive"] = open_along(load.joint.drive.quantity, free, stress)
    if load.tension is not None:
        parts["drive"] = parts["tension"] = np.asarray(force.any(axis=1))
    parts["pressure"] = parts.get("radial", np.asarray(force.any(axis=1)))
    for own in (block, *block.get("shares", {}).values()):
        for name in parts.keys() & own.keys():
            own[name] = opened(own[name], parts[name])
    block["open"] = names_of({name: is_open for name, is_open in parts.items() if name in block})


def open_along(quantity: str, free: Array, stress: SelfStress) -> Mask:
    """Whether what a drive or a stop exerts along a coordinate is open, (n_t,); its share is free of the constraint."""
    part, scale = (free[:, 3:], stress.length) if quantity == "angle" else (free[:, :3], 1.0)
    return np.asarray(stress.reaches(part, scale).any(axis=1))


def of_quantity(free: Array, quantity: str) -> Array:
    """What of a joint's shares beside its constraint acts along one of its coordinates."""
    turns = np.arange(6) >= 3
    return free * (turns if quantity == "angle" else ~turns)[:, None]


def open_support(block: Block, share: Array, stress: SelfStress) -> None:
    """Open components of what stands ON the ground, a support or an element, in place."""
    force, moment = wrench_open(stress, share)
    for own in (block, *block.get("shares", {}).values()):
        own["force"], own["moment"] = opened(own["force"], force), opened(own["moment"], moment)


def open_coupling(block: Block, loads: CouplingLoads, stress: SelfStress) -> None:
    """Open components of a coupling's block, in place: of what it carries, and of what it exerts ON each body."""
    parts: dict[str, Mask] = {}
    for number in numbers_of(loads):
        rows = stress.multipliers[:, [loads.rows[k] for k in number.rows]]
        parts[number.name] = np.asarray(stress.reaches(rows, stress.length if number.is_moment else 1.0).any(axis=1))
    for own in (block, *block.get("shares", {}).values()):
        for name in parts.keys() & own.keys():
            own[name] = opened(own[name], parts[name])
    for beside in ("radial", "axial", "normal", "torque", "tight", "slack"):
        if beside in block and beside not in parts and hangs_on_load(loads.coupling, beside):
            block[beside], parts[beside] = opened(block[beside], parts[loads.carries]), parts[loads.carries]
    by_stress = [loads.of_multipliers(stress.multipliers[:, :, k]) for k in range(stress.largest.shape[1])]
    on = [list(own.on_bodies().values()) for own in by_stress]
    for i, (end, own) in enumerate(block["on"].items()):
        share = np.stack([np.concatenate(bodies[i][1:], axis=1) for bodies in on], axis=-1)
        open_support(own, share, stress)
        force, moment = wrench_open(stress, share)
        parts |= {f"on.{end}.force": force, f"on.{end}.moment": moment}
    block["open"] = names_of(parts)


def hangs_on_load(coupling: Coupling, beside: str) -> bool:
    """Whether a number that is told beside the load hangs on it: of straight teeth the axial part does not."""
    told = TOLD[coupling.given.type](coupling.given, np.ones(1), False)
    return bool(np.any(told[beside]))


def open_in_section(
    cuts: Cuts,
    states: BodyStates,
    joints: Sequence[JointLoads],
    couplings: Sequence[CouplingLoads],
    stress: SelfStress,
) -> dict[str, Mask]:
    """Of each component of a section's loads whether it is open: some self-stress has a share in it."""
    from heuncli.loads.kinetostatics.sections import MOMENTS, attachments, components_at_rest

    is_open: dict[str, Mask] = {}
    for k in range(stress.largest.shape[1]):
        parts = zip(joints, stress.shares, strict=True)
        actions = [joint_action(j, s[:, :3, k], s[:, 3:, k]) for j, s in parts]
        actions += coupling_actions([own.of_multipliers(stress.multipliers[:, :, k]) for own in couplings])
        on = attachments(cuts.body, states, actions)
        limit = np.where(stress.largest[:, k] > 0.0, tolerances.OPEN_SHARE * stress.largest[:, k], np.inf)
        for name, share in components_at_rest(cuts, states, on).items():
            scale = limit * (stress.length if name in MOMENTS else 1.0)
            reached = np.abs(share) > scale.reshape(-1, *([1] * (share.ndim - 1)))
            is_open[name] = is_open.get(name, False) | reached
    return is_open


def names_in_section(is_open: Mapping[str, Mask]) -> list[str]:
    """Names of a section's components that are open at some instant, in some cut."""
    from heuncli.loads.kinetostatics.sections import ABOUT_CENTROID

    shown = {name: mask for name, mask in is_open.items() if name not in ABOUT_CENTROID}
    return names_of({name: mask.reshape(-1, 3) if mask.ndim == 3 else mask.ravel() for name, mask in shown.items()})
