"""Solve the variants of a plan on the workers of a Dask cluster.

    solve_variants(recipe, plan, numbers, address)  ->  (number, VariantResult), in the order of completion

This process receives every result, and it alone writes; workers need neither the spec nor its files. Each batch of
variants (workers.py) is a task for one worker, and each worker has two at most. So it is known which variants a worker
had when it goes away, no more tasks are under way than are useful, and results do not pile up on the cluster. The
remaining batches of a worker that went away go to others; a variant that ends workers repeatedly gets that as its
result. At the end, also after an error or a signal, nothing is left on the cluster.

The files that the variants name are read once here, and sent with the recipe.

Impure: files, the network, the clock, another thread, in which `distributed` reports that a task has ended.
"""

from __future__ import annotations

import socket
import time
from asyncio import CancelledError
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from itertools import chain
from typing import Any

from heuncli.analyses.variants.evaluation import Recipe
from heuncli.analyses.variants.measures import WORKER_DIED, VariantResult
from heuncli.analyses.variants.parameters import CASE
from heuncli.analyses.variants.plans import Plan
from heuncli.app.cli.entry import UsageError
from heuncli.app.commands.sweep.cluster.connection import PATIENCE, ClusterGone, connect
from heuncli.app.commands.sweep.cluster.worker import PartialResults, Variant, format_exception
from heuncli.app.commands.sweep.cluster.workers import (
    WORKERS,
    BatchQueue,
    ClusterTask,
    ClusterWorker,
    VariantBatch,
    WorkerPool,
    format_addresses,
)
from heuncli.base.errors import HeunError, Problem
from heuncli.scene.file_format.incremental_loader import SpecVariants
from heuncli.scene.file_format.named_files import NamedFiles, TrackedFiles
from heuncli.scene.file_format.parameters import parse_settings
from heuncli.version import VERSION

FILE_KEYS = (".file", ".curve")  # endings of the keys whose values are names of files


def add_files(recipe: Recipe, plan: Plan) -> Recipe:
    """Add to the recipe the files that its spec names and those that the axes set, with their present content.

    A variant may name a further file, by a key that holds a whole table: see `add_named_files`. Raises SpecError.
    """
    noted_files = TrackedFiles(recipe.path)
    spec = SpecVariants(recipe.path, recipe.text, recipe.overrides, False, recipe.case, noted_files).spec
    for case in _iter_cases(plan, spec.cases):
        try:
            SpecVariants(recipe.path, recipe.text, recipe.overrides, False, case, noted_files)
        except HeunError:  # the rows of that case report it
            continue
    return add_named_files(recipe, [*noted_files.names, *_iter_set_files(plan)])


def add_named_files(recipe: Recipe, names: Iterable[str]) -> Recipe:
    """Add some files to the recipe."""
    files = NamedFiles(recipe.path)
    files_by_name = dict(recipe.files or {})
    files_by_name.update((name, files.get_file(name)) for name in dict.fromkeys(names) if name not in files_by_name)
    return recipe._replace(files=files_by_name)


def _iter_cases(plan: Plan, cases: Iterable[str]) -> Iterator[str]:
    """Yield the load cases that the plan varies."""
    texts = {text for axis in (*plan.columns, *plan.axes) if axis.name == CASE for text in axis.values}
    return (case for case in cases if case in texts)


def _iter_set_files(plan: Plan) -> Iterator[str]:
    """Yield the files that axes name."""
    for axis in (*plan.columns, *plan.axes):
        if axis.name.endswith(FILE_KEYS):
            for text in axis.values if axis.unit is None else ():
                settings, _ = parse_settings({axis.name: str(text)})
                yield from (setting.value for setting in settings if isinstance(setting.value, str))


UPDATE_INTERVAL = 1.0  # seconds between updates of the list of workers
LONGEST_WAIT = 600.0  # seconds without a worker
FETCH_TIMEOUT = 2.0  # seconds to fetch the results of a finished batch
MAX_MISSES = 10  # how often results may fail to arrive from a connected worker
SAME_HEUN = f"install the same heun on every worker: pip install heuncli=={VERSION}"
NumberedResult = tuple[int, VariantResult]


def solve_variants(
    recipe: Recipe,
    plan: Plan,
    numbers: Iterator[int],
    address: str,
    count: int,
    report: Callable[[str], None],
    stop_descriptor: int | None = None,
) -> Iterator[NumberedResult]:
    """Yield each number with its result, in the order of completion.

    count: how many numbers there are
    report: is called with lines about the workers
    stop_descriptor: a file descriptor; the work ends once anything can be read from it

    Raises UsageError: bad-option, missing-extra, no-cluster, no-worker; ClusterGone.
    """
    first = next(numbers, None)
    if first is None:  # no variants
        return
    variants = ((number, plan.find_values(number)) for number in chain((first,), numbers))
    with connect(address) as client:
        scheduler = _Scheduler(client, address, add_files(recipe, plan), BatchQueue(variants, count), report)
        try:
            yield from scheduler.iter_results(stop_descriptor)
        finally:
            scheduler.close()


class _Scheduler:
    """Sends batches to the workers and receives their results."""

    def __init__(
        self, client: Any, address: str, recipe: Recipe, queue: BatchQueue, report: Callable[[str], None]
    ) -> None:
        self.client, self.address, self.queue, self.report = client, address, queue, report
        self.ended_keys: deque[str] = deque()  # keys of ended tasks, added by the thread of `distributed`
        self.wake_receiver, self.wake_sender = socket.socketpair()
        self.wake_receiver.setblocking(False)
        self.wake_sender.setblocking(False)
        self.pool = WorkerPool(client, recipe, self._wake)
        self.last_update = -UPDATE_INTERVAL
        self.last_with_workers = time.monotonic()  # last time with a worker
        self.waiting = False

    def iter_results(self, stop_descriptor: int | None) -> Iterator[NumberedResult]:
        """Yield all results."""
        pool, queue = self.pool, self.queue
        while True:
            yield from self._update_workers()
            self._send_batches()
            if queue.is_empty() and not any(worker.batches for worker in pool.known.values()):
                break
            if self._wait(stop_descriptor):
                return
            while self.ended_keys:
                task = pool.pop_task(key := self.ended_keys.popleft())
                if task is not None:
                    yield from self._process_task(key, task)
            self._report_remarks()
        self._report_remarks()

    def close(self) -> None:
        """Leave nothing on the cluster."""
        if self.client.status == "running":
            with suppress(Exception):  # the cluster may be closing
                self.pool.cancel_all()
        self.wake_sender.close()
        self.wake_receiver.close()

    def _wake(self, key: str) -> None:
        """Note that a task has ended, and wake the main thread; runs in the thread of `distributed`."""
        self.ended_keys.append(key)
        with suppress(OSError):  # full: already notified; closed: nobody waits any more
            self.wake_sender.send(b"\0")

    def _wait(self, stop_descriptor: int | None) -> bool:
        """Wait until a task has ended, or the next update is due; returns whether the work must stop."""
        from select import select

        descriptors: list[Any] = (
            [self.wake_receiver] if stop_descriptor is None else [self.wake_receiver, stop_descriptor]
        )
        readable, _, _ = select(descriptors, [], [], max(0.0, self.last_update + UPDATE_INTERVAL - time.monotonic()))
        with suppress(BlockingIOError):
            while self.wake_receiver in readable and self.wake_receiver.recv(4096):
                pass
        return stop_descriptor is not None and stop_descriptor in readable

    def _update_workers(self) -> Iterator[NumberedResult]:
        """Update the list of workers now and then; yields results of variants that ended workers. Raises ClusterGone,
        UsageError.
        """
        now = time.monotonic()
        if now < self.last_update + UPDATE_INTERVAL:
            return
        self._require_connection()
        try:
            lost_batches = list(self.pool.update())
        except Exception as error:
            raise ClusterGone(self.address, f"the scheduler no longer answers: {format_exception(error)}") from None
        self.last_update = now
        for batch in lost_batches:
            yield from self._handle_lost(batch)
        self._require_workers(now)

    def _require_connection(self) -> None:
        """Raise ClusterGone if the connection to the scheduler is lost."""
        if self.client.status != "running":
            raise ClusterGone(self.address, "the scheduler was lost")

    def _require_workers(self, now: float) -> None:
        """Raise UsageError if no worker can be used, ClusterGone if none comes."""
        pool = self.pool
        if pool.list_usable() or pool.has_unknown():
            self.last_with_workers, self.waiting = now, False
            return
        if pool.known:
            reasons: dict[str, list[str]] = {}
            for worker in pool.known.values():
                reasons.setdefault(worker.refusal, []).append(worker.address)
            reason_text = "; ".join(f"{format_addresses(addresses)}: {why}" for why, addresses in reasons.items())
            raise UsageError(
                Problem("no-worker", f"--dask {self.address}: no worker can be used: {reason_text}", hint=SAME_HEUN)
            )
        if now - self.last_with_workers > LONGEST_WAIT:
            raise ClusterGone(self.address, f"no worker was available for {LONGEST_WAIT:g} s")
        if not self.waiting:
            self.waiting = True
            self.report(f"{self.address}: no workers; waiting for them")

    def _send_batches(self) -> None:
        """Send as many batches as the workers can take; while there are isolated ones, only these."""
        usable, isolated = self.pool.list_usable(), self.queue.isolated
        if isolated:
            for worker in usable:
                if isolated and worker.has_capacity(isolated=True):
                    self.pool.send(worker, isolated.popleft())
            return
        for _ in range(2):  # first one to each, then the next
            for worker in usable:
                if (
                    worker.has_capacity(isolated=False)
                    and (batch := self.queue.pop_next(worker.pace.size, len(usable))) is not None
                ):
                    self.pool.send(worker, batch)

    def _process_task(self, key: str, task: ClusterTask) -> Iterator[NumberedResult]:
        """Process a task that has ended. Raises ClusterGone."""
        status = task.future.status
        if status == "error":
            error = task.future.exception(timeout=PATIENCE)
            if type(error).__name__ == "KilledWorker" and task.batch is not None:
                yield from self._handle_lost(task.batch, WORKERS)
            else:
                self._refuse_worker(task, _explain_failure(error))
        elif status == "finished":
            yield from self._fetch_results(key, task)
        elif status != "cancelled":  # done, but lost with its worker before it was fetched
            self.pool.wait_again(key, task)
        else:  # cancelled by the cluster: heun does not cancel tasks that it still tracks
            self._require_connection()
            if task.worker.address in self.pool.known:  # it will be asked for its version again
                other_batches = [batch for batch in self.pool.remove(task.worker) if batch is not task.batch]
                for batch in [task.batch, *other_batches] if task.batch is not None else other_batches:
                    self.queue.return_rest(batch, 0)

    def _fetch_results(self, key: str, task: ClusterTask) -> Iterator[NumberedResult]:
        """Fetch the results of a finished task."""
        try:
            task_result = task.future.result(timeout=FETCH_TIMEOUT)
        except (Exception, CancelledError) as error:  # its worker may be gone, which the next update notices
            self._require_connection()
            if task.misses < MAX_MISSES:
                self.pool.wait_again(key, task)
            else:
                self._refuse_worker(task, f"its results do not arrive: {format_exception(error)}")
            return
        if task.batch is None:
            version, worker_version = task_result
            self.pool.record_version(task.worker, version, worker_version)
        else:
            yield from self._accept_results(task.worker, task.batch, task_result)

    def _accept_results(
        self, worker: ClusterWorker, batch: VariantBatch, partial: PartialResults
    ) -> Iterator[NumberedResult]:
        """Yield the results of a batch, or of its first variants, and put back the rest."""
        if partial.failure:
            self.pool.refuse(worker, f"it cannot solve the model: {partial.failure}")
        if partial.results:
            worker.pace.record_time(len(partial.results), partial.seconds)
        if partial.missing_file:
            self.pool.replace_recipe(add_named_files(self.pool.recipe, [partial.missing_file]))
        self.queue.return_rest(batch, len(partial.results))
        yield from zip(map(_get_number, batch.variants), partial.results, strict=False)

    def _handle_lost(self, batch: VariantBatch, workers: int = 1) -> Iterator[NumberedResult]:
        """Put back a batch whose worker is gone, or yield the result of the variant that ends workers."""
        if self.queue.return_lost(batch, workers):
            reason = f"the worker that solved it was lost, {WORKERS} times and with no other task"
            yield _get_number(batch.variants[0]), VariantResult(code=WORKER_DIED, reason=reason)

    def _refuse_worker(self, task: ClusterTask, why: str) -> None:
        """Stop using the worker of a task; its batches go to others."""
        self.pool.refuse(task.worker, why)
        if task.batch is not None:
            self.queue.return_rest(task.batch, 0)

    def _report_remarks(self) -> None:
        """Report the remarks on workers, once the version of all is known."""
        if not self.pool.has_unknown() and (self.pool.list_usable() or not self.pool.known):
            for line in self.pool.take_remarks():
                self.report(line)


def _get_number(variant: Variant) -> int:
    """Return the number of a variant."""
    return variant[0]


def _explain_failure(error: BaseException | None) -> str:
    """Return why a worker cannot be used, in words."""
    if isinstance(error, ModuleNotFoundError) and "heuncli" in str(error):
        return "heun is not installed"
    return f"it cannot be queried: {format_exception(error)}"
