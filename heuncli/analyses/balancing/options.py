"""Options of a balance that are not part of its scene."""

from __future__ import annotations

from heuncli.base.records import record
from heuncli.results.results import Array


@record
class WeightRequest:
    """A requested counterweight: a point of a body, and the distance of the weight from it or from its axis [m].

    radius: None means the distance of the body's farthest joint
    """

    body: str
    point: str
    radius: float | None


@record
class FlywheelRequest:
    """A requested flywheel: its joint (empty: the joint of the cycle) and the permitted degree of unevenness
    `delta`.
    """

    joint: str
    delta: float


@record
class BalanceOptions:
    """Options of a balance; None means that the scene decides."""

    cycle: str | None = None
    turns: int | None = None
    rate: float | None = None
    orders: tuple[float, ...] | None = None
    about: Array | None = None
    place: str = ""
    weights: tuple[WeightRequest, ...] = ()
    minimise: str | None = None
    lever: float | None = None
    flywheel: FlywheelRequest | None = None
    period: float | None = None


DEFAULT_OPTIONS = BalanceOptions()
