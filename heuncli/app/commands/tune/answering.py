"""Variants answered in this process or several, as the search takes them. Impure: processes, the clock."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

from heuncli.analyses.tune.results import Reading, TrialOutcome
from heuncli.analyses.tune.trials import TIME_LIMIT
from heuncli.analyses.variants.asking import Answer, Asker, failed
from heuncli.app.cli import alarm, jobs
from heuncli.app.cli.entry import UsageError, contained
from heuncli.base.errors import HeunError, Problem
from heuncli.study.ask.measure import NotOneNumber

NO_NUMBER = "bad-option"  # the code of a measure that is not one number
ALMOST = 1e-9  # s: what is left of a time limit that is reached
WORTH = 0.02  # s: processes for shorter variants take longer to make than they save
WORKER_DIED = "worker-died"


class Answering:
    """Answers some variants at once, in their order."""

    def __init__(self, asker: Asker, at_once: int | None) -> None:
        """at_once: how many processes; None: as many as there are processors, where a variant is worth it."""
        self.asker, self.at_once = asker, at_once
        self.seconds = 0.0  # that the scene as it is took

    def own(self) -> TrialOutcome:
        """That of the scene as it is. Raises UsageError where a measure is not one number of it."""
        begun = time.perf_counter()
        try:
            return outcome_of(self.asker.measured({}))
        except NotOneNumber as error:
            (problem,) = error.problems
            raise UsageError(problem) from None
        except HeunError as error:
            return outcome_of(failed(error))
        finally:
            self.seconds = time.perf_counter() - begun

    def __call__(self, several: Sequence[Mapping[str, str]]) -> Iterator[TrialOutcome]:
        """The outcomes of variants, in the form of --set. Raises UsageError where a measure is not one number."""
        short = self.at_once is None and self.seconds < WORTH
        at_once = 1 if short or len(several) == 1 else jobs.how_many(self.at_once, len(several))
        work: Callable[[Mapping[str, str]], Answer] = partial(answer_apart if at_once > 1 else answer, self.asker)
        for found in jobs.each(work, several, at_once, died):
            if found.code == NO_NUMBER:
                raise UsageError(Problem(found.code, found.reason, hint="such as 'max foundation.force'"))
            yield outcome_of(found)


def answer(asker: Asker, values: Mapping[str, str]) -> Answer:
    """The answer of a variant, in this process, whose time limit interrupts whatever is going on."""
    left = alarm.remaining()
    if left is not None and left <= ALMOST:
        return Answer(code=TIME_LIMIT)
    try:
        return alarm.interruptible(partial(asker.answer, values))
    except alarm.TimeUp:  # the search calls this through SciPy, which no exception passes unharmed
        return Answer(code=TIME_LIMIT)


def answer_apart(asker: Asker, values: Mapping[str, str]) -> Answer:
    """The answer of a variant, in a process of its own, which has no alarm but what it sets itself."""
    work = partial(alarm.limited, lambda: asker.answer(values), alarm.remaining())
    try:
        return contained(work, ("tune", asker.recipe.path, *(f"{name}={text}" for name, text in values.items())))
    except HeunError as error:
        return failed(error)


def died(values: Mapping[str, str], how: jobs.Died) -> Answer:
    """What stands for a variant whose process died."""
    if how.is_time_up:
        return Answer(code=TIME_LIMIT)
    return Answer(code=WORKER_DIED, reason=f"the process that solved it was {how.how}, twice")


def outcome_of(found: Answer) -> TrialOutcome:
    """An answer as the search takes it."""
    readings = tuple(Reading(one.value, one.error, one.at, one.word) for one in found.measures)
    return TrialOutcome(readings, found.code, found.reason, found.warnings)
