"""The kernel's loop with the arrays it writes to, and what is put down of its steps."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from heuncli import tolerances
from heuncli.integration.methods.method import Method
from heuncli.integration.run.pace import FIRST_LOOK
from heuncli.integration.run.step_records import Growing, Kept
from heuncli.kernel.choose import integration
from heuncli.mechanism.model import Load
from heuncli.records import record
from heuncli.response import Workspace
from heuncli.results import Array
from heuncli.tree.layout import Layout

KEPT = 20_000_000  # numbers in the states kept for replays, at the ends of all steps or of every second, fourth, ...
PASSED = 100_000  # of these states, at most, on the way to an error
STIFF_AFTER = 15  # steps held short by stability, as in Hairer's DOP853 ...
EASY_AFTER = 6  # ... and steps on end that were not, after which their count begins anew
LOOK_AFTER = 1_000  # steps; then each time that they have doubled
EVENTS_AFTER = 16  # steps; then likewise: fewer are no pattern
UNWATCHED = {"stiff_after": 0, "easy_after": 0, "look_after": 0, "stable": 0.0}
PER_STEP = ("ends", "settled", "pivots", "turned")  # what is put down of each step


@record
class Start:
    """What a run sets out from, and what its steps are judged by.

    local: the tolerance of a step, or of a method of given steps their length; rate [1/s]: slower ones are judged as if
    that fast. following: its steps are given by their ends, and none is judged; late: events are met late by rounding,
    to see what that makes of the run; watched: it is noticed where stability holds its steps short.
    """

    state: Array
    local: float
    rate: float = 0.0
    following: bool = False
    late: bool = False
    watched: bool = False


class Integration:
    """The kernel's loop over the asked instants, at most `most` steps at a time, with the arrays it writes to."""

    def __init__(
        self, layout: Layout, workspace: Workspace, method: Method, times: Array, most: int, start: Start
    ) -> None:
        if method.foreign:
            raise ValueError(f"the kernel has no stages of {method.name}")
        n = self.n = layout.n_state
        self.method, self.start = method, start
        self.looked = 0  # steps after which it was looked at last whether another method takes less
        self.width = integration.record_width(workspace, n)
        self.output = {name: np.zeros(most) for name in PER_STEP}
        self.held = layout.pack.held
        self.branches = np.zeros(most * self.held)
        self.passed = np.zeros(0 if start.following else most * self.width)
        self.count = len(times)
        self.samples = np.zeros(self.count * n)
        output = self.output | {"times": times, "samples": self.samples, "passed": self.passed}
        output["branches"] = self.branches
        self.loop = integration.Integration(workspace, method.arrays, begin_with(start, method, layout), output)

    def records(self, every: int, offset: int) -> Array:
        """What the steps after those just done start from: of every so many, (count, width); a view."""
        done = self.loop.done
        return self.passed[: done * self.width].reshape(done, self.width)[offset::every]

    def held_branches(self) -> Array:
        """The branches that the steps just done held, (count, n); a view."""
        return self.branches[: self.loop.done * self.held].reshape(-1, self.held)

    def states(self) -> Array:
        """The states at the asked instants, (n_t, n)."""
        self.loop.fetch()
        return self.samples.reshape(self.count, self.n)


def begin_with(start: Start, method: Method, layout: Layout) -> dict[str, Any]:
    """A start as the kernel's loop takes it (kernel/integration.py): its tolerance, or the step in its place."""
    return {
        "groups": layout.tables["groups"],
        "energy_group": layout.energy_group,
        "weights": layout.weights,
        "state": start.state,
        "tolerance": 1.0 if method.fixed else start.local,
        "step": start.local if method.fixed else 0.0,
        "rate": start.rate,
        "following": int(start.following),
        "late": int(start.late),
        **(stiffness_of(method, layout) if start.watched else UNWATCHED),
    }


def stiffness_of(method: Method, layout: Layout) -> dict[str, float]:
    """By what the kernel's loop notices stiffness (kernel/stiffness.py); an implicit method is not held by it."""
    if method.stable == 0.0:
        return UNWATCHED
    look = LOOK_AFTER if any(depends(load) for load in layout.mechanism.loads) else 0
    stable = tolerances.STIFF * method.stable
    return {"stiff_after": STIFF_AFTER, "easy_after": EASY_AFTER, "look_after": look, "stable": stable}


def depends(load: Load) -> bool:
    """Whether a load depends on where bodies are, or how fast: a spring, damper, friction, or by its expression."""
    return not load.values or any(value.uses for value in load.values)


class Segment(NamedTuple):
    """A part of a run without discontinuities: begin, the last instant before its end, and its end."""

    begin: float
    before_end: float
    end: float


@record
class Segments:
    """The segments of a run, (n, 3): begin, before_end, end. A table met point by point makes a million of them."""

    rows: Array

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[Segment]:
        return (Segment(*map(float, row)) for row in self.rows)

    @cached_property
    def ends(self) -> Array:
        """Where they end, (n,)."""
        return self.rows[:, 2].copy()

    def at(self, t: float) -> Segment:
        """The one that an instant lies in; at an end the one behind it."""
        return Segment(*map(float, self.rows[np.searchsorted(self.ends, t, side="right")]))


NO_SEGMENTS = Segments(np.zeros((0, 3)))


class Steps:
    """The steps done: of each its end, its least pivot, whether its stages were settled; for replays some records."""

    def __init__(self, start: Array, width: int) -> None:
        self.rows, self.count = Growing(len(PER_STEP)), 0
        self.branches: Growing | None = None
        # what steps 0, every, 2 every, ... start from; the first is a segment's, of which the state alone counts
        self.kept, self.width = Growing(width), width
        self.kept.add(self.whole(start))
        self.every, self.room = 1, max(2, KEPT // max(width, 1))
        self.after: dict[int, Array] = {}  # of the steps after blows, which are kept in any case
        self.look = FIRST_LOOK
        self.looked = self.cut_before = 0  # steps when it was last looked at how many events ended, and those
        self.holdings: list[tuple[int, Array]] = []  # from which step on which contacts are closed

    def whole(self, state: Array) -> Array:
        """The record of a state that no step has reached, (1, width)."""
        return np.concatenate([state, np.zeros(self.width - len(state))])[None, :]

    def hold(self, holding: Array) -> None:
        """From the next step on other contacts are closed."""
        self.holdings.append((self.count, holding.copy()))

    def holding(self, contacts: int) -> Array:
        """The contacts closed in each step, and behind the last one, (n_steps + 1, contacts)."""
        found = np.zeros((self.count + 1, contacts))
        bounds = [*(first for first, _ in self.holdings), self.count + 1]
        for (first, holding), end in zip(self.holdings, bounds[1:], strict=True):
            found[first:end] = holding
        return found

    def stand(self, state: Array) -> None:
        """The next step starts from another state than the last one reached."""
        self.after[self.count] = self.whole(state)[0]

    def records(self) -> Kept:
        """Records by their steps, those after blows among them."""
        return self.every_so_many.with_others(self.after)

    @property
    def every_so_many(self) -> Kept:
        """The records of every so many steps."""
        return Kept(self.every * np.arange(self.kept.count), self.kept.rows)

    def add(self, run: Integration) -> None:
        """Add the steps of the last call; while there are too many records, every second of them is dropped."""
        done = run.loop.done
        self.rows.add(np.column_stack([run.output[name][:done] for name in PER_STEP]))
        if run.held:
            self.branches = self.branches or Growing(run.held)
            self.branches.add(run.held_branches())
        first = self.count // self.every * self.every + self.every  # the next number of which one is kept
        self.kept.add(run.records(self.every, first - self.count - 1))
        self.count += done
        while self.kept.count > self.room:
            self.every *= 2
            self.kept.thin()

    def doubled(self) -> bool:
        """Whether there are twice as many as when this was last so."""
        if self.count < self.look:
            return False
        self.look = 2 * self.count
        return True

    def passed(self, n: int) -> list[tuple[float, Array]]:
        """Instants and states (n,) of some steps of which records were kept, ascending."""
        ends, kept = self.column("ends"), self.every_so_many
        some = slice(None, None, -(-len(kept) // PASSED))
        instants = np.append(0.0, ends)[kept.steps[some]]
        return list(zip(instants.tolist(), kept.records[some, :n], strict=True))

    def column(self, name: str) -> Array:
        """Ends, least pivots, or which were settled, (n_steps,)."""
        return self.rows.rows[:, PER_STEP.index(name)].copy()

    def held_branches(self) -> Array:
        """The branches that the steps held, (n_steps, n)."""
        return self.branches.rows if self.branches is not None else np.zeros((0, 0))


def smooth_segments(last: float, jumps: Sequence[float]) -> Segments:
    """The segments of (0, last) without discontinuities, which are at `jumps`.

    Each ends with the left limits of what jumps, the next one begins with the right limits.
    """
    within = np.asarray(jumps, dtype=float)
    left, right = limits_of(within[(within > 0.0) & (within < last)])
    begins, ends = np.append(0.0, right), np.append(left, just_before(last))
    segments = np.column_stack([begins, ends, np.nextafter(ends, np.inf)])
    # a discontinuity at t = 0 makes a first segment without length
    kept = segments[ends > begins] if (ends > begins).any() else segments[-1:]
    # where a discontinuity is the double before the last instant, no segment is left behind it
    kept[-1, 2] = max(kept[-1, 2], last)
    return Segments(kept)


def limits_of(jumps: Sequence[float] | Array) -> tuple[Array, Array]:
    """The last instants before discontinuities, ascending, and the first after them, as `one_sided_limits` has them."""
    instants = np.asarray(jumps, dtype=float)
    before = np.nextafter(instants, -np.inf)
    fresh = np.append(True, instants[:-1] < before[1:])[: len(instants)]  # neighbouring doubles are one discontinuity
    return before[fresh], instants[np.append(fresh[1:], True)[: len(instants)]]


def just_before(t: float) -> float:
    """The last instant before t: at a jump, the left limit is taken there."""
    return math.nextafter(t, -math.inf)


def just_after(t: float) -> float:
    """The first instant after t."""
    return math.nextafter(t, math.inf)
