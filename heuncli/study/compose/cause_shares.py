"""Shares by cause beside the loads they add up to, put into the blocks of results."""

from __future__ import annotations

from typing import Any

from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.coupling_numbers import numbers_of
from heuncli.loads.kinetostatics.shares import Shares, foundation_shares, joint_shares
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array, Block


def put_shares(shown: dict[str, Any], shares: Shares, mechanism: Mechanism, states: BodyStates, about: Array) -> None:
    """Beside the loads of joints and foundation their shares by cause, in place; about: the point of M_s, (3,)."""
    if "joints" in shown:
        for load in shares.joints:
            if load.joint.name in shown["joints"]:  # of single joints these alone are told
                shown["joints"][load.joint.name]["shares"] = joint_shares(shares, load)
        for coupled in shares.couplings:
            carried = {number.name: number.values for number in numbers_of(coupled) if number.is_sum}
            shown["couplings"][coupled.coupling.name]["shares"] = shares.by_name(carried)
    if "foundation" in shown:
        for keys, own in foundation_shares(mechanism, states, shares, about).items():
            at(shown["foundation"], keys)["shares"] = own


def at(block: Block, keys: tuple[str, ...]) -> Block:
    """The block under some keys."""
    for key in keys:
        block = block[key]
    return block
