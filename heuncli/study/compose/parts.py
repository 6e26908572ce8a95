"""The results of a long run composed part by part: some instants at a time, whose arrays go to a file.

So memory holds the states of all instants, and of what follows from them a part. The numbers are the same to the last
bit as where all is composed at once: each follows from the state at its own instant, and products of matrices find that
at the same place of a block. What looks over all instants:

    central axis          none where the total is none beside the largest force of the run: left out afterwards
    accuracy              largest values, which grow from part to part (accuracy.py)
    errors                an error looks at the sizes of all instants: raised by composing all at once

Composed at once, as they are where they fit into memory (results.py):

    closed chains         what is open, certain sums, singular poses: judged from the self-stresses of all instants
    loads by cause        which causes there are is seen over all instants
    events on results     searched for in the answers at all instants
    one instant           there are no parts
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from heuncli.base.errors import SolveError
from heuncli.loads.kinetostatics.foundation import inertia_loads, largest_force, no_force
from heuncli.results.results import Array
from heuncli.results.results_schema import quantity
from heuncli.results.stored_arrays import ArrayStore, StoredArray
from heuncli.study.compose.accuracy import Balance
from heuncli.study.compose.blocks import blocks_asked_for
from heuncli.study.compose.finiteness import require_finite_blocks
from heuncli.study.compose.recovery import Recovery, recover
from heuncli.study.compose.results import Composed
from heuncli.study.model.memory_estimate import divisible, numbers_at_an_instant
from heuncli.study.model.setup import Setup
from heuncli.study.solve.history import History

AT_ONCE = 400_000  # numbers of a part, with the answers that they follow from
BLOCK = 8  # rows that BLAS multiplies together, at most; those left over are rounded otherwise
FEW = 2_000_000  # numbers that memory holds anyway: no parts


def composed_in_parts(setup: Setup, history: History, wanted: frozenset[str], least_norm: bool) -> Composed | None:
    """What is composed of the run's instants; None where they are to be composed at once.

    So they are, too, where a part fails: it is judged by its own sizes, and may fail where the whole does not.
    """
    numbers = numbers_at_an_instant(setup)
    if not divisible(setup) or numbers * len(history.times) <= FEW:
        return None
    parts = divided(len(history.times), int(AT_ONCE // numbers))
    try:
        return composed(setup, history, wanted, least_norm, parts)
    except SolveError:
        return None


def divided(count: int, at_once: int) -> list[slice]:
    """Parts of about so many instants, each but the last of whole blocks: as all at once are multiplied."""
    blocks, in_part = count // BLOCK, max(1, at_once // BLOCK)
    bounds = BLOCK * np.linspace(0, blocks, max(1, blocks // in_part) + 1).astype(int)
    bounds[-1] = count
    return [slice(first, end) for first, end in pairwise(bounds.tolist())]


def composed(setup: Setup, history: History, wanted: frozenset[str], least_norm: bool, parts: list[slice]) -> Composed:
    """All parts. Raises SolveError where one of them has no accelerations, or what is not finite in it."""
    store, shown, balance, largest = ArrayStore(), dict[str, Any](), Balance(setup, history.followed_for), 0.0
    for part in parts:
        recovery = recover(setup, history.answers(part), least_norm)
        own = blocks_asked_for(recovery, wanted)
        times = recovery.recovered.times
        require_finite_blocks(own, times, np.ones(len(times), dtype=bool))
        balance.add(recovery)
        shown = shown or room_for(store, own, len(history.times))
        put(shown, own, part.start)
        if "axis" in own.get("foundation", {}):
            largest = max(largest, largest_force_at(recovery, own["foundation"]["force"]))
    if "axis" in shown.get("foundation", {}):
        leave_out_axes(shown["foundation"], largest, parts)
    return Composed(history.times, recovery, shown, np.zeros(0), balance)


def room_for(store: ArrayStore, block: Mapping[str, Any], count: int, keys: tuple[str, ...] = ()) -> dict[str, Any]:
    """A block like one of a part, with room for so many instants in place of the part's own."""
    found: dict[str, Any] = {}
    for name, value in block.items():
        if isinstance(value, Mapping):
            found[name] = room_for(store, value, count, (*keys, name))
            continue
        row = quantity((*keys, name)) if isinstance(value, np.ndarray) else None
        timed = row is not None and row.timed
        found[name] = store.array((count, *value.shape[1:])) if timed else value
    return found


def put(shown: Mapping[str, Any], own: Mapping[str, Any], first: int) -> None:
    """A part's arrays into those of the run, from an instant on."""
    for name, room in shown.items():
        if isinstance(room, StoredArray):
            room.put(first, own[name])
        elif isinstance(room, Mapping):
            put(room, own[name], first)


def largest_force_at(recovery: Recovery, s: Array) -> float:
    """The largest force of a part that its foundation's s (n_t, 3) is seen beside [N]."""
    mechanism, states = recovery.setup.scene.mechanism, recovery.states
    actions = recovery.standing
    return largest_force(mechanism, s, inertia_loads(mechanism, states)[0], actions)


def leave_out_axes(foundation: Mapping[str, Any], largest: float, parts: list[slice]) -> None:
    """No central axis where the total is none beside the largest force of the run; a part saw its own largest alone."""
    for part in parts:
        none = no_force(foundation["force"][part], largest)
        for room in foundation["axis"].values() if none.any() else ():
            rows = room[part]
            rows[none] = np.nan
            room.put(part.start, rows)
