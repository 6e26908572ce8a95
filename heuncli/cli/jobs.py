"""The same work on many things, in several processes that are forked from this one; answers come in the things' order.

What was imported before is there in each of them: Python starts once. A process that dies takes with it what it was at,
and nothing else: the next takes its place. Impure: processes.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Generic, TypeVar

from heuncli.cli.leaving import Undoing

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.context import ForkProcess

Item = TypeVar("Item")
Answer = TypeVar("Answer")
WORTH = 8  # things from which on several processes are worth their making


def processors() -> int:
    """On how many processors this process may run."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def how_many(asked: int | None, things: int) -> int:
    """How many processes work: as many as asked for, else one a processor where there is enough to do."""
    if not hasattr(os, "fork"):
        return 1
    most = asked if asked is not None else processors() if things >= WORTH else 1
    return max(1, min(most, things))


def each(
    work: Callable[[Item], Answer],
    items: Sequence[Item],
    jobs: int,
    dead: Callable[[Item, str], Answer],
    is_last: Callable[[Answer], bool] = lambda answer: False,
) -> Iterator[Answer]:
    """The answers in the order of the items, each as soon as those before it are there.

    dead: the answer for an item whose process died, from what is known of its end; is_last: whether no item behind one
    with this answer is asked for.
    """
    if jobs <= 1:
        for item in items:
            answer = work(item)
            yield answer
            if is_last(answer):
                return
        return
    pool = _Pool(work, items, dead, is_last)
    with Undoing(pool.kill):
        try:
            yield from pool.answers(jobs)
        finally:
            pool.kill()


class _Worker:
    """A process at work on one item after the other, and the pipe to it."""

    def __init__(self, work: Callable[[Item], Answer], others: Sequence[_Worker]) -> None:
        import multiprocessing

        context = multiprocessing.get_context("fork")
        self.pipe, theirs = context.Pipe()
        inherited = [self.pipe, *(other.pipe for other in others)]
        self.process: ForkProcess = context.Process(target=_serve, args=(theirs, work, inherited), daemon=True)
        self.process.start()
        theirs.close()
        self.at: int | None = None

    def end(self) -> str:
        """How it died, in words."""
        self.process.join()
        code = self.process.exitcode or 0
        self.pipe.close()
        return f"killed by signal {-code}" if code < 0 else f"ended with exit code {code}"


def _serve(pipe: Connection, work: Callable[[Item], Answer], inherited: Sequence[Connection]) -> None:
    """The life of a process: items in, answers out, until nobody sends any more; signals are its parent's affair."""
    import signal

    for end in inherited:  # else none of these would see its other side close
        end.close()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for name in ("SIGTERM", "SIGHUP"):
        signal.signal(getattr(signal, name), signal.SIG_DFL)
    try:
        while True:
            pipe.send(work(pipe.recv()))
    except (EOFError, BrokenPipeError, ConnectionResetError):
        os._exit(0)


class _Pool(Generic[Item, Answer]):
    """Processes, and the answers that wait for those before them."""

    def __init__(
        self, work: Callable[[Item], Answer], items: Sequence[Item], dead: Callable[[Item, str], Answer],
        is_last: Callable[[Answer], bool],
    ) -> None:  # fmt: skip
        self.work, self.items, self.dead, self.is_last = work, items, dead, is_last
        self.workers: list[_Worker] = []
        self.waiting: dict[int, Answer] = {}
        self.next = 0
        self.until = len(items)

    def answers(self, jobs: int) -> Iterator[Answer]:
        """All of them in order."""
        for _ in range(jobs):
            self._begin()
        for number in range(len(self.items)):
            while number not in self.waiting:
                self._receive()
            answer = self.waiting.pop(number)
            yield answer
            if self.is_last(answer):
                return

    def _begin(self) -> None:
        """One process more, with the next item."""
        worker = _Worker(self.work, self.workers)
        self.workers.append(worker)
        self._give(worker)

    def _give(self, worker: _Worker) -> None:
        """The next item, if one is left."""
        worker.at = None
        if self.next < self.until:
            worker.at, self.next = self.next, self.next + 1
            with suppress(BrokenPipeError, ConnectionResetError):  # it died between two items: found while waiting
                worker.pipe.send(self.items[worker.at])

    def _receive(self) -> None:
        """Wait for the next answers, or deaths."""
        from multiprocessing.connection import wait

        busy = {worker.pipe: worker for worker in self.workers if worker.at is not None}
        for pipe in wait([*busy]):
            worker = busy[pipe]  # type: ignore[index]
            assert worker.at is not None
            try:
                answer = worker.pipe.recv()
            except (EOFError, ConnectionResetError):
                self.workers.remove(worker)
                answer = self.dead(self.items[worker.at], worker.end())
                self._keep(worker.at, answer)
                self._begin()
            else:
                self._keep(worker.at, answer)
                self._give(worker)

    def _keep(self, number: int, answer: Answer) -> None:
        self.waiting[number] = answer
        if self.is_last(answer):
            self.until = min(self.until, number + 1)

    def kill(self) -> None:
        """End all of them at once."""
        for worker in self.workers:
            if worker.process.pid is not None:
                worker.process.kill()
