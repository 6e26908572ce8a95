"""Find the numbers of the results that are unknown: close to a singular pose, or indeterminate between instants.

Where the least singular value of the closures is σ (relative), a pose is closed to a gap g but may be off by g/σ, and
every derivative divides by σ once more: rates by g/σ², accelerations by g/σ³, multipliers by g/σ⁴. How much of this a
number feels depends on the motion and on the instant. So the states of such instants are moved by g/σ in some
directions, settled and recovered again: the change of a number is its error, and it is unknown (nan) where that exceeds
a table's digits of the largest of its kind.

Whether a component is indeterminate follows from the pose alone, by the null space of the closures. Between two
instants that null space turns steadily with the pose as long as its dimension is constant; a component with a share in
it on both sides has one between them, and a component with none on either side has none, except in single poses. So the
search of extremes finds the self-stresses on its grid, and between two instants of it with equal verdicts it uses
theirs. It does not where the number of dependent rows differs, where a contact has closed or opened, or where the pose
of either side is singular.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from typing import Any, Protocol

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.redundancy.indeterminate_components import list_indeterminate_names, mask_indeterminate
from heuncli.motion.integration.check.estimate import evaluate_run
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.tree.layout import Layout
from heuncli.results.path_words import find_quantity
from heuncli.results.results import Array, Indices, Mask
from heuncli.results.results_schema import SPACE
from heuncli.study.compose.blocks import make_requested_blocks
from heuncli.study.compose.recovery import RANK_REPORTS, Recovery

# An error is taken as SAFETY times the observed change: in 4,711 instants its ratio was 0.2 in the median, at most 3.4.
SAFETY = 10.0
DIRECTIONS = 3  # random ones in which a state is moved; with probability 1e-3 none meets the weak direction
ACCELERATION_UNITS = frozenset({"m/s²", "rad/s²", "N", "N·m", "Pa", "W", "N·m/s"})  # units that depend on them
PathAndUnit = tuple[str, str]  # numbers of one kind: the path of the schema, and the unit


class OpenMarker(Protocol):
    """Marks what is indeterminate at some instants without a new search for it (study/compose/unknown_numbers.py)."""

    def mark_open(self, blocks: dict[str, Any], times: Array) -> None:
        """Mark what is indeterminate in the blocks of these instants, in place."""


class Leaf(NamedTuple):
    """An array over the instants: its block, its name there, its kind, and whether it is of vectors."""

    block: dict[str, Any]
    name: str
    kind: PathAndUnit
    vectors: bool


class LeafGroup(NamedTuple):
    """Arrays over the instants of one kind and form: their values (n, n_leaves, ...) at some instants, and errors."""

    kind: PathAndUnit
    leaves: tuple[Leaf, ...]
    values: Array
    errors: Array


def make_blocks_without_unknown(
    recovery: Recovery,
    reports: Set[str],
    run: Trajectory,
    jumps: Sequence[float],
    open_marker: OpenMarker | None = None,
) -> tuple[dict[str, Any], Array]:
    """Make the blocks of a motion, nan where rounding decides a number close to a singular pose; return also these
    instants.

    open_marker: marks what is indeterminate, where the recovery does not look for it
    """
    blocks = make_requested_blocks(recovery, reports)
    if open_marker is not None:
        open_marker.mark_open(blocks, recovery.solutions.times)
    close_instants = find_nearly_singular(recovery, reports)
    if not len(close_instants):
        return blocks, np.zeros(0)
    moved_solutions = solve_moved_states(recovery, close_instants, run, jumps)
    skips_open_search = recovery.skips_indeterminacy_search and np.array_equal(
        moved_solutions.dependent_count, recovery.solutions.dependent_count[close_instants].repeat(DIRECTIONS)
    )
    moved_blocks = make_requested_blocks(
        Recovery(recovery.setup, moved_solutions, recovery.least_norm, skips_indeterminacy_search=skips_open_search),
        reports,
    )
    unknown = np.zeros(len(close_instants), dtype=bool)
    groups = group_leaves(blocks, moved_blocks, close_instants)
    scales = find_largest_by_kind(groups, estimate_typical_sizes(recovery, close_instants))
    left_out = (
        find_left_out_rows(recovery, close_instants)
        if reports & RANK_REPORTS
        else np.zeros(len(close_instants), dtype=bool)
    )
    for group in groups:
        path, unit = group.kind
        is_lost = find_unknown(group.errors, scales[group.kind])
        if unit in ACCELERATION_UNITS and not path.startswith("forces."):
            is_lost = is_lost | left_out.reshape(-1, *[1] * (is_lost.ndim - 1))
        for k in np.flatnonzero(is_lost.any(axis=(0, *range(2, is_lost.ndim)))).tolist():
            block, name, is_lost_here = group.leaves[k].block, group.leaves[k].name, is_lost[:, k]
            block[name] = block[name].copy()
            block[name][close_instants] = np.where(is_lost_here, np.nan, group.values[:, k])
            unknown |= is_lost_here.reshape(len(close_instants), -1).any(axis=1)
    return blocks, recovery.solutions.times[close_instants[unknown]]


def group_leaves(blocks: dict[str, Any], moved_blocks: dict[str, Any], close_instants: Indices) -> list[LeafGroup]:
    """Group the arrays over the instants by their kind and form; with their errors at close instants."""
    members: dict[Any, list[tuple[Leaf, Array]]] = {}
    for leaf, moved_leaf in zip(iter_leaves(blocks), iter_leaves(moved_blocks), strict=True):
        array = leaf.block[leaf.name]
        members.setdefault((leaf.kind, array.shape[1:], array.dtype), []).append(
            (leaf, moved_leaf.block[moved_leaf.name])
        )
    groups = []
    for (kind, _, _), pairs in members.items():
        values = np.stack([leaf.block[leaf.name][close_instants] for leaf, _ in pairs], axis=1)
        errors = estimate_errors(values, np.stack([moved for _, moved in pairs], axis=1))
        groups.append(LeafGroup(kind, tuple(leaf for leaf, _ in pairs), values, errors))
    return groups


def find_nearly_singular(recovery: Recovery, reports: Set[str]) -> Indices:
    """Return the instants at a singular pose, or so close to one that rounding may decide their results."""
    is_near = recovery.solutions.pivot < tolerances.NEAR_PIVOT
    if reports & RANK_REPORTS and recovery.resolution is not None and recovery.resolution.found_self_stress is not None:
        is_near |= recovery.resolution.found_self_stress.count > recovery.generic_self_stress_count
    return np.flatnonzero(is_near)


def find_left_out_rows(recovery: Recovery, close_instants: Indices) -> Mask:
    """Mark the instants at which the kernel left out rows that are independent elsewhere, as when passing a flat pose.

    Their multipliers are missing from the loads, and the directions that they constrain accelerate freely.
    """
    stress = recovery.resolution.found_self_stress if recovery.resolution is not None else None
    if stress is None:
        return np.zeros(len(close_instants), dtype=bool)
    return np.asarray(stress.count[close_instants] > recovery.generic_self_stress_count[close_instants])


def solve_moved_states(
    recovery: Recovery, close_instants: Indices, run: Trajectory, jumps: Sequence[float]
) -> Evaluation:
    """Solve the states of some instants again, each moved in some directions by the uncertainty of its closure."""
    layout, solutions = recovery.setup.scene.layout, recovery.solutions
    gap = np.maximum(solutions.gap[close_instants] / layout.size, tolerances.UNSEEN_GAP)
    # a pose closer to singular than its own gap counts as that close: gap/σ is at most σ
    sigma = np.maximum(np.sqrt(np.maximum(solutions.pivot[close_instants], 0.0)), np.sqrt(gap))
    shifts = (gap / sigma)[:, None, None] * make_directions(layout)
    states = solutions.states[close_instants][:, None] + shifts
    times = np.repeat(solutions.times[close_instants], DIRECTIONS)
    causes = solutions.causes is not None
    return evaluate_run(recovery.setup.runner, run, times, states.reshape(len(times), -1), jumps, causes=causes)


def make_directions(layout: Layout) -> Array:
    """Make fixed directions without a pattern in the coordinates of a state, (DIRECTIONS, n): angles, or parts of the
    size.
    """
    coordinates = np.zeros(layout.n_state)
    for group in layout.tables["groups"]:
        coordinates[group["coordinates"] : group["rates"]] = 1.0
    without_pattern = np.sin(7.0 * np.arange(1.0, DIRECTIONS * layout.n_state + 1.0) ** 2)
    weights = np.where(coordinates > 0.0, layout.weights, 1.0)
    return np.asarray(without_pattern.reshape(DIRECTIONS, -1) * coordinates / weights)


def iter_leaves(blocks: dict[str, Any], keys: tuple[str, ...] = ()) -> Iterator[Leaf]:
    """Yield the arrays over the instants in the blocks."""
    for name, part in blocks.items():
        if isinstance(part, dict):
            yield from iter_leaves(part, (*keys, name))
        elif isinstance(part, np.ndarray):
            row = find_quantity((*keys, name))
            if row is not None and row.is_timed:
                yield Leaf(blocks, name, (row.path, row.units[-1]), row.shape[-1:] == (SPACE,))


def find_largest_by_kind(groups: Sequence[LeafGroup], minimum_by_unit: Mapping[str, Array]) -> dict[PathAndUnit, Array]:
    """Return the largest number of each kind at each instant, minus its error; at least the typical size of its
    unit.
    """
    found: dict[PathAndUnit, Array] = {}
    for group in groups:
        most = find_largest_magnitudes(np.maximum(np.abs(group.values) - group.errors, 0.0))
        found[group.kind] = np.maximum(found.get(group.kind, minimum_by_unit.get(group.kind[1], 0.0)), most)
    return found


def estimate_typical_sizes(recovery: Recovery, close_instants: Indices) -> dict[str, Array]:
    """Return the typical size of numbers, by unit, at some instants of a motion under its weight, applied loads and
    speed, (n,).

    Accelerations and reactions are not used: they may be noise there. Numbers far below these sizes count as 0.
    """
    mechanism, states, size = recovery.setup.scene.mechanism, recovery.states, recovery.setup.scene.layout.size
    mass, one = sum(body.mass for body in mechanism.bodies), np.ones(len(close_instants))
    v = np.maximum(
        find_largest_magnitudes(states.v_centre[close_instants]),
        size * find_largest_magnitudes(states.omega[close_instants]),
    )
    load_sizes = [
        find_largest_magnitudes(a.force[close_instants]) + find_largest_magnitudes(a.moment[close_instants]) / size
        for a in recovery.law_actions
    ]
    a = v * v / size + float(np.linalg.norm(mechanism.gravity)) + sum(load_sizes, 0.0 * one) / mass
    v = np.maximum(v, np.sqrt(a * size))
    return {
        "m": size * one, "m/s": v, "m/s²": a, "rad": one, "rad/s": v / size, "rad/s²": a / size, "1": one,
        "N": mass * a, "N·m": mass * a * size, "J": mass * a * size, "W": mass * a * v, "N·m/s": mass * a * v,
        "N·s": mass * v, "N·m·s": mass * v * size,
    }  # fmt: skip


def find_largest_magnitudes(values: Array) -> Array:
    """Return the largest magnitude at each instant, (n,); nan does not count."""
    found = np.abs(values).reshape(len(values), -1)
    return np.asarray(np.where(np.isfinite(found), found, 0.0).max(axis=1, initial=0.0))


def estimate_errors(values: Array, moved_values: Array) -> Array:
    """Estimate the error of numbers (n, ...) by their change where their states are moved (n * DIRECTIONS, ...).

    Numbers that are indeterminate, here or in the moved state, do not count.
    """
    change = np.abs(moved_values.reshape(len(values), DIRECTIONS, *values.shape[1:]) - values[:, None])
    return np.asarray(SAFETY * np.where(np.isnan(change), 0.0, change).max(axis=1))


def find_unknown(errors: Array, scale: Array) -> Mask:
    """Mark the numbers that are unknown: their errors (n, ...) are too large relative to the largest of their kind
    (n,).
    """
    return np.asarray(errors > tolerances.UNKNOWN_NEAR_SINGULAR * scale.reshape(-1, *[1] * (errors.ndim - 1)))


class Verdicts(NamedTuple):
    """What is indeterminate at some instants, times (n_t,).

    dependent (n_t,): number of dependent closure rows
    holding (n_t, contacts): which contacts are closed
    ordinary (n_t,): whether the pose is not singular
    open: for each array over the instants the mask of its indeterminate components, None for none; empty if nothing is
    indeterminate
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
        count = max((len(part.open) for part in parts), default=0)
        rows = (part.open or (None,) * count for part in parts)
        self.open = [concatenate_masks(masks, lengths) for masks in zip(*rows, strict=True)]
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
        if all(mask is None for mask in self.open):
            return
        k = self._find_previous(times)
        for leaf, mask in zip(iter_leaves(blocks), self.open, strict=True):
            if mask is not None:
                leaf.block[leaf.name] = mask_indeterminate(leaf.block[leaf.name], mask[k])
                if "open" in leaf.block:  # it lists what is indeterminate at any instant or cut
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
    resolution, solutions = recovery.resolution, recovery.solutions
    if (
        resolution is None
        or resolution.choices
        or resolution.sentences
        or recovery.setup.scene.mechanism.joint_friction
    ):
        return None
    stress = resolution.found_self_stress
    ordinary = (
        np.ones(len(solutions.times), dtype=bool)
        if stress is None
        else stress.count <= recovery.generic_self_stress_count
    )
    found: tuple[Mask | None, ...] = ()
    if resolution.remaining_self_stress is not None:
        determinate_blocks, blocks = (
            make_requested_blocks(own, reports) for own in (recovery.without_indeterminacy_search(), recovery)
        )
        found = tuple(
            find_newly_open(own.block[own.name], other.block[other.name])
            for own, other in zip(iter_leaves(determinate_blocks), iter_leaves(blocks), strict=True)
        )
    return Verdicts(solutions.times, solutions.dependent_count, solutions.holding, ordinary, found)


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
