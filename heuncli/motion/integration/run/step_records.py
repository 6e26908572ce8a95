"""What a run puts down of its steps, in arrays that grow: a step of a long run takes bytes, not objects."""

from __future__ import annotations

import numpy as np

from heuncli.motion.integration.run.kernel_loop import PER_STEP, KernelLoop
from heuncli.motion.integration.run.pace import FIRST_LOOK
from heuncli.motion.integration.trajectory import Courses, Kept
from heuncli.results.results import Array

FIRST_ROOM = 64  # rows


class GrowingRows:
    """Rows of so many numbers, one behind the other; the room is doubled where it ends, so that adding stays cheap."""

    def __init__(self, width: int) -> None:
        self.room, self.count = np.empty((FIRST_ROOM, width)), 0

    def add(self, rows: Array) -> None:
        """Rows (n, width) behind the others; a copy."""
        count = self.count + len(rows)
        if count > len(self.room):
            room = np.empty((max(count, 2 * len(self.room)), self.room.shape[1]))
            room[: self.count] = self.rows
            self.room = room
        self.room[self.count : count] = rows
        self.count = count

    def thin(self) -> None:
        """Leave every second row, the first among them."""
        kept = self.rows[::2].copy()
        self.room[: len(kept)], self.count = kept, len(kept)

    @property
    def rows(self) -> Array:
        """All rows, (n, width); a view, until more are added."""
        return self.room[: self.count]


class Steps:
    """The steps done: of each what PER_STEP names, and the branches it held; for replays some records."""

    def __init__(self, start: Array, width: int) -> None:
        self.rows, self.count = GrowingRows(len(PER_STEP)), 0
        self.branches: GrowingRows | None = None
        # what steps 0, every, 2 every, ... start from; the first is a segment's, of which the state alone counts
        self.kept, self.width = GrowingRows(width), width
        self.kept.add(self.whole(start))
        self.every, self.room = 1, max(2, KEPT // max(width, 1))
        self.courses: tuple[GrowingRows, GrowingRows] | None = None
        self.after: dict[int, Array] = {}  # of the steps after blows, which are kept in any case
        self.look = FIRST_LOOK
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

    def add(self, kernel: KernelLoop) -> None:
        """Add the steps of the last call; while there are too many records, every second of them is dropped."""
        done = kernel.loop.done
        self.rows.add(kernel.put_down())
        if kernel.held:
            self.branches = self.branches or GrowingRows(kernel.held)
            self.branches.add(kernel.held_branches())
        first = self.count // self.every * self.every + self.every  # the next number of which one is kept
        self.kept.add(kernel.records(self.every, first - self.count - 1))
        if kernel.keeping:
            self.add_courses(kernel)
        self.count += done
        while self.kept.count > self.room:
            self.every *= 2
            self.kept.thin()

    def add_courses(self, kernel: KernelLoop) -> None:
        """Add the polynomials of the last call; those of a run that comes to have too many are let go."""
        parts = kernel.put_down_courses()
        self.courses = self.courses or (GrowingRows(parts[0].shape[1]), GrowingRows(parts[1].shape[1]))
        for rows, part in zip(self.courses, parts, strict=True):
            rows.add(part)
        if sum(rows.rows.size for rows in self.courses) > MOST_COURSES:
            self.courses = None
            kernel.keep_no_more()

    def kept_courses(self) -> Courses | None:
        """The polynomials of all steps."""
        return None if self.courses is None else Courses(*(rows.rows for rows in self.courses))

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
        """What was put down of each step under a name of PER_STEP, (n_steps,); a copy."""
        return self.rows.rows[:, PER_STEP.index(name)].copy()

    def held_branches(self) -> Array:
        """The branches that the steps held, (n_steps, n)."""
        return self.branches.rows if self.branches is not None else np.zeros((0, 0))


MOST_COURSES = 1_000_000  # numbers in the polynomials that are kept; beyond, steps are done again
KEPT = 20_000_000  # numbers in the states kept for replays, at the ends of all steps or of every second, fourth, ...
PASSED = 100_000  # of these states, at most, on the way to an error
