"""Apply one function to many items in several processes, forked from this one.

A forked process inherits all imported modules, so Python starts once. If a process dies only the item at work is lost:
another process replaces it, and the item is tried once more. Impure: processes.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Generic, TypeVar

from heuncli.app.cli import timeout
from heuncli.base import signals
from heuncli.base.errors import LimitError, Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.signals import CleanupOnSignal

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.context import ForkProcess

Item = TypeVar("Item")
Answer = TypeVar("Answer")
MIN_ITEMS = 8  # with fewer items several processes do not pay


def count_processors() -> int:
    """Return the number of processors that this process may run on."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def can_fork() -> bool:
    """Return whether this system can fork processes."""
    return hasattr(os, "fork")


def max_jobs(requested: int | None) -> int:
    """Return the largest number of processes: the requested one, or one per processor."""
    return requested if requested is not None else count_processors()


def choose_job_count(requested: int | None, item_count: int) -> int:
    """Return the number of processes: the requested one, or one per processor if there are enough items."""
    if not can_fork():
        return 1
    count = max_jobs(requested) if requested is not None or item_count >= MIN_ITEMS else 1
    return max(1, min(count, item_count))


class ProcessDeath(NamedTuple):
    """The result of an item whose process died.

    description: how it ended, in words
    code: its exit code, negative for a signal
    """

    description: str
    code: int = 0

    @property
    def is_time_up(self) -> bool:
        """Whether the time limit ended it, at its hard end (app/cli/timeout.py)."""
        return self.code == LimitError.exit_code

    def make_problem(self, work: str, bug_hint: str) -> Problem:
        """Make the problem that reports the lost item.

        work: what the process did, for the message
        bug_hint: the hint if no limit ended it
        """
        if self.is_time_up:
            return Problem("time-limit", "the time limit was reached, but the work did not stop", hint=timeout.HINT)
        return Problem("bug", f"the process that {work} failed twice: {self.description}", hint=bug_hint)


class RetryQueue:
    """Items, by number, whose process died; each is tried once more, alone."""

    def __init__(self) -> None:
        self._waiting: deque[int] = deque()
        self._tried: set[int] = set()

    def pop_next(self) -> int | None:
        """Remove and return the next item to try again, or None."""
        return self._waiting.popleft() if self._waiting else None

    def forget(self, numbers: Sequence[int]) -> None:
        """Forget items that have a result."""
        self._tried.difference_update(numbers)

    def add_lost(self, numbers: Sequence[int], died: ProcessDeath) -> list[int]:
        """Add items whose process died; returns those that are not tried again.

        An item is not tried again if its process died twice, or if it alone reached its time limit, which it would
        reach again.
        """
        if died.is_time_up and len(numbers) == 1:
            return list(numbers)
        twice = [number for number in numbers if number in self._tried]
        self._tried.update(numbers)
        self._tried.difference_update(twice)
        self._waiting.extend(number for number in numbers if number not in twice)
        return twice


def run_in_order(
    work: Callable[[Item], Answer],
    items: Sequence[Item],
    jobs: int,
    make_failure: Callable[[Item, ProcessDeath], Answer],
    is_last: Callable[[Answer], bool] = lambda answer: False,
    separate_process: bool = False,
) -> Iterator[Answer]:
    """Yield results in the order of the items, each as soon as it and all earlier ones are there.

    make_failure: makes the result of an item whose process died twice, or at its time limit
    is_last: whether a result ends the work, so that later items are skipped
    separate_process: use another process even for a single job
    """
    if jobs <= 1 and not (separate_process and can_fork()):
        for item in items:
            answer = work(item)
            yield answer
            if is_last(answer):
                return
        return
    end = len(items)
    numbers = iter(range(len(items)))
    retries = RetryQueue()

    def pop_next() -> int | None:
        """Return the next item: one to try again, else one that was not tried yet; None if there is none now."""
        number = retries.pop_next()
        if number is None:
            number = next(numbers, end)
        return number if number < end else None

    finished: dict[int, Answer] = {}
    next_number = 0
    for number, outcome in run_as_completed(lambda number: work(items[number]), pop_next, jobs):
        if isinstance(outcome, ProcessDeath):
            if not retries.add_lost([number], outcome):
                continue
            finished[number] = make_failure(items[number], outcome)
        else:
            finished[number] = outcome
        if is_last(finished[number]):
            end = min(end, number + 1)
        while next_number in finished:
            answer = finished.pop(next_number)
            next_number += 1
            yield answer
            if is_last(answer):
                return


def run_as_completed(
    work: Callable[[Item], Answer],
    pop_next_item: Callable[[], Item | None],
    jobs: int,
    stop_descriptor: int | None = None,
) -> Iterator[tuple[Item, Answer | ProcessDeath]]:
    """Yield each item with its result, or with how its process died, in the order of completion.

    pop_next_item: returns the next item, or None if there is none now; it is called after each result has been
    consumed, and the work ends when it returns None while no process is at work
    stop_descriptor: a file descriptor; the work ends once anything can be read from it

    Processes are started as items come, and end with this generator.
    """
    pool = _Pool(work, pop_next_item, jobs)
    with timeout.pause_watch(), CleanupOnSignal(pool.kill):
        try:
            yield from pool.iter_results(stop_descriptor)
        finally:
            pool.kill()
            pool.join()


class _Worker(Generic[Item, Answer]):
    """A worker process that handles items one by one, and the pipe to it."""

    def __init__(self, work: Callable[[Item], Answer], other_workers: Sequence[_Worker[Item, Answer]]) -> None:
        import multiprocessing

        context = multiprocessing.get_context("fork")
        self.pipe, child_end = context.Pipe()
        inherited = [self.pipe, *(other.pipe for other in other_workers)]
        self.process: ForkProcess = context.Process(target=_serve, args=(child_end, work, inherited), daemon=True)
        self.process.start()
        child_end.close()
        self.item: Item | None = None

    def send(self, item: Item) -> None:
        """Send an item to the process."""
        self.item = item
        with suppress(BrokenPipeError, ConnectionResetError):  # it died between two items: noticed while waiting
            self.pipe.send(item)

    def join_dead(self) -> ProcessDeath:
        """Wait for the dead process, and return how it ended."""
        self.process.join()
        code = self.process.exitcode or 0
        self.pipe.close()
        return ProcessDeath(f"killed by signal {-code}" if code < 0 else f"exit code {code}", code)


def _serve(pipe: Connection, work: Callable[[Item], Answer], parent_ends: Sequence[Connection]) -> None:
    """Run the loop of a worker process: receive items, send results, until the pipe closes. Signals are left to the
    parent.
    """
    import signal

    for parent_end in parent_ends:  # otherwise no worker would notice that its parent is gone
        parent_end.close()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for name in ("SIGTERM", "SIGHUP"):
        signal.signal(getattr(signal, name), signal.SIG_DFL)
    signals.clear_cleanups()
    timeout.silence()
    while True:
        try:
            item = pipe.recv()
        except (EOFError, ConnectionResetError):
            os._exit(0)
        answer = work(item)  # its own errors of these classes end the process with another code
        try:
            pipe.send(answer)
        except (BrokenPipeError, ConnectionResetError):
            os._exit(0)


class _Pool(Generic[Item, Answer]):
    """Worker processes, each with an item or idle."""

    def __init__(self, work: Callable[[Item], Answer], pop_next_item: Callable[[], Item | None], jobs: int) -> None:
        self.work, self.pop_next_item, self.jobs = work, pop_next_item, jobs
        self.workers: list[_Worker[Item, Answer]] = []

    def iter_results(self, stop_descriptor: int | None) -> Iterator[tuple[Item, Answer | ProcessDeath]]:
        """Yield all items with their results in the order of completion."""
        from multiprocessing.connection import wait

        while True:
            self._assign_items()
            busy: dict[object, _Worker[Item, Answer]] = {
                worker.pipe: worker for worker in self.workers if worker.item is not None
            }
            if not busy:
                return
            ready = wait([*busy, *(() if stop_descriptor is None else (stop_descriptor,))])  # type: ignore[list-item]
            if stop_descriptor in ready:
                return
            for pipe in ready:
                yield self._receive_result(busy[pipe])

    def _assign_items(self) -> None:
        """Send items to idle workers, and start workers up to the number of jobs, while there are items."""
        idle = [worker for worker in self.workers if worker.item is None]
        while idle or len(self.workers) < self.jobs:
            item = self.pop_next_item()
            if item is None:
                return
            if not idle:
                self.workers.append(_Worker(self.work, self.workers))
            (idle.pop() if idle else self.workers[-1]).send(item)

    def _receive_result(self, worker: _Worker[Item, Answer]) -> tuple[Item, Answer | ProcessDeath]:
        """Return the item and the result of a worker, and send it the next item at once."""
        item, answer = worker.item, None
        assert item is not None
        try:
            answer = worker.pipe.recv()
        except (EOFError, OSError):  # OSError if it died while sending
            self.workers.remove(worker)
            return item, worker.join_dead()
        worker.item = None
        self._assign_items()
        return item, answer

    def join(self) -> None:
        """Wait until all processes have ended."""
        for worker in self.workers:
            worker.process.join()

    def kill(self) -> None:
        """Kill all processes at once."""
        for worker in self.workers:
            if worker.process.pid is not None:
                worker.process.kill()
