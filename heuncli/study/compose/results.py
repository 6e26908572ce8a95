"""Setup + History + Recovery -> Results: the blocks at some instants of a run, with the model, accuracy and
warnings.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.kernel.choose import KERNEL
from heuncli.motion.integration.integrated_scene import note_fallback_to_integration
from heuncli.results.results import Array, Block, Results
from heuncli.results.results_schema import IMPULSES
from heuncli.study.compose.accuracy import Balance, make_accuracy, require_finite
from heuncli.study.compose.blocks import make_requested_blocks
from heuncli.study.compose.recovery import Recovery, find_determinate_sums
from heuncli.study.compose.warnings import (
    collect_warnings,
    describe_partial_samples,
    has_smoothed_friction,
    make_status,
    warn_near_singular,
)
from heuncli.study.model.model_note import explain_restart
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
    """

    times: Array
    recovery: Recovery
    blocks: Block
    unknown: Array
    balance: Balance


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
        model=make_model_block(
            setup, history, recovery, is_complete=len(composed.times) == len(recovery.solutions.times)
        ),
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
            *warn_of_wheels(setup, history, composed.blocks, impulses),
            *warn_of_belts(setup, recovery, composed.blocks, impulses),
            *warn_of_threads(setup, impulses),
            *(rest.warnings if rest is not None else ()),
            *setup.start_warnings,
        ),
    )
    return require_finite(results)


def compose_at_once(setup: Setup, history: History, recovery: Recovery, reports: frozenset[str]) -> ComposedInstants:
    """Compose all the instants of `recovery`."""
    blocks, unknown = make_known_blocks(history, recovery, reports)
    balance = Balance(setup, history.followed_duration).add(recovery)
    return ComposedInstants(recovery.solutions.times, recovery, blocks, unknown, balance)


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


def warn_of_wheels(setup: Setup, history: History, blocks: Block, impulses: Impulses | None) -> tuple[str, ...]:
    """Warn of wheels that lift or slip where no event covers it."""
    if not setup.spec.rolling:
        return ()
    from heuncli.study.compose.scene_warnings import (  # few scenes have them
        warn_of_wheels_at_impulses,
        warn_of_wheels_at_instant,
    )

    instant_warnings = (
        warn_of_wheels_at_instant(setup.spec, blocks.get("couplings", {})) if history.checked_run is None else ()
    )
    return (*instant_warnings, *(warn_of_wheels_at_impulses(setup.spec, impulses) if impulses is not None else ()))


def warn_of_threads(setup: Setup, impulses: Impulses | None) -> tuple[str, ...]:
    """Warn of threads that transmit impulses."""
    if impulses is None or not any(own.type == "screw" for own in setup.spec.couplings.values()):
        return ()
    from heuncli.study.compose.scene_warnings import warn_of_threads_at_impulses  # few scenes have them

    return tuple(warn_of_threads_at_impulses(setup.spec, impulses))


def warn_of_belts(setup: Setup, recovery: Recovery, blocks: Block, impulses: Impulses | None) -> tuple[str, ...]:
    """Warn of belts that would push where no event covers it."""
    if not any(own.type == "belt" for own in setup.spec.couplings.values()):
        return ()
    from heuncli.study.compose.scene_warnings import (  # few scenes have them
        warn_of_belts_at_impulses,
        warn_of_belts_at_instant,
    )

    largest = recovery.load_magnitudes.by_unit["N"]
    has_one_instant = setup.spec.analysis.type != "motion"
    instant_warnings = (
        warn_of_belts_at_instant(setup.spec, blocks.get("couplings", {}), largest) if has_one_instant else ()
    )
    return (*instant_warnings, *(warn_of_belts_at_impulses(setup.spec, impulses) if impulses is not None else ()))


def find_impulses(setup: Setup, history: History, least_norm: bool, by_cause: bool) -> Impulses | None:
    """Return the impulses of the run, by_cause: with their shares; None if there was none."""
    if not history.impulses:
        return None
    from heuncli.study.compose.impulses import make_impulses  # only if there are impulses

    return make_impulses(setup, history, least_norm, by_cause)


def make_model_block(setup: Setup, history: History, recovery: Recovery, *, is_complete: bool) -> Block:
    """Make the block `model`: that of the setup, with what only the run shows.

    is_complete: whether `recovery` is at all instants of the results
    """
    split = recovery.decided.words if recovery.needs_indeterminacy and recovery.decided is not None else ()
    return (
        setup.model
        | ({"split": "; ".join(split)} if split else {})
        | make_acceleration_note(recovery)
        | ({"axes": setup.selection.axes} if setup.selection.axes != "world" else {})
        | make_contact_notes(history)
        | make_method_change(setup, history)
        | (make_friction_notes(setup, recovery) if is_complete else {})
    )


def make_friction_notes(setup: Setup, recovery: Recovery) -> Block:
    """Make the notes on instants at which smoothed friction is below its full value; a rest pose has no friction."""
    if setup.rest is not None or not has_smoothed_friction(setup.scene.mechanism):
        return {}
    notes = describe_partial_samples(setup.scene.mechanism, recovery.solutions)
    return {"notes": [*setup.model["notes"], *notes]} if notes else {}


def make_acceleration_note(recovery: Recovery) -> Block:
    """Make the entry on a state that its loads set in motion."""
    if recovery.setup.spec.analysis.type != "state":
        return {}
    from heuncli.study.compose.scene_warnings import describe_accelerations  # not for motions

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
