"""Variants on their way to workers, some at a time: how many go together, and what becomes of those that come back.

A lot is as many variants as take its worker about SECONDS, by the pace of those before; near the end as many as leave
something for all. A lot whose worker went away goes again; one that lost two is taken apart, and of its variants each
goes alone to a worker that does nothing else for us. The one that loses two workers so is the one that ends them.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from itertools import islice

from heuncli.app.commands.sweep.cluster.worker import Variant
from heuncli.base.named_tuples import NamedTuple

SECONDS = 2.0  # that a lot takes: long beside the way to a worker and back, short beside what is lost with one
FIRST = 4  # variants of a worker's first lot
GROWTH = 8  # times the lot before, at most: of the first variants some wait for what is only made once
MOST = 5000
DEPTH = 2  # lots with a worker: the one that it is at, and the next
WORKERS = 2  # that a lot may lose: the first may have gone for reasons of its own


class Lot(NamedTuple):
    """Variants that go together, how many workers they have lost, and whether there is only one of them for that."""

    variants: tuple[Variant, ...]
    lost: int = 0
    alone: bool = False


class Pace:
    """How quick a worker is, by what it did last."""

    def __init__(self) -> None:
        self.size = FIRST

    def took(self, variants: int, seconds: float) -> None:
        """So many variants took so long."""
        fitting = SECONDS * variants / max(seconds, 1e-6)
        self.size = int(min(max(fitting, 1.0), GROWTH * max(variants, self.size), MOST))


class Lots:
    """The variants that no worker has."""

    def __init__(self, variants: Iterator[Variant], many: int) -> None:
        """many: how many variants there are."""
        self.variants = variants
        self.left = many  # that were not drawn yet
        self.drained = many == 0
        self.again: deque[Lot] = deque()
        self.alone: deque[Lot] = deque()

    def next(self, size: int, workers: int) -> Lot | None:
        """The next lot; None where there is none for now. workers: among how many the rest is divided."""
        if self.again:
            return self.again.popleft()
        size = max(1, min(size, -(-self.left // (DEPTH * max(workers, 1)))))
        variants = tuple(islice(self.variants, size))
        self.left = max(0, self.left - len(variants))
        self.drained = not variants
        return Lot(variants) if variants else None

    def nothing(self) -> bool:
        """Whether none waits."""
        return self.drained and not self.again and not self.alone

    def unanswered(self, lot: Lot, answered: int) -> None:
        """Of a lot the first variants are answered; the others go again."""
        rest = lot.variants[answered:]
        if rest:
            (self.alone if lot.alone else self.again).append(Lot(rest, 0, lot.alone))

    def lost(self, lot: Lot, workers: int = 1) -> bool:
        """The worker of a lot went away, or several did. Returns whether the one variant it holds is what ends them."""
        lot = lot._replace(lost=lot.lost + workers)
        if lot.lost < WORKERS:
            (self.alone if lot.alone else self.again).append(lot)
        elif not lot.alone:
            self.alone.extend(Lot((variant,), 0, True) for variant in lot.variants)
        else:
            return True
        return False
