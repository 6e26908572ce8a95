"""Numbers beside a singular pose of a motion: how far rounding reaches them there, and which are not known.

Where the least singular value of the closures is σ (relative), a pose is closed to a gap g but may be off by g/σ, and
every derivative divides by σ once more: rates by g/σ², accelerations by g/σ³, multipliers by g/σ⁴. How much of this
meets a number hangs on the motion and on where it is looked at. So the states of such instants are moved by g/σ in
some directions, settled and recovered again: what a number then changes by is its error, and it is not known (nan)
where that is more than a table's digits of the largest of its kind.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from typing import Any, Protocol

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.motion.integration.check.estimate import recovered_at
from heuncli.motion.integration.evaluator import Recovered
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Indices, Mask
from heuncli.results.results_schema import SPACE, quantity
from heuncli.study.compose.blocks import blocks_asked_for
from heuncli.study.compose.recovery import HUNG_ON_RANK, Recovery

AMPLE = 10.0  # times the change: errors were 0.2 of it in the median of 4,711 instants, 3.4 at the most
DIRECTIONS = 3  # in which a state is moved: that none of them meets the weak one is a matter of 1e-3
OF_ACCELERATIONS = frozenset({"m/s²", "rad/s²", "N", "N·m", "Pa", "W", "N·m/s"})  # units of what hangs on them
PathAndUnit = tuple[str, str]  # numbers of one kind: the path of the schema, and the unit


class TellsOpen(Protocol):
    """What knows what is open at some instants without a look at them (study/search/open_between.py)."""

    def put(self, shown: dict[str, Any], times: Array) -> None:
        """Mark what is open in the blocks of these instants, in place."""


class Leaf(NamedTuple):
    """An array over the instants: the block it stands in, its name there, of which kind it is, whether of vectors."""

    block: dict[str, Any]
    name: str
    kind: PathAndUnit
    vectors: bool


def without_unknown(
    recovery: Recovery, wanted: Set[str], run: Trajectory, jumps: Sequence[float], tells: TellsOpen | None = None
) -> tuple[dict[str, Any], Array]:
    """The blocks of a motion, nan where rounding reaches a number beside a singular pose; the instants of such.

    tells: puts in what is open, where the recovery does not look for it.
    """
    shown = blocks_asked_for(recovery, wanted)
    if tells is not None:
        tells.put(shown, recovery.recovered.times)
    near = nearly_singular(recovery, wanted)
    if not len(near):
        return shown, np.zeros(0)
    moved = moved_states(recovery, near, run, jumps)
    told = recovery.told and np.array_equal(moved.dependent, recovery.recovered.dependent[near].repeat(DIRECTIONS))
    other = blocks_asked_for(Recovery(recovery.setup, moved, recovery.least_norm, told=told), wanted)
    unknown = np.zeros(len(near), dtype=bool)
    known = [
        (leaf, leaf.block[leaf.name][near], error(leaf.block[leaf.name][near], elsewhere.block[leaf.name]))
        for leaf, elsewhere in zip(leaves(shown), leaves(other), strict=True)
    ]
    scales = largest_of_kind(known, least_by_unit(recovery, near))
    left_out = rows_left_out(recovery, near) if wanted & HUNG_ON_RANK else np.zeros(len(near), dtype=bool)
    for leaf, values, off in known:
        lost = reached(off, scales[leaf.kind])
        if leaf.kind[1] in OF_ACCELERATIONS and not leaf.kind[0].startswith("forces."):
            lost = lost | left_out.reshape(-1, *[1] * (lost.ndim - 1))
        if lost.any():
            block = leaf.block
            block[leaf.name] = block[leaf.name].copy()
            block[leaf.name][near] = np.where(lost, np.nan, values)
            unknown |= lost.reshape(len(near), -1).any(axis=1)
    return shown, recovery.recovered.times[near[unknown]]


def nearly_singular(recovery: Recovery, wanted: Set[str]) -> Indices:
    """The instants so near to a singular pose that rounding may reach what is told of them, or just at one."""
    near = recovery.recovered.pivot < tolerances.NEAR_PIVOT
    if wanted & HUNG_ON_RANK and recovery.decided is not None and recovery.decided.searched is not None:
        near |= recovery.decided.searched.count > recovery.generic
    return np.flatnonzero(near)


def rows_left_out(recovery: Recovery, near: Indices) -> Mask:
    """At which instants the kernel left out rows that are independent elsewhere, as on the way through a flat pose.

    Their multipliers are missing from the loads, and what they hold accelerates as if nothing did.
    """
    found = recovery.decided.searched if recovery.decided is not None else None
    if found is None:
        return np.zeros(len(near), dtype=bool)
    return np.asarray(found.count[near] > recovery.generic[near])


def moved_states(recovery: Recovery, near: Indices, run: Trajectory, jumps: Sequence[float]) -> Recovered:
    """The states of some instants, each moved in some directions by what its closing leaves open, recovered."""
    layout, recovered = recovery.setup.scene.layout, recovery.recovered
    gap = np.maximum(recovered.gap[near] / layout.size, tolerances.UNSEEN_GAP)
    # what is nearer than its own gap is no nearer than that: gap/σ is at most σ
    sigma = np.maximum(np.sqrt(np.maximum(recovered.pivot[near], 0.0)), np.sqrt(gap))
    by = (gap / sigma)[:, None, None] * directions(layout)
    states = recovered.states[near][:, None] + by
    times = np.repeat(recovered.times[near], DIRECTIONS)
    causes = recovered.causes is not None
    return recovered_at(recovery.setup.runner, run, times, states.reshape(len(times), -1), jumps, causes=causes)


def directions(layout: Layout) -> Array:
    """Fixed directions without a pattern in the coordinates of a state, (DIRECTIONS, n): angles, or of the size."""
    coordinates = np.zeros(layout.n_state)
    for group in layout.tables["groups"]:
        coordinates[group["coordinates"] : group["rates"]] = 1.0
    without_pattern = np.sin(7.0 * np.arange(1.0, DIRECTIONS * layout.n_state + 1.0) ** 2)
    weights = np.where(coordinates > 0.0, layout.weights, 1.0)
    return np.asarray(without_pattern.reshape(DIRECTIONS, -1) * coordinates / weights)


def leaves(shown: dict[str, Any], keys: tuple[str, ...] = ()) -> Iterator[Leaf]:
    """The arrays over the instants in the blocks."""
    for name, part in shown.items():
        if isinstance(part, dict):
            yield from leaves(part, (*keys, name))
        elif isinstance(part, np.ndarray):
            row = quantity((*keys, name))
            if row is not None and row.timed:
                yield Leaf(shown, name, (row.path, row.units[-1]), row.shape[-1:] == (SPACE,))


def largest_of_kind(known: Sequence[tuple[Leaf, Array, Array]], least: Mapping[str, Array]) -> dict[PathAndUnit, Array]:
    """The largest number of each kind at each instant, less its error; not below what its unit comes to (least)."""
    found: dict[PathAndUnit, Array] = {}
    for leaf, values, off in known:
        most = largest(np.maximum(np.abs(values) - off, 0.0))
        found[leaf.kind] = np.maximum(found.get(leaf.kind, least.get(leaf.kind[1], 0.0)), most)
    return found


def least_by_unit(recovery: Recovery, near: Indices) -> dict[str, Array]:
    """What numbers come to, by unit, at some instants of a motion under its weight, applied loads and speed, (n,).

    Not from accelerations or reactions: these may be noise there. What is 0 is told beside these.
    """
    mechanism, states, size = recovery.setup.scene.mechanism, recovery.states, recovery.setup.scene.layout.size
    mass, one = sum(body.mass for body in mechanism.bodies), np.ones(len(near))
    v = np.maximum(largest(states.v_centre[near]), size * largest(states.omega[near]))
    pushed = [largest(a.force[near]) + largest(a.moment[near]) / size for a in recovery.pushing]
    a = v * v / size + float(np.linalg.norm(mechanism.gravity)) + sum(pushed, 0.0 * one) / mass
    v = np.maximum(v, np.sqrt(a * size))
    return {
        "m": size * one, "m/s": v, "m/s²": a, "rad": one, "rad/s": v / size, "rad/s²": a / size, "1": one,
        "N": mass * a, "N·m": mass * a * size, "J": mass * a * size, "W": mass * a * v, "N·m/s": mass * a * v,
        "N·s": mass * v, "N·m·s": mass * v * size,
    }  # fmt: skip


def largest(values: Array) -> Array:
    """The largest magnitude at each instant, (n,); nan is none."""
    found = np.abs(values).reshape(len(values), -1)
    return np.asarray(np.where(np.isfinite(found), found, 0.0).max(axis=1, initial=0.0))


def error(values: Array, moved: Array) -> Array:
    """The error of numbers (n, ...), by what they change where their states are moved (n * DIRECTIONS, ...).

    What is open anyway, or open where the state is moved, says nothing.
    """
    change = np.abs(moved.reshape(len(values), DIRECTIONS, *values.shape[1:]) - values[:, None])
    return np.asarray(AMPLE * np.where(np.isnan(change), 0.0, change).max(axis=1))


def reached(off: Array, scale: Array) -> Mask:
    """Which numbers of these errors (n, ...) are not known, beside the largest of their kind (n,)."""
    return np.asarray(off > tolerances.TOLD_BESIDE * scale.reshape(-1, *[1] * (off.ndim - 1)))
