"""Shares of loads by cause: put them into the results, and compare them between a run and its check run.

Two shares that nearly cancel are larger than their sum and have a larger error. So the check run compares the shares
themselves, kind by kind, like the loads.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.kinetostatics.actions import Action
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.coupling_numbers import list_numbers
from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.loads.kinetostatics.moved_reactions import (
    PlacedSensor,
    Reaction,
    iter_bearing_terms,
    make_bearing_loads,
)
from heuncli.loads.kinetostatics.reactions import JointLoads, rotate_joint_loads
from heuncli.loads.kinetostatics.shares import (
    CauseResults,
    Shares,
    find_cause_columns,
    find_shares,
    make_foundation_shares_blocks,
    make_joint_shares_block,
)
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array, Block
from heuncli.study.model.setup import Setup
from heuncli.study.solve.error_estimates import BalanceTerms


def add_shares(
    blocks: dict[str, Any], shares: Shares, mechanism: Mechanism, states: BodyStates, moment_point: Array
) -> None:
    """Add shares by cause to the loads of joints and foundation, in place.

    moment_point (3,): of M_s
    """
    if "joints" in blocks:
        for load in shares.joints:
            if load.joint.name in blocks["joints"]:  # if single joints are requested, only these are shown
                block = blocks["joints"][load.joint.name]
                block["shares"] = make_joint_shares_block(shares, load)
                if load.joint.bearings is not None:
                    for key, own in make_bearing_loads(load, mechanism.planar).items():
                        block["bearings"][key]["shares"] = shares.to_blocks(own)
        for coupled in shares.couplings:
            carried = {number.name: number.values for number in list_numbers(coupled) if number.is_sum}
            blocks["couplings"][coupled.coupling.name]["shares"] = shares.to_blocks(carried)
    if "foundation" in blocks:
        for keys, foundation_block in make_foundation_shares_blocks(mechanism, states, shares, moment_point).items():
            find_block(blocks["foundation"], keys)["shares"] = foundation_block


def find_block(block: Block, keys: tuple[str, ...]) -> Block:
    """Return the block under some keys."""
    for key in keys:
        block = block[key]
    return block


class ComparedShares(NamedTuple):
    """The shares of one kind of loads: `force` or `moment`, values of both runs with the instants first, (c n, ...).

    factor (c n,): ratio of the terms of the largest share to those of the whole
    """

    kind: str
    quantity: str
    values: Array
    factor: Array


def iter_compared_shares(
    setup: Setup,
    solutions: Evaluation,
    states: BodyStates,
    applied_actions: Sequence[Action],
    kinds: Set[str],
    terms: BalanceTerms,
) -> Iterator[ComparedShares]:
    """Yield the shares of the compared kinds of loads, of joints, couplings, foundation and sections."""
    layout = setup.scene.layout
    shares = find_shares(layout, solutions, states, applied_actions, find_cause_columns(layout.mechanism))
    factor = compute_term_ratio(shares.cause_results, terms)
    joint_shares = [rotate_joint_loads(load, states, setup.selection.axes) for load in shares.joints]
    shares_of_kinds = (
        list_joint_shares(joint_shares) + list_coupling_shares(shares.couplings) if "reactions" in kinds else []
    )
    shares_of_kinds += list_moved_shares(setup, states, shares) if "reactions" in kinds else []
    shares_of_kinds += list_foundation_shares(setup, states, shares) if "foundation" in kinds else []
    shares_of_kinds += list_section_shares(setup, states, shares) if "sections" in kinds else []
    for kind, name, values in shares_of_kinds:
        yield ComparedShares(kind, name, values, factor)


def compute_term_ratio(column: CauseResults, terms: BalanceTerms) -> Array:
    """Return the ratio of the terms of the largest share to those of the whole, at least 1, (n_t,)."""
    row_forces = column.rows["multiplier"][..., None] * column.rows["f"]
    parts = [column.bodies["joint_force"], row_forces]
    largest = np.max([np.abs(x).max(axis=(0, 2, 3), initial=0.0) for x in parts], axis=0)
    return np.asarray(np.maximum(1.0, largest / np.where(terms.force > 0.0, terms.force, np.inf)))


WRENCH = ("force", "moment")
KindValues = list[tuple[str, str, Array]]  # kind, quantity, values with the instants first


def list_joint_shares(joints: Sequence[JointLoads]) -> KindValues:
    """Return the shares of reactions and of drives."""
    found: KindValues = []
    for name in WRENCH:
        values = [np.moveaxis(getattr(load, name), 0, 1) for load in joints]
        found += [("reactions", name, np.stack(values, axis=1))] if values else []
    for load in joints:
        if load.drive is not None and load.joint.drive is not None:
            name = "moment" if load.joint.drive.quantity == "angle" else "force"
            found.append(("drives", name, load.drive.T[..., None]))
    return found


def list_moved_shares(setup: Setup, states: BodyStates, shares: Shares) -> KindValues:
    """Return the shares of the bearings of joints, and of what sensors read."""
    bearing_terms = iter_bearing_terms(shares.joints)
    found: KindValues = [("bearings", "force", np.moveaxis(values, 0, 1)) for values, *_ in bearing_terms]
    for sensor in setup.sensors:
        wrench = sensor.read(states, find_sensor_shares(setup, sensor, states, shares), setup.scene.mechanism.planar)
        found += [("sensors", name, np.moveaxis(values, 0, 1)) for name, values in zip(WRENCH, wrench, strict=True)]
    return found


def find_sensor_shares(setup: Setup, sensor: PlacedSensor, states: BodyStates, shares: Shares) -> Reaction:
    """Return the shares by cause in a sensor's reaction: origin (n_t, 3), force and moment, (n_c, n_t, 3) each."""
    if sensor.joint is not None:
        load = next(load for load in shares.joints if load.joint.name == sensor.joint)
        return Reaction(load.point, load.force, load.moment)
    from heuncli.loads.kinetostatics.sections import make_cut_places  # few sensors read a cut
    from heuncli.loads.kinetostatics.shares import make_section_shares_block

    cuts = next(cuts for cuts in setup.cuts if cuts.name == sensor.section).for_impulse
    block = make_section_shares_block(cuts, setup.scene.layout, states, shares, {})
    places = make_cut_places(cuts, states)
    origin = places.to_world_axes(places.moment_points, is_position=True)[:, 0]
    force, moment = (np.array([block[cause][name] for cause in shares.causes]) for name in WRENCH)
    return Reaction(origin, force, moment)


def list_coupling_shares(couplings: Sequence[CouplingLoads]) -> KindValues:
    """Return the shares of the coupling results that are sums of shares."""
    numbers = [number for own in couplings for number in list_numbers(own) if number.is_sum]
    return [
        ("reactions", "moment" if number.is_moment else "force", np.moveaxis(number.values, 0, 1)[..., None])
        for number in numbers
    ]


def list_foundation_shares(setup: Setup, states: BodyStates, shares: Shares) -> KindValues:
    """Return the shares of the foundation's total and of its elements."""
    found: KindValues = []
    for keys, block in make_foundation_shares_blocks(setup.scene.mechanism, states, shares, setup.moment_point).items():
        if keys[:1] == ("supports",):
            continue  # those of their joints
        for name in ("force", "moment"):
            values = [own[key] for own in block.values() for key in (name, f"direct_{name}") if key in own]
            found.append(("foundation", name, np.stack(values, axis=1)))
    return found


def list_section_shares(setup: Setup, states: BodyStates, shares: Shares) -> KindValues:
    """Return the shares of the cuts' loads, world axes."""
    found: KindValues = []
    if not setup.cuts:
        return found
    from heuncli.loads.kinetostatics.shares import make_section_shares_block  # where there are sections

    for cuts in setup.cuts:
        block = make_section_shares_block(cuts, setup.scene.layout, states, shares, {})
        for name in ("force", "moment"):
            values = [own[key] for own in block.values() for key in (name, f"direct_{name}") if key in own]
            found.append(("sections", name, np.stack(values, axis=1)))
    return found
