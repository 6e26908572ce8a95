"""The result of a run: the states at the requested instants, its steps, events and impulses."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property

import numpy as np

from heuncli.base.records import record
from heuncli.kernel.choose import integration
from heuncli.motion.integration.contacts.impulses import ImpulseEvent
from heuncli.motion.integration.integrated_scene import NO_SEGMENTS, Segments
from heuncli.motion.integration.methods.method import Method
from heuncli.results.results import Array, Indices, Mask


@record
class StepRecords:
    """The records from which some steps start, by step number (n,), ascending."""

    steps: Indices
    records: Array

    def __len__(self) -> int:
        return len(self.steps)

    def merge(self, others: Mapping[int, Array]) -> StepRecords:
        """Add the records of other steps; they replace those of the same number."""
        if not others:
            return self
        not_replaced = ~np.isin(self.steps, list(others))
        steps = np.concatenate([self.steps[not_replaced], list(others)])
        order = np.argsort(steps)
        return StepRecords(steps[order], np.concatenate([self.records[not_replaced], list(others.values())])[order])


@record
class StepPolynomials:
    """The interpolation polynomials of a run's steps. Not pure: polynomials are added when steps are repeated.

    spans (n_steps, 3): whether a polynomial is stored, begin and length of the step [s]
    numbers (n_steps, .): the integrated state at its begin and the rows of coefficients
    """

    spans: Array
    numbers: Array

    def store(self, first: int, spans: Array, numbers: Array) -> None:
        """Store in place the polynomials that consecutive steps from `first` on have made."""
        stored_steps = np.flatnonzero(spans[:, 0])
        self.spans[first + stored_steps], self.numbers[first + stored_steps] = (
            spans[stored_steps],
            numbers[stored_steps],
        )

    def interpolate_states(self, times: Array, ends: Array, n: int) -> tuple[Mask, Array]:
        """Interpolate states of n numbers at instants within steps whose polynomials are stored, before their ends.

        ends (n_steps,): of the steps. Returns which of the instants these are, (n_t,), and the states, (n_t, n), those
        of the other instants undefined.
        """
        states, found = np.empty((len(times), n)), np.zeros(len(times))
        if n:  # if nothing moves, there is no polynomial
            steps = {"ends": ends, "spans": self.spans.reshape(-1), "courses": self.numbers.reshape(-1)}
            integration.interpolate_steps(steps, n, times, states.reshape(-1), found)
        return found > 0.0, states


NO_RECORDS = StepRecords(np.zeros(0, dtype=int), np.zeros((0, 0)))


@record
class Trajectory:
    """The states at the requested instants, and how the run came to them.

    times (n_t,): instants [s]
    states (n_t, n_state): states of the full scene
    records: start records of some steps, of the integrated scene
    ends: ends of the accepted steps [s]
    gap: largest closure gap left [m]
    branches (n_steps, n): branches of the expressions that each step held
    branch_changed: for each step, whether branches change at its end
    uncertain_count: number of steps in which bounds could not tell what loads do between the stages
    polynomials: stored for a run that is asked for more instants, unless it is very long
    """

    times: Array
    states: Array
    ends: Array
    steps: int
    evaluations: int
    gap: float
    local: float  # local tolerance; for a method of fixed step, the step
    method: Method
    seconds: float
    segments: Segments = NO_SEGMENTS  # without discontinuities, contact events or impulses
    # start records of the first step, of some others and of those after impulses
    records: StepRecords = NO_RECORDS
    pivots: Array = np.zeros(0)  # least pivot of the closures in each step
    is_projected: Array = np.zeros(0)  # for each step, whether its stages were projected onto the closures
    branches: Array = np.zeros((0, 0))
    branch_changed: Array = np.zeros(0)
    uncertain_count: int = 0
    pushing_rope: str | None = None  # the rope that would have to push just after the last instant
    ended_by_condition: bool = False  # ended by its ending condition
    final_branches: Array = np.zeros(0)  # branches that hold after the last step
    impulse_events: tuple[ImpulseEvent, ...] = ()
    holding: Array = np.zeros((1, 0))  # (n_steps + 1, contacts): closed in each step, and after the last one
    notes: tuple[str, ...] = ()  # notes on contacts
    polynomials: StepPolynomials | None = None
    interpolate: Callable[[Array], Array] | None = None  # for other steps than the kernel's: returns states at instants

    @property
    def end_time(self) -> float:
        """End of the last step [s]; the start, if a rope ends the run before any step."""
        return float(self.ends[-1]) if len(self.ends) else 0.0

    @property
    def events(self) -> tuple[float, ...]:
        """The instants at which branches that depend on coordinates change."""
        return tuple(self.ends[self.branch_changed > 0.0].tolist())

    @cached_property
    def records_after_impulses(self) -> dict[int, Array]:
        """The records from which the steps after impulses start, by step number."""
        if not self.impulse_events:
            return {}
        step_numbers = {int(np.searchsorted(self.ends, blow.time, side="right")) for blow in self.impulse_events}
        selected = np.isin(self.records.steps, list(step_numbers))
        return dict(zip(self.records.steps[selected].tolist(), self.records.records[selected], strict=True))

    @property
    def jumps(self) -> tuple[float, ...]:
        """The instants of events and of impulses."""
        return tuple(sorted({*self.events, *(blow.time for blow in self.impulse_events)}))

    def find_holding(self, times: Array) -> Array:
        """Return the contacts that are closed at instants, (n_t, contacts); at an event, those after it."""
        return np.asarray(self.holding[np.searchsorted(self.ends, times, side="right")])

    def find_branches(self, times: Array) -> Array:
        """Return the branches that hold at instants, (n_t, n); at an event, those after it."""
        if not self.branches.size:
            return self.branches
        step = np.searchsorted(self.ends, times, side="right")
        rows = np.vstack([self.branches, self.final_branches[None, :]]) if self.ended_by_condition else self.branches
        return np.asarray(rows[np.minimum(step, len(rows) - 1)])
