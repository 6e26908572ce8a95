"""Couplings as they are meant: what stands under `couplings` and `rolling`, SI, references followed.

One class a type; joints and bodies by their names. As in spec/models.py, None is what was left out.
"""

from __future__ import annotations

from typing import Literal

from heuncli.named_tuples import NamedTuple


class Term(NamedTuple):
    """A joint's coordinate and how many times it is taken."""

    joint: str
    quantity: Literal["angle", "travel"]
    factor: float


class Ratio(NamedTuple):
    """A linear relation: the sum of the terms stays what it is at the start, or is `is_`."""

    terms: tuple[Term, ...]
    is_: float | None = None
    type: Literal["ratio"] = "ratio"


Coupling = Ratio  # a union of the classes here
