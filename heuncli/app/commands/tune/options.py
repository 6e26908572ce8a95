"""The options of `heun tune`: what is to be tuned, parsed and checked against the scene before anything is solved."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from itertools import chain
from typing import Annotated

from heuncli.analyses.tune.results import TuneGoal, TuneTask
from heuncli.analyses.variants.conditions import WrittenCondition, parse_condition, resolve_condition
from heuncli.analyses.variants.evaluation import VariantEvaluator
from heuncli.analyses.variants.parameters import INTERVAL_HINT, AxisError, DesignVariable, parse_interval
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.options import CASE, NO_REDUCE, OUTPUT, QUIET, SET, TOLERANCE, UNITS, Option, make_format_option
from heuncli.app.cli.solving import split_spec_and_assignments
from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.units import parse_unit
from heuncli.output.tables import measure
from heuncli.scene.file_format.models import Spec
from heuncli.study.queries.measure import MeasureRequest
from heuncli.study.queries.measure_uncertainty import find_unit

FORMATS = ("table", "json")


class TuneRequest(NamedTuple):
    """The options and arguments of `heun tune`."""

    words: Annotated[
        tuple[str, ...],
        Option(
            (),
            "YAML file of the spec, and the varied parameters with their bounds: m=0:3kg, r=20:60mm.",
            "SPEC NAME=LOW:HIGH...",
            completes="spec",
        ),
    ]
    minimise: Annotated[
        str | None,
        Option(("--minimise",), "Result to minimise: 'max foundation.force'.", "WHAT", completes="measure"),
    ] = None
    maximise: Annotated[
        str | None,
        Option(("--maximise",), "Result to maximise: 'min joints.main.axial'.", "WHAT", completes="measure"),
    ] = None
    subject_to: Annotated[
        tuple[str, ...],
        Option(
            ("--subject-to",),
            "Limit on a result: 'max abs sections.web.M2 < 40 N*m'. May be repeated.",
            "CONDITION",
            completes="measure",
        ),
    ] = ()
    evaluations: Annotated[
        int | None,
        Option(("--evaluations",), "Maximum number of variants. Default: 200 plus 200 per variable.", "N"),
    ] = None
    precision: Annotated[
        float | None,
        Option(
            ("--precision",),
            "Smallest improvement to search for, relative to the range of the result. Default: 1e-6.",
            "FRACTION",
        ),
    ] = None
    seed: Annotated[
        int | None, Option(("--seed",), "Random seed; the same seed gives the same variants. Default: 0.", "N")
    ] = None
    format: Annotated[
        str | None,
        make_format_option(FORMATS),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    history: Annotated[str | None, Option(("--history",), "Also write all variants in order: history.csv.", "FILE")] = (
        None
    )
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    tolerance: Annotated[float | None, TOLERANCE] = None
    no_reduce: Annotated[bool, NO_REDUCE] = False
    units: Annotated[str | None, UNITS] = None
    jobs: Annotated[
        int | None, Option(("--jobs", "-j"), "Number of variants solved in parallel, where they are independent.", "N")
    ] = None
    strict: Annotated[
        bool, Option(("--strict",), "Exit with 1 if the search did not converge, or no variant meets all limits.")
    ] = False
    time_limit: Annotated[
        float | None,
        Option(("--time-limit",), "Stop the search after this time and report the best result so far.", "SECONDS"),
    ] = None
    quiet: Annotated[bool, QUIET] = False


FORM = "expected MEASURE < VALUE"
HINT = "for example 'max abs sections.web.M2 < 40 N*m'"
EVALUATIONS_PER_VARIABLE = 200  # default evaluations: for each variable, and once in addition
MAX_EVALUATIONS = 1_000_000


class TuningOptions(NamedTuple):
    """The options of a tuning, as far as the command line alone gives them."""

    path: str
    variables: tuple[DesignVariable, ...]
    goal: str
    greatest: bool
    conditions: tuple[WrittenCondition, ...]

    @property
    def measures(self) -> tuple[MeasureRequest, ...]:
        """The measures of the goal and of the constraints. Raises UsageError."""
        return tuple(measure.parse_measures([self.goal, *(condition.measure for condition in self.conditions)]))


def parse_options(request: TuneRequest) -> TuningOptions:
    """Parse the variables, the goal and the limits. Raises UsageError, AxisError."""
    path, variables = parse_words(request.words)
    goals = [(text, greatest) for text, greatest in ((request.minimise, False), (request.maximise, True)) if text]
    if len(goals) != 1:
        message = "both --minimise and --maximise are given" if goals else "no goal is given"
        hint = "--minimise WHAT or --maximise WHAT, such as --minimise 'max foundation.force'"
        raise UsageError(Problem("bad-option", f"tune: {message}", hint=hint))
    ((goal, greatest),) = goals
    conditions = tuple(_parse_constraint(text) for text in request.subject_to)
    return TuningOptions(path, tuple(variables), goal, greatest, conditions)


def parse_words(words: Sequence[str]) -> tuple[str, list[DesignVariable]]:
    """Split the arguments into the spec's file and the variables. Raises UsageError, AxisError."""
    path, assignments = split_spec_and_assignments(words, "tune", "heun tune SPEC NAME=LOW:HIGH --minimise WHAT")
    variables = [parse_interval(word) for word in assignments]
    names = [variable.name for variable in variables]
    if not names:
        raise UsageError(Problem("bad-option", "tune: no parameter to vary is given", hint=INTERVAL_HINT))
    for name in names:
        if names.count(name) > 1:
            raise AxisError(name, "is varied twice", "give one interval per parameter")
    return path, variables


def _parse_constraint(text: str) -> WrittenCondition:
    """Parse a limit of --subject-to. Raises AxisError."""
    condition = parse_condition(text, FORM, HINT)
    if condition.relation == "=":
        raise AxisError(text, "a limit has < or >: = cannot be met exactly", HINT)
    return condition


def make_task(request: TuneRequest, options: TuningOptions, evaluator: VariantEvaluator) -> TuneTask:
    """Make the task of the search, checked against the scene. Raises UsageError, AxisError, SpecError."""
    spec, measures = evaluator.spec, evaluator.recipe.measures
    goal, *others = measures
    scene_makers = [partial(evaluator.load_samples, variable) for variable in options.variables]
    scene_lists = measure.check_with_others(measures, spec, scene_makers, "tune")
    scenes = [spec, *chain.from_iterable(scene_lists)]
    constraints = [
        resolve_condition(condition, find_unit(measure_request.path, spec), scenes, HINT)
        for condition, measure_request in zip(options.conditions, others, strict=True)
    ]
    return TuneTask(
        variables=tuple(add_spec_value(variable, spec) for variable in options.variables),
        goal=TuneGoal(options.goal, find_unit(goal.path, spec), options.greatest),
        constraints=tuple(constraints),
        max_variants=parse_max_evaluations(request, len(options.variables)),
        precision=parse_precision(request),
        seed=parse_seed(request),
    )


def add_spec_value(variable: DesignVariable, spec: Spec) -> DesignVariable:
    """Add the value that the spec gives a variable, if the variable is a parameter."""
    value = spec.parameters.get(variable.name)
    return variable if value is None else variable._replace(spec_value=value / parse_unit(variable.unit or "1")[0])


def parse_max_evaluations(request: TuneRequest, variables: int) -> int:
    """Return how many variants may be solved. Raises UsageError."""
    requested = request.evaluations
    if requested is None:
        return EVALUATIONS_PER_VARIABLE * (variables + 1)
    if not 1 <= requested <= MAX_EVALUATIONS:
        message = f"--evaluations {requested}: expected 1 to {MAX_EVALUATIONS:,}"
        raise UsageError(Problem("bad-option", message, hint="for example --evaluations 400"))
    return requested


def parse_precision(request: TuneRequest) -> float:
    """Return the relative gain below which the search stops. Raises UsageError."""
    requested = request.precision
    if requested is None:
        return TuneTask.precision
    if not (math.isfinite(requested) and 0.0 < requested <= 0.1):
        message = f"--precision {requested:g}: expected more than 0 and at most 0.1"
        raise UsageError(Problem("bad-option", message, hint="for example --precision 1e-6"))
    return requested


def parse_seed(request: TuneRequest) -> int:
    """Return the seed of the random draws. Raises UsageError."""
    requested = request.seed or 0
    if requested < 0:
        raise UsageError(Problem("bad-option", f"--seed {requested}: expected 0 or more", hint="for example --seed 1"))
    return requested
