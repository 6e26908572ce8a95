"""Answers of variants, each asked for once: for what looks for a value by itself, and counts its runs."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from types import MappingProxyType

from heuncli.analyses.variants.asking import Answer, Asker
from heuncli.base.tolerances import EPS

ROUNDING = 8.0 * EPS  # of a measure: what some sums of a run's last step leave where it states no more
FIGURES = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
SEVERAL = re.compile(r"#(?:(?:, | to )#)+(?: \.\.\.)?")
# why there is no measure, by the word that stands for it
REASONS: Mapping[str, str] = MappingProxyType(
    {
        "open": "open: the laws of rigid bodies do not give it (redundant supports)",
        "unknown": "not known: beside a singular pose",
        "beyond": "beyond the run's horizon nothing is claimed",
        "absent": "what is measured does not happen there, as an event or a blow",
    }
)


class AnswersOnce:
    """The answers of an asker by their values: what was asked for before is not solved again."""

    def __init__(self, asker: Asker, begun: Callable[[int], None] = lambda runs: None) -> None:
        """begun: told of each variant that is solved, with how many were before it."""
        self.asker, self._begun = asker, begun
        self._known: dict[tuple[tuple[str, str], ...], Answer] = {}

    @property
    def runs(self) -> int:
        """How many variants have been asked for, those that could not be solved among them."""
        return len(self._known)

    def of(self, values: Mapping[str, str]) -> Answer:
        """The answer of a variant; values: by name, in the form of `--set`."""
        key = tuple(sorted(values.items()))
        if key not in self._known:
            self._begun(self.runs)
            self._known[key] = self.asker.answer(values)
        return self._known[key]

    def warnings(self) -> dict[str, int]:
        """What the variants warned of, the first sentence of each kind, and how many of them."""
        found: dict[str, tuple[str, int]] = {}
        for answer in self._known.values():
            for kind, text in {kind_of_warning(text): text for text in answer.warnings}.items():
                first, so_far = found.get(kind, (text, 0))
                found[kind] = first, so_far + 1
        return dict(found.values())


def kind_of_warning(text: str) -> str:
    """A warning without its figures, which differ from variant to variant."""
    return SEVERAL.sub("#", FIGURES.sub("#", text))
