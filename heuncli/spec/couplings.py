"""Couplings as they are meant: what stands under `couplings` and `rolling`, SI, references followed.

One class a type; joints and bodies by their names. As in spec/models.py, None is what was left out.
"""

from __future__ import annotations

from typing import Literal

from heuncli.expressions.programs import TableFunction
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


class Cam(NamedTuple):
    """A disc on the pin `shaft` that moves the follower of another joint: its coordinate is the lift over the angle.

    at: the point of the follower, its axes; its roller has that centre and a radius [m], its flat face that point and a
    normal. restitution: of one that lifts off and strikes again; None: the run ends where it would lift, or, with
    `both`, the follower is guided on both sides.
    """

    shaft: str
    follower: str
    lift: TableFunction
    at: tuple[float, float, float]
    contact: Literal["roller", "flat", "point"]
    radius: float = 0.0
    normal: tuple[float, float, float] | None = None
    both: bool = False
    restitution: float | None = None
    type: Literal["cam"] = "cam"


Coupling = Ratio | Cam  # a union of the classes here
