"""The measures of a variant: each is a number with its instant and stated error, or a reason; compared with a value.

A value is written as in a spec: with a unit of the measure's kind, in SI without one, or by parameters.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Literal

from heuncli.analyses.variants.parameters import AxisError
from heuncli.base.errors import Finding, HeunError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.tolerances import EPS
from heuncli.base.units import parse_unit
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.quantity import Scope, parse_number_with_unit, read_number
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
        return bool(self.measures) and all(reading.value is not None for reading in self.measures)

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
        reasons = (self.explain(index) for index, reading in enumerate(self.measures) if reading.value is None)
        return next(reasons, Reason(self.code, self.reason))


NO_VALUE = MeasureValue(None)


def make_failed_result(error: HeunError) -> VariantResult:
    """Make the result of a variant that could not be solved."""
    problem = error.problems[0]
    return VariantResult(code=problem.code, reason=problem.message)


Relation = Literal["=", "<", ">", "<=", ">="]
SPELLINGS: dict[str, Relation] = {
    "=": "=", "==": "=", "<": "<", ">": ">", "<=": "<=", ">=": ">=", "≤": "<=", "≥": ">=", "=<": "<=", "=>": ">=",
}  # fmt: skip
PARTS = re.compile(r"([^<>=≤≥]*)([<>=≤≥]+)([^<>=≤≥]*)\Z", re.DOTALL)


SIDES: dict[Relation, int] = {"=": 0, "<": -1, "<=": -1, ">": 1, ">=": 1}  # of the value: where it is met


class WrittenCondition(NamedTuple):
    """A condition as it is written: the words of a measure, the relation, and the value."""

    measure: str
    relation: Relation
    value: str

    @property
    def text(self) -> str:
        """The whole condition."""
        return f"{self.measure} {self.relation} {self.value}"


class Comparison(NamedTuple):
    """A condition on a measure, in SI.

    measure: its words
    unit: its SI unit; empty if it has none
    given_unit: the unit in which the value was given; empty if it has none, or is an expression
    """

    measure: str
    relation: Relation
    value: float
    unit: str
    given_unit: str = ""

    @property
    def side(self) -> int:
        """The side of the value where an inequality is met: 1 above, -1 below; 0 of an equation."""
        return SIDES[self.relation]

    @property
    def includes_value(self) -> bool:
        """Whether the value itself meets the condition."""
        return "=" in self.relation

    def compute_excess(self, number: float) -> float:
        """Return by how much an inequality is violated; negative: the margin."""
        return number - self.value if self.side < 0 else self.value - number

    def is_met(self, number: float) -> bool:
        """Return whether a number meets an inequality."""
        excess = self.compute_excess(number)
        return excess < 0.0 or (excess == 0.0 and self.includes_value)


def parse_condition(text: str, form: str, hint: str) -> WrittenCondition:
    """Parse a text such as `max joints.main.force < 10 kN`; form, hint: the message where it is not understood.

    Raises AxisError.
    """
    found = PARTS.match(text)
    relation = SPELLINGS.get(found[2]) if found is not None else None
    if found is None or relation is None:
        raise AxisError(text, form, hint)
    if not found[1].strip() or not found[3].strip():
        what = "no measure before" if not found[1].strip() else "no value after"
        raise AxisError(text, f"{form}; there is {what} the '{found[2]}'", hint)
    if parse_number_with_unit(found[1]) is not None:
        raise AxisError(text, "put the measure first", hint)
    return WrittenCondition(found[1].strip(), relation, found[3].strip())


def resolve_condition(condition: WrittenCondition, unit: str, specs: Sequence[Spec], hint: str) -> Comparison:
    """Return a condition in SI, whose value must be the same in all specs.

    unit: the measure's own, empty where it is unknown

    Raises AxisError.
    """
    number = parse_number_with_unit(condition.value)
    value = find_si_value(condition, unit, specs, hint)
    return Comparison(condition.measure, condition.relation, value, unit, number.unit if number is not None else "")


def find_si_value(condition: WrittenCondition, unit: str, specs: Sequence[Spec], hint: str) -> float:
    """Return the value of a condition in SI, the same in all specs; unit: the measure's own, empty where it is unknown.

    Raises AxisError.
    """
    dimension = parse_unit(unit)[1] if unit else None
    values: set[float] = set()
    for spec in specs:
        try:
            values.add(read_number(_parse_plain(condition.value), dimension, Scope(spec.parameters)))
        except Finding as finding:
            raise AxisError(condition.text, finding.message, finding.hint or hint, finding.code) from None
    if len(values) > 1:
        raise AxisError(
            condition.text, f"the value '{condition.value}' depends on what is varied", "give it as a number"
        )
    return values.pop()


def _parse_plain(text: str) -> float | str:
    """Return a number if the text is one, because in a spec a plain number is no text."""
    try:
        return float(text)
    except ValueError:
        return text
