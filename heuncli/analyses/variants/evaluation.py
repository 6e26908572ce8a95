"""Evaluate the measures of the variants of a spec; what depends on no varied value is solved once.

    solver = VariantSolver("specs/slider_crank.yaml", options=Options(requested_reports=frozenset({"joints"})))
    study = solver.solve({"w": "1500 rpm", "r": NumberWithUnit(60.0, "mm")})

A cached stage has the very same bits that the variant would compute: this is decided by what each entry, rule and stage
has looked up (scene/file_format/incremental_loader.py). So a variant equals the result of `heun run --set` to the bit,
whatever was solved before.

The value that a parameter or a dotted key has in the spec itself is read as it is written: the number and the unit.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from heuncli.analyses.variants.measures import MeasureValue, VariantResult, make_failed_result
from heuncli.analyses.variants.parameters import CASE, AxisError, DesignVariable, format_value
from heuncli.base.errors import Finding, HeunError, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.base.spelling import suggest
from heuncli.base.units import parse_unit
from heuncli.multibody.stage_cache import RecordingStages, ReusingStages
from heuncli.results.results_schema import EVENTS, IMPULSES
from heuncli.scene.file_format.incremental_loader import SpecVariants
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.named_files import NamedFile, NamedFiles, PreloadedFiles
from heuncli.scene.file_format.names import as_mapping
from heuncli.scene.file_format.parameters import (
    apply_settings,
    get_value,
    list_case_settings,
    parse_path,
    parse_settings,
)
from heuncli.scene.file_format.quantity import NumberWithUnit, ParameterValue, Scope, match_quantity, read_number
from heuncli.scene.file_format.source import read_source
from heuncli.study.model.options import Options, apply_options
from heuncli.study.model.selection import select_paths
from heuncli.study.queries.measure import MeasureRequest, NotInThisRun, Peak, find_exceeded_horizon, measure_value
from heuncli.study.queries.measure_uncertainty import measure_uncertainty
from heuncli.study.queries.study import Study
from heuncli.study.workflow import set_up_requested, solve


class VariantSolver:
    """A spec that was read, checked and resolved once, to be solved with other values."""

    def __init__(
        self,
        path: str | Path,
        text: str | None = None,
        *,
        options: Options | None = None,
        overrides: Mapping[str, ParameterValue] | None = None,
        case: str | None = None,
        measures: Sequence[str] = (),
        files: NamedFiles | None = None,
    ) -> None:
        """Read the file of a spec, or its text, as `load` does; nothing of it is read again.

        options: with which all variants are solved
        overrides: set in all of them
        case: the load case that these values are applied to
        measures: paths into the results; only what they need is solved
        files: the files that the spec names; None: they are read from the spec's folder

        Raises SpecError.
        """
        self.options = options or Options()
        self._specs = SpecVariants(path, text, overrides, checking=False, case=case, files=files)
        if measures:
            selection = select_paths(measures, self.spec)
            self.options = replace(self.options, requested_reports=selection.reports, entries=selection.entries)
        first = RecordingStages()
        with suppress(HeunError):  # a scene that cannot be set up leaves a partly filled or empty cache
            set_up_requested(apply_options(self._specs.spec, self.options), self.options, first)
        self._stages = ReusingStages(first)

    @property
    def spec(self) -> Spec:
        """The scene as it was read, with the values set in all variants."""
        return self._specs.spec

    def find_unused_parameters(self, names: Collection[str]) -> frozenset[str]:
        """Return the parameters among some names that nothing of the scene depends on."""
        return self._specs.unused_parameters(names)

    def load(self, values: Mapping[str, ParameterValue]) -> Spec:
        """Load the scene with other values, by name. Raises SpecError."""
        return self._specs.load(values)

    def solve(self, values: Mapping[str, ParameterValue]) -> Study:
        """Solve the scene with other values, by name: numbers with their units, or texts in the form of `--set`.

        Raises what `load` and `solve` raise: SpecError, SolveError, LimitError; the next variant is not affected.
        """
        return solve(self.load(values), self.options, self._stages)


EXTREME_REDUCERS = ("max", "min", "abs")
SAMPLE_PLACES = (0.5, 0.0, 1.0, 0.25, 0.75)  # places of an interval at which its values are checked
EVENT_BLOCKS = (IMPULSES, EVENTS)  # their number differs from run to run
SPELLING_CODES = ("set-in-si",)  # warnings about how values are written: shown once for an axis, not for variants
NUMBERS = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
NUMBER_LISTS = re.compile(r"#(?:(?:, | to )#)+(?: \.\.\.)?")
Values = Mapping[str, ParameterValue]  # of a variant: what is set in it, by name


class Recipe(NamedTuple):
    """All that is needed to evaluate variants of a spec, in this process or another.

    text: the spec as it was read
    overrides: set in all variants
    case: the load case that they are applied to
    files: the files named in the spec, as they were read; None: they are read from the spec's folder (files.py)
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
        """Load the scenes at some places between the bounds of a variable, without those that are invalid. Raises
        SpecError if all are.
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


KnownResults = dict[tuple[tuple[str, ParameterValue], ...], VariantResult]  # by the values of the variants


class CachedEvaluator:
    """The results of variants by their values: no variant is solved twice."""

    def __init__(
        self, answer: Callable[[Values], VariantResult], report_run: Callable[[int], None] = lambda runs: None
    ) -> None:
        """answer: evaluates a variant
        report_run: called before a variant is solved and after others are added, with the number of those known
        """
        self._answer, self._report_run = answer, report_run
        self.known: KnownResults = {}

    @property
    def runs(self) -> int:
        """How many variants were evaluated, including those that could not be solved."""
        return len(self.known)

    def evaluate(self, values: Values) -> VariantResult:
        """Return the result of a variant."""
        key = tuple(sorted(values.items()))
        if key not in self.known:
            self._report_run(self.runs)
            self.known[key] = self._answer(values)
        return self.known[key]

    def add_known(self, results: KnownResults) -> None:
        """Add results of variants that were evaluated elsewhere."""
        self.known.update(results)
        self._report_run(self.runs)

    def count_warnings(self) -> dict[str, int]:
        """Return the first warning of each kind, and how many variants gave one."""
        warnings_by_kind: dict[str, tuple[str, int]] = {}
        for result in self.known.values():
            for kind, text in {strip_numbers(text): text for text in result.warnings}.items():
                first, so_far = warnings_by_kind.get(kind, (text, 0))
                warnings_by_kind[kind] = first, so_far + 1
        return dict(warnings_by_kind.values())


def strip_numbers(text: str) -> str:
    """Return a warning with its numbers replaced by `#`: they differ from variant to variant."""
    return NUMBER_LISTS.sub("#", NUMBERS.sub("#", text))


def varies_cases(spec: Spec) -> bool:
    """Whether `case` means the load case: a spec may have a parameter of that name."""
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
    """Whether an extreme is next to instants that its search left out because rounding decides them: it may be exceeded
    there.

    The search leaves these instants out together with the intervals to their neighbours.
    """
    if peak.time is None or not study.left_out:
        return False
    times = study.search_times
    index = int(np.searchsorted(times, peak.time))
    low, high = times[max(index - 2, 0)], times[min(index + 1, len(times) - 1)]
    return any(low <= time <= high for time in study.left_out)


EXAMPLES = "for example L, or bodies.crank.mass"


class SpecNumber(NamedTuple):
    """A number by its name, in its unit (empty: SI, or none); size: of the unit in SI."""

    name: str
    value: float
    unit: str
    size: float

    def make_value(self, number: float) -> NumberWithUnit:
        """Return another number as its value."""
        return NumberWithUnit(float(number), self.unit)


class SpecNumbers:
    """The numbers of a spec as a recipe gives them: with its load case, and the values set in all variants."""

    def __init__(self, recipe: Recipe, spec: Spec) -> None:
        source = read_source(recipe.path, recipe.text)
        settings = [] if recipe.case is None else list_case_settings(recipe.case, source)
        settings += parse_settings(recipe.overrides)[0]
        self._data: dict[str, Any] = apply_settings(source.data, settings)[0]
        self._spec = spec

    def find_number(self, name: str) -> SpecNumber:
        """Return the number under a name; of an expression its value in SI. Raises AxisError."""
        path = parse_path(name, self._data)
        entry = get_value(self._data, path)
        if entry is None:
            parameter_names = [*as_mapping(self._data.get("parameters"))]
            raise AxisError(
                name, "the spec gives no number there", suggest(name, parameter_names, "parameters") or EXAMPLES
            )
        try:
            return self._parse(name, entry)
        except Finding as finding:
            raise AxisError(name, f"not a number: {finding.message}", EXAMPLES) from None

    def iter_parameters(self) -> Iterator[SpecNumber]:
        """Yield the parameters that are given as numbers, without those that are expressions of others."""
        for name, entry in as_mapping(self._data.get("parameters")).items():
            if type(entry) in (int, float) or (type(entry) is str and match_quantity(entry) is not None):
                yield self._parse(name, entry)

    def _parse(self, name: str, entry: Any) -> SpecNumber:
        value = read_number(entry, None, Scope(self._spec.parameters))
        with_unit = match_quantity(entry) if type(entry) is str else None
        if with_unit is None:
            return SpecNumber(name, value, "", 1.0)
        return SpecNumber(name, with_unit.value, with_unit.unit, parse_unit(with_unit.unit)[0])
