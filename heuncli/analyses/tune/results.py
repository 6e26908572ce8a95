"""What a tuning is of, what was tried, and what came of it.

Variables are told in their own units and looked for as places in [0, 1], 0 at the lower bound; measures are SI.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record

DIGITS = 9  # of a variable, beside the width of its interval: a thousandth of what the search tells apart
Ending = Literal["converged", "evaluations", "time", "infeasible"]


class TunedVariable(NamedTuple):
    """A parameter that may lie between two bounds, in its unit; own: its value in the spec, None where that is none."""

    name: str
    low: float
    high: float
    unit: str
    own: float | None = None

    def value(self, place: float) -> float:
        """The value at a place of [0, 1], in as many digits as make a difference: what is typed is what was solved."""
        if place <= 0.0:
            return self.low
        if place >= 1.0:
            return self.high
        width = self.high - self.low
        decimals = DIGITS - math.floor(math.log10(width))
        return min(max(round(self.low + place * width, decimals), self.low), self.high)

    def text(self, place: float) -> str:
        """The value at a place, as --set takes it."""
        value = repr(self.value(place))
        return f"{value} {self.unit}" if self.unit else value

    @property
    def own_place(self) -> float | None:
        """Where the spec's own value lies; None outside of the bounds."""
        if self.own is None or not self.low <= self.own <= self.high:
            return None
        return (self.own - self.low) / (self.high - self.low)


class Goal(NamedTuple):
    """What is to be least, or greatest: a measure in words, and its SI unit (empty: none)."""

    measure: str
    unit: str
    greatest: bool

    @property
    def sign(self) -> float:
        """By which the measure is to be least."""
        return -1.0 if self.greatest else 1.0


class Constraint(NamedTuple):
    """A measure in words that is to lie below a limit, or above it; SI."""

    measure: str
    sign: Literal["<", ">", "<=", ">="]
    limit: float
    unit: str

    def excess(self, value: float) -> float:
        """By how much the limit is passed; negative: how much is left."""
        return value - self.limit if self.sign in ("<", "<=") else self.limit - value

    def met(self, value: float) -> bool:
        """Whether it holds."""
        excess = self.excess(value)
        return excess < 0.0 or (excess == 0.0 and len(self.sign) == 2)


@record
class TuneTask:
    """What is to be tuned: variables, the goal, constraints.

    most: how many variants may be solved; precision: below which share of what the goal ranges over nothing more is
    looked for; seed: of what is drawn.
    """

    variables: tuple[TunedVariable, ...]
    goal: Goal
    constraints: tuple[Constraint, ...] = ()
    most: int = 400
    precision: float = 1e-6
    seed: int = 0


class Reading(NamedTuple):
    """A measure of a variant: its value with its stated error and its instant; None: not known, the word says why."""

    value: float | None
    error: float | None = None
    at: float | None = None
    word: str = ""


class TrialOutcome(NamedTuple):
    """What a variant gave: readings of goal and constraints, or the code and the reason why there are none.

    warnings: of the run, in sentences.
    """

    readings: tuple[Reading, ...] = ()
    code: str = ""
    reason: str = ""
    warnings: tuple[str, ...] = ()


class Trial(NamedTuple):
    """A variant that was tried: where, in which phase of the search, and what it gave."""

    number: int
    phase: str
    place: tuple[float, ...]
    outcome: TrialOutcome

    @property
    def solved(self) -> bool:
        """Whether all that is measured is known."""
        return bool(self.outcome.readings) and all(one.value is not None for one in self.outcome.readings)

    @property
    def failure(self) -> tuple[str, str]:
        """The code or the word for what is not known, and a sentence."""
        outcome = self.outcome
        word = next((one.word for one in outcome.readings if one.value is None), "")
        return (outcome.code, outcome.reason) if outcome.code else (word, UNKNOWN.get(word, word))

    @property
    def goal(self) -> float:
        """The value of the goal, of what is solved."""
        value = self.outcome.readings[0].value
        assert value is not None
        return value

    @property
    def kept_to(self) -> tuple[float, ...]:
        """The values of the constraints, of what is solved."""
        return tuple(one.value for one in self.outcome.readings[1:] if one.value is not None)


UNKNOWN = {
    "absent": "what is measured does not happen",
    "open": "a measure is open: redundant supports leave it so",
    "beyond": "a measure lies beyond the horizon",
    "unknown": "a measure is not known: the pose is singular",
}


class Move(NamedTuple):
    """How far a variable may move to one side before the goal is worse by some amount.

    by: in its unit; until: what ends the way, `worse`, `bound`, `jump`, a constraint's words or a code; or `less` and
    `more`, where it is less or more than that.
    """

    by: float
    until: str


class Leeway(NamedTuple):
    """How far one variable may move, down and up: until the goal is worse by the floor, and by a hundredth of it."""

    of_floor: tuple[Move | None, Move | None] = (None, None)
    of_hundredth: tuple[Move | None, Move | None] = (None, None)


@record
class TuneResults:
    """What came of a tuning.

    own: the scene as it is; best: the best that keeps all constraints, or, `feasible` being false, the one that passes
    them least; None where nothing could be solved. gain: what the last two restarts improved the goal by; floor: below
    which nothing was looked for. freedoms: a variable each, empty where there was no evaluation left. active: which
    constraints hold the goal back; scales: of what is left of each constraint, as it ranges over the box.
    """

    task: TuneTask
    own: TrialOutcome
    history: tuple[Trial, ...]
    best: Trial | None
    feasible: bool
    ending: Ending
    gain: float | None
    floor: float
    freedoms: tuple[Leeway, ...]
    active: tuple[bool, ...]
    scales: tuple[float, ...]
    failures: Mapping[str, int]

    @property
    def texts(self) -> dict[str, str]:
        """The values of the best variant, as --set takes them."""
        assert self.best is not None
        return texts_at(self.task.variables, self.best.place)

    @property
    def own_is_better(self) -> bool:
        """Whether the scene as it is keeps all constraints, and is better than the best by more than the floor."""
        assert self.best is not None
        own = Trial(0, "", (), self.own)
        if not own.solved or not all(map(Constraint.met, self.task.constraints, own.kept_to)):
            return False
        return not self.feasible or self.task.goal.sign * (self.best.goal - own.goal) > self.floor

    @property
    def nearest_unmet(self) -> int | None:
        """Which of the constraints that the best does not keep is nearest to being met, by its scale."""
        assert self.best is not None
        cells = zip(self.task.constraints, self.best.kept_to, self.scales, strict=True)
        passed = {i: one.excess(value) / scale for i, (one, value, scale) in enumerate(cells) if not one.met(value)}
        return min(passed, key=passed.__getitem__, default=None)

    def at_bound(self, which: int) -> str:
        """Which of its bounds a variable of the best variant lies at: `low`, `high` or empty."""
        assert self.best is not None
        place = self.best.place[which]
        return "low" if place <= 0.0 else "high" if place >= 1.0 else ""


def texts_at(variables: tuple[TunedVariable, ...], place: tuple[float, ...]) -> dict[str, str]:
    """The values at a place, as --set takes them."""
    return {variable.name: variable.text(x) for variable, x in zip(variables, place, strict=True)}
