"""From a validated spec to its results: the one place that sees both the spec and the kernel.

Impure: looks at the clock.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from heuncli.errors import Problem, SpecError
from heuncli.integration.methods import METHODS
from heuncli.kernel.choose import KERNEL
from heuncli.records import record
from heuncli.results import Accuracy, Array, Block, Extremes, Magnitudes, Results
from heuncli.results_schema import REPORTS
from heuncli.spec.models import Spec
from heuncli.study import extremes
from heuncli.study.history import History, integrate, resample, search_times
from heuncli.study.recover import Recovery, accuracy, blocks, certain_sums, recover
from heuncli.study.setup import Setup, set_up
from heuncli.study.warnings import beside_singular_poses, left_out, status, warnings
from heuncli.version import VERSION

MOST_SEARCHED = 1_000_000  # numbers to look at for extremes between the samples


@record
class Options:
    """What a command asks beside the spec; None leaves it to the spec. wanted: reports, None for all."""

    tolerance: float | None = None
    method: str | None = None
    wanted: frozenset[str] | None = None
    time_limit: float | None = None
    least_norm: bool = False
    load_seconds: float = 0.0  # what reading the spec took, for the block `work`


def solve(spec: Spec, options: Options | None = None) -> Study:
    """Solve a spec. Raises SpecError, SolveError, LimitError."""
    options = options or Options()
    deadline = time.monotonic() + options.time_limit if options.time_limit else None
    begun = time.perf_counter()
    setup = set_up(spec, known_method(options.method))
    built = time.perf_counter()
    history = integrate(setup, spec.analysis.tolerance if options.tolerance is None else options.tolerance, deadline)
    moved = time.perf_counter()
    recovery = recover(setup, history.recovered, options.least_norm)
    results = compose(setup, history, recovery, options.wanted)
    seconds = {"load": options.load_seconds, "build": built - begun, **history.seconds}
    results.work["seconds"] = seconds | {"recover": time.perf_counter() - moved}
    return Study(spec, options, setup, history, recovery, results)


def describe(spec: Spec) -> Block:
    """The block `model` of a scene, with advice on what is redundant; nothing is integrated."""
    from heuncli.redundancy.advice import advice  # runs give none

    setup = set_up(spec)
    return setup.model | {"notes": setup.model["notes"] + advice(setup.scene, setup.model)}


def known_method(name: str | None) -> str | None:
    """The name of a method if it is one. Raises SpecError [not-yet]."""
    if name is not None and name not in METHODS:
        message = f"method {name}: not yet: a method other than {' and '.join(METHODS)}"
        raise SpecError(Problem("not-yet", message, hint=f"known: {', '.join(METHODS)}"))
    return name


def compose(setup: Setup, history: History, recovery: Recovery, wanted: frozenset[str] | None) -> Results:
    """The results at the instants of `recovery`, which are the history's own or others within it."""
    wanted = frozenset(REPORTS) if wanted is None else wanted
    shown, unknown = blocks_of(history, recovery, wanted)
    split = recovery.decided.words if recovery.decided is not None else ()
    balance = accuracy(recovery)
    checked = history.checked
    gap = checked.run.gap if checked is not None else setup.scene.start.gap
    return Results(
        title=setup.spec.title,
        spec={"path": setup.spec.path, "sha256": setup.spec.sha256},
        version=VERSION,
        model=setup.model | ({"split": "; ".join(split)} if split else {}),
        status=status(history),
        time=recovery.recovered.times,
        **shown,
        certain_sums=certain_sums(recovery) if "joints" in wanted else [],
        accuracy=balance
        | {
            "constraint_gap": max(balance["constraint_gap"], gap),
            "horizon": checked.horizon if checked is not None else None,
            "estimate": history.estimate,
        }
        | ({"unknown": unknown.tolist()} if len(unknown) else {}),
        work={
            "kernel": KERNEL,
            "steps": checked.run.steps if checked is not None else 0,
            "evaluations": checked.run.evaluations if checked is not None else 0,
            "seconds": {},
        },
        warnings=(
            *warnings(setup, history, recovery, shown.get("joints", {}), balance["balance_residual"]),
            *beside_singular_poses(unknown),
        ),
    )


def blocks_of(history: History, recovery: Recovery, wanted: frozenset[str]) -> tuple[dict[str, Any], Array]:
    """The blocks of the reports that are wanted, and the instants of a motion at which some of it is not known: nan."""
    if history.checked is None or not recovery.setup.scene.layout.rows:
        return blocks(recovery, wanted), np.zeros(0)
    from heuncli.study.beside import known_blocks  # only closed chains have singular poses

    return known_blocks(recovery, wanted, history.jumps)


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

    @property
    def magnitudes(self) -> Magnitudes:
        """What the numbers at the asked instants are summed from, and their errors."""
        checked = self.history.checked
        return self.recovery.magnitudes._replace(errors=checked.errors if checked is not None else {})

    @cached_property
    def search_times(self) -> Array:
        """Instants close enough to bracket every extreme, (n,) ascending."""
        return search_times(self.history)

    def resample(self, times: Array) -> Results:
        """The same run at other instants within it (ascending)."""
        if self.history.checked is None:
            return self.results
        results = self._composed(times)
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

    def only(self, times: Array, wanted: frozenset[str]) -> Results:
        """Some reports' blocks at other instants of the same run, and nothing beside them."""
        recovery = self._recovery(times)
        own = self.results
        shown, unknown = blocks_of(self.history, recovery, wanted)
        accuracy: Accuracy = {"unknown": unknown.tolist()} if len(unknown) else {}
        times = recovery.recovered.times
        return Results(own.title, own.spec, own.version, own.model, own.status, times, accuracy=accuracy, **shown)

    def _composed(self, times: Array) -> Results:
        results = compose(self.setup, self.history, self._recovery(times), self.options.wanted)
        results.work["seconds"] = dict(self.results.work["seconds"])
        return results

    def _recovery(self, times: Array) -> Recovery:
        recovered = resample(self.setup.runner, self.history, times)
        return recover(self.setup, recovered, self.options.least_norm)

    def extremes(
        self,
        columns: Callable[[Results], Array],
        groups: Sequence[Sequence[int]],
        wanted: frozenset[str] | None,
        rounds: int = extremes.ROUNDS,
    ) -> Extremes:
        """The extremes over the run, before its horizon, of the columns made of its results.

        wanted: the reports that the columns are made of, None where that is not known. Where there are so many columns
        that a search would outweigh the run, the extremes are those of the asked instants.
        """
        times = self.search_times
        if sum(map(len, groups)) * len(times) > MOST_SEARCHED:
            times, rounds = self.results.time, 0
        horizon = self.results.accuracy.get("horizon")
        if horizon is not None:
            times = times[times < horizon] if times[0] < horizon else times[:1]

        unknown: list[float] = []

        def sample(at: Array) -> Array:
            if np.array_equal(at, self.results.time):
                results = self.results
            else:
                results = self._composed(at) if wanted is None else self.only(at, wanted)
            unknown.extend(results.accuracy.get("unknown", []))
            return columns(results)

        found = extremes.search(sample, times, groups, rounds)
        self.later.update(dict.fromkeys(left_out(unknown)))
        return found
