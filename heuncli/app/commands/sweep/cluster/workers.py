"""The workers of a cluster: which of them have the same heun, their tasks, and the batches that they solve."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from itertools import count, islice
from typing import Any

from heuncli.analyses.variants.evaluation import Recipe
from heuncli.app.commands.sweep.cluster.worker import (
    HELLO,
    CachedRecipe,
    Variant,
    WorkerVersion,
    read_worker_version,
    solve_batch,
)
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.version import VERSION

SECONDS = 2.0  # of a batch: long compared with the transfer, short enough to lose
FIRST_SIZE = 4  # variants of a worker's first batch
GROWTH = 8  # largest growth from batch to batch: the first variants include one-off work
MAX_SIZE = 5000
DEPTH = 2  # batches per worker: the current one and the next
WORKERS = 2  # that a batch may lose: the first may have gone for another reason


class VariantBatch(NamedTuple):
    """A batch of variants.

    lost_workers: how many workers it has lost
    alone: whether its worker must have nothing else to do
    """

    variants: tuple[Variant, ...]
    lost_workers: int = 0
    alone: bool = False


class WorkerPace:
    """The speed of a worker, by its last batch."""

    def __init__(self) -> None:
        self.size = FIRST_SIZE

    def record_time(self, variants: int, seconds: float) -> None:
        """Record the time of a batch, and adapt the size of the next one."""
        fitting = SECONDS * variants / max(seconds, 1e-6)
        self.size = int(min(max(fitting, 1.0), GROWTH * max(variants, self.size), MAX_SIZE))


class BatchQueue:
    """The variants that no worker has."""

    def __init__(self, variants: Iterator[Variant], count: int) -> None:
        """count: number of variants"""
        self.variants = variants
        self.remaining = count  # number of variants not yet taken from the iterator
        self.drained = count == 0
        self.retries: deque[VariantBatch] = deque()
        self.isolated: deque[VariantBatch] = deque()

    def pop_next(self, size: int, workers: int) -> VariantBatch | None:
        """Return the next batch, or None if there is none now.

        workers: number of workers that share the rest
        """
        if self.retries:
            return self.retries.popleft()
        size = max(1, min(size, -(-self.remaining // (DEPTH * max(workers, 1)))))
        variants = tuple(islice(self.variants, size))
        self.remaining = max(0, self.remaining - len(variants))
        self.drained = not variants
        return VariantBatch(variants) if variants else None

    def is_empty(self) -> bool:
        """Return whether no variant waits."""
        return self.drained and not self.retries and not self.isolated

    def return_rest(self, batch: VariantBatch, solved_count: int) -> None:
        """Put back the variants of a batch after the first ones, which are solved."""
        rest = batch.variants[solved_count:]
        if rest:
            (self.isolated if batch.alone else self.retries).append(VariantBatch(rest, 0, batch.alone))

    def return_lost(self, batch: VariantBatch, workers: int = 1) -> bool:
        """Put back a batch whose worker, or workers, went away; returns whether its single variant is what ends
        them.
        """
        batch = batch._replace(lost_workers=batch.lost_workers + workers)
        if batch.lost_workers < WORKERS:
            (self.isolated if batch.alone else self.retries).append(batch)
        elif not batch.alone:
            self.isolated.extend(VariantBatch((variant,), 0, True) for variant in batch.variants)
        else:
            return True
        return False


MAX_ADDRESSES = 8  # addresses in a line


class ClusterWorker:
    """A worker: what is known of it, and its batches by the keys of their tasks."""

    def __init__(self, address: str, threads: int) -> None:
        self.address, self.threads = address, threads
        self.pace = WorkerPace()
        self.is_usable = False
        self.refusal = ""  # why it gets no work
        self.recipe_future: Any = None  # the future of the recipe in its memory
        self.batches: dict[str, VariantBatch] = {}

    def has_capacity(self, isolated: bool) -> bool:
        """Return whether it can take another batch.

        isolated: whether the batch needs the worker for itself
        """
        if any(batch.alone for batch in self.batches.values()):
            return False
        return self.is_usable and len(self.batches) < (1 if isolated else DEPTH)


class ClusterTask:
    """A task that is under way: its worker and its future.

    batch: its batch; None while the worker is asked for its version
    """

    def __init__(self, worker: ClusterWorker, batch: VariantBatch | None) -> None:
        self.worker, self.batch = worker, batch
        self.future: Any = None
        self.misses = 0  # how often its result did not arrive


class WorkerPool:
    """The workers, and their tasks."""

    def __init__(self, client: Any, recipe: Recipe, on_end: Callable[[str], None]) -> None:
        """on_end: called in another thread with the key of a task that has ended"""
        self.client, self.recipe, self.on_end = client, recipe, on_end
        self.known: dict[str, ClusterWorker] = {}
        self.tasks: dict[str, ClusterTask] = {}
        self.remarks: dict[str, list[str]] = {}  # remarks on workers, with their addresses
        self.own_version = read_worker_version()
        self.keys = (f"heun-{client.id}-{number}" for number in count())
        self.wake_up_task: Any = None  # a task for any worker, so that an adaptive cluster starts one

    def list_usable(self) -> list[ClusterWorker]:
        """Return the workers that solve variants."""
        return [worker for worker in self.known.values() if worker.is_usable]

    def has_unknown(self) -> bool:
        """Return whether the version of some workers is not known yet."""
        return any(not worker.is_usable and not worker.refusal for worker in self.known.values())

    def update(self) -> Iterator[VariantBatch]:
        """Update the list of workers; yields the batches of those that went away."""
        present: dict[str, int] = self.client.nthreads()
        for address in [address for address in self.known if address not in present]:
            yield from self.remove(self.known[address])
        for address, threads in present.items():
            if address not in self.known:
                worker = self.known[address] = ClusterWorker(address, threads)
                self._start(ClusterTask(worker, None), eval, HELLO)
        if not present and self.wake_up_task is None:
            self.wake_up_task = self.client.submit(eval, "None", key=next(self.keys))
        elif present:
            self.wake_up_task = None

    def remove(self, worker: ClusterWorker) -> list[VariantBatch]:
        """Remove a worker that went away; returns its batches."""
        del self.known[worker.address]
        for key in [key for key, task in self.tasks.items() if task.worker is worker]:
            del self.tasks[key]
        worker.recipe_future = None
        return list(worker.batches.values())

    def send(self, worker: ClusterWorker, batch: VariantBatch) -> None:
        """Send a batch to a worker."""
        if worker.recipe_future is None:
            worker.recipe_future = self._submit(worker, next(self.keys), CachedRecipe, self.recipe)
        task = ClusterTask(worker, batch)
        worker.batches[self._start(task, solve_batch, worker.recipe_future, batch.variants, SECONDS)] = batch

    def pop_task(self, key: str) -> ClusterTask | None:
        """Remove and return the task of a key, or None."""
        task = self.tasks.pop(key, None)
        if task is not None:
            task.worker.batches.pop(key, None)
        return task

    def wait_again(self, key: str, task: ClusterTask) -> None:
        """Wait again for a task whose result has not arrived."""
        task.misses += 1
        self.tasks[key] = task
        if task.batch is not None:
            task.worker.batches[key] = task.batch
        self._watch(key, task)

    def replace_recipe(self, recipe: Recipe) -> None:
        """Use another recipe from here on."""
        self.recipe = recipe
        for worker in self.known.values():
            worker.recipe_future = None

    def record_version(self, worker: ClusterWorker, version: str, worker_version: WorkerVersion | None) -> None:
        """Record the version of a worker, and decide whether it is used."""
        if worker_version is None:
            self.refuse(worker, f"heun {version} there, {VERSION} here")
        elif worker_version.text != self.own_version.text:
            self.refuse(worker, f"heun {VERSION} there too, but with different code")
        else:
            worker.is_usable = True
            if worker_version.kernel != self.own_version.kernel:
                own_kernel = self.own_version.kernel
                self.add_remark(
                    worker,
                    f"its kernel is the {worker_version.kernel} one, here it is the {own_kernel} one: same results",
                )
            if worker.threads > 1:
                better = f"dask worker --nworkers {worker.threads} --nthreads 1"
                self.add_remark(worker, f"heun uses one of its {worker.threads} threads; faster: {better}")

    def refuse(self, worker: ClusterWorker, why: str) -> None:
        """Give a worker no more work."""
        worker.is_usable, worker.refusal, worker.recipe_future = False, why, None
        self.add_remark(worker, f"is not used: {why}")

    def add_remark(self, worker: ClusterWorker, text: str) -> None:
        """Add a remark on a worker, to be reported."""
        self.remarks.setdefault(text, []).append(worker.address)

    def take_remarks(self) -> list[str]:
        """Return the remarks, one line for all workers with the same one, and clear them."""
        lines = [f"{format_addresses(addresses)}: {escape(text)}" for text, addresses in self.remarks.items()]
        self.remarks.clear()
        return lines

    def cancel_all(self) -> None:
        """Cancel all tasks; data on the cluster is released when no future refers to it."""
        futures = [task.future for task in self.tasks.values()]
        self.wake_up_task = None
        self.tasks.clear()
        self.known.clear()
        if futures:
            self.client.cancel(futures, force=True)

    def _start(self, task: ClusterTask, function: Any, *arguments: Any) -> str:
        """Send a task to its worker; returns its key."""
        key = next(self.keys)
        task.future = self._submit(task.worker, key, function, *arguments)
        self.tasks[key] = task
        self._watch(key, task)
        return key

    def _submit(self, worker: ClusterWorker, key: str, function: Any, *arguments: Any) -> Any:
        """Send a call to one worker; returns its future."""
        return self.client.submit(
            function, *arguments, key=key, workers=[worker.address], allow_other_workers=False, pure=False
        )

    def _watch(self, key: str, task: ClusterTask) -> None:
        task.future.add_done_callback(lambda _: self.on_end(key))


def format_addresses(addresses: list[str]) -> str:
    """Format some addresses on one line."""
    more_text = f" and {len(addresses) - MAX_ADDRESSES} more" if len(addresses) > MAX_ADDRESSES else ""
    return ", ".join(addresses[:MAX_ADDRESSES]) + more_text
