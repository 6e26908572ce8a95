"""The same work on many things, in several processes that are forked from this one.

What was imported before is there in each of them: Python starts once. A process that dies takes with it what it was at,
and nothing else: the next takes its place, and what the dead one was at is tried once more. Impure: processes.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Generic, TypeVar

from heuncli.app.cli import alarm
from heuncli.base import signals
from heuncli.base.errors import LimitError, Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.signals import Undoing

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.context import ForkProcess

Item = TypeVar("Item")
Answer = TypeVar("Answer")
WORTH = 8  # things from which on several processes are worth their making


def processors() -> int:
    """On how many processors this process may run."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def forks() -> bool:
    """Whether processes can be forked here."""
    return hasattr(os, "fork")


def most(asked: int | None) -> int:
    """How many processes may work at once."""
    return asked if asked is not None else processors()


def how_many(asked: int | None, things: int) -> int:
    """How many processes work: as many as asked for, else one a processor where there is enough to do."""
    if not forks():
        return 1
    wanted = most(asked) if asked is not None or things >= WORTH else 1
    return max(1, min(wanted, things))


class Died(NamedTuple):
    """What stands for an answer whose process died: how, in words; exit code, negative that of a signal."""

    how: str
    code: int = 0

    @property
    def is_time_up(self) -> bool:
        """Whether the time limit ended it, at its hard end (app/cli/alarm.py)."""
        return self.code == LimitError.exit_code

    def problem(self, work: str, bug_hint: str) -> Problem:
        """What is told of what was lost; work: what the process did; bug_hint: where no limit ended it."""
        if self.is_time_up:
            return Problem("time-limit", "the time limit was reached, and the work did not stop", hint=alarm.HINT)
        return Problem("bug", f"the process that {work} was {self.how}, twice", hint=bug_hint)


class SecondTries:
    """Items, by their numbers, whose process died: each is tried once more, alone."""

    def __init__(self) -> None:
        self._waiting: deque[int] = deque()
        self._tried: set[int] = set()

    def next(self) -> int | None:
        """The next item to try again; None where there is none."""
        return self._waiting.popleft() if self._waiting else None

    def answered(self, numbers: Sequence[int]) -> None:
        """Forget items that are answered."""
        self._tried.difference_update(numbers)

    def lost(self, numbers: Sequence[int], died: Died) -> list[int]:
        """Note items whose process died. Returns those that are not tried again.

        These died twice; or one alone took longer than its time limit, and would take as long again.
        """
        if died.is_time_up and len(numbers) == 1:
            return list(numbers)
        twice = [number for number in numbers if number in self._tried]
        self._tried.update(numbers)
        self._tried.difference_update(twice)
        self._waiting.extend(number for number in numbers if number not in twice)
        return twice


def each(
    work: Callable[[Item], Answer],
    items: Sequence[Item],
    jobs: int,
    dead: Callable[[Item, Died], Answer],
    is_last: Callable[[Answer], bool] = lambda answer: False,
    apart: bool = False,
) -> Iterator[Answer]:
    """The answers in the order of the items, each as soon as those before it are there.

    dead: the answer for an item whose process died, twice, or at its time limit; is_last: whether no item behind one
    with this answer is asked for; apart: in another process also where it is one alone.
    """
    if jobs <= 1 and not (apart and forks()):
        for item in items:
            answer = work(item)
            yield answer
            if is_last(answer):
                return
        return
    until = len(items)
    numbers = iter(range(len(items)))
    again = SecondTries()

    def more() -> int | None:
        number = again.next()
        if number is None:
            number = next(numbers, until)
        return number if number < until else None

    waiting: dict[int, Answer] = {}
    done = 0
    for number, found in as_done(lambda number: work(items[number]), more, jobs):
        if isinstance(found, Died):
            if not again.lost([number], found):
                continue
            waiting[number] = dead(items[number], found)
        else:
            waiting[number] = found
        if is_last(waiting[number]):
            until = min(until, number + 1)
        while done in waiting:
            answer = waiting.pop(done)
            done += 1
            yield answer
            if is_last(answer):
                return


def as_done(
    work: Callable[[Item], Answer], more: Callable[[], Item | None], jobs: int, stopped: int | None = None
) -> Iterator[tuple[Item, Answer | Died]]:
    """Each item with its answer, or how the process died that was at it, in the order in which they come.

    more: the next item, None where there is none for now; it is asked after every answer, once what is done with that
    is done, too, and the end is when there is none while nobody is at work. stopped: a descriptor; once anything can be
    read from it, this ends. The processes are made as they find work, and end with this.
    """
    pool = _Pool(work, more, jobs)
    with alarm.unwatched(), Undoing(pool.kill):
        try:
            yield from pool.answers(stopped)
        finally:
            pool.kill()
            pool.join()


class _Worker(Generic[Item, Answer]):
    """A process at work on one item after the other, and the pipe to it."""

    def __init__(self, work: Callable[[Item], Answer], others: Sequence[_Worker[Item, Answer]]) -> None:
        import multiprocessing

        context = multiprocessing.get_context("fork")
        self.pipe, theirs = context.Pipe()
        inherited = [self.pipe, *(other.pipe for other in others)]
        self.process: ForkProcess = context.Process(target=_serve, args=(theirs, work, inherited), daemon=True)
        self.process.start()
        theirs.close()
        self.at: Item | None = None

    def give(self, item: Item) -> None:
        """Something to do."""
        self.at = item
        with suppress(BrokenPipeError, ConnectionResetError):  # it died between two items: found while waiting
            self.pipe.send(item)

    def end(self) -> Died:
        """How it died."""
        self.process.join()
        code = self.process.exitcode or 0
        self.pipe.close()
        return Died(f"killed by signal {-code}" if code < 0 else f"ended with exit code {code}", code)


def _serve(pipe: Connection, work: Callable[[Item], Answer], inherited: Sequence[Connection]) -> None:
    """The life of a process: items in, answers out, until nobody sends any more; signals are its parent's affair."""
    import signal

    for end in inherited:  # else none of these would see its other side close
        end.close()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for name in ("SIGTERM", "SIGHUP"):
        signal.signal(getattr(signal, name), signal.SIG_DFL)
    signals.undo_nothing()
    alarm.be_silent()
    try:
        while True:
            pipe.send(work(pipe.recv()))
    except (EOFError, BrokenPipeError, ConnectionResetError):
        os._exit(0)


class _Pool(Generic[Item, Answer]):
    """Processes, each at work on an item or idle."""

    def __init__(self, work: Callable[[Item], Answer], more: Callable[[], Item | None], jobs: int) -> None:
        self.work, self.more, self.jobs = work, more, jobs
        self.workers: list[_Worker[Item, Answer]] = []

    def answers(self, stopped: int | None) -> Iterator[tuple[Item, Answer | Died]]:
        """All of them as they come."""
        from multiprocessing.connection import wait

        while True:
            self._employ()
            busy: dict[object, _Worker[Item, Answer]] = {
                worker.pipe: worker for worker in self.workers if worker.at is not None
            }
            if not busy:
                return
            ready = wait([*busy, *(() if stopped is None else (stopped,))])  # type: ignore[list-item]
            if stopped in ready:
                return
            for pipe in ready:
                yield self._received(busy[pipe])

    def _employ(self) -> None:
        """Items for those who have none, as long as there are any."""
        idle = [worker for worker in self.workers if worker.at is None]
        while idle or len(self.workers) < self.jobs:
            item = self.more()
            if item is None:
                return
            if not idle:
                self.workers.append(_Worker(self.work, self.workers))
            (idle.pop() if idle else self.workers[-1]).give(item)

    def _received(self, worker: _Worker[Item, Answer]) -> tuple[Item, Answer | Died]:
        """What a worker has to say, which goes on with the next item at once."""
        item, answer = worker.at, None
        assert item is not None
        try:
            answer = worker.pipe.recv()
        except (EOFError, OSError):  # the latter where it died while it spoke
            self.workers.remove(worker)
            return item, worker.end()
        worker.at = None
        self._employ()
        return item, answer

    def join(self) -> None:
        """Wait until all of them have ended."""
        for worker in self.workers:
            worker.process.join()

    def kill(self) -> None:
        """End all of them at once."""
        for worker in self.workers:
            if worker.process.pid is not None:
                worker.process.kill()
