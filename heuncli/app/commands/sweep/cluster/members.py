"""The workers of a cluster as a sweep sees them: which of them have the same heun, and what they are at.

Workers come and go. Each is asked first what it has (`worker.HELLO`); one that has no heun, or another one,
gets nothing and is told of in one line.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import count
from typing import Any

from heuncli.analyses.variants.asking import Recipe
from heuncli.app.commands.sweep.cluster.lots import DEPTH, SECONDS, Lot, Pace
from heuncli.app.commands.sweep.cluster.worker import HELLO, AbleWorker, HeldRecipe, answered, described
from heuncli.base.foreign_text import shown
from heuncli.version import VERSION

MOST_NAMED = 8  # addresses in a line


class Member:
    """A worker: what is known of it, and the lots that it has, by the keys of their tasks."""

    def __init__(self, address: str, threads: int) -> None:
        self.address, self.threads = address, threads
        self.pace = Pace()
        self.able = False
        self.unable = ""  # why it gets nothing
        self.held: Any = None  # the future of the recipe in its memory
        self.lots: dict[str, Lot] = {}

    def has_room(self, alone: bool) -> bool:
        """Whether it takes a lot more; alone: one that is to have the worker for itself."""
        if any(lot.alone for lot in self.lots.values()):
            return False
        return self.able and len(self.lots) < (1 if alone else DEPTH)


class ClusterTask:
    """A task that is under way: at whom, and its future; lot: None while a worker is asked what it has."""

    def __init__(self, member: Member, lot: Lot | None) -> None:
        self.member, self.lot = member, lot
        self.future: Any = None
        self.misses = 0  # times that its result did not come


class Members:
    """The workers, and the tasks they have."""

    def __init__(self, client: Any, recipe: Recipe, ended: Callable[[str], None]) -> None:
        """ended: called with the key of a task that has come to its end, in another thread."""
        self.client, self.recipe, self.ended = client, recipe, ended
        self.known: dict[str, Member] = {}
        self.tasks: dict[str, ClusterTask] = {}
        self.remarks: dict[str, list[str]] = {}  # what is to be told of workers: their addresses
        self.mine = described()
        self.keys = (f"heun-{client.id}-{number}" for number in count())
        self.call: Any = None  # a task for whichever worker comes, so that a cluster that grows by need does

    def able(self) -> list[Member]:
        """Those that answer variants."""
        return [member for member in self.known.values() if member.able]

    def asked(self) -> bool:
        """Whether some have not told yet what they have."""
        return any(not member.able and not member.unable for member in self.known.values())

    def look(self) -> Iterator[Lot]:
        """See who came and who went; gives the lots of those that went."""
        there: dict[str, int] = self.client.nthreads()
        for address in [address for address in self.known if address not in there]:
            yield from self.leaves(self.known[address])
        for address, threads in there.items():
            if address not in self.known:
                member = self.known[address] = Member(address, threads)
                self._begin(ClusterTask(member, None), eval, HELLO)
        if not there and self.call is None:
            self.call = self.client.submit(eval, "None", key=next(self.keys))
        elif there:
            self.call = None

    def leaves(self, member: Member) -> list[Lot]:
        """A worker is gone; returns the lots that it had."""
        del self.known[member.address]
        for key in [key for key, task in self.tasks.items() if task.member is member]:
            del self.tasks[key]
        member.held = None
        return list(member.lots.values())

    def give(self, member: Member, lot: Lot) -> None:
        """A lot for a worker."""
        if member.held is None:
            member.held = self._submit(member, next(self.keys), HeldRecipe, self.recipe)
        task = ClusterTask(member, lot)
        member.lots[self._begin(task, answered, member.held, lot.variants, SECONDS)] = lot

    def takes(self, key: str) -> ClusterTask | None:
        """The task of a key, which is no longer under way."""
        task = self.tasks.pop(key, None)
        if task is not None:
            task.member.lots.pop(key, None)
        return task

    def waits_on(self, key: str, task: ClusterTask) -> None:
        """A task whose result does not come yet, or not at all."""
        task.misses += 1
        self.tasks[key] = task
        if task.lot is not None:
            task.member.lots[key] = task.lot
        self._watch(key, task)

    def uses(self, recipe: Recipe) -> None:
        """Another recipe from here on."""
        self.recipe = recipe
        for member in self.known.values():
            member.held = None

    def told(self, member: Member, version: str, found: AbleWorker | None) -> None:
        """A worker has told what it has."""
        if found is None:
            self.refuse(member, f"heun {version} there, {VERSION} here")
        elif found.text != self.mine.text:
            self.refuse(member, f"heun {VERSION} there, too, but with another text")
        else:
            member.able = True
            if found.kernel != self.mine.kernel:
                here = self.mine.kernel
                self.remark(member, f"its kernel is the {found.kernel} one, here it is the {here} one: the same bits")
            if member.threads > 1:
                better = f"dask worker --nworkers {member.threads} --nthreads 1"
                self.remark(member, f"of its {member.threads} threads one works for heun; quicker: {better}")

    def refuse(self, member: Member, why: str) -> None:
        """A worker gets nothing from here on."""
        member.able, member.unable, member.held = False, why, None
        self.remark(member, f"is not used: {why}")

    def remark(self, member: Member, text: str) -> None:
        """Something to be told of a worker."""
        self.remarks.setdefault(text, []).append(member.address)

    def lines(self) -> list[str]:
        """What is to be told, a line for all workers of which the same is; it is told once."""
        lines = [f"{named(addresses)}: {shown(text)}" for text, addresses in self.remarks.items()]
        self.remarks.clear()
        return lines

    def end(self) -> None:
        """Leave nothing on the cluster; what is at rest there goes when nobody here refers to it any more."""
        under_way = [task.future for task in self.tasks.values()]
        self.call = None
        self.tasks.clear()
        self.known.clear()
        if under_way:
            self.client.cancel(under_way, force=True)

    def _begin(self, task: ClusterTask, function: Any, *given: Any) -> str:
        """Send a task to its worker; returns its key."""
        key = next(self.keys)
        task.future = self._submit(task.member, key, function, *given)
        self.tasks[key] = task
        self._watch(key, task)
        return key

    def _submit(self, member: Member, key: str, function: Any, *given: Any) -> Any:
        return self.client.submit(
            function, *given, key=key, workers=[member.address], allow_other_workers=False, pure=False
        )

    def _watch(self, key: str, task: ClusterTask) -> None:
        task.future.add_done_callback(lambda _: self.ended(key))


def named(addresses: list[str]) -> str:
    """Some addresses in a line."""
    more = f" and {len(addresses) - MOST_NAMED} more" if len(addresses) > MOST_NAMED else ""
    return ", ".join(addresses[:MOST_NAMED]) + more
