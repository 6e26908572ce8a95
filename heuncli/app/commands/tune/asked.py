"""What is to be tuned, from the words of the command line: each checked against the scene before anything is solved."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from itertools import chain

from heuncli.analyses.tune.results import Constraint, Goal, TunedVariable, TuneTask
from heuncli.analyses.variants.asking import Asker
from heuncli.analyses.variants.axes import INTERVAL_HINT, AxisError, Interval, interval_of
from heuncli.analyses.variants.conditions import MeasureCondition, condition_of, in_si
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.solving import spec_among
from heuncli.app.commands.tune.request import TuneRequest
from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.units import parse_unit
from heuncli.output.snapshots import measure
from heuncli.scene.file_format.models import Spec
from heuncli.study.ask.measure import MeasureRequest
from heuncli.study.quantities.stated import unit_of

FORM = "expected MEASURE < VALUE"
HINT = "such as 'max abs sections.web.M2 < 40 N*m'"
EACH = 200  # evaluations by default: for each variable, and once more
MOST_EVALUATIONS = 1_000_000


class AskedTuning(NamedTuple):
    """What is asked for, as far as the words alone tell."""

    path: str
    intervals: tuple[Interval, ...]
    goal: str
    greatest: bool
    conditions: tuple[MeasureCondition, ...]

    @property
    def measures(self) -> tuple[MeasureRequest, ...]:
        """Those of goal and constraints. Raises UsageError."""
        return tuple(measure.parse_all([self.goal, *(one.measure for one in self.conditions)]))


def asked_by(request: TuneRequest) -> AskedTuning:
    """What the words say. Raises UsageError, AxisError."""
    path, intervals = spec_and_intervals(request.words)
    goals = [(text, greatest) for text, greatest in ((request.minimise, False), (request.maximise, True)) if text]
    if len(goals) != 1:
        message = "both --minimise and --maximise are given" if goals else "what is to be tuned is not said"
        hint = "--minimise WHAT or --maximise WHAT, such as --minimise 'max foundation.force'"
        raise UsageError(Problem("bad-option", f"tune: {message}", hint=hint))
    ((goal, greatest),) = goals
    conditions = tuple(_constraint(text) for text in request.subject_to)
    return AskedTuning(path, tuple(intervals), goal, greatest, conditions)


def spec_and_intervals(words: Sequence[str]) -> tuple[str, list[Interval]]:
    """The spec's file, and what is varied. Raises UsageError, AxisError."""
    path, given = spec_among(words, "tune", "heun tune SPEC NAME=LOW:HIGH --minimise WHAT")
    intervals = [interval_of(word) for word in given]
    names = [interval.name for interval in intervals]
    if not names:
        raise UsageError(Problem("bad-option", "tune: nothing is varied", hint=INTERVAL_HINT))
    for name in names:
        if names.count(name) > 1:
            raise AxisError(name, "is varied twice", "one interval a parameter")
    return path, intervals


def _constraint(text: str) -> MeasureCondition:
    condition = condition_of(text, FORM, HINT)
    if condition.sign == "=":
        raise AxisError(text, "a constraint has < or >: no two numbers are equal to the last bit", HINT)
    return condition


def task_of(request: TuneRequest, asked: AskedTuning, asker: Asker) -> TuneTask:
    """The task, checked against the scene. Raises UsageError, AxisError, SpecError."""
    spec, measures = asker.spec, asker.recipe.measures
    goal, *others = measures
    fitting = [partial(asker.scenes, interval) for interval in asked.intervals]
    found = measure.known(measures, spec, fitting, "tune")
    scenes = [spec, *chain.from_iterable(found)]
    constraints = []
    for condition, one in zip(asked.conditions, others, strict=True):
        unit = unit_of(one.path, spec)
        sign = condition.sign
        assert sign != "="
        constraints.append(Constraint(condition.measure, sign, in_si(condition, unit, scenes, HINT), unit))
    return TuneTask(
        variables=tuple(variable_of(interval, spec) for interval in asked.intervals),
        goal=Goal(asked.goal, unit_of(goal.path, spec), asked.greatest),
        constraints=tuple(constraints),
        most=most(request, len(asked.intervals)),
        precision=precision(request),
        seed=seed(request),
    )


def variable_of(interval: Interval, spec: Spec) -> TunedVariable:
    """A variable with its value in the spec, if it is a parameter."""
    own = spec.parameters.get(interval.name)
    if own is not None and interval.unit:
        own = own / parse_unit(interval.unit)[0]
    return TunedVariable(interval.name, interval.low, interval.high, interval.unit, own)


def most(request: TuneRequest, variables: int) -> int:
    """How many variants may be solved. Raises UsageError."""
    asked = request.evaluations
    if asked is None:
        return EACH * (variables + 1)
    if not 1 <= asked <= MOST_EVALUATIONS:
        message = f"--evaluations {asked}: expected 1 to {MOST_EVALUATIONS:,}"
        raise UsageError(Problem("bad-option", message, hint="such as --evaluations 400"))
    return asked


def precision(request: TuneRequest) -> float:
    """The share below which no gain is looked for. Raises UsageError."""
    asked = request.precision
    if asked is None:
        return TuneTask.precision
    if not (math.isfinite(asked) and 0.0 < asked <= 0.1):
        message = f"--precision {asked:g}: expected more than 0, and 0.1 at most"
        raise UsageError(Problem("bad-option", message, hint="such as --precision 1e-6"))
    return asked


def seed(request: TuneRequest) -> int:
    """What draws are made by. Raises UsageError."""
    asked = request.seed or 0
    if asked < 0:
        raise UsageError(Problem("bad-option", f"--seed {asked}: expected 0 or more", hint="such as --seed 1"))
    return asked
