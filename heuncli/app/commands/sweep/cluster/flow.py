"""The variants of a plan answered by the workers of a Dask cluster.

    answers_of(recipe, plan, numbers, address)  ->  (number, Answer), in the order in which they come

This process receives every answer, and it alone writes; workers need neither the spec nor its files. Each lot of
variants (lots.py) is a task for one worker, of which each has two at most: so it is known who had what when a
worker goes away, as many tasks are under way as workers have use for, and results do not gather on the cluster. What
is left over of those that went is given to others; what ends a worker again and again has that for its answer. When
this ends, by an error or a signal too, nothing of it is left on the cluster.

Impure: the network, the clock, another thread, in which `distributed` tells that a task has ended.
"""

from __future__ import annotations

import socket
import time
from asyncio import CancelledError
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import chain
from typing import Any

from heuncli.analyses.sweep_store.rows import WORKER_DIED
from heuncli.analyses.variants.asking import Answer, Recipe
from heuncli.analyses.variants.files import with_files, with_more_files
from heuncli.analyses.variants.plans import Plan
from heuncli.app.cli.entry import UsageError
from heuncli.app.commands.sweep.cluster.door import PATIENCE, ClusterGone, connected
from heuncli.app.commands.sweep.cluster.lots import WORKERS, Lot, Lots
from heuncli.app.commands.sweep.cluster.members import ClusterTask, Member, Members, named
from heuncli.app.commands.sweep.cluster.worker import PartAnswered, Variant, in_words
from heuncli.base.errors import Problem
from heuncli.version import VERSION

LOOK = 1.0  # seconds from one look at who is there to the next
LONGEST_WAIT = 600.0  # seconds without a worker
FETCH = 2.0  # seconds for the answers of a lot that is done
MISSES = 10  # times that answers may fail to arrive from a worker that is there
SAME_HEUN = f"the same heun on every worker: pip install heuncli=={VERSION}"
Numbered = tuple[int, Answer]


def answers_of(
    recipe: Recipe,
    plan: Plan,
    numbers: Iterator[int],
    address: str,
    many: int,
    tell: Callable[[str], None],
    stopped: int | None = None,
) -> Iterator[Numbered]:
    """Each number with its answer, as they come.

    many: how many numbers there are; tell: is given lines on workers; stopped: a descriptor, and what can be read there
    ends it. Raises UsageError: bad-option, missing-extra, no-cluster, no-worker; ClusterGone.
    """
    first = next(numbers, None)
    if first is None:  # nobody is needed
        return
    variants = ((number, plan.values(number)) for number in chain((first,), numbers))
    with connected(address) as client:
        sweeping = _Sweeping(client, address, with_files(recipe, plan), Lots(variants, many), tell)
        try:
            yield from sweeping.answers(stopped)
        finally:
            sweeping.end()


class _Sweeping:
    """Lots on their way to workers, and answers on their way back."""

    def __init__(self, client: Any, address: str, recipe: Recipe, lots: Lots, tell: Callable[[str], None]) -> None:
        self.client, self.address, self.lots, self.tell = client, address, lots, tell
        self.ended: deque[str] = deque()  # keys of tasks, by the thread of `distributed`
        self.bell, self.ringer = socket.socketpair()
        self.bell.setblocking(False)
        self.ringer.setblocking(False)
        self.members = Members(client, recipe, self._ring)
        self.looked = -LOOK
        self.with_workers = time.monotonic()  # when a worker was there
        self.waiting = False

    def answers(self, stopped: int | None) -> Iterator[Numbered]:
        """All of them."""
        members, lots = self.members, self.lots
        while True:
            yield from self._look()
            self._give()
            if lots.nothing() and not any(member.lots for member in members.known.values()):
                break
            if self._wait(stopped):
                return
            while self.ended:
                task = members.takes(key := self.ended.popleft())
                if task is not None:
                    yield from self._take(key, task)
            self._speak()
        self._speak()

    def end(self) -> None:
        """Leave nothing on the cluster."""
        if self.client.status == "running":
            with suppress(Exception):  # it may be going just now
                self.members.end()
        self.ringer.close()
        self.bell.close()

    def _ring(self, key: str) -> None:
        """In the thread of `distributed`: a task has ended."""
        self.ended.append(key)
        with suppress(OSError):  # full: it rings already; closed: nobody waits any more
            self.ringer.send(b"\0")

    def _wait(self, stopped: int | None) -> bool:
        """Wait until a task has ended, or it is time to look round; returns whether this is to end."""
        from select import select

        watched: list[Any] = [self.bell] if stopped is None else [self.bell, stopped]
        readable, _, _ = select(watched, [], [], max(0.0, self.looked + LOOK - time.monotonic()))
        with suppress(BlockingIOError):
            while self.bell in readable and self.bell.recv(4096):
                pass
        return stopped is not None and stopped in readable

    def _look(self) -> Iterator[Numbered]:
        """See who came and who went, now and then. Raises ClusterGone, UsageError."""
        now = time.monotonic()
        if now < self.looked + LOOK:
            return
        self._require_connection()
        try:
            gone = list(self.members.look())
        except Exception as error:
            raise ClusterGone(self.address, f"the scheduler does not answer any more: {in_words(error)}") from None
        self.looked = now
        for lot in gone:
            yield from self._lost(lot)
        self._require_workers(now)

    def _require_connection(self) -> None:
        if self.client.status != "running":
            raise ClusterGone(self.address, "the scheduler went away")

    def _require_workers(self, now: float) -> None:
        """Raise UsageError where no worker will do, ClusterGone where none comes."""
        members = self.members
        if members.able() or members.asked():
            self.with_workers, self.waiting = now, False
            return
        if members.known:
            reasons: dict[str, list[str]] = {}
            for member in members.known.values():
                reasons.setdefault(member.unable, []).append(member.address)
            found = "; ".join(f"{named(addresses)}: {why}" for why, addresses in reasons.items())
            raise UsageError(
                Problem("no-worker", f"--dask {self.address}: no worker can be used: {found}", hint=SAME_HEUN)
            )
        if now - self.with_workers > LONGEST_WAIT:
            raise ClusterGone(self.address, f"there was no worker for {LONGEST_WAIT:g} s")
        if not self.waiting:
            self.waiting = True
            self.tell(f"{self.address}: no workers; waiting for them")

    def _give(self) -> None:
        """As many lots as workers have room for; while some go alone, only these."""
        able, alone = self.members.able(), self.lots.alone
        if alone:
            for member in able:
                if alone and member.has_room(alone=True):
                    self.members.give(member, alone.popleft())
            return
        for _ in range(2):  # first one to each, then the next
            for member in able:
                if member.has_room(alone=False) and (lot := self.lots.next(member.pace.size, len(able))) is not None:
                    self.members.give(member, lot)

    def _take(self, key: str, task: ClusterTask) -> Iterator[Numbered]:
        """What a task has come to. Raises ClusterGone."""
        status = task.future.status
        if status == "error":
            error = task.future.exception(timeout=PATIENCE)
            if type(error).__name__ == "KilledWorker" and task.lot is not None:
                yield from self._lost(task.lot, WORKERS)
            else:
                self._cannot(task, _unable(error))
        elif status == "finished":
            yield from self._finished(key, task)
        elif status != "cancelled":  # done, and lost with its worker before it was taken
            self.members.waits_on(key, task)
        else:  # not by us: what is in our books we do not cancel
            self._require_connection()
            if task.member.address in self.members.known:  # it is asked again
                others = [lot for lot in self.members.leaves(task.member) if lot is not task.lot]
                for lot in [task.lot, *others] if task.lot is not None else others:
                    self.lots.unanswered(lot, 0)

    def _finished(self, key: str, task: ClusterTask) -> Iterator[Numbered]:
        """The answers of a task that is done."""
        try:
            found = task.future.result(timeout=FETCH)
        except (Exception, CancelledError) as error:  # its worker may be gone with them: seen at the next look
            self._require_connection()
            if task.misses < MISSES:
                self.members.waits_on(key, task)
            else:
                self._cannot(task, f"its answers do not arrive: {in_words(error)}")
            return
        if task.lot is None:
            version, able = found
            self.members.told(task.member, version, able)
        else:
            yield from self._answered(task.member, task.lot, found)

    def _answered(self, member: Member, lot: Lot, found: PartAnswered) -> Iterator[Numbered]:
        """The answers of a lot, or of its first variants."""
        if found.broken:
            self.members.refuse(member, f"it cannot solve the scene: {found.broken}")
        if found.answers:
            member.pace.took(len(found.answers), found.seconds)
        if found.lacking:
            self.members.uses(with_more_files(self.members.recipe, [found.lacking]))
        self.lots.unanswered(lot, len(found.answers))
        yield from zip(map(_number, lot.variants), found.answers, strict=False)

    def _lost(self, lot: Lot, workers: int = 1) -> Iterator[Numbered]:
        """The worker of a lot is gone."""
        if self.lots.lost(lot, workers):
            reason = f"the worker that solved it went away, {WORKERS} times and with nothing else to do"
            yield _number(lot.variants[0]), Answer(code=WORKER_DIED, reason=reason)

    def _cannot(self, task: ClusterTask, why: str) -> None:
        """A worker cannot do what it is asked; its lots go to others."""
        self.members.refuse(task.member, why)
        if task.lot is not None:
            self.lots.unanswered(task.lot, 0)

    def _speak(self) -> None:
        """What is to be told of workers, when all have said what they have."""
        if not self.members.asked() and (self.members.able() or not self.members.known):
            for line in self.members.lines():
                self.tell(line)


def _number(variant: Variant) -> int:
    return variant[0]


def _unable(error: BaseException | None) -> str:
    """Why a worker cannot, in words."""
    if isinstance(error, ModuleNotFoundError) and "heuncli" in str(error):
        return "there is no heun"
    return f"it cannot be asked: {in_words(error)}"
