"""The description of a sweep, and its results: one row per variant."""

from __future__ import annotations

from collections.abc import Mapping

from heuncli.analyses.variants.evaluation import VariantResult
from heuncli.analyses.variants.plans import Plan
from heuncli.base.named_tuples import NamedTuple

WORKER_DIED = "worker-died"  # the code of a variant that ends the processes that solve it


class SweptMeasure(NamedTuple):
    """A measure in the words of the request, and its SI unit (empty: none)."""

    text: str
    unit: str


class SweepHead(NamedTuple):
    """The description of a sweep: the spec with its digest, what is varied, what is measured."""

    title: str
    path: str
    sha256: str
    version: str
    plan: Plan
    measures: tuple[SweptMeasure, ...]


class SweptRow(NamedTuple):
    """A variant: its number in the plan, its values in the form of `--set`, and its result."""

    number: int
    values: Mapping[str, str]
    answer: VariantResult
