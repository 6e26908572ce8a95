"""What a balance is asked for beside its scene."""

from __future__ import annotations

from heuncli.base.records import record
from heuncli.results.results import Array


@record
class AskedWeight:
    """A counterweight that is looked for: a body's point, and how far from it or its axis [m]; None: as joints are."""

    body: str
    point: str
    radius: float | None


@record
class AskedWheel:
    """A flywheel that is looked for: on which joint (empty: the cycle's), for which unevenness."""

    joint: str
    delta: float


@record
class BalanceOptions:
    """What is asked for beside the scene; None: as the scene has it."""

    cycle: str | None = None
    turns: int | None = None
    rate: float | None = None
    orders: tuple[float, ...] | None = None
    about: Array | None = None
    place: str = ""
    weights: tuple[AskedWeight, ...] = ()
    minimise: str | None = None
    lever: float | None = None
    flywheel: AskedWheel | None = None
    period: float | None = None


NOTHING_ASKED = BalanceOptions()
