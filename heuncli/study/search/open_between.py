"""Predict which components are indeterminate between instants at which this was found.

It follows from the pose alone, by the null space of the closures. Between two instants that null space turns steadily
with the pose as long as its dimension is constant; a component with a share in it on both sides has one between them,
and a component with none on either side has none, except in single poses. So the search of extremes finds the
self-stresses on its grid, and between two instants of it with equal verdicts it uses theirs. It does not where the
number of dependent rows differs, where a contact has closed or opened, or where the pose of either side is singular.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.redundancy.indeterminate_components import list_indeterminate_names, mask_indeterminate
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.results.results import Array, Indices, Mask
from heuncli.study.compose.blocks import make_requested_blocks
from heuncli.study.compose.near_singular import iter_leaves
from heuncli.study.compose.recovery import Recovery


class Verdicts(NamedTuple):
    """What is indeterminate at some instants, times (n_t,).

    dependent (n_t,): number of dependent closure rows
    holding (n_t, contacts): which contacts are closed
    ordinary (n_t,): whether the pose is not singular
    open: for each array over the instants the mask of its indeterminate components, None for none
    """

    times: Array
    dependent: Array
    holding: Array
    ordinary: Mask
    open: tuple[Mask | None, ...]


class VerdictsBetween:
    """Verdicts at instants, ascending, and what they imply for the instants between."""

    def __init__(self, parts: Sequence[Verdicts]) -> None:
        times, dependent, holding, ordinary = (np.concatenate(x) for x in list(zip(*parts, strict=True))[:4])
        self.times, self.dependent, self.holding = times, dependent, holding
        lengths = [len(part.times) for part in parts]
        self.open = [concatenate_masks(masks, lengths) for masks in zip(*(part.open for part in parts), strict=True)]
        same = ordinary[1:] & ordinary[:-1] & (dependent[1:] == dependent[:-1])
        same &= (holding[1:] == holding[:-1]).all(axis=1)
        for mask in self.open:
            if mask is not None:
                same &= (mask[1:] == mask[:-1]).all(axis=tuple(range(1, mask.ndim)))
        self.same = same

    def covers(self, solutions: Evaluation) -> Mask:
        """Mark the instants whose indeterminate components follow from those on either side, (n,)."""
        if len(self.times) < 2:
            return np.zeros(len(solutions.times), dtype=bool)
        k = self._find_previous(solutions.times)
        is_inside = (solutions.times >= self.times[0]) & (solutions.times <= self.times[-1])
        is_unchanged = solutions.dependent_count == self.dependent[k]
        is_unchanged &= (solutions.holding == self.holding[k]).all(axis=1)
        return np.asarray(is_inside & self.same[k] & is_unchanged)

    def mark_open(self, blocks: dict[str, Any], times: Array) -> None:
        """Mark the indeterminate components in the blocks of instants that this covers, in place."""
        k = self._find_previous(times)
        for leaf, mask in zip(iter_leaves(blocks), self.open, strict=True):
            if mask is not None:
                leaf.block[leaf.name] = mask_indeterminate(leaf.block[leaf.name], mask[k])
                if "open" in leaf.block:  # at some instant, in some cut
                    leaf.block["open"] += list_indeterminate_names(
                        {leaf.name: mask[k].reshape(-1, *[3] * leaf.vectors)}
                    )

    def _find_previous(self, times: Array) -> Indices:
        """Return the index of the last known instant before each, at most the second to last."""
        return np.asarray(np.clip(np.searchsorted(self.times, times, side="right") - 1, 0, len(self.times) - 2))


def find_verdicts(recovery: Recovery, reports: frozenset[str]) -> Verdicts | None:
    """Return the verdicts at the instants of a recovery; None if redundancy affects its numbers in other ways, too.

    A split of the reactions, by least norm or stiffness, changes with the pose: it is found at each instant.
    """
    decided, recovered = recovery.decided, recovery.solutions
    if decided is None or decided.choices or decided.words or recovery.setup.scene.mechanism.joint_friction:
        return None
    stress = decided.found_self_stress
    ordinary = (
        np.ones(len(recovered.times), dtype=bool)
        if stress is None
        else stress.count <= recovery.generic_self_stress_count
    )
    determinate_leaves = list(iter_leaves(make_requested_blocks(recovery.without_indeterminacy_search(), reports)))
    found: tuple[Mask | None, ...] = (None,) * len(determinate_leaves)
    if decided.remaining_self_stress is not None:
        leaves_with_open = iter_leaves(make_requested_blocks(recovery, reports))
        found = tuple(
            find_newly_open(own.block[own.name], other.block[other.name])
            for own, other in zip(determinate_leaves, leaves_with_open, strict=True)
        )
    return Verdicts(recovered.times, recovered.dependent_count, recovered.holding, ordinary, found)


def find_newly_open(determinate: Array, values: Array) -> Mask | None:
    """Mark the numbers that are indeterminate only because of redundancy; None if there are none."""
    if values is determinate or values.dtype != np.float64:
        return None
    mask = np.isnan(values) & ~np.isnan(determinate)
    return mask if mask.any() else None


def concatenate_masks(masks: Sequence[Mask | None], lengths: Sequence[int]) -> Mask | None:
    """Concatenate the masks of consecutive instants, so many each; None if all are None."""
    shape = next((mask.shape[1:] for mask in masks if mask is not None), None)
    if shape is None:
        return None
    parts = zip(masks, lengths, strict=True)
    return np.concatenate([np.zeros((n, *shape), dtype=bool) if mask is None else mask for mask, n in parts])
