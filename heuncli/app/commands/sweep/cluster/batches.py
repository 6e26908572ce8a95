"""Batches of variants for the workers of a cluster: their size, and what happens to those that come back.

A batch has as many variants as its worker solves in about SECONDS, by the pace of earlier batches; near the end it is
smaller, so that all workers have something to do. A batch whose worker went away is sent again. A batch that lost two
workers is divided, and each of its variants is sent alone to a worker that does nothing else for heun. A variant that
loses two workers in this way is the one that ends them.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from itertools import islice

from heuncli.app.commands.sweep.cluster.worker import Variant
from heuncli.base.named_tuples import NamedTuple

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
