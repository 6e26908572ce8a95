"""A sweep under way: what is missing goes to the workers, every answer into the store; at the end all of it is told.

Impure: writes the store and the results, listens to signals.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Generator, Iterator
from contextlib import closing

from heuncli.analyses.sweep_store.rows import SweepHead
from heuncli.analyses.sweep_store.store.heads import texts_of_head
from heuncli.analyses.sweep_store.store.store import Store, StoredRows
from heuncli.analyses.variants.asking import Answer, Asker
from heuncli.analyses.variants.keys import VariantKeys
from heuncli.app.cli import jobs
from heuncli.app.cli.entry import BUG
from heuncli.app.cli.output import say
from heuncli.app.cli.progress import Tell, progress
from heuncli.app.cli.units import say_what_stays
from heuncli.app.commands.sweep.request import SweepRequest
from heuncli.app.commands.sweep.telling.noticed import Noticed, noticed_in, say_noticed
from heuncli.app.commands.sweep.telling.told import Telling, tell
from heuncli.app.commands.sweep.workers import answers_of
from heuncli.base.errors import OutputError, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.signals import Stopping
from heuncli.study.ask.measure import NotOneNumber

PAUSE = 0.1  # seconds from one line of progress to the next
NO_NUMBER = ("bad-option", "unknown-path")  # codes of a measure that is no number of the scene


class Sweep(NamedTuple):
    """A sweep that is to be done: of what, by whom, where its rows go, and which part of it."""

    asker: Asker
    head: SweepHead
    keys: VariantKeys
    store: Store
    shard: tuple[int, int]

    @property
    def size(self) -> int:
        """How many variants the part has."""
        k, n = self.shard
        return len(range(k - 1, self.head.plan.size, n))

    def identity(self) -> bytes:
        """By which the same sweep is known again: of the same spec, plan, measures and options."""
        texts, draws = texts_of_head(self.head)
        return bytes(hashlib.sha256(b"\0".join((self.keys.of_spec(), texts.encode(), draws or b""))).digest())


class Under(NamedTuple):
    """A variant that is under way: its key and its values."""

    key: bytes
    given: tuple[str, ...]


def run(sweep: Sweep, request: SweepRequest, how: Telling) -> int:
    """Solve what is missing and tell all of it; returns the exit code."""
    number = sweep.store.sweep(sweep.head, sweep.identity())
    with Stopping() as stopping:
        done = _done(sweep, number, request, stopping)
    rows = sweep.store.rows(number, sweep.head.plan.names, sweep.shard)
    if stopping.number:
        if request.store is None and done:
            tell(sweep.head, rows, how)
        goes_on = "the same command goes on with the rest" if request.store is not None else "--store FILE keeps them"
        say(f"{stopping.word}: {done} of {sweep.size} variants are done; {goes_on}")
        return 128 + stopping.number
    noticed = noticed_in(sweep.head, rows)
    if len(noticed.codes) == 1 and noticed.failed == sweep.size:
        _require_one(sweep, rows)
    tell(sweep.head, rows, how)
    say_what_stays(request.units, how.form, request.quiet)
    say_noticed(noticed, request.quiet)
    return exit_code(noticed, request.strict)


def exit_code(noticed: Noticed, strict: bool) -> int:
    """That of a sweep that was told."""
    return BUG if "bug" in noticed.codes else 1 if strict and noticed.failed else 0


def _done(sweep: Sweep, number: int, request: SweepRequest, stopping: Stopping) -> int:
    """Answer what is missing, and keep it; returns how many variants of the part are done."""
    under_way: dict[int, Under] = {}
    count = Count(sweep.size)
    plan, store = sweep.head.plan, sweep.store

    def missing() -> Iterator[int]:
        for variant in plan.numbers(sweep.shard):
            values = plan.values(variant)
            under = Under(sweep.keys.of(values), tuple(values.values()))
            if store.has(under.key):
                store.take_up(number, variant, *under)
                count.there += 1
            else:
                under_way[variant] = under
                yield variant

    answers = _answers(sweep, missing(), request, stopping.descriptor)
    with progress(request.quiet) as tell, closing(answers):
        try:
            for variant, answer in answers:
                if not count.solved and answer.code in NO_NUMBER:
                    _require_numbers(sweep.asker, plan.values(variant))
                store.keep(number, variant, *under_way.pop(variant), answer)
                count.take(answer)
                count.tell(tell)
        except OutputError as error:
            told = f"; {count.done} of {count.of} variants are done" + (" and kept" if request.store else "")
            error.tell(*(problem._replace(message=problem.message + told) for problem in error.problems))
            raise
    return count.done


def _answers(
    sweep: Sweep, numbers: Iterator[int], request: SweepRequest, stopped: int
) -> Generator[tuple[int, Answer], None, None]:
    """The variants answered, by processes of this machine or by a cluster."""
    plan = sweep.head.plan
    if request.dask is None:
        yield from answers_of(sweep.asker, plan, numbers, jobs.how_many(request.jobs, sweep.size), stopped)
        return
    from heuncli.app.commands.sweep.cluster import flow  # what is heavy, and not everybody has

    def told(line: str) -> None:
        if not request.quiet:
            say(f"heun: {line}")

    yield from flow.answers_of(sweep.asker.recipe, plan, numbers, request.dask, sweep.size, told, stopped)


class Count:
    """How far a sweep is."""

    def __init__(self, of: int) -> None:
        self.of, self.there, self.answered, self.solved = of, 0, 0, 0
        self.begun = self.told = time.monotonic()

    @property
    def done(self) -> int:
        """How many variants are there."""
        return self.there + self.answered

    def take(self, answer: Answer) -> None:
        """Another one is answered."""
        self.answered += 1
        self.solved += not answer.code

    def tell(self, tell: Tell) -> None:
        """How many of how many, how fast, and how long it will take."""
        now = time.monotonic()
        if now < self.told + PAUSE:
            return
        self.told = now
        rate = self.answered / max(now - self.begun, 1e-9)
        left = (self.of - self.done) / rate
        tell(self.done, self.of, f"{self.done} of {self.of} variants, {rate:.3g} a second, {in_words(left)} to go")


def in_words(seconds: float) -> str:
    """A time that is left."""
    minutes, s = divmod(int(seconds + 0.5), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02} min" if hours else f"{minutes} min {s:02} s" if minutes else f"{s} s"


def _require_numbers(asker: Asker, values: dict[str, str]) -> None:
    """Raise what is wrong with a measure of a scene that can be solved."""
    try:
        asker.measured(values)
    except NotOneNumber as error:
        error.tell(*(problem._replace(message=f"--measure: {problem.message}") for problem in error.problems))
        raise


def _require_one(sweep: Sweep, rows: StoredRows) -> None:
    """Raise what is wrong with the spec in all variants, with its place and hint. Raises SpecError."""
    first = next(iter(rows))
    try:
        sweep.asker.load(first.values)
    except SpecError as error:
        if error.problems[0].code == first.answer.code:
            raise
