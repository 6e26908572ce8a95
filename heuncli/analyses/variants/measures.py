"""The measures of a variant: each is a number with its instant and stated error, or the reason why there is none.

`find`, `tune` and `sensitivity` ask for some variants again, so their results are cached by the values.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Literal

from heuncli.analyses.variants.parameters import Values
from heuncli.base.errors import HeunError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.tolerances import EPS
from heuncli.scene.file_format.quantity import ParameterValue
from heuncli.study.quantities.digits import OPEN, UNKNOWN

MissingWord = Literal["", "open", "unknown", "beyond", "absent"]
TIME_LIMIT_CODE = "time-limit"  # the code of a variant that was not solved for lack of time
WORKER_DIED = "worker-died"  # the code of a variant that ends the processes that solve it
ROUNDING = 8.0 * EPS  # smallest relative error of a measure: its sums are rounded, whatever error the run states
NUMBERS = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
NUMBER_LISTS = re.compile(r"#(?:(?:, | to )#)+(?: \.\.\.)?")


class MeasureLabel(NamedTuple):
    """A measure in the words of the request, and its SI unit (empty: none)."""

    text: str
    unit: str


class MissingKind(NamedTuple):
    """Why a measure of a solved variant has no number: a mark for cells, a sentence, and a short form for figures."""

    mark: str
    sentence: str
    short: str


MISSING_KINDS: Mapping[str, MissingKind] = MappingProxyType(
    {
        "open": MissingKind(OPEN, "open: statically indeterminate, depends on stiffness", "open"),
        "unknown": MissingKind(UNKNOWN, "not known near a singular position", "not known"),
        "beyond": MissingKind(UNKNOWN, "not reliable past the horizon", "past the horizon"),
        "absent": MissingKind("-", "does not happen in this run", "absent"),
    }
)


class Reason(NamedTuple):
    """Why there is no number: a code and a sentence; both empty if there is one."""

    code: str = ""
    text: str = ""


class MeasureValue(NamedTuple):
    """A measure of one variant in SI; value None: unknown, and the word says why.

    error: absolute, as the run states it; None where the run states none
    time: its instant [s], None where it has none
    word: absent: the event or impulse does not occur in this run
    """

    value: float | None
    error: float | None = None
    time: float | None = None
    word: MissingWord = ""


class NoisyValue(NamedTuple):
    """A measure within an error no smaller than its rounding; value None: it does not exist, `why` says why."""

    value: float | None
    error: float = 0.0
    why: Reason = Reason()


class VariantResult(NamedTuple):
    """The measures of one variant, or the code and the reason why it could not be solved.

    warnings: of the run, in sentences
    singular: whether its motion passes a singular pose, or its extremes leave out an instant close to one; then its
    numbers may differ from those of similar variants
    """

    measures: tuple[MeasureValue, ...] = ()
    code: str = ""
    reason: str = ""
    warnings: tuple[str, ...] = ()
    singular: bool = False

    @property
    def is_complete(self) -> bool:
        """Whether all measures are known."""
        return bool(self.measures) and all(reading.value is not None for reading in self.measures)

    def get_measure(self, index: int) -> MeasureValue:
        """Return a measure; it has no number if the variant could not be solved."""
        return self.measures[index] if self.measures else NO_VALUE

    def find_noisy_value(self, index: int, magnitude: float = 0.0) -> NoisyValue:
        """Return a measure with its error.

        magnitude: of a number that is subtracted from it, whose rounding counts as well
        """
        measure = self.get_measure(index)
        if measure.value is None:
            return NoisyValue(None, why=self.explain(index))
        rounding = ROUNDING * (abs(measure.value) + magnitude)
        return NoisyValue(measure.value, max(measure.error or 0.0, rounding))

    def explain(self, index: int) -> Reason:
        """Return why a measure has no number."""
        word = self.get_measure(index).word
        return Reason(word, MISSING_KINDS[word].sentence) if word else Reason(self.code, self.reason)

    def explain_first(self) -> Reason:
        """Return why the variant, or else the first of its measures that has no number, has none."""
        reasons = (self.explain(index) for index, reading in enumerate(self.measures) if reading.value is None)
        return next(reasons, Reason(self.code, self.reason))


NO_VALUE = MeasureValue(None)


def make_failed_result(error: HeunError) -> VariantResult:
    """Make the result of a variant that could not be solved."""
    problem = error.problems[0]
    return VariantResult(code=problem.code, reason=problem.message)


# results of variants by their values, sorted by name
KnownResults = dict[tuple[tuple[str, ParameterValue], ...], VariantResult]


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
