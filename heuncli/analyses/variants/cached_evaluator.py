"""Evaluate each variant once, for commands that search for a value and count their runs."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from types import MappingProxyType

from heuncli.analyses.variants.evaluation import VariantEvaluator, VariantResult
from heuncli.base.tolerances import EPS

ROUNDING = 8.0 * EPS  # of a measure: rounding of sums of a run's last step, where the run states no larger error
NUMBERS = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
NUMBER_LISTS = re.compile(r"#(?:(?:, | to )#)+(?: \.\.\.)?")
# the reason why a measure has no value, by its word
REASONS: Mapping[str, str] = MappingProxyType(
    {
        "open": "open: statically indeterminate, depends on stiffness",
        "unknown": "not known: near a singular position",
        "beyond": "not reliable past the run's horizon",
        "absent": "the measured event or impulse does not happen there",
    }
)


class CachedEvaluator:
    """The results of an evaluator by their values: no variant is solved twice."""

    def __init__(self, evaluator: VariantEvaluator, report_run: Callable[[int], None] = lambda runs: None) -> None:
        """report_run: called before each variant is solved, with the number of those before it"""
        self.evaluator, self._report_run = evaluator, report_run
        self._known: dict[tuple[tuple[str, str], ...], VariantResult] = {}

    @property
    def runs(self) -> int:
        """How many variants were evaluated, including those that could not be solved."""
        return len(self._known)

    def evaluate(self, values: Mapping[str, str]) -> VariantResult:
        """Return the result of a variant; values: by name, in the form of `--set`."""
        key = tuple(sorted(values.items()))
        if key not in self._known:
            self._report_run(self.runs)
            self._known[key] = self.evaluator.answer(values)
        return self._known[key]

    def count_warnings(self) -> dict[str, int]:
        """Return the first warning of each kind, and how many variants gave one."""
        warnings_by_kind: dict[str, tuple[str, int]] = {}
        for result in self._known.values():
            for kind, text in {strip_numbers(text): text for text in result.warnings}.items():
                first, so_far = warnings_by_kind.get(kind, (text, 0))
                warnings_by_kind[kind] = first, so_far + 1
        return dict(warnings_by_kind.values())


def strip_numbers(text: str) -> str:
    """Return a warning with its numbers replaced by `#`: they differ from variant to variant."""
    return NUMBER_LISTS.sub("#", NUMBERS.sub("#", text))
