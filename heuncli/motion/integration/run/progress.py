"""The progress of a run: the records of its steps, and its pace.

The pace of the steps done tells how many steps the rest would take, if the run finishes at all. What grows without
bound, or turns ever faster, takes ever shorter steps: no step is wrong, and the end is never reached. With t(n) the
instant after n steps, the times of the steps n/4 -> n/2 and n/2 -> n have a ratio r. r = 2 is a steady pace, √2 a rate
in proportion to the time, 1 an exponential growth, less than 1 one that ends at a finite instant. Every further
doubling of n is assumed to last r times the one before:

    last - t = d (r + r^2 + ... + r^k),  d of the last doubling,  n 2^k steps

This applies only where the last steps are the shortest: those of an irregular motion become shorter for a while, and
longer again; then the pace of its last part is assumed to continue.
The records are arrays that grow, so that a step of a long run takes bytes, not objects.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.integration.integrated_scene import IntegratedScene
from heuncli.motion.integration.run.kernel_loop import PER_STEP, KernelLoop
from heuncli.motion.integration.trajectory import StepPolynomials, StepRecords
from heuncli.results.results import Array

# Pace

PARTS = 8  # of the steps done, whose lengths are compared
FIRST_LOOK = 2_000  # steps; then each time that their number has doubled


def project_steps(ends: Array, last: float) -> float:
    """Project how many steps a run to `last` takes in all; ends (n,): of the steps done."""
    n = len(ends)
    quarter, half, now = (float(ends[k - 1]) for k in (n // 4, n // 2, n))
    d, previous_doubling = now - half, half - quarter
    if not (d > 0.0 and previous_doubling > 0.0):
        return math.inf
    r, rest = d / previous_doubling, (last - now) / d
    if r == 1.0:
        doublings = rest
    else:
        left = 1.0 + rest * (r - 1.0) / r  # r^k
        doublings = math.log(left) / math.log(r) if left > 0.0 else math.inf
    return n * 2.0**doublings if doublings < 1000.0 else math.inf


def find_hopeless_steps(ends: Array, last: float, max_steps: int, *, irregular: bool = True) -> float | None:
    """Return how many steps a run would take if it cannot come near its end within `max_steps` of them; else None.

    irregular: whether steps may become shorter for a while; those along a branch do so towards its end

    The longer a pace has lasted, the less it may still change: the tolerated excess is the square root of the part done
    of the maximum, a hundredth after 2,000 of 20 million.
    """
    part_times = np.diff(ends[np.linspace(0, len(ends) - 1, PARTS + 1).astype(int)])
    if part_times[-1] <= part_times.min() or not irregular:
        steps = project_steps(ends, last)
    else:
        steps = len(ends) * (1.0 + float((last - ends[-1]) / part_times[-1]) / PARTS)
    return steps if steps > tolerances.HOPELESS * max_steps * math.sqrt(max_steps / len(ends)) else None


def estimate_seconds_left(ends: Array, last: float, seconds: float) -> float:
    """Estimate the time for the rest of a run at the pace of its last steps [s]; ends (n,): of the steps done in
    `seconds`.
    """
    n = len(ends)
    last_part = float(ends[-1] - ends[-1 - n // PARTS]) if n >= PARTS else 0.0
    return float(last - ends[-1]) / last_part * seconds / PARTS if last_part > 0.0 else math.inf


def format_seconds_left(ends: Array, last: float, seconds: float) -> str:
    """Say how long the rest of a stopped run would have taken at the pace of its last steps."""
    left = estimate_seconds_left(ends, last, seconds) if len(ends) >= FIRST_LOOK else math.inf
    return f"; at the pace of its last steps the rest would take about {left:.1g} s" if left < math.inf else ""


# Step records

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
# numbers in the records for replays, at the ends of all steps or of every second, fourth, ...
MAX_RECORD_NUMBERS = 20_000_000
MAX_PASSED_STATES = 100_000  # most states used to explain an error


# Progress

LAST_STEPS = 101  # whose mean length is the pace


@record
class RunProgress:
    """A running integration.

    scene: the scene whose motion is requested
    integrated_scene: what is integrated in its place
    kernel: the stepping loop
    steps: those done
    last: the intended end [s]
    """

    scene: Evaluator
    integrated_scene: IntegratedScene
    kernel: KernelLoop
    steps: StepRecorder
    last: float

    @property
    def t(self) -> float:
        """The instant reached [s]."""
        return self.kernel.loop.t

    @property
    def integrated_state(self) -> Array:
        """The integrated state reached, (n',)."""
        return np.array(self.kernel.loop.state())

    @property
    def state(self) -> Array:
        """The scene's state reached, (n,)."""
        return self.integrated_scene.embed_state(self.t, self.integrated_state)

    @property
    def pace(self) -> tuple[float, float]:
        """Mean length of the last steps [s], and their tolerance."""
        ends = self.steps.copy_column("ends")[-LAST_STEPS:]
        return (float(ends[-1] - ends[0]) / (len(ends) - 1) if len(ends) > 1 else 0.0), self.kernel.start.local

    @property
    def passed_states(self) -> list[tuple[float, Array]]:
        """Some instants and states of the scene (n,) that it has passed, ascending, for the explanation of an error."""
        passed = self.steps.passed_states(self.kernel.n)
        times = [t for t, _ in passed]
        return list(
            zip(times, self.integrated_scene.embed(np.array(times), np.array([y for _, y in passed])), strict=True)
        )
