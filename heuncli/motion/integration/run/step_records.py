"""Records the steps of a run in arrays that grow, so that a step of a long run takes bytes, not objects."""

from __future__ import annotations

import numpy as np

from heuncli.motion.integration.run.kernel_loop import PER_STEP, KernelLoop
from heuncli.motion.integration.run.pace import FIRST_LOOK
from heuncli.motion.integration.trajectory import StepPolynomials, StepRecords
from heuncli.results.results import Array

FIRST_CAPACITY = 64  # rows


class GrowingRows:
    """Rows of equal width in a growing array; its capacity doubles when it is full, so that adding stays cheap."""

    def __init__(self, width: int) -> None:
        self.storage, self.count = np.empty((FIRST_CAPACITY, width)), 0

    def add(self, rows: Array) -> None:
        """Append a copy of rows (n, width)."""
        count = self.count + len(rows)
        if count > len(self.storage):
            enlarged = np.empty((max(count, 2 * len(self.storage)), self.storage.shape[1]))
            enlarged[: self.count] = self.rows
            self.storage = enlarged
        self.storage[self.count : count] = rows
        self.count = count

    def thin(self) -> None:
        """Drop every second row; the first stays."""
        remaining = self.rows[::2].copy()
        self.storage[: len(remaining)], self.count = remaining, len(remaining)

    @property
    def rows(self) -> Array:
        """All rows, (n, width); a view, valid until more are added."""
        return self.storage[: self.count]


class StepRecorder:
    """The steps done: for each the PER_STEP values and the branches it held; for replays, the records of some."""

    def __init__(self, start: Array, width: int) -> None:
        self.rows, self.count = GrowingRows(len(PER_STEP)), 0
        self.branches: GrowingRows | None = None
        # start records of steps 0, every, 2 every, ...; of the first, a segment's start, only the state
        # counts
        self.start_records, self.width = GrowingRows(width), width
        self.start_records.add(self.make_record(start))
        self.every, self.max_records = 1, max(2, MAX_RECORD_NUMBERS // max(width, 1))
        self.polynomials: tuple[GrowingRows, GrowingRows] | None = None
        self.records_after: dict[int, Array] = {}  # records of the steps after impulses, which always stay
        self.next_look = FIRST_LOOK
        self.holdings: list[tuple[int, Array]] = []  # step number from which on these contacts are closed

    def make_record(self, state: Array) -> Array:
        """Return the record of a state that no step has reached, (1, width)."""
        return np.concatenate([state, np.zeros(self.width - len(state))])[None, :]

    def record_holding(self, holding: Array) -> None:
        """Record that from the next step on other contacts are closed."""
        self.holdings.append((self.count, holding.copy()))

    def find_holding(self, contacts: int) -> Array:
        """Return the contacts closed in each step, and after the last one, (n_steps + 1, contacts)."""
        holding_by_step = np.zeros((self.count + 1, contacts))
        bounds = [*(first for first, _ in self.holdings), self.count + 1]
        for (first, holding), end in zip(self.holdings, bounds[1:], strict=True):
            holding_by_step[first:end] = holding
        return holding_by_step

    def restart_from(self, state: Array) -> None:
        """Record that the next step starts from another state than the last one reached."""
        self.records_after[self.count] = self.make_record(state)[0]

    def list_records(self) -> StepRecords:
        """Return the records by step, including those after impulses."""
        return self.regular_records.merge(self.records_after)

    @property
    def regular_records(self) -> StepRecords:
        """The records at regular intervals of steps."""
        return StepRecords(self.every * np.arange(self.start_records.count), self.start_records.rows)

    def add(self, kernel: KernelLoop) -> None:
        """Add the steps of the last call; while there are too many records, drop every second of them."""
        done = kernel.loop.last_step_count
        self.rows.add(kernel.read_steps())
        if kernel.branch_count:
            self.branches = self.branches or GrowingRows(kernel.branch_count)
            self.branches.add(kernel.read_branches())
        next_recorded = self.count // self.every * self.every + self.every  # the next step with a record
        self.start_records.add(kernel.read_records(self.every, next_recorded - self.count - 1))
        if kernel.stores_polynomials:
            self.add_polynomials(kernel)
        self.count += done
        while self.start_records.count > self.max_records:
            self.every *= 2
            self.start_records.thin()

    def add_polynomials(self, kernel: KernelLoop) -> None:
        """Add the polynomials of the last call; if a run comes to have too many, drop them all."""
        parts = kernel.read_polynomials()
        self.polynomials = self.polynomials or (GrowingRows(parts[0].shape[1]), GrowingRows(parts[1].shape[1]))
        for rows, part in zip(self.polynomials, parts, strict=True):
            rows.add(part)
        if sum(rows.rows.size for rows in self.polynomials) > MAX_POLYNOMIAL_NUMBERS:
            self.polynomials = None
            kernel.stop_storing_polynomials()

    def collect_polynomials(self) -> StepPolynomials | None:
        """Return the polynomials of all steps, or None if they were dropped."""
        return None if self.polynomials is None else StepPolynomials(*(rows.rows for rows in self.polynomials))

    def has_doubled(self) -> bool:
        """Return whether there are twice as many steps as when this was last true."""
        if self.count < self.next_look:
            return False
        self.next_look = 2 * self.count
        return True

    def passed_states(self, n: int) -> list[tuple[float, Array]]:
        """Return instants and states (n,) of some steps that have records, ascending."""
        ends, records = self.copy_column("ends"), self.regular_records
        selection = slice(None, None, -(-len(records) // MAX_PASSED_STATES))
        instants = np.append(0.0, ends)[records.steps[selection]]
        return list(zip(instants.tolist(), records.records[selection, :n], strict=True))

    def copy_column(self, name: str) -> Array:
        """Return a copy of one PER_STEP value of all steps, (n_steps,)."""
        return self.rows.rows[:, PER_STEP.index(name)].copy()

    def read_branches(self) -> Array:
        """Return the branches that the steps held, (n_steps, n)."""
        return self.branches.rows if self.branches is not None else np.zeros((0, 0))


MAX_POLYNOMIAL_NUMBERS = 1_000_000  # numbers in the stored polynomials; with more, steps are repeated instead
MAX_RECORD_NUMBERS = (
    20_000_000  # numbers in the records for replays, at the ends of all steps or of every second, fourth, ...
)
MAX_PASSED_STATES = 100_000  # most states used to explain an error
