"""The measures of a variant: each is a number with its instant and its stated error, or a word why there is none."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal

from heuncli.base.errors import HeunError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.tolerances import EPS
from heuncli.study.quantities.digits import OPEN, UNKNOWN

MissingWord = Literal["", "open", "unknown", "beyond", "absent"]
TIME_LIMIT_CODE = "time-limit"  # the code of a variant that was not solved for lack of time
WORKER_DIED = "worker-died"  # the code of a variant that ends the processes that solve it
ROUNDING = 8.0 * EPS  # of a measure: rounding of sums of a run's last step, where the run states no larger error


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
        return bool(self.measures) and all(one.value is not None for one in self.measures)

    def get_measure(self, index: int) -> MeasureValue:
        """Return a measure; of a variant that could not be solved one without a number."""
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
        reasons = (self.explain(index) for index, one in enumerate(self.measures) if one.value is None)
        return next(reasons, Reason(self.code, self.reason))


NO_VALUE = MeasureValue(None)


def make_failed_result(error: HeunError) -> VariantResult:
    """Make the result of a variant that could not be solved."""
    problem = error.problems[0]
    return VariantResult(code=problem.code, reason=problem.message)
