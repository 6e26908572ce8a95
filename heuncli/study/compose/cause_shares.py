"""Put shares by cause into the blocks of results, beside the loads that they add up to."""

from __future__ import annotations

from typing import Any

from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.coupling_numbers import list_numbers
from heuncli.loads.kinetostatics.shares import Shares, foundation_shares_blocks, joint_shares_block
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array, Block


def add_shares(
    blocks: dict[str, Any], shares: Shares, mechanism: Mechanism, states: BodyStates, moment_point: Array
) -> None:
    """Add shares by cause to the loads of joints and foundation, in place; moment_point: of M_s, (3,)."""
    if "joints" in blocks:
        for load in shares.joints:
            if load.joint.name in blocks["joints"]:  # if single joints are requested, only these are shown
                blocks["joints"][load.joint.name]["shares"] = joint_shares_block(shares, load)
        for coupled in shares.couplings:
            carried = {number.name: number.values for number in list_numbers(coupled) if number.is_sum}
            blocks["couplings"][coupled.coupling.name]["shares"] = shares.to_blocks(carried)
    if "foundation" in blocks:
        for keys, foundation_block in foundation_shares_blocks(mechanism, states, shares, moment_point).items():
            find_block(blocks["foundation"], keys)["shares"] = foundation_block


def find_block(block: Block, keys: tuple[str, ...]) -> Block:
    """Return the block under some keys."""
    for key in keys:
        block = block[key]
    return block
