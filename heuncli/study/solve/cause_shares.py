"""Shares by cause beside the loads they add up to: put into the blocks of results, and their errors.

The error of a share is not that of the whole: two that nearly cancel are larger than their sum, and err by more. So the
check run compares the shares themselves, kind by kind, as it does the loads.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from heuncli.integration.evaluator import Recovered
from heuncli.kinetostatics.actions import Action
from heuncli.kinetostatics.bodies import BodyStates
from heuncli.kinetostatics.joint_axes import in_axes
from heuncli.kinetostatics.reactions import JointLoads
from heuncli.kinetostatics.shares import Column, Shares, foundation_shares, joint_shares, members_of, shares_of
from heuncli.results import Array, Block
from heuncli.results_schema import BY_CAUSE
from heuncli.study.solve.setup import Setup

if TYPE_CHECKING:
    from heuncli.study.solve.load_errors import Kinds, Terms
    from heuncli.study.solve.recover import Recovery


def put_shares(recovery: Recovery, about: Array, shown: dict[str, Any]) -> None:
    """Beside the loads of joints and foundation their shares by cause, in place."""
    shares = recovery.shares
    if "joints" in shown:
        for load in shares.joints:
            shown["joints"][load.joint.name]["shares"] = joint_shares(shares, load)
    if "foundation" in shown:
        mechanism = recovery.setup.scene.mechanism
        for keys, own in foundation_shares(mechanism, recovery.states, shares, about).items():
            at(shown["foundation"], keys)["shares"] = own


def at(block: Block, keys: tuple[str, ...]) -> Block:
    """The block under some keys."""
    for key in keys:
        block = block[key]
    return block


def compare_shares(
    kinds: Kinds, several: Recovered, states: BodyStates, applied: Sequence[Action], about: Array, terms: Terms
) -> None:
    """More instants of what a check run compares: see study/solve/load_errors.py."""
    setup = kinds.setup
    layout = setup.scene.layout
    shares = shares_of(layout, several, states, applied, members_of(layout.mechanism))
    more = larger(shares.column, terms)
    F, M = (x * more for x in terms.rounding)
    force, moment = terms.force * more, terms.moment * more
    told = [in_axes(load, states, setup.asked.axes) for load in shares.joints]
    found = of_joints(told) if "reactions" in kinds.compared else []
    found += of_foundation(setup, states, shares, about) if "foundation" in kinds.compared else []
    found += of_sections(setup, states, shares) if "sections" in kinds.compared else []
    for kind, name, values in found:
        rounding, of = (M, moment) if name == "moment" else (F, force)
        kinds.take((f"{kind} {BY_CAUSE}", name), values, rounding, of)


def larger(column: Column, terms: Terms) -> Array:
    """How many times the terms of the largest share are as large as those of the whole, at least once, (n_t,)."""
    of_rows = column.rows["multiplier"][..., None] * column.rows["f"]
    parts = [column.bodies["joint_force"], of_rows]
    largest = np.max([np.abs(x).max(axis=(0, 2, 3), initial=0.0) for x in parts], axis=0)
    return np.asarray(np.maximum(1.0, largest / np.where(terms.force > 0.0, terms.force, np.inf)))


Compared = list[tuple[str, str, Array]]  # kind, quantity, values with the instants first


def of_joints(joints: Sequence[JointLoads]) -> Compared:
    """The joints' shares."""
    found: Compared = []
    for name in ("force", "moment"):
        values = [np.moveaxis(getattr(load, name), 0, 1) for load in joints]
        found += [("reactions", name, np.stack(values, axis=1))] if values else []
    for load in joints:
        if load.drive is not None and load.joint.drive is not None:
            name = "moment" if load.joint.drive.quantity == "angle" else "force"
            found.append(("drives", name, load.drive.T[..., None]))
    return found


def of_foundation(setup: Setup, states: BodyStates, shares: Shares, about: Array) -> Compared:
    """The shares of the total and of the elements."""
    found: Compared = []
    for keys, block in foundation_shares(setup.scene.mechanism, states, shares, about).items():
        if keys[:1] == ("supports",):
            continue  # those of their joints
        for name in ("force", "moment"):
            both = [own[key] for own in block.values() for key in (name, f"direct_{name}") if key in own]
            found.append(("foundation", name, np.stack(both, axis=1)))
    return found


def of_sections(setup: Setup, states: BodyStates, shares: Shares) -> Compared:
    """The shares of the cuts' loads, world axes."""
    found: Compared = []
    if not setup.cuts:
        return found
    from heuncli.kinetostatics.section_shares import section_shares  # where there are sections

    for cuts in setup.cuts:
        block = section_shares(cuts, setup.scene.layout, states, shares, {})
        for name in ("force", "moment"):
            both = [own[key] for own in block.values() for key in (name, f"direct_{name}") if key in own]
            found.append(("sections", name, np.stack(both, axis=1)))
    return found
