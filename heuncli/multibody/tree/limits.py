"""Where the coordinates that stops limit stand at the start."""

from __future__ import annotations

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import replace
from heuncli.multibody.mechanism.model import Assembly, Mechanism, Stop
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.starts import distance


def start_within_limits(layout: Layout, start: Assembly) -> None:
    """Raise SolveError [beyond-stop] with all stops beyond whose limits the scene starts."""
    mechanism = layout.mechanism
    found = []
    for stop in mechanism.stops:
        value = coordinate(layout, start, stop)
        slack = tolerances.AT_LIMIT * (1.0 if stop.quantity == "angle" else layout.size)
        if stop.low is not None and value < stop.low - slack:
            found.append(_beyond(mechanism, stop, value, stop.low, "below"))
        if stop.high is not None and value > stop.high + slack:
            found.append(_beyond(mechanism, stop, value, stop.high, "above"))
    if found:
        raise SolveError(*found)


def coordinate(layout: Layout, start: Assembly, stop: Stop) -> float:
    """The angle [rad], travel [m] or length [m] that a stop limits, at the start."""
    joint = layout.mechanism.joints[stop.joint]
    if stop.quantity == "length":
        return distance(start, joint)
    at = layout.starts[stop.joint]
    return at.angle if stop.quantity == "angle" else at.travel


def at_rest_on_stops(mechanism: Mechanism, layout: Layout, start: Assembly) -> Mechanism | None:
    """The mechanism with rates of zero where the ones that were chosen drive what stands at a stop into it.

    None where there are none such. Rates that are given, or follow from given ones, strike.
    """
    joints, found = list(mechanism.joints), False
    for stop in mechanism.stops:
        joint, at = mechanism.joints[stop.joint], layout.starts[stop.joint]
        near = tolerances.AT_LIMIT * (1.0 if stop.quantity == "angle" else layout.size)
        rate, held = (at.rate, joint.rate) if stop.quantity == "angle" else (at.speed, joint.speed)
        value = coordinate(layout, start, stop)
        low = stop.low is not None and value <= stop.low + near and rate < 0.0
        high = stop.high is not None and value >= stop.high - near and rate > 0.0
        if stop.quantity != "length" and held is None and (low or high):
            found = True
            joints[stop.joint] = replace(joint, **{"rate" if stop.quantity == "angle" else "speed": 0.0})
    return replace(mechanism, joints=tuple(joints)) if found else None


def _beyond(mechanism: Mechanism, stop: Stop, value: float, limit: float, side: str) -> Problem:
    joint = mechanism.joints[stop.joint].name
    unit = "rad" if stop.quantity == "angle" else "m"
    starts = f"{joint}.{stop.quantity} starts at {value:.9g} {unit}"
    message = f"{starts}, {side} the limit {limit:.9g} {unit} of stop {stop.name}"
    return Problem("beyond-stop", message, hint=f"start the joint {joint} within its limits, or change the limits",
                   about=f"stops.{stop.name}")  # fmt: skip
