"""What redundant joints leave open between instants at which it was found.

What is open follows from the pose alone, by the null space of the closures. Between two instants that null space turns
with the pose, steadily as long as its dimension stands; a component in which it has a share on both sides has one
between them, and one in which it has none on either side has none, but for single poses. So the search of extremes
finds the self-stresses on its grid, and between two instants of it that agree in what is open takes their verdict. It
does not where the number of dependent rows is another there, where a contact has closed or opened, or where the pose of
either side is a singular one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.redundancy.open_components import names_of, opened
from heuncli.motion.integration.evaluator import Recovered
from heuncli.results.results import Array, Indices, Mask
from heuncli.study.compose.blocks import blocks_asked_for
from heuncli.study.compose.near_singular import leaves
from heuncli.study.compose.recovery import Recovery


class Verdicts(NamedTuple):
    """What was found at some instants, times (n_t,).

    dependent (n_t,): how many closure rows depend on others; holding (n_t, contacts); ordinary (n_t,): whether the pose
    is no singular one; open: of each array over the instants that they tell what is open of it, None for nothing.
    """

    times: Array
    dependent: Array
    holding: Array
    ordinary: Mask
    open: tuple[Mask | None, ...]


class OpenBetween:
    """Verdicts at instants, ascending, and what they say of those between."""

    def __init__(self, parts: Sequence[Verdicts]) -> None:
        times, dependent, holding, ordinary = (np.concatenate(x) for x in list(zip(*parts, strict=True))[:4])
        self.times, self.dependent, self.holding = times, dependent, holding
        lengths = [len(part.times) for part in parts]
        self.open = [joined(masks, lengths) for masks in zip(*(part.open for part in parts), strict=True)]
        same = ordinary[1:] & ordinary[:-1] & (dependent[1:] == dependent[:-1])
        same &= (holding[1:] == holding[:-1]).all(axis=1)
        for mask in self.open:
            if mask is not None:
                same &= (mask[1:] == mask[:-1]).all(axis=tuple(range(1, mask.ndim)))
        self.same = same

    def tells(self, recovered: Recovered) -> Mask:
        """At which instants what is open follows from what it is on either side, (n,)."""
        if len(self.times) < 2:
            return np.zeros(len(recovered.times), dtype=bool)
        k = self._before(recovered.times)
        inside = (recovered.times >= self.times[0]) & (recovered.times <= self.times[-1])
        as_there = recovered.dependent == self.dependent[k]
        as_there &= (recovered.holding == self.holding[k]).all(axis=1)
        return np.asarray(inside & self.same[k] & as_there)

    def put(self, shown: dict[str, Any], times: Array) -> None:
        """Mark what is open in the blocks of instants that this tells of, in place."""
        k = self._before(times)
        for leaf, mask in zip(leaves(shown), self.open, strict=True):
            if mask is not None:
                leaf.block[leaf.name] = opened(leaf.block[leaf.name], mask[k])
                if "open" in leaf.block:  # at some instant, in some cut
                    leaf.block["open"] += names_of({leaf.name: mask[k].reshape(-1, *[3] * leaf.vectors)})

    def _before(self, times: Array) -> Indices:
        """The last of the instants before each, but for the very last."""
        return np.asarray(np.clip(np.searchsorted(self.times, times, side="right") - 1, 0, len(self.times) - 2))


def verdicts(recovery: Recovery, wanted: frozenset[str]) -> Verdicts | None:
    """What is open at the instants of a recovery; None where that is not all that redundancy does to its numbers.

    A split of the reactions, by least norm or stiffness, changes with the pose as these do: it is found at each.
    """
    decided, recovered = recovery.decided, recovery.recovered
    if decided is None or decided.choices or decided.words or recovery.setup.scene.mechanism.rubbing:
        return None
    stress = decided.searched
    ordinary = np.ones(len(recovered.times), dtype=bool) if stress is None else stress.count <= recovery.generic
    bare = list(leaves(blocks_asked_for(recovery.as_told(), wanted)))
    found: tuple[Mask | None, ...] = (None,) * len(bare)
    if decided.left is not None:
        told = leaves(blocks_asked_for(recovery, wanted))
        found = tuple(
            newly_open(own.block[own.name], other.block[other.name]) for own, other in zip(bare, told, strict=True)
        )
    return Verdicts(recovered.times, recovered.dependent, recovered.holding, ordinary, found)


def newly_open(bare: Array, told: Array) -> Mask | None:
    """Which numbers are open that would not be if nothing were redundant; None where there are none."""
    if told is bare or told.dtype != np.float64:
        return None
    mask = np.isnan(told) & ~np.isnan(bare)
    return mask if mask.any() else None


def joined(masks: Sequence[Mask | None], lengths: Sequence[int]) -> Mask | None:
    """Masks of consecutive instants, so many each, as one; None where all are."""
    shape = next((mask.shape[1:] for mask in masks if mask is not None), None)
    if shape is None:
        return None
    parts = zip(masks, lengths, strict=True)
    return np.concatenate([np.zeros((n, *shape), dtype=bool) if mask is None else mask for mask, n in parts])
