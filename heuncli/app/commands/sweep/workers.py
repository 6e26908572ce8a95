"""The variants of a plan answered by processes of this machine, each forked from this one with the scene set up.

    answers_of(asker, plan, numbers, jobs)  ->  (number, Answer), in the order in which they come

Whatever else answers variants (a cluster) has this form: numbers are drawn from it as there is room for them, and every
number that was drawn is answered once. A process that dies takes a batch with it: its variants are tried once more, one
by one, and the one that ends a second process has that for its answer. Impure: processes, the clock.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from itertools import islice

from heuncli.analyses.sweep_store.rows import WORKER_DIED
from heuncli.analyses.variants.asking import Answer, Asker, failed
from heuncli.analyses.variants.plans import Plan
from heuncli.app.cli import alarm, jobs
from heuncli.app.cli.entry import contained
from heuncli.base.errors import HeunError
from heuncli.base.named_tuples import NamedTuple

BATCH = 0.2  # seconds that a batch takes: long beside the way to a process and back, short beside what a kill loses
GROWTH = 8  # times the batch before, at most: of the first variants some wait for what is only made once
MOST = 2000  # variants of a batch


class Answered(NamedTuple):
    """The answers of a batch, and what they took [s]."""

    answers: tuple[Answer, ...]
    seconds: float


def answers_of(
    asker: Asker, plan: Plan, numbers: Iterator[int], jobs_: int, stopped: int | None = None
) -> Iterator[tuple[int, Answer]]:
    """Each number with its answer, as they come; stopped: a descriptor, and what can be read there ends it."""
    batches = Batches(numbers)
    work = partial(answered, asker, plan)
    if not jobs.forks():
        while (batch := batches.next()) is not None:
            found = work(batch)
            batches.took(batch, found.seconds)
            yield from zip(batch, found.answers, strict=True)
        return
    for batch, found_ in jobs.as_done(work, batches.next, jobs_, stopped):
        if isinstance(found_, jobs.Died):
            yield from ((number, died(found_)) for number in batches.again.lost(batch, found_))
        else:
            batches.took(batch, found_.seconds)
            yield from zip(batch, found_.answers, strict=True)


def answered(asker: Asker, plan: Plan, numbers: Sequence[int]) -> Answered:
    """The answers of some variants, whatever becomes of each."""
    begun = time.monotonic()
    answers = tuple(answer_of(asker, plan.values(number)) for number in numbers)
    return Answered(answers, time.monotonic() - begun)


def answer_of(asker: Asker, values: Mapping[str, str]) -> Answer:
    """What a variant answers: also where the time is up, the memory ends, or heun itself is at fault."""
    limit = asker.recipe.options.time_limit
    words = [asker.recipe.path, *(f"{name}={text}" for name, text in values.items())]
    try:
        return contained(lambda: alarm.limited(lambda: asker.answer(values), limit), ("sweep", *words))
    except HeunError as error:
        return failed(error)


def died(how: jobs.Died) -> Answer:
    """The answer of a variant that ended two processes, or one at the hard end of its time limit."""
    if how.is_time_up:
        return Answer(code="time-limit", reason="the time limit was reached, and the work did not stop")
    return Answer(code=WORKER_DIED, reason=f"the process that solved it was {how.how}, twice")


class Batches:
    """Numbers of variants, some at a time: as many as take a process about so long as a batch should."""

    def __init__(self, numbers: Iterator[int]) -> None:
        self.numbers = numbers
        self.size = 1
        self.again = jobs.SecondTries()  # of batches whose process died

    def next(self) -> tuple[int, ...] | None:
        """The next batch; None where there is none for now."""
        alone = self.again.next()
        if alone is not None:
            return (alone,)
        return tuple(islice(self.numbers, self.size)) or None

    def took(self, batch: Sequence[int], seconds: float) -> None:
        """A batch is answered: the next ones are as large as its pace makes fit."""
        self.again.answered(batch)
        fitting = BATCH * len(batch) / max(seconds, 1e-6)
        self.size = int(min(max(fitting, 1.0), GROWTH * len(batch), MOST))
