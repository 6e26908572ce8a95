"""Shares by cause as a check run compares them: the error of a share is not that of the whole.

Two shares that nearly cancel are larger than their sum, and err by more. So the check run compares the shares
themselves, kind by kind, as it does the loads.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.kinetostatics.actions import Action
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.coupling_numbers import numbers_of
from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.loads.kinetostatics.joint_axes import in_axes
from heuncli.loads.kinetostatics.reactions import JointLoads
from heuncli.loads.kinetostatics.shares import Column, Shares, foundation_shares, members_of, shares_of
from heuncli.motion.integration.evaluator import Recovered
from heuncli.results.results import Array
from heuncli.study.model.setup import Setup
from heuncli.study.solve.balance_terms import BalanceTerms


class ComparedShares(NamedTuple):
    """The shares of one kind of loads: `force` or `moment`, values with the instants of both runs first, (c n, ...).

    more (c n,): how many times the terms of the largest share are as large as those of the whole.
    """

    kind: str
    quantity: str
    values: Array
    more: Array


def compared_shares(
    setup: Setup,
    several: Recovered,
    states: BodyStates,
    applied: Sequence[Action],
    kinds: Set[str],
    terms: BalanceTerms,
) -> Iterator[ComparedShares]:
    """The shares of the kinds of loads that are compared, of joints, couplings, foundation and sections."""
    layout = setup.scene.layout
    shares = shares_of(layout, several, states, applied, members_of(layout.mechanism))
    more = larger(shares.column, terms)
    told = [in_axes(load, states, setup.asked.axes) for load in shares.joints]
    found = of_joints(told) + of_couplings(shares.couplings) if "reactions" in kinds else []
    found += of_foundation(setup, states, shares) if "foundation" in kinds else []
    found += of_sections(setup, states, shares) if "sections" in kinds else []
    for kind, name, values in found:
        yield ComparedShares(kind, name, values, more)


def larger(column: Column, terms: BalanceTerms) -> Array:
    """How many times the terms of the largest share are as large as those of the whole, at least once, (n_t,)."""
    of_rows = column.rows["multiplier"][..., None] * column.rows["f"]
    parts = [column.bodies["joint_force"], of_rows]
    largest = np.max([np.abs(x).max(axis=(0, 2, 3), initial=0.0) for x in parts], axis=0)
    return np.asarray(np.maximum(1.0, largest / np.where(terms.force > 0.0, terms.force, np.inf)))


OfKind = list[tuple[str, str, Array]]  # kind, quantity, values with the instants first


def of_joints(joints: Sequence[JointLoads]) -> OfKind:
    """The shares of reactions and of drives."""
    found: OfKind = []
    for name in ("force", "moment"):
        values = [np.moveaxis(getattr(load, name), 0, 1) for load in joints]
        found += [("reactions", name, np.stack(values, axis=1))] if values else []
    for load in joints:
        if load.drive is not None and load.joint.drive is not None:
            name = "moment" if load.joint.drive.quantity == "angle" else "force"
            found.append(("drives", name, load.drive.T[..., None]))
    return found


def of_couplings(couplings: Sequence[CouplingLoads]) -> OfKind:
    """The shares of what couplings are told by, where it is a sum of them."""
    numbers = [number for own in couplings for number in numbers_of(own) if number.is_sum]
    return [
        ("reactions", "moment" if number.is_moment else "force", np.moveaxis(number.values, 0, 1)[..., None])
        for number in numbers
    ]


def of_foundation(setup: Setup, states: BodyStates, shares: Shares) -> OfKind:
    """The shares of the total and of the elements."""
    found: OfKind = []
    for keys, block in foundation_shares(setup.scene.mechanism, states, shares, setup.about).items():
        if keys[:1] == ("supports",):
            continue  # those of their joints
        for name in ("force", "moment"):
            both = [own[key] for own in block.values() for key in (name, f"direct_{name}") if key in own]
            found.append(("foundation", name, np.stack(both, axis=1)))
    return found


def of_sections(setup: Setup, states: BodyStates, shares: Shares) -> OfKind:
    """The shares of the cuts' loads, world axes."""
    found: OfKind = []
    if not setup.cuts:
        return found
    from heuncli.loads.kinetostatics.section_shares import section_shares  # where there are sections

    for cuts in setup.cuts:
        block = section_shares(cuts, setup.scene.layout, states, shares, {})
        for name in ("force", "moment"):
            both = [own[key] for own in block.values() for key in (name, f"direct_{name}") if key in own]
            found.append(("sections", name, np.stack(both, axis=1)))
    return found
