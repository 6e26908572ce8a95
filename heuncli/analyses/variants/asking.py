"""One variant asked for its measures: each a number with its instant and its stated error, or why there is none."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from typing import Literal

import numpy as np

from heuncli.analyses.variants.axes import Interval
from heuncli.analyses.variants.prepared import Variants
from heuncli.base.errors import HeunError, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results_schema import BLOWS, EVENTS
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.named_files import FilesAtHand, NamedFile
from heuncli.study.ask.measure import MeasureRequest, NotInThisRun, Peak, lost_from, value
from heuncli.study.ask.study import Study
from heuncli.study.model.options import Options
from heuncli.study.quantities.stated import error_of

EXTREMES = ("max", "min", "abs")
LOOKED_AT = (0.5, 0.0, 1.0, 0.25, 0.75)  # places of an interval at which it is seen whether its values fit
COUNTED = (BLOWS, EVENTS)  # of which one run has more than another
CASE = "case"  # the name by which an axis varies the load case
OF_WORDS = ("set-in-si",)  # warnings of how values are written, not of the scene: told once of an axis, not of variants
Word = Literal["", "open", "unknown", "beyond", "absent"]


class Measured(NamedTuple):
    """A measure of one variant in SI; None: not known, and the word says why. error: as the run states it, absolute.

    absent: what is measured does not happen in this run, as an event or a blow.

    at: its instant [s], None where it has none; error None: the run states none.
    """

    value: float | None
    error: float | None = None
    at: float | None = None
    word: Word = ""


class Answer(NamedTuple):
    """What a variant answered: its measures, or the code and the reason why it could not be solved.

    warnings: of the run, in sentences; singular: whether its motion passes a singular pose, or an instant beside one is
    left out of its extremes: its numbers may then be others than those of variants close by.
    """

    measures: tuple[Measured, ...] = ()
    code: str = ""
    reason: str = ""
    warnings: tuple[str, ...] = ()
    singular: bool = False


class Recipe(NamedTuple):
    """All that is needed to answer variants of a spec, in this process or another.

    text: the spec as it was read; overrides: set in all variants, in the form of `--set`; case: the load case on top of
    which they go; files: those that the spec names, as they were read, None where they stand beside it (files.py).
    """

    path: str
    text: str
    measures: tuple[MeasureRequest, ...]
    options: Options
    overrides: Mapping[str, str]
    case: str | None = None
    files: Mapping[str, NamedFile] | None = None


class Asker:
    """Answers variants of a spec one after the other; which came before does not change an answer."""

    def __init__(self, recipe: Recipe) -> None:
        """Read the spec and set it up once. Raises SpecError."""
        self.recipe = recipe
        self._files = None if recipe.files is None else FilesAtHand(recipe.path, recipe.files)
        self._prepared: dict[str | None, Variants] = {}
        self.spec = self.variants(recipe.case).spec

    def variants(self, case: str | None) -> Variants:
        """The variants of one load case. Raises SpecError."""
        found = self._prepared.get(case)
        if found is None:
            recipe = self.recipe
            found = Variants(
                recipe.path, recipe.text, options=recipe.options, overrides=recipe.overrides, case=case,
                measures=[asked.path for asked in recipe.measures], files=self._files,
            )  # fmt: skip
            self._prepared[case] = found
        return found

    def study(self, values: Mapping[str, str]) -> Study:
        """A variant solved; values: by name, in the form of `--set`, and the load case by its own name.

        Raises SpecError, SolveError, LimitError.
        """
        variants, given = self._with_case(values)
        return variants.solve(given)

    def load(self, values: Mapping[str, str]) -> Spec:
        """The scene of a variant. Raises SpecError."""
        variants, given = self._with_case(values)
        return variants.load(given)

    def scenes(self, interval: Interval) -> list[Spec]:
        """The scenes at some places of an interval, those that are scenes. Raises SpecError where none is."""
        specs: list[Spec] = []
        errors: list[SpecError] = []
        for place in LOOKED_AT:
            try:
                specs.append(self.load({interval.name: interval.at(place)}))
            except SpecError as error:
                errors.append(error)
        if not specs:
            raise errors[0]
        return specs

    def idle(self, names: Collection[str]) -> frozenset[str]:
        """The parameters among some names on which nothing hangs, in none of the load cases solved so far."""
        return frozenset.intersection(*(variants.idle(names) for variants in self._prepared.values()))

    def answer(self, values: Mapping[str, str]) -> Answer:
        """The measures of a variant, or why there are none."""
        try:
            return self.measured(values)
        except HeunError as error:
            return failed(error)

    def measured(self, values: Mapping[str, str]) -> Answer:
        """The measures of a variant.

        Raises what `study` does; of a measure that is no number of this scene NotOneNumber, SpecError [unknown-path].
        """
        study = self.study(values)
        measures = tuple(measured(asked, study) for asked in self.recipe.measures)
        read = (problem.message for problem in study.spec.warnings if problem.code not in OF_WORDS)
        warnings = tuple(dict.fromkeys((*read, *study.results.warnings, *study.later_warnings)))
        singular = bool(len(study.history.singular) or study.left_out or study.unknown)
        return Answer(measures, warnings=warnings, singular=singular)

    def _with_case(self, values: Mapping[str, str]) -> tuple[Variants, Mapping[str, str]]:
        case = values.get(CASE) if varies_cases(self.spec) else None
        if case is None:
            return self.variants(self.recipe.case), values
        return self.variants(case), {name: text for name, text in values.items() if name != CASE}


def failed(error: HeunError) -> Answer:
    """The answer of a variant that could not be solved."""
    problem = error.problems[0]
    return Answer(code=problem.code, reason=problem.message)


def varies_cases(spec: Spec) -> bool:
    """Whether `case` is the load case: a spec may have a parameter of that name."""
    return bool(spec.cases) and CASE not in spec.parameters


def measured(asked: MeasureRequest, study: Study) -> Measured:
    """A measure of a solved variant. Raises NotOneNumber, SpecError [unknown-path]."""
    try:
        peak, horizon = value(asked, study), lost_from(asked, study)
    except NotInThisRun:
        return Measured(None, word="absent")
    except SpecError:
        if asked.path.split(".")[0] not in COUNTED:
            raise
        return Measured(None, word="absent")
    if horizon is not None:
        return Measured(None, word="beyond")
    if math.isnan(peak.value):
        return Measured(None, at=peak.at, word="unknown" if peak.at in study.unknown else "open")
    if asked.how in EXTREMES and beside_singular(peak, study):
        return Measured(None, at=peak.at, word="unknown")
    return Measured(peak.value, error_of(asked, peak, study), peak.at)


def beside_singular(peak: Peak, study: Study) -> bool:
    """Whether an extreme stands beside instants at which rounding leaves nothing known: there it may go on.

    Its search leaves these instants out, with what lies between them and the next instants that it looks at.
    """
    if peak.at is None or not study.left_out:
        return False
    times = study.search_times
    place = int(np.searchsorted(times, peak.at))
    low, high = times[max(place - 2, 0)], times[min(place + 1, len(times) - 1)]
    return any(low <= at <= high for at in study.left_out)
