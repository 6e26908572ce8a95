"""What a sweep is of, and what it finds: a row a variant."""

from __future__ import annotations

from collections.abc import Mapping

from heuncli.analyses.variants.asking import Answer
from heuncli.analyses.variants.plans import Plan
from heuncli.base.named_tuples import NamedTuple

WORKER_DIED = "worker-died"  # the code of a variant that ends the processes that solve it


class SweptMeasure(NamedTuple):
    """A measure in the words in which it was asked for, and its SI unit (empty: none)."""

    text: str
    unit: str


class SweepHead(NamedTuple):
    """What a sweep is of: the spec with its digest, what is varied, what is measured."""

    title: str
    path: str
    sha256: str
    version: str
    plan: Plan
    measures: tuple[SweptMeasure, ...]


class SweptRow(NamedTuple):
    """A variant by its number in the plan, its values in the form of `--set`, and what it answered."""

    number: int
    values: Mapping[str, str]
    answer: Answer
