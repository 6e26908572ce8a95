"""Evaluate each variant once, and count what the variants warn about.

`find`, `tune` and `sensitivity` ask for some variants again. Their results are cached by the values.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from heuncli.analyses.variants.evaluation import Values
from heuncli.analyses.variants.measures import VariantResult
from heuncli.scene.file_format.quantity import ParameterValue

NUMBERS = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
NUMBER_LISTS = re.compile(r"#(?:(?:, | to )#)+(?: \.\.\.)?")

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
