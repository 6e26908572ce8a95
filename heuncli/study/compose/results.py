"""Setup + History + Recovery -> Results: the blocks at some instants of a run, with the model, accuracy and warnings.

A long run is composed part by part: some instants at a time, whose arrays go to a file. So memory holds the states of
all instants, but the results of one part only. The numbers are equal to the last bit to those composed at once: each
depends on the state at its own instant, and products of matrices see it at the same place of a block. What depends on
all instants:

    central axis          none where the total is zero relative to the largest force of the run: removed afterwards
    accuracy              largest values, which grow from part to part (accuracy.py)
    errors                an error depends on the sizes of all instants: raised by composing all at once

Composed at once, as where they fit into memory:

    closed chains         where something is indeterminate, or an instant is close to a singular pose: marks,
                          determinate sums and the sentences on singular poses depend on all instants
    events on results     searched for in the solutions at all instants
    one instant           there are no parts
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from heuncli.base.errors import SolveError
from heuncli.base.named_tuples import NamedTuple
from heuncli.kernel.choose import KERNEL
from heuncli.loads.kinetostatics.foundation import find_inertia_loads, is_zero_force, largest_force
from heuncli.motion.integration.integrated_scene import note_fallback_to_integration
from heuncli.results.path_words import find_quantity
from heuncli.results.results import Array, Block, Results
from heuncli.results.results_schema import IMPULSES
from heuncli.results.stored_arrays import ArrayStore, StoredArray
from heuncli.study.compose.accuracy import Balance, make_accuracy, require_finite, require_finite_blocks
from heuncli.study.compose.blocks import make_requested_blocks
from heuncli.study.compose.recovery import Recovery, find_determinate_sums, recover
from heuncli.study.compose.warnings import (
    PartialSamples,
    collect_warnings,
    find_partial_samples,
    make_status,
    warn_near_singular,
)
from heuncli.study.model.memory import can_compose_in_parts, count_numbers_per_instant, has_few_numbers
from heuncli.study.model.method_choice import explain_restart
from heuncli.study.model.selection import select_sums
from heuncli.study.model.setup import Setup
from heuncli.study.solve.history import History
from heuncli.version import VERSION

if TYPE_CHECKING:  # loaded only if there are impulses
    from heuncli.study.compose.impulses import Impulses
    from heuncli.study.compose.unknown_numbers import OpenMarker


class ComposedInstants(NamedTuple):
    """The results composed of instants, (n_t,) ascending: their blocks, and how well they balance.

    recovery: what they were composed of, or the last part of it
    unknown: the instants at which some numbers are unknown
    partial_friction: those at which smoothed friction is below its full value, if there are any
    """

    times: Array
    recovery: Recovery
    blocks: Block
    unknown: Array
    balance: Balance
    partial_friction: PartialSamples | None


def compose(
    setup: Setup, history: History, recovery: Recovery, reports: frozenset[str], impulses: Impulses | None,
    composed: ComposedInstants | None = None,
) -> Results:  # fmt: skip
    """Compose the results at the instants of `recovery`, which are the history's own or others within it, with the
    impulses.

    composed: what was composed of them already, part by part

    Raises SolveError where a number is neither finite nor indeterminate.
    """
    composed = composed or compose_at_once(setup, history, recovery, reports)
    rest = setup.rest
    run = history.checked_run.run if history.checked_run is not None else rest
    accuracy = make_accuracy(history, composed.balance, impulses.residual if impulses is not None else 0.0)
    results = Results(
        title=setup.spec.title,
        spec={"path": setup.spec.path, "sha256": setup.spec.sha256},
        version=VERSION,
        model=make_model_block(setup, history, recovery, composed),
        status=make_status(history, setup.scene.mechanism) if rest is None else rest.status,
        time=composed.times,
        **composed.blocks,
        impulses=impulses.make_blocks() if impulses is not None and IMPULSES in reports else [],
        certain_sums=select_sums(find_determinate_sums(recovery), setup.selection) if "joints" in reports else [],
        accuracy=accuracy | ({"unknown": composed.unknown.tolist()} if len(composed.unknown) else {}),
        work={
            "kernel": KERNEL,
            "steps": run.steps if run is not None else 0,
            "evaluations": run.evaluations if run is not None else 0,
            "seconds": {},
        },
        labels=dict(setup.spec.labels),
        warnings=(
            *collect_warnings(
                setup, history, recovery, composed.blocks.get("joints", {}), accuracy["balance_residual"]
            ),
            *warn_near_singular(composed.unknown),
            *warn_of_couplings(setup, history, recovery, composed.blocks, impulses),
            *(rest.warnings if rest is not None else ()),
            *setup.start_warnings,
        ),
    )
    return require_finite(results)


def compose_at_once(setup: Setup, history: History, recovery: Recovery, reports: frozenset[str]) -> ComposedInstants:
    """Compose all the instants of `recovery`."""
    blocks, unknown = make_known_blocks(history, recovery, reports)
    balance = Balance(setup, history.followed_duration).add(recovery)
    partial = find_partial_samples(setup.scene.mechanism, recovery.solutions)
    return ComposedInstants(recovery.solutions.times, recovery, blocks, unknown, balance, partial)


def make_known_blocks(
    history: History, recovery: Recovery, reports: frozenset[str], open_marker: OpenMarker | None = None
) -> tuple[dict[str, Any], Array]:
    """Make the blocks of some reports, nan for unknown numbers of a motion; return also the instants of these.

    open_marker: marks what is indeterminate, where the recovery does not look for it
    """
    if history.checked_run is None or not recovery.setup.scene.layout.rows:
        return make_requested_blocks(recovery, reports), np.zeros(0)
    # only closed chains have singular poses
    from heuncli.study.compose.unknown_numbers import make_blocks_without_unknown

    return make_blocks_without_unknown(recovery, reports, history.checked_run.run, history.jumps, open_marker)


def warn_of_couplings(
    setup: Setup, history: History, recovery: Recovery, blocks: Block, impulses: Impulses | None
) -> tuple[str, ...]:
    """Warn of wheels that lift or slip, belts that push and threads without friction, where no event covers it."""
    spec = setup.spec
    if not spec.rolling and not any(own.type in ("belt", "screw") for own in spec.couplings.values()):
        return ()
    from heuncli.study.compose.coupling_warnings import iter_coupling_warnings  # few scenes have them

    largest_force = recovery.load_magnitudes.by_unit["N"] if history.checked_run is None else None
    return tuple(iter_coupling_warnings(spec, blocks.get("couplings", {}), largest_force, impulses))


def find_impulses(setup: Setup, history: History, least_norm: bool, by_cause: bool) -> Impulses | None:
    """Return the impulses of the run, by_cause: with their shares; None if there was none."""
    if not history.impulses:
        return None
    from heuncli.study.compose.impulses import make_impulses  # only if there are impulses

    return make_impulses(setup, history, least_norm, by_cause)


def make_model_block(setup: Setup, history: History, recovery: Recovery, composed: ComposedInstants) -> Block:
    """Make the block `model`: that of the setup, with what only the run shows; recovery: of the instants or some of
    them.
    """
    split = recovery.resolution.sentences if recovery.needs_indeterminacy and recovery.resolution is not None else ()
    return (
        setup.model
        | ({"split": "; ".join(split)} if split else {})
        | make_acceleration_note(recovery)
        | ({"axes": setup.selection.axes} if setup.selection.axes != "world" else {})
        | make_contact_notes(history)
        | make_method_change(setup, history)
        | make_friction_notes(setup, composed)
    )


def make_friction_notes(setup: Setup, composed: ComposedInstants) -> Block:
    """Make the notes on instants at which smoothed friction is below its full value; a rest pose has no friction."""
    partial = composed.partial_friction
    if setup.rest is not None or partial is None:
        return {}
    return {"notes": [*setup.model["notes"], partial.describe(len(composed.times))]}


def make_acceleration_note(recovery: Recovery) -> Block:
    """Make the entry on a state that its loads set in motion."""
    if recovery.setup.spec.analysis.type != "state":
        return {}
    from heuncli.study.compose.warnings import describe_accelerations  # not for motions

    found = describe_accelerations(recovery)
    return {"moves": found} if found else {}


def make_contact_notes(history: History) -> Block:
    """Make the entry on contacts: how they share impulses, and which came to rest after how many impacts."""
    notes = history.checked_run.run.notes if history.checked_run is not None else history.notes
    return {"contacts": list(notes)} if notes else {}


def make_method_change(setup: Setup, history: History) -> Block:
    """Make the entries on a motion that was solved by another method than it began with."""
    checked = history.checked_run
    if checked is None or setup.method is None or checked.run.method is setup.method:
        return {}
    changes: Block = {"method": checked.run.method.name}
    if setup.method.is_determined:
        changes |= note_fallback_to_integration(setup.model)
    if checked.restart_reason is not None:
        changes |= {"reasons": [*setup.model["reasons"], explain_restart(checked.restart_reason, checked.run.method)]}
    return changes


AT_ONCE = 400_000  # numbers of a part, including the solutions
BLOCK = 8  # largest number of rows that BLAS multiplies together; remaining rows are rounded differently


def compose_in_parts(
    setup: Setup, history: History, reports: frozenset[str], least_norm: bool
) -> ComposedInstants | None:
    """Compose the results of the run's instants part by part; None where they are to be composed at once.

    That is also the case where a part fails, as it is judged by its own sizes and may fail where the whole does not, or
    where a closed chain shows what all instants decide.
    """
    if not can_compose_in_parts(setup) or has_few_numbers(setup, len(history.times)):
        return None
    parts = divide_instants(len(history.times), int(AT_ONCE // count_numbers_per_instant(setup)))
    try:
        return compose_parts(setup, history, reports, least_norm, parts)
    except SolveError:
        return None


def divide_instants(count: int, part_size: int) -> list[slice]:
    """Divide the instants into parts of about `part_size`.

    All parts but the last consist of whole blocks of the matrix products, so that each number keeps its bits.
    """
    blocks, in_part = count // BLOCK, max(1, part_size // BLOCK)
    bounds = BLOCK * np.linspace(0, blocks, max(1, blocks // in_part) + 1).astype(int)
    bounds[-1] = count
    return [slice(first, end) for first, end in pairwise(bounds.tolist())]


def compose_parts(
    setup: Setup, history: History, reports: frozenset[str], least_norm: bool, parts: list[slice]
) -> ComposedInstants | None:
    """Compose all parts; None where one of them depends on all instants.

    Raises SolveError where one of them has no accelerations, or a number that is not finite.
    """
    store, blocks, balance, largest = ArrayStore(), dict[str, Any](), Balance(setup, history.followed_duration), 0.0
    partial: PartialSamples | None = None
    for part in parts:
        recovery = recover(setup, history.find_solutions(part), least_norm)
        part_blocks, unknown = make_known_blocks(history, recovery, reports)
        if len(unknown) or depends_on_all_instants(recovery):
            return None
        times = recovery.solutions.times
        require_finite_blocks(part_blocks, times, np.ones(len(times), dtype=bool))
        balance.add(recovery)
        later = find_partial_samples(setup.scene.mechanism, recovery.solutions)
        partial = later if partial is None else partial.add_later(later)
        blocks = blocks or allocate_like(store, part_blocks, len(history.times))
        copy_part(blocks, part_blocks, part.start)
        if "axis" in part_blocks.get("foundation", {}):
            largest = max(largest, find_largest_force(recovery, part_blocks["foundation"]["force"]))
    if "axis" in blocks.get("foundation", {}):
        drop_axes(blocks["foundation"], largest, parts)
    return ComposedInstants(history.times, recovery, blocks, np.zeros(0), balance, partial)


def depends_on_all_instants(recovery: Recovery) -> bool:
    """Return whether a closed chain is indeterminate at some instants, or singular, or nearly so."""
    is_marked = recovery.needs_indeterminacy and recovery.resolution is not None and recovery.resolution.has_marks
    return is_marked or bool(recovery.describe_singular_poses())


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
    ma, _ = find_inertia_loads(mechanism, states)
    return largest_force(mechanism, s, ma, recovery.ground_actions, recovery.inner_forces)


def drop_axes(foundation: Mapping[str, Any], largest: float, parts: list[slice]) -> None:
    """Remove the central axis where the total is zero relative to the largest force of the run.

    A part of the results knew only its own largest force.
    """
    for part in parts:
        is_zero = is_zero_force(foundation["force"][part], largest)
        for stored in foundation["axis"].values() if is_zero.any() else ():
            rows = stored[part]
            rows[is_zero] = np.nan
            stored.write_rows(part.start, rows)
