"""Mark indeterminate components: `nan` where a self-stress has a share, and the list of those indeterminate at some
instant.

A component in any direction c of a wrench is indeterminate where c . share is; so `axial` may be determinate where x,
y, z are not.

Where it is indeterminate which of several meshes carries how much, so are the separating forces of their flanks. Such a
force depends on the magnitude of a multiplier, not on its sign, and is not linear in self-stresses. To be on the
safe side, the separating force of every mesh that some self-stress reaches counts as one more free load.

Joint friction that depends on an indeterminate load is refused.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import SolveError
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.actions import make_joint_action
from heuncli.loads.kinetostatics.bodies import BodyStates, make_body_states
from heuncli.loads.kinetostatics.coupling_numbers import DRIVE_ELEMENT_NUMBERS, list_numbers
from heuncli.loads.kinetostatics.couplings import (
    CouplingLoads,
    find_joints_between,
    has_separating_forces,
    list_coupling_actions,
    transfer_force,
)
from heuncli.loads.kinetostatics.reactions import (
    JointLoads,
    remove_free_components,
    rotate_shares,
    rotate_to_axes,
)
from heuncli.loads.redundancy.self_stress import SelfStress, find_self_stress
from heuncli.motion.integration.run.runner import Runner
from heuncli.multibody.mechanism.couplings import Coupling
from heuncli.multibody.mechanism.loads import JointLoad, ThreadLoad
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array, Block, Mask

if TYPE_CHECKING:
    from heuncli.loads.kinetostatics.cuts import Cuts


# Indeterminate components

WORLD = ("x", "y", "z")


def mask_indeterminate(values: Array, is_open: Mask) -> Array:
    """Return the values with nan where they are indeterminate."""
    masked: Array = np.where(is_open, np.nan, values)
    return masked


def find_indeterminate_wrench(stress: SelfStress, share: Array) -> tuple[Mask, Mask]:
    """Return which of force and moment x, y, z are indeterminate, (n_t, 3) each, for a share (n_t, 6, k)."""
    return stress.has_share(share[:, :3]), stress.has_share(share[:, 3:], stress.length)


def list_indeterminate_names(parts: Mapping[str, Mask]) -> list[str]:
    """List the components indeterminate at some instant: "force.z" of (n_t, 3), "axial" of (n_t,)."""
    names = []
    for name, is_open in parts.items():
        if is_open.ndim == 1:
            names += [name] if is_open.any() else []
        else:
            names += [f"{name}.{WORLD[i]}" for i in range(3) if is_open[:, i].any()]
    return names


def mark_joint(
    block: Block, load: JointLoads, shares: tuple[Array, Array], stress: SelfStress, axes: Array | None = None
) -> None:
    """Mark the indeterminate components of a joint's block, in place; shares (n_t, 6, k) of its constraint, and of its
    drive.

    axes (n_t, 3, 3): the axes in which its force and moment are reported, if not the world's
    """
    share, free_share = shares
    force, moment = find_indeterminate_wrench(stress, rotate_shares(share, axes))
    parts: dict[str, Mask] = {"force": force, "moment": moment}
    if load.axis is not None:
        n = load.axis
        F, M = share[:, :3], share[:, 3:]
        axial = np.einsum("ti,tik->tk", n, F)[:, None]
        radial_shares = F - n[:, :, None] * axial
        torque_shares = np.einsum("ti,tik->tk", n, M)[:, None]
        parts["axial"] = stress.has_share(axial)[:, 0]
        parts["radial"] = np.asarray(stress.has_share(radial_shares).any(axis=1))
        tilting = stress.has_share(M - n[:, :, None] * torque_shares, stress.length)
        parts["tilting"] = np.asarray(tilting.any(axis=1))
        parts["torque"] = stress.has_share(torque_shares, stress.length)[:, 0]
        if load.drive is not None and load.joint.drive is not None:
            parts["drive"] = is_coordinate_indeterminate(load.joint.drive.quantity, free_share, stress)
    if load.tension is not None:
        parts["drive"] = parts["tension"] = np.asarray(force.any(axis=1))
    parts["pressure"] = parts.get("radial", np.asarray(force.any(axis=1)))
    mask_parts(block, parts)
    block["open"] = list_indeterminate_names({name: is_open for name, is_open in parts.items() if name in block})
    if load.joint.bearings is not None:
        mark_bearings(block["bearings"], load, share, stress, axes)


def mask_parts(block: Block, parts: Mapping[str, Mask]) -> None:
    """Set the indeterminate components of a block, and of its shares by cause, to nan, in place."""
    for entry in (block, *block.get("shares", {}).values()):
        for name in parts.keys() & entry.keys():
            entry[name] = mask_indeterminate(entry[name], parts[name])


def mark_bearings(block: Block, load: JointLoads, share: Array, stress: SelfStress, axes: Array | None) -> None:
    """Mark the indeterminate components of a joint's bearings, in place; axes as of `mark_joint`."""
    from heuncli.loads.kinetostatics.moved_reactions import (  # few joints have them
        find_bearing_factors,
        split_to_bearings,
    )

    pair = load.joint.bearings
    assert pair is not None
    assert load.axis is not None
    F, M = np.moveaxis(share[:, :3], 2, 0), np.moveaxis(share[:, 3:], 2, 0)
    axial = stress.has_share(np.einsum("ti,tik->tk", load.axis, share[:, :3])[:, None])[:, 0]
    by_force, by_moment = find_bearing_factors(pair)
    scale = by_force + by_moment * stress.length
    for (key, bearing), across in zip(block.items(), split_to_bearings(pair, load.axis, F, M), strict=True):
        is_open = stress.has_share(np.moveaxis(rotate_to_axes(across, axes), 0, 2), scale)
        parts = {"radial_force": is_open, "radial": np.asarray(is_open.any(axis=1))}
        if "axial" in bearing and pair.axial in (None, int(key)):
            parts["axial"] = axial
        mask_parts(bearing, parts)
        bearing["open"] = [*dict.fromkeys([*list_indeterminate_names(parts), *bearing["open"]])]


def is_coordinate_indeterminate(quantity: str, free_share: Array, stress: SelfStress) -> Mask:
    """Return whether the load of a drive or a stop along a coordinate is indeterminate, (n_t,); its share is outside
    the constraint.
    """
    part, scale = (free_share[:, 3:], stress.length) if quantity == "angle" else (free_share[:, :3], 1.0)
    return np.asarray(stress.has_share(part, scale).any(axis=1))


def select_coordinate_share(free_share: Array, quantity: str) -> Array:
    """Return the part of a joint's shares outside its constraint that acts along one of its coordinates."""
    turns = np.arange(6) >= 3
    return free_share * (turns if quantity == "angle" else ~turns)[:, None]


def mark_ground_load(block: Block, share: Array, stress: SelfStress) -> None:
    """Mark the indeterminate components of a load ON the ground, a support or an element, in place."""
    force, moment = find_indeterminate_wrench(stress, share)
    for entry in (block, *block.get("shares", {}).values()):
        entry["force"], entry["moment"] = (
            mask_indeterminate(entry["force"], force),
            mask_indeterminate(entry["moment"], moment),
        )


def mark_coupling(block: Block, loads: CouplingLoads, stress: SelfStress) -> None:
    """Mark the indeterminate components of a coupling's block, in place: of its numbers, and of its load ON each
    body.
    """
    parts: dict[str, Mask] = {}
    for number in list_numbers(loads):
        rows = stress.multipliers[:, [loads.rows[k] for k in number.rows]]
        parts[number.name] = np.asarray(stress.has_share(rows, stress.length if number.is_moment else 1.0).any(axis=1))
    for entry in (block, *block.get("shares", {}).values()):
        for name in parts.keys() & entry.keys():
            entry[name] = mask_indeterminate(entry[name], parts[name])
    for number_name in ("radial", "axial", "normal", "torque", "tight", "slack"):
        if number_name in block and number_name not in parts and depends_on_load(loads.coupling, number_name):
            block[number_name], parts[number_name] = (
                mask_indeterminate(block[number_name], parts[loads.load_name]),
                parts[loads.load_name],
            )
    loads_by_stress = [loads.with_multipliers(stress.multipliers[:, :, k]) for k in range(stress.largest.shape[1])]
    body_loads = [list(entry.body_loads().values()) for entry in loads_by_stress]
    for i, (end, entry) in enumerate(block["on"].items()):
        share = np.stack([np.concatenate(bodies[i][1:], axis=1) for bodies in body_loads], axis=-1)
        mark_ground_load(entry, share, stress)
        force, moment = find_indeterminate_wrench(stress, share)
        parts |= {f"on.{end}.force": force, f"on.{end}.moment": moment}
    block["open"] = list_indeterminate_names(parts)


def depends_on_load(coupling: Coupling, number_name: str) -> bool:
    """Return whether a further number depends on the load: for straight teeth the axial part does not."""
    unit_numbers = DRIVE_ELEMENT_NUMBERS[coupling.entry.type](coupling.entry, np.ones(1), False)
    return bool(np.any(unit_numbers[number_name]))


def find_indeterminate_section(
    cuts: Cuts,
    states: BodyStates,
    joints: Sequence[JointLoads],
    couplings: Sequence[CouplingLoads],
    stress: SelfStress,
) -> dict[str, Mask]:
    """Return for each component of a section's loads whether it is indeterminate: some self-stress has a share in
    it.
    """
    from heuncli.loads.kinetostatics.sections import MOMENTS

    is_open: dict[str, Mask] = {}
    for k, components in enumerate(iter_self_stress_components(cuts, states, joints, couplings, stress)):
        limit = np.where(stress.largest[:, k] > 0.0, tolerances.OPEN_SHARE * stress.largest[:, k], np.inf)
        for name, share in components.items():
            scale = limit * (stress.length if name in MOMENTS else 1.0)
            has_share = np.abs(share) > scale.reshape(-1, *([1] * (share.ndim - 1)))
            is_open[name] = is_open.get(name, False) | has_share
    return is_open


def iter_self_stress_components(
    cuts: Cuts,
    states: BodyStates,
    joints: Sequence[JointLoads],
    couplings: Sequence[CouplingLoads],
    stress: SelfStress,
) -> Iterator[Block]:
    """Yield for each self-stress its share in the loads of cuts, by name."""
    from heuncli.loads.kinetostatics.piece_loads import find_attachments
    from heuncli.loads.kinetostatics.sections import compute_static_components

    for k in range(stress.largest.shape[1]):
        parts = zip(joints, stress.shares, strict=True)
        actions = [make_joint_action(j, s[:, :3, k], s[:, 3:, k]) for j, s in parts]
        actions += list_coupling_actions([own.with_multipliers(stress.multipliers[:, :, k]) for own in couplings])
        yield compute_static_components(cuts, states, find_attachments(cuts.body, states, actions))


def list_indeterminate_section_names(is_open: Mapping[str, Mask]) -> list[str]:
    """List a section's components that are indeterminate at some instant, in some cut."""
    from heuncli.loads.kinetostatics.sections import ABOUT_CENTROID

    reported = {name: mask for name, mask in is_open.items() if name not in ABOUT_CENTROID}
    return list_indeterminate_names(
        {name: mask.reshape(-1, 3) if mask.ndim == 3 else mask.ravel() for name, mask in reported.items()}
    )


# Indeterminate flanks


def add_flank_columns(
    stress: SelfStress, layout: Layout, joints: Sequence[JointLoads], couplings: Sequence[CouplingLoads]
) -> SelfStress:
    """Return the self-stresses with a column for the separating force of every mesh that they reach."""
    if not has_separating_forces(layout.mechanism):
        return stress
    columns = []
    for own in couplings:
        for r, part in own.iter_row_parts():
            unit = np.abs(stress.multipliers[:, r]) / np.where(stress.largest > 0.0, stress.largest, 1.0)
            if part.separating_force is not None and unit.max(initial=0.0) > tolerances.OPEN_SHARE:
                columns.append(
                    _flank_column(
                        layout, joints, part.separating_force, part.place, find_joints_between(layout, part.part)
                    )
                )
    if not columns:
        return stress
    shares = np.concatenate([stress.shares, np.stack(columns, axis=3)], axis=3)
    ones = np.ones((len(stress.largest), len(columns)))
    rows = np.zeros((*stress.multipliers.shape[:2], len(columns)))
    found: SelfStress = replace(
        stress, shares=shares, largest=np.concatenate([stress.largest, ones], axis=1),
        multipliers=np.concatenate([stress.multipliers, rows], axis=2),
    )  # fmt: skip
    return found


def _flank_column(
    layout: Layout, joints: Sequence[JointLoads], push: Array, place: Array, factors: dict[int, float]
) -> Array:
    """Return the shares of a unit separating force in all joints, (n_j, n_t, 6)."""
    shares = np.zeros((len(joints), len(push), 6))
    size = np.max(np.sqrt(np.sum(push * push, axis=1)))
    for k, share in factors.items():
        shares[k] = np.concatenate(transfer_force(joints[k], share / size * push, place), axis=1)
    return shares


# Friction check


def require_determinate_friction(layout: Layout, stress: SelfStress | None, states: BodyStates, times: Array) -> None:
    """Raise SolveError where a self-stress has a share in the load that causes friction, even if a stiffness splits
    it.
    """
    if stress is None or not stress.count.any():
        return
    friction_loads = layout.mechanism.joint_friction
    is_open = [is_pressure_indeterminate(layout, load, stress, states) for load in friction_loads]
    instants = np.flatnonzero(np.any(is_open, axis=0))
    if len(instants):
        # only on the way to an error
        from heuncli.motion.integration.diagnosis.ambiguous_laws import make_indeterminate_friction_problem

        loads = [load for load, mask in zip(friction_loads, is_open, strict=True) if mask[instants[0]]]
        raise SolveError(make_indeterminate_friction_problem(layout.mechanism, loads, float(times[instants[0]])))


def require_determinate_friction_at_start(scene: PreparedScene, runner: Runner, t: float) -> None:
    """Raise SolveError for indeterminate friction at the start."""
    evaluation = runner.evaluate(np.array([t]), scene.layout.y0[None, :])
    states = make_body_states(scene.layout, evaluation)
    require_determinate_friction(scene.layout, find_self_stress(runner, evaluation, states), states, evaluation.times)


def is_pressure_indeterminate(
    layout: Layout, load: JointLoad | ThreadLoad, stress: SelfStress, states: BodyStates
) -> Mask:
    """Return whether the pressure is indeterminate, (n_t,): a joint's force, with two ends its tilting moment, a
    thread's force.
    """
    mechanism = layout.mechanism
    if isinstance(load, ThreadLoad):
        row = layout.rows.index(len(mechanism.joints) + load.coupling)
        return np.asarray(stress.has_share(stress.multipliers[:, [row]]).any(axis=1))
    shares = np.moveaxis(stress.shares[load.joint], 2, 0)
    force, moment = remove_free_components(mechanism.joints[load.joint], states, shares[..., :3], shares[..., 3:])
    result = stress.has_share(np.moveaxis(force, 0, 2)).any(axis=-1)
    if load.presses == "ends":
        result = result | stress.has_share(np.moveaxis(moment, 0, 2), stress.length).any(axis=-1)
    return np.asarray(result)
