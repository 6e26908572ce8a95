"""The description of a sweep, and its results: one row per variant."""

from __future__ import annotations

from heuncli.analyses.variants.evaluation import Values
from heuncli.analyses.variants.measures import MeasureLabel, VariantResult
from heuncli.analyses.variants.plans import Plan
from heuncli.base.named_tuples import NamedTuple


class SweepHead(NamedTuple):
    """The description of a sweep: the spec with its digest, what is varied, what is measured."""

    title: str
    path: str
    sha256: str
    version: str
    plan: Plan
    measures: tuple[MeasureLabel, ...]


class SweptRow(NamedTuple):
    """A variant: its number in the plan, its values, and its result."""

    number: int
    values: Values
    answer: VariantResult
