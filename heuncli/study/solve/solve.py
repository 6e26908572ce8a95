"""From a validated spec to its results: the one place that sees both the spec and the kernel.

Impure: looks at the clock.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from heuncli.errors import Problem, SolveError, SpecError
from heuncli.integration.contacts.blows import met_freely
from heuncli.integration.following import integrated_after_all
from heuncli.kernel.choose import KERNEL
from heuncli.method_rows import canonical, row_of
from heuncli.records import record, replace
from heuncli.results import Accuracy, Array, Block, Extremes, Magnitudes, Place, Results
from heuncli.results_schema import BLOWS, REPORTS, SHARED, SHARES, with_shared
from heuncli.spec.methods import unfit
from heuncli.spec.models import Spec
from heuncli.study.ask.selection import Asked, Entry, needed_by, sums_among
from heuncli.study.search import extremes
from heuncli.study.search.columns import Sampled
from heuncli.study.search.extremes import Searched
from heuncli.study.solve.finiteness import require_finite
from heuncli.study.solve.history import History, integrate, resample, search_times
from heuncli.study.solve.memory_estimate import Room, require_room
from heuncli.study.solve.places import placed
from heuncli.study.solve.recover import Recovery, accuracy, asked_blocks, certain_sums, recover
from heuncli.study.solve.setup import Setup, set_up
from heuncli.study.solve.warnings import beside_singular_poses, left_out, status, warnings
from heuncli.version import VERSION

if TYPE_CHECKING:
    from heuncli.integration.conditions import Changes
    from heuncli.integration.methods.method import Method
    from heuncli.study.solve.impulses import Impulses

MOST_SEARCHED = 1_000_000  # numbers to look at for the extremes of a whole report; one measure has no such bound
NONE: frozenset[str] = frozenset()
CHUNK = 200_000  # body-instants whose answers are kept at a time
TOO_FEW = "extremes are searched from {} instants: too few to see every turn and step of this motion"
CUT_SHORT = "the search for extremes was ended before all was looked at that may lie higher"


@record
class Options:
    """What a command asks beside the spec; None leaves it to the spec.

    wanted: reports, None for all; entries: single ones of these, in place of the whole. axes: of joint loads.
    """

    tolerance: float | None = None
    method: str | None = None
    step: float | None = None  # of a method of fixed step [s]
    wanted: frozenset[str] | None = None
    entries: frozenset[Entry] = frozenset()
    axes: str = "world"
    time_limit: float | None = None
    least_norm: bool = False
    reduce: bool = True  # whether less than the whole scene may be solved, where that changes nothing
    room: Room | None = None  # that results may take; None: as much as they want
    load_seconds: float = 0.0  # what reading the spec took, for the block `work`

    @property
    def reports(self) -> frozenset[str]:
        """The reports that are asked for."""
        return frozenset(REPORTS) if self.wanted is None else with_shared(self.wanted)

    @property
    def asked(self) -> Asked:
        """What of the results is asked for."""
        return Asked(self.reports, self.entries, self.axes)


def solve(spec: Spec, options: Options | None = None) -> Study:
    """Solve a spec. Raises SpecError, SolveError, LimitError."""
    with placed(spec):
        return begun(spec, options or Options())


def begun(spec: Spec, options: Options) -> Study:
    """The same, with errors that have names in place of places."""
    deadline = time.monotonic() + options.time_limit if options.time_limit is not None else None
    try:
        return solved(spec, options, deadline)
    except SolveError as error:
        if error.reached is None or not any(c.ends and c.value is None for c in spec.analysis.conditions):
            raise
        from heuncli.study.search.events import before_failure  # few scenes end so

        return before_failure(spec, options, deadline, error)


def solved(spec: Spec, options: Options, deadline: float | None) -> Study:
    """The same by a deadline (time.monotonic()), with nothing where the motion fails."""
    begun = time.perf_counter()
    conditions = spec.analysis.conditions
    asked = options.asked.with_all(needed_by(conditions, spec)) if conditions else options.asked
    spec = as_asked(spec, options)
    setup = set_up(spec, reduce=options.reduce, asked=asked)
    if options.room is not None:
        require_room(setup, options.room)
    built = time.perf_counter()
    history = integrate(setup, spec.analysis.tolerance, deadline, by_cause=SHARES in options.reports, room=options.room)
    whole, setup = setup, replace(setup, asked=options.asked) if conditions else setup
    moved = time.perf_counter()
    recovery = recover(setup, history.recovered, options.least_norm)
    struck = blows(setup, history, options.least_norm, SHARES in options.reports)
    results = compose(setup, history, recovery, options.reports, struck)
    looked_for = setup.rest.seconds if setup.rest is not None else 0.0
    seconds = {"load": options.load_seconds, "build": built - begun - looked_for, **history.seconds}
    results.work["seconds"] = seconds | {"recover": time.perf_counter() - moved}
    study = Study(spec, options, setup, history, recovery, results, struck)
    if not conditions:
        return study
    from heuncli.study.search.events import with_events  # few scenes have them

    return with_events(study, whole, deadline)


def blows(setup: Setup, history: History, least_norm: bool, by_cause: bool) -> Impulses | None:
    """The blows of the run, by_cause: with their shares; None where there was none."""
    if not history.blows:
        return None
    from heuncli.study.solve.impulses import impulses  # where something strikes

    return impulses(setup, history, least_norm, by_cause)


def describe(spec: Spec, *, reduce: bool = True) -> Block:
    """The block `model` of a scene, with its names, advice on what is redundant, and what a run of it will take."""
    with placed(spec):
        return described(spec, reduce)


def described(spec: Spec, reduce: bool) -> Block:
    """The same, with errors that have names in place of places."""
    from heuncli.redundancy.advice import advice  # runs give none
    from heuncli.study.solve.outlook import noticed, outlook

    asked = Options(wanted=None if spec.report is None else frozenset(spec.report)).asked
    setup = set_up(spec, reduce=reduce, asked=asked, looked_for=False)
    mechanism = setup.scene.mechanism
    names = {"bodies": [b.name for b in mechanism.bodies], "joints": {j.name: j.kind for j in mechanism.joints}}
    found = noticed(setup)
    if found is not None:
        setup = by_another_method(setup, *found)
    model = setup.model | {"names": names, "integrates": outlook(setup)}
    watched = [f"ends: until {c.text}" if c.ends else f"watched: {c.name} ({c.text})" for c in spec.analysis.conditions]
    return model | {"reasons": [*model["reasons"], *watched], "notes": model["notes"] + advice(setup.scene, model)}


def by_another_method(setup: Setup, method: Method, why: str) -> Setup:
    """The same with the method that a motion is begun anew with, stiff or full of events."""
    told = {"method": method.name, "reasons": [*setup.model["reasons"], anew(why, method)]}
    return replace(setup, method=method, model=setup.model | told)


def anew(why: str, method: Method) -> str:
    """Why a run was begun anew, and by which method."""
    return f"{why}; begun anew by {method.name}"


def as_asked(spec: Spec, options: Options) -> Spec:
    """The spec with the tolerance, method and step of the options; its own step goes with methods of fixed step alone.

    Raises SpecError where they do not go together.
    """
    given = spec.analysis
    method = given.method if options.method is None else options.method
    row = row_of(method)
    fixed = row is not None and row.steps == "fixed"
    step = options.step if options.step is not None or not (fixed or options.method is None) else given.step
    wrong = [Problem(one.code, one.message, hint=one.hint) for one in unfit(method, step, given.duration)]
    if wrong:
        raise SpecError(*wrong)
    given = given._replace(method=canonical(method), step=step)
    if options.tolerance is not None:
        given = given._replace(tolerance=options.tolerance, tolerance_given=True)
    return spec._replace(analysis=given)


def compose(
    setup: Setup, history: History, recovery: Recovery, wanted: frozenset[str], struck: Impulses | None
) -> Results:
    """The results at the instants of `recovery`, which are the history's own or others within it; and the blows.

    Raises SolveError where something is neither finite nor open.
    """
    shown, unknown = blocks_of(history, recovery, wanted)
    rest = setup.rest
    done = history.checked.run if history.checked is not None else rest
    known = accuracy_of(setup, history, recovery, struck)
    results = Results(
        title=setup.spec.title,
        spec={"path": setup.spec.path, "sha256": setup.spec.sha256},
        version=VERSION,
        model=model_of(setup, history, recovery),
        status=status(history) if rest is None else rest.status,
        time=recovery.recovered.times,
        **shown,
        impulses=struck.blocks() if struck is not None and BLOWS in wanted else [],
        certain_sums=sums_among(certain_sums(recovery), setup.asked) if "joints" in wanted else [],
        accuracy=known | ({"unknown": unknown.tolist()} if len(unknown) else {}),
        work={
            "kernel": KERNEL,
            "steps": done.steps if done is not None else 0,
            "evaluations": done.evaluations if done is not None else 0,
            "seconds": {},
        },
        warnings=(
            *warnings(setup, history, recovery, shown.get("joints", {}), known["balance_residual"]),
            *beside_singular_poses(unknown),
            *(rest.warnings if rest is not None else ()),
        ),
    )
    return require_finite(results)


def model_of(setup: Setup, history: History, recovery: Recovery) -> Block:
    """What the results say of the model, that of the run with what only the run shows."""
    split = recovery.decided.words if recovery.verdicts and recovery.decided is not None else ()
    return (
        setup.model
        | ({"split": "; ".join(split)} if split else {})
        | not_at_rest(recovery)
        | ({"axes": setup.asked.axes} if setup.asked.axes != "world" else {})
        | contacts_of(history)
        | integrated(setup, history)
    )


def accuracy_of(setup: Setup, history: History, recovery: Recovery, struck: Impulses | None) -> Accuracy:
    """How well the results are known: balance of bodies and blows, gaps, the horizon, estimated errors."""
    checked = history.checked
    struck_freely = sum(met_freely(setup.scene.layout, jump.impulses) for jump in history.blows)
    known = accuracy(recovery, checked.kinetic if checked is not None else 0.0, struck_freely, history.followed_for)
    if struck is not None:
        known["balance_residual"] = max(known["balance_residual"], struck.residual)
    gap = checked.run.gap if checked is not None else setup.scene.start.gap
    return known | {
        "constraint_gap": max(known["constraint_gap"], gap),
        "horizon": checked.horizon if checked is not None else None,
        "estimate": history.estimate,
    }


def not_at_rest(recovery: Recovery) -> Block:
    """What is told of a state that its loads set going."""
    if recovery.setup.spec.analysis.type != "state":
        return {}
    from heuncli.study.solve.state_motion import moves  # a motion moves

    found = moves(recovery)
    return {"moves": found} if found else {}


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


def contacts_of(history: History) -> Block:
    """What is told of contacts: who was struck at once, who came to rest after how many strikes."""
    notes = history.checked.run.notes if history.checked is not None else ()
    return {"contacts": list(notes)} if notes else {}


def blocks_of(history: History, recovery: Recovery, wanted: frozenset[str]) -> tuple[dict[str, Any], Array]:
    """The blocks of the reports that are wanted, and the instants of a motion at which some of it is not known: nan."""
    if history.checked is None or not recovery.setup.scene.layout.rows:
        return asked_blocks(recovery, wanted), np.zeros(0)
    from heuncli.study.search.near_singular import known_blocks  # only closed chains have singular poses

    return known_blocks(recovery, wanted, history.checked.run, history.jumps)


@record
class Study:
    """A solved scene: `results` at the asked instants, `resample` for any others of the same run.

    Impure: keeps what its answers at other instants are warned of.
    """

    spec: Spec
    options: Options
    setup: Setup
    history: History
    recovery: Recovery
    results: Results
    struck: Impulses | None = None
    changes: Mapping[str, Changes] = MappingProxyType({})

    @property
    def magnitudes(self) -> Magnitudes:
        """What the numbers at the asked instants, and those of blows, are summed from, and their errors."""
        own, errors = self.recovery.magnitudes, dict(self.history.errors)
        if self.struck is None:
            return own._replace(errors=errors)
        return own._replace(by_unit={**self.struck.by_unit, **own.by_unit}, errors=errors | self.struck.errors)

    @cached_property
    def search_times(self) -> Array:
        """Instants close enough to bracket every extreme, (n,) ascending."""
        times, enough = search_times(self.setup, self.history)
        if not enough:
            self.later[TOO_FEW.format(len(times))] = None
        if self.setup.cuts and len(times) > 1:
            from heuncli.study.search.passages import may_pass, passages  # where there are sections

            if may_pass(self.setup):
                times = extremes.distinct(np.concatenate([times, passages(lambda at: self._recovery(at, NONE), times)]))
        return extremes.filled(times)

    def resample(self, times: Array) -> Results:
        """The same run at other instants within it (ascending)."""
        if self.history.checked is None:
            return self.results
        wanted = self.options.reports
        results = compose(self.setup, self.history, self._recovery(times, wanted), wanted, self.struck)
        results.work["seconds"] = dict(self.results.work["seconds"])
        self.unknown.update(results.accuracy.get("unknown", ()))
        self.later.update(dict.fromkeys(w for w in results.warnings if w not in self.results.warnings))
        return results

    @cached_property
    def later(self) -> dict[str, None]:
        """What was warned of since the run, at other instants and in searches: sentences, in their order."""
        return {}

    @cached_property
    def unknown(self) -> set[float]:
        """The instants looked at since the run at which rounding beside a singular pose reaches some numbers."""
        return set(self.results.accuracy.get("unknown", ()))

    def impulses(self, setup: Setup | None = None) -> list[Block]:
        """The blocks of the blows; setup: with other cuts."""
        if self.struck is None:
            return []
        return (self.struck if setup is None else self.struck.cut_by(setup)).blocks()

    def struck_along(self, quantities: Sequence[str]) -> list[dict[str, Extremes]]:
        """Of each blow the extremes of some quantities along its runs of cuts, of their whole stretches."""
        if not any(cuts.s is not None for cuts in self.setup.cuts):
            return []
        from heuncli.study.search.stretches import extremes_at_a_blow  # only runs of cuts are worth it

        setup = self.stretched(False)
        return [extremes_at_a_blow(setup, block, quantities) for block in self.impulses(setup)]

    def only(self, times: Array, wanted: frozenset[str], setup: Setup | None = None) -> Results:
        """Some reports' blocks at other instants of the same run, and nothing beside them; setup: with other cuts."""
        recovery = self._recovery(times, wanted)
        recovery = recovery if setup is None else replace(recovery, setup=setup)
        own = self.results
        shown, unknown = blocks_of(self.history, recovery, wanted)
        accuracy: Accuracy = {"unknown": unknown.tolist()} if len(unknown) else {}
        times = recovery.recovered.times
        results = Results(own.title, own.spec, own.version, own.model, own.status, times, accuracy=accuracy, **shown)
        return require_finite(results)

    def at(self, times: Array) -> Results:
        """Loads by cause at other instants of the same run."""
        return self.only(times, self.options.reports & (SHARED | {SHARES}))

    def along(self, name: str, times: Array, places: Sequence[Place]) -> Results:
        """The same of a run of cuts, at places along it."""
        from heuncli.study.search.stretches import at_places

        return self.only(times, frozenset({"sections", SHARES}), at_places(self.setup, name, places))

    def _recovery(self, times: Array, wanted: frozenset[str]) -> Recovery:
        recovered = resample(self.setup.runner, self.history, times, by_cause=SHARES in wanted)
        return recover(self.setup, recovered, self.options.least_norm)

    @property
    def at_once(self) -> int:
        """At how many instants results are made at a time."""
        mechanism = self.setup.scene.mechanism
        causes = len(mechanism.loads) + 3 if SHARES in self.options.reports else 0
        return max(50, CHUNK // max(1, len(mechanism.bodies) * (1 + causes)))

    def stretched(self, bent: bool) -> Setup:
        """The scene with its runs of cuts as whole stretches; bent: for what is no polynomial of the loads."""
        from heuncli.study.search.stretches import stretched  # only runs of cuts are worth it

        return stretched(self.setup, bent)

    def extremes(
        self, searched: Searched, wanted: frozenset[str] | None, *, whole: bool = False, times: Array | None = None
    ) -> Extremes:
        """The extremes over the run, before its horizon, of the columns made of its results.

        wanted: the reports that the columns are made of, None for any. whole: of a whole report, where
        there may be so many columns that a search would outweigh the run: then they are those of the asked instants.
        times: of these instants alone.
        """
        between = times is None
        times = self.search_times if times is None else times
        if whole and len(searched.errors) * len(times) > MOST_SEARCHED:
            times, between = self.results.time, False
        horizon = self.results.accuracy.get("horizon")
        if horizon is not None:
            times = times[times < horizon] if times[0] < horizon else times[:1]
        reports = frozenset(REPORTS) if wanted is None else with_shared(wanted)
        sampled = Sampled(self, searched, reports, self.stretched(searched.bent) if searched.along else None)
        found = extremes.search(
            sampled.columns, times, sampled.groups, errors=searched.errors, even=searched.even, between=between,
            most=extremes.MOST_COLUMNS if whole else None,
        )  # fmt: skip
        found = sampled.placed(found)
        self.later.update(dict.fromkeys(left_out(sampled.unknown)))
        if not found.complete:
            self.later[CUT_SHORT] = None
        return found
