"""Evaluate the measures of the variants of a spec: each with its uncertainty, or with the reason why it has none.

A recipe holds all that a process needs to evaluate variants; VariantEvaluator solves them, one solver for each load
case. The order of the variants does not change a result.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping

import numpy as np

from heuncli.analyses.variants.measures import MeasureValue, VariantResult, make_failed_result
from heuncli.analyses.variants.parameters import CASE, DesignVariable, Values, format_value
from heuncli.analyses.variants.solver import VariantSolver
from heuncli.base.errors import HeunError, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results_schema import EVENTS, IMPULSES
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.named_files import NamedFile, PreloadedFiles
from heuncli.study.model.options import Options
from heuncli.study.queries.measure import MeasureRequest, NotInThisRun, Peak, find_exceeded_horizon, measure_value
from heuncli.study.queries.measure_uncertainty import measure_uncertainty
from heuncli.study.queries.study import Study

EXTREME_REDUCERS = ("max", "min", "abs")
SAMPLE_PLACES = (0.5, 0.0, 1.0, 0.25, 0.75)  # places of an interval at which its values are checked
EVENT_BLOCKS = (IMPULSES, EVENTS)  # their number differs from run to run
SPELLING_CODES = ("set-in-si",)  # warnings about how values are written: shown once for an axis, not for variants


class Recipe(NamedTuple):
    """All that is needed to evaluate variants of a spec, in this process or another.

    text: the spec as it was read
    overrides: set in all variants
    case: the load case that they are applied to
    files: the files named in the spec, as they were read; None: they are read from the spec's folder
    """

    path: str
    text: str
    measures: tuple[MeasureRequest, ...]
    options: Options
    overrides: Values
    case: str | None = None
    files: Mapping[str, NamedFile] | None = None


class VariantEvaluator:
    """Evaluates variants of a spec one after the other; their order does not change a result."""

    def __init__(self, recipe: Recipe) -> None:
        """Read the spec and set it up once. Raises SpecError."""
        self.recipe = recipe
        self._files = None if recipe.files is None else PreloadedFiles(recipe.path, recipe.files)
        self._prepared: dict[str | None, VariantSolver] = {}
        self.spec = self.find_solver(recipe.case).spec

    def find_solver(self, case: str | None) -> VariantSolver:
        """Return the solver for one load case, from the cache if possible. Raises SpecError."""
        solver = self._prepared.get(case)
        if solver is None:
            recipe = self.recipe
            solver = VariantSolver(
                recipe.path, recipe.text, options=recipe.options, overrides=recipe.overrides, case=case,
                measures=[request.path for request in recipe.measures], files=self._files,
            )  # fmt: skip
            self._prepared[case] = solver
        return solver

    def solve(self, values: Values) -> Study:
        """Solve a variant; values: with the load case under its own name.

        Raises SpecError, SolveError, LimitError.
        """
        variants, overrides = self._split_case(values)
        return variants.solve(overrides)

    def load(self, values: Values) -> Spec:
        """Load the scene of a variant. Raises SpecError."""
        variants, overrides = self._split_case(values)
        return variants.load(overrides)

    def load_samples(self, variable: DesignVariable) -> list[Spec]:
        """Load the scenes at some places between the bounds of a variable, without those that are invalid.

        Raises SpecError if all are invalid.
        """
        specs: list[Spec] = []
        errors: list[SpecError] = []
        for place in SAMPLE_PLACES:
            try:
                specs.append(self.load({variable.name: variable.to_value(place)}))
            except SpecError as error:
                errors.append(error)
        if not specs:
            raise errors[0]
        return specs

    def find_unused_parameters(self, names: Collection[str]) -> frozenset[str]:
        """Return the parameters among some names that nothing depends on, in none of the load cases solved so far."""
        return frozenset.intersection(*(variants.find_unused_parameters(names) for variants in self._prepared.values()))

    def answer(self, values: Values) -> VariantResult:
        """Evaluate the measures of a variant, or return the reason why there are none."""
        try:
            return self.measure(values)
        except HeunError as error:
            return make_failed_result(error)

    def measure(self, values: Values) -> VariantResult:
        """Evaluate the measures of a variant; unlike `answer`, which turns errors into a result, it raises them.

        Raises what `solve` does; for a measure that is no number of this scene NotOneNumber, SpecError [unknown-path].
        """
        study = self.solve(values)
        measures = tuple(measure_study(request, study) for request in self.recipe.measures)
        spec_warnings = (problem.message for problem in study.spec.warnings if problem.code not in SPELLING_CODES)
        warnings = tuple(dict.fromkeys((*spec_warnings, *study.results.warnings, *study.later_warnings)))
        singular = bool(len(study.history.singular) or study.left_out or study.unknown)
        return VariantResult(measures, warnings=warnings, singular=singular)

    def _split_case(self, values: Values) -> tuple[VariantSolver, Values]:
        case = values.get(CASE) if varies_cases(self.spec) else None
        if case is None:
            return self.find_solver(self.recipe.case), values
        return self.find_solver(format_value(case)), {name: value for name, value in values.items() if name != CASE}


def varies_cases(spec: Spec) -> bool:
    """Return whether `case` means the load case: a spec may have a parameter of that name."""
    return bool(spec.cases) and CASE not in spec.parameters


def measure_study(request: MeasureRequest, study: Study) -> MeasureValue:
    """Evaluate a measure of a solved variant. Raises NotOneNumber, SpecError [unknown-path]."""
    try:
        peak, horizon = measure_value(request, study), find_exceeded_horizon(request, study)
    except NotInThisRun:
        return MeasureValue(None, word="absent")
    except SpecError:
        if request.path.split(".")[0] not in EVENT_BLOCKS:
            raise
        return MeasureValue(None, word="absent")
    if horizon is not None:
        return MeasureValue(None, word="beyond")
    if math.isnan(peak.value):
        return MeasureValue(None, time=peak.time, word="unknown" if peak.time in study.unknown else "open")
    if request.how in EXTREME_REDUCERS and is_near_left_out(peak, study):
        return MeasureValue(None, time=peak.time, word="unknown")
    return MeasureValue(peak.value, measure_uncertainty(study, request.path, request.how, peak.value), peak.time)


def is_near_left_out(peak: Peak, study: Study) -> bool:
    """Return whether an extreme is next to instants that its search left out, where it may be exceeded.

    The search leaves out instants at which rounding decides numbers, with the intervals to their neighbours.
    """
    if peak.time is None or not study.left_out:
        return False
    times = study.search_times
    index = int(np.searchsorted(times, peak.time))
    low, high = times[max(index - 2, 0)], times[min(index + 1, len(times) - 1)]
    return any(low <= time <= high for time in study.left_out)
