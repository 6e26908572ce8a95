"""Setup + History + Recovery -> Results: the answers at some instants of a run, with what is told of it beside them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.kernel.choose import KERNEL
from heuncli.motion.integration.determined_motion import integrated_after_all
from heuncli.results.results import Array, Block, Results
from heuncli.results.results_schema import BLOWS
from heuncli.study.compose.accuracy import Balance, accuracy_of
from heuncli.study.compose.blocks import blocks_asked_for
from heuncli.study.compose.finiteness import require_finite
from heuncli.study.compose.recovery import Recovery, certain_sums
from heuncli.study.compose.smoothed_friction import has_smoothed_friction, samples_with_partial
from heuncli.study.compose.warnings import beside_singular_poses, status, warnings
from heuncli.study.model.method_choice import anew
from heuncli.study.model.selection import sums_among
from heuncli.study.model.setup import Setup
from heuncli.study.solve.history import History
from heuncli.version import VERSION

if TYPE_CHECKING:  # loaded where something strikes
    from heuncli.study.compose.impulses import Impulses
    from heuncli.study.compose.near_singular import TellsOpen


class Composed(NamedTuple):
    """What was composed of instants, (n_t,) ascending: their blocks, and how well they balance.

    recovery: what they were composed of, or the last part of it; unknown: the instants at which not all is known.
    """

    times: Array
    recovery: Recovery
    shown: Block
    unknown: Array
    balance: Balance


def compose(
    setup: Setup, history: History, recovery: Recovery, wanted: frozenset[str], struck: Impulses | None,
    own: Composed | None = None,
) -> Results:  # fmt: skip
    """The results at the instants of `recovery`, which are the history's own or others within it; and the blows.

    own: what was composed of them already, part by part. Raises SolveError where something is neither finite nor open.
    """
    own = own or composed_at_once(setup, history, recovery, wanted)
    rest = setup.rest
    done = history.checked.run if history.checked is not None else rest
    known = accuracy_of(history, own.balance, struck.residual if struck is not None else 0.0)
    results = Results(
        title=setup.spec.title,
        spec={"path": setup.spec.path, "sha256": setup.spec.sha256},
        version=VERSION,
        model=model_of(setup, history, recovery, whole=len(own.times) == len(recovery.recovered.times)),
        status=status(history, setup.scene.mechanism) if rest is None else rest.status,
        time=own.times,
        **own.shown,
        impulses=struck.blocks() if struck is not None and BLOWS in wanted else [],
        certain_sums=sums_among(certain_sums(recovery), setup.asked) if "joints" in wanted else [],
        accuracy=known | ({"unknown": own.unknown.tolist()} if len(own.unknown) else {}),
        work={
            "kernel": KERNEL,
            "steps": done.steps if done is not None else 0,
            "evaluations": done.evaluations if done is not None else 0,
            "seconds": {},
        },
        warnings=(
            *warnings(setup, history, recovery, own.shown.get("joints", {}), known["balance_residual"]),
            *beside_singular_poses(own.unknown),
            *of_wheels(setup, history, own.shown, struck),
            *of_belts(setup, recovery, own.shown, struck),
            *of_threads(setup, struck),
            *(rest.warnings if rest is not None else ()),
        ),
    )
    return require_finite(results)


def composed_at_once(setup: Setup, history: History, recovery: Recovery, wanted: frozenset[str]) -> Composed:
    """What is composed of all the instants of `recovery`."""
    shown, unknown = known_blocks(history, recovery, wanted)
    balance = Balance(setup, history.followed_for).add(recovery)
    return Composed(recovery.recovered.times, recovery, shown, unknown, balance)


def known_blocks(
    history: History, recovery: Recovery, wanted: frozenset[str], tells: TellsOpen | None = None
) -> tuple[dict[str, Any], Array]:
    """The blocks of the reports that are wanted, and the instants of a motion at which some of it is not known: nan.

    tells: puts in what is open, where the recovery does not look for it.
    """
    if history.checked is None or not recovery.setup.scene.layout.rows:
        return blocks_asked_for(recovery, wanted), np.zeros(0)
    from heuncli.study.compose.near_singular import without_unknown  # only closed chains have singular poses

    return without_unknown(recovery, wanted, history.checked.run, history.jumps, tells)


def of_wheels(setup: Setup, history: History, shown: Block, struck: Impulses | None) -> tuple[str, ...]:
    """Warnings of wheels that lift or slip where no event tells it."""
    if not setup.spec.rolling:
        return ()
    from heuncli.study.compose.wheels import at_the_instant, in_blows  # few scenes have them

    alone = at_the_instant(setup.spec, shown.get("couplings", {})) if history.checked is None else ()
    return (*alone, *(in_blows(setup.spec, struck) if struck is not None else ()))


def of_threads(setup: Setup, struck: Impulses | None) -> tuple[str, ...]:
    """Warnings of threads through which blows go."""
    if struck is None or not any(own.type == "screw" for own in setup.spec.couplings.values()):
        return ()
    from heuncli.study.compose.rubbing_threads import in_blows  # few scenes have them

    return tuple(in_blows(setup.spec, struck))


def of_belts(setup: Setup, recovery: Recovery, shown: Block, struck: Impulses | None) -> tuple[str, ...]:
    """Warnings of belts that would push where no event tells it."""
    if not any(own.type == "belt" for own in setup.spec.couplings.values()):
        return ()
    from heuncli.study.compose.belts import at_the_instant, in_blows  # few scenes have them

    largest = recovery.load_magnitudes.by_unit["N"]
    alone = setup.spec.analysis.type != "motion"
    told = at_the_instant(setup.spec, shown.get("couplings", {}), largest) if alone else ()
    return (*told, *(in_blows(setup.spec, struck) if struck is not None else ()))


def impulses_of(setup: Setup, history: History, least_norm: bool, by_cause: bool) -> Impulses | None:
    """The blows of the run, by_cause: with their shares; None where there was none."""
    if not history.blows:
        return None
    from heuncli.study.compose.impulses import impulses  # where something strikes

    return impulses(setup, history, least_norm, by_cause)


def model_of(setup: Setup, history: History, recovery: Recovery, *, whole: bool) -> Block:
    """What the results say of the model, that of the run with what only the run shows.

    whole: whether `recovery` is at all instants of the results.
    """
    split = recovery.decided.words if recovery.verdicts and recovery.decided is not None else ()
    return (
        setup.model
        | ({"split": "; ".join(split)} if split else {})
        | not_at_rest(recovery)
        | ({"axes": setup.asked.axes} if setup.asked.axes != "world" else {})
        | contacts_of(history)
        | integrated(setup, history)
        | (friction_near_rest(setup, recovery) if whole else {})
    )


def friction_near_rest(setup: Setup, recovery: Recovery) -> Block:
    """What is told of instants at which smoothed friction is not at its value; of a rest pose nothing rubs."""
    if setup.rest is not None or not has_smoothed_friction(setup.scene.mechanism):
        return {}
    notes = samples_with_partial(setup.scene.mechanism, recovery.recovered)
    return {"notes": [*setup.model["notes"], *notes]} if notes else {}


def not_at_rest(recovery: Recovery) -> Block:
    """What is told of a state that its loads set going."""
    if recovery.setup.spec.analysis.type != "state":
        return {}
    from heuncli.study.compose.accelerating_bodies import moves  # a motion moves

    found = moves(recovery)
    return {"moves": found} if found else {}


def contacts_of(history: History) -> Block:
    """What is told of contacts: how they share blows, who came to rest after how many strikes."""
    notes = history.checked.run.notes if history.checked is not None else history.notes
    return {"contacts": list(notes)} if notes else {}


def integrated(setup: Setup, history: History) -> Block:
    """What is told of a motion that went by another method than it was begun with."""
    checked = history.checked
    if checked is None or setup.method is None or checked.run.method is setup.method:
        return {}
    told: Block = {"method": checked.run.method.name}
    if setup.method.determined:
        told |= integrated_after_all(setup.model)
    if checked.begun_anew is not None:
        told |= {"reasons": [*setup.model["reasons"], anew(checked.begun_anew, checked.run.method)]}
    return told
