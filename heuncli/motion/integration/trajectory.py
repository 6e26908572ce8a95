"""What a run leaves: the states at the asked instants, its steps, its events and blows."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Mapping
from functools import cached_property

import numpy as np

from heuncli.base.records import record
from heuncli.kernel.choose import integration
from heuncli.motion.integration.contacts.blows import Jump
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.segments import NO_SEGMENTS, Segments
from heuncli.results.results import Array, Indices, Mask


@record
class Kept:
    """The steps whose starts were kept, by their numbers (n,), ascending, and the records that they start from."""

    steps: Indices
    records: Array

    def __len__(self) -> int:
        return len(self.steps)

    def with_others(self, others: Mapping[int, Array]) -> Kept:
        """With other steps' records, which go before those of the same number."""
        if not others:
            return self
        own = ~np.isin(self.steps, list(others))
        steps = np.concatenate([self.steps[own], list(others)])
        order = np.argsort(steps)
        return Kept(steps[order], np.concatenate([self.records[own], list(others.values())])[order])


@record
class Courses:
    """The polynomials of a run's steps, of those that made one; impure: more are put in when they are made again.

    spans (n_steps, 3): whether it was kept, begin and length of the step [s]; numbers (n_steps, .): the state at its
    begin and the rows of coefficients, of what is integrated.
    """

    spans: Array
    numbers: Array

    def take(self, first: int, spans: Array, numbers: Array) -> None:
        """Take over those that some steps from the first on have made, in place."""
        made = np.flatnonzero(spans[:, 0])
        self.spans[first + made], self.numbers[first + made] = spans[made], numbers[made]

    def known(self, times: Array, step: Indices, ends: Array) -> Mask:
        """Which instants lie within steps whose polynomials were kept, before their ends, (n,)."""
        return np.asarray((self.spans[step, 0] > 0.0) & (times < ends[step]))

    def states(self, times: Array, step: Indices, n: int) -> Array:
        """States of n numbers at instants within such steps, (n_t, n)."""
        out = np.zeros(len(times) * n)
        if not n:  # nothing moves, and no polynomial is kept of it
            return out.reshape(len(times), n)
        flat = {"spans": self.spans.reshape(-1), "courses": self.numbers.reshape(-1)}
        integration.within(flat, n, array("d", times.tobytes()), array("i", step.astype(np.intc).tobytes()), out)
        return out.reshape(len(times), n)


NOTHING_KEPT = Kept(np.zeros(0, dtype=int), np.zeros((0, 0)))


@record
class Trajectory:
    """The state at the asked instants.

    times (n_t,) [s]; states (n_t, n_state), those of the scene; kept: of what is integrated in its place; ends:
    instants of the accepted steps; gap: largest closure gap left [m]. branches (n_steps, n): those of the expressions
    that a step held; turned: of each step whether they change at its end; undecided: of how many steps bounds could not
    tell what loads do between the stages; courses: of a run that is asked for more instants, unless it is very long.
    """

    times: Array
    states: Array
    ends: Array
    steps: int
    evaluations: int
    gap: float
    local: float  # its local tolerance; of a method of fixed step, the step
    method: Method
    seconds: float
    segments: Segments = NO_SEGMENTS  # without discontinuities, events of contacts or blows
    # of the first, of some other steps and of those after blows: number, record of where it starts
    kept: Kept = NOTHING_KEPT
    pivots: Array = np.zeros(0)  # least pivot of the closures in each step
    settled: Array = np.zeros(0)  # of each step whether its stages were settled on the closures
    branches: Array = np.zeros((0, 0))
    turned: Array = np.zeros(0)
    undecided: int = 0
    stopped: str | None = None  # the rope that would have to push just after the last instant
    ended: bool = False  # by the condition that ends it
    behind: Array = np.zeros(0)  # the branches that hold behind the last step
    blows: tuple[Jump, ...] = ()
    holding: Array = np.zeros((1, 0))  # (n_steps + 1, contacts): closed in each step, and behind the last one
    notes: tuple[str, ...] = ()  # what is told of contacts
    courses: Courses | None = None
    within: Callable[[Array], Array] | None = None  # of steps that are not the kernel's: the states at instants

    @property
    def reached(self) -> float:
        """The end of its last step [s]; the start where a rope ends it there, before any step."""
        return float(self.ends[-1]) if len(self.ends) else 0.0

    @property
    def events(self) -> tuple[float, ...]:
        """The instants at which branches change that hang on coordinates."""
        return tuple(self.ends[self.turned > 0.0].tolist())

    @cached_property
    def after_blows(self) -> dict[int, Array]:
        """The records from which the steps after blows start."""
        if not self.blows:
            return {}
        at = {int(np.searchsorted(self.ends, blow.time, side="right")) for blow in self.blows}
        own = np.isin(self.kept.steps, list(at))
        return dict(zip(self.kept.steps[own].tolist(), self.kept.records[own], strict=True))

    @property
    def jumps(self) -> tuple[float, ...]:
        """The instants of events and of blows."""
        return tuple(sorted({*self.events, *(blow.time for blow in self.blows)}))

    def holding_at(self, times: Array) -> Array:
        """The contacts that are closed at instants, (n_t, contacts); at an event those behind it."""
        return np.asarray(self.holding[np.searchsorted(self.ends, times, side="right")])

    def branches_at(self, times: Array) -> Array:
        """The branches that hold at instants, (n_t, n); at an event those behind it."""
        if not self.branches.size:
            return self.branches
        step = np.searchsorted(self.ends, times, side="right")
        held = np.vstack([self.branches, self.behind[None, :]]) if self.ended else self.branches
        return np.asarray(held[np.minimum(step, len(held) - 1)])
