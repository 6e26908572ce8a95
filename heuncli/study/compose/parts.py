"""Compose the results of a long run part by part: some instants at a time, whose arrays go to a file.

So memory holds the states of all instants, but the results of one part only. The numbers are equal to the last bit to
those composed at once: each depends on the state at its own instant, and products of matrices see it at the same place
of a block. What depends on all instants:

    central axis          none where the total is zero relative to the largest force of the run: removed afterwards
    accuracy              largest values, which grow from part to part (accuracy.py)
    errors                an error depends on the sizes of all instants: raised by composing all at once

Composed at once, as where they fit into memory (results.py):

    closed chains         indeterminate components, determinate sums, singular poses depend on all instants
    loads by cause        the list of causes depends on all instants
    events on results     searched for in the solutions at all instants
    one instant           there are no parts
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from heuncli.base.errors import SolveError
from heuncli.loads.kinetostatics.foundation import inertia_loads, is_zero_force, largest_force
from heuncli.results.path_words import find_quantity
from heuncli.results.results import Array
from heuncli.results.stored_arrays import ArrayStore, StoredArray
from heuncli.study.compose.accuracy import Balance, require_finite_blocks
from heuncli.study.compose.blocks import make_requested_blocks
from heuncli.study.compose.recovery import Recovery, recover
from heuncli.study.compose.results import ComposedInstants
from heuncli.study.model.options import can_compose_in_parts, count_numbers_per_instant
from heuncli.study.model.setup import Setup
from heuncli.study.solve.history import History

AT_ONCE = 400_000  # numbers of a part, including the solutions
BLOCK = 8  # largest number of rows that BLAS multiplies together; remaining rows are rounded differently
FEW = 2_000_000  # numbers that fit into memory without parts


def compose_in_parts(
    setup: Setup, history: History, reports: frozenset[str], least_norm: bool
) -> ComposedInstants | None:
    """Compose the results of the run's instants part by part; None where they are to be composed at once.

    That is also the case where a part fails: it is judged by its own sizes, and may fail where the whole does not.
    """
    numbers = count_numbers_per_instant(setup)
    if not can_compose_in_parts(setup) or numbers * len(history.times) <= FEW:
        return None
    parts = divide_instants(len(history.times), int(AT_ONCE // numbers))
    try:
        return compose_parts(setup, history, reports, least_norm, parts)
    except SolveError:
        return None


def divide_instants(count: int, part_size: int) -> list[slice]:
    """Divide the instants into parts of about `part_size`; all but the last consist of whole blocks, as all at once are
    multiplied.
    """
    blocks, in_part = count // BLOCK, max(1, part_size // BLOCK)
    bounds = BLOCK * np.linspace(0, blocks, max(1, blocks // in_part) + 1).astype(int)
    bounds[-1] = count
    return [slice(first, end) for first, end in pairwise(bounds.tolist())]


def compose_parts(
    setup: Setup, history: History, reports: frozenset[str], least_norm: bool, parts: list[slice]
) -> ComposedInstants:
    """Compose all parts. Raises SolveError where one of them has no accelerations, or a number that is not finite."""
    store, blocks, balance, largest = ArrayStore(), dict[str, Any](), Balance(setup, history.followed_duration), 0.0
    for part in parts:
        recovery = recover(setup, history.find_solutions(part), least_norm)
        part_blocks = make_requested_blocks(recovery, reports)
        times = recovery.solutions.times
        require_finite_blocks(part_blocks, times, np.ones(len(times), dtype=bool))
        balance.add(recovery)
        blocks = blocks or allocate_like(store, part_blocks, len(history.times))
        copy_part(blocks, part_blocks, part.start)
        if "axis" in part_blocks.get("foundation", {}):
            largest = max(largest, find_largest_force(recovery, part_blocks["foundation"]["force"]))
    if "axis" in blocks.get("foundation", {}):
        drop_axes(blocks["foundation"], largest, parts)
    return ComposedInstants(history.times, recovery, blocks, np.zeros(0), balance)


def allocate_like(
    store: ArrayStore, block: Mapping[str, Any], count: int, keys: tuple[str, ...] = ()
) -> dict[str, Any]:
    """Allocate a block like one of a part, for `count` instants."""
    found: dict[str, Any] = {}
    for name, value in block.items():
        if isinstance(value, Mapping):
            found[name] = allocate_like(store, value, count, (*keys, name))
            continue
        row = find_quantity((*keys, name)) if isinstance(value, np.ndarray) else None
        is_timed = row is not None and row.is_timed
        found[name] = store.allocate((count, *value.shape[1:])) if is_timed else value
    return found


def copy_part(target: Mapping[str, Any], part: Mapping[str, Any], first: int) -> None:
    """Copy a part's arrays into those of the run, from an instant on."""
    for name, value in target.items():
        if isinstance(value, StoredArray):
            value.write_rows(first, part[name])
        elif isinstance(value, Mapping):
            copy_part(value, part[name], first)


def find_largest_force(recovery: Recovery, s: Array) -> float:
    """Return the largest force of a part that its foundation's s (n_t, 3) is compared with [N]."""
    mechanism, states = recovery.setup.scene.mechanism, recovery.states
    ma, _ = inertia_loads(mechanism, states)
    return largest_force(mechanism, s, ma, recovery.ground_actions, recovery.inner_forces)


def drop_axes(foundation: Mapping[str, Any], largest: float, parts: list[slice]) -> None:
    """Remove the central axis where the total is zero relative to the largest force of the run; a part knew only its
    own largest.
    """
    for part in parts:
        is_zero = is_zero_force(foundation["force"][part], largest)
        for stored in foundation["axis"].values() if is_zero.any() else ():
            rows = stored[part]
            rows[is_zero] = np.nan
            stored.write_rows(part.start, rows)
