"""Check the coordinates that stops limit at the start."""

from __future__ import annotations

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import replace
from heuncli.multibody.mechanism.model import Assembly, Mechanism, Stop
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.starts import point_distance


def require_within_limits(layout: Layout, start: Assembly) -> None:
    """Raise SolveError [beyond-stop] with all stops whose limits the start exceeds."""
    mechanism = layout.mechanism
    problems = []
    for stop in mechanism.stops:
        value = stop_coordinate(layout, start, stop)
        slack = tolerances.AT_LIMIT * (1.0 if stop.quantity == "angle" else layout.size)
        if stop.low is not None and value < stop.low - slack:
            problems.append(_limit_problem(mechanism, stop, value, stop.low, "below"))
        if stop.high is not None and value > stop.high + slack:
            problems.append(_limit_problem(mechanism, stop, value, stop.high, "above"))
    if problems:
        raise SolveError(*problems)


def stop_coordinate(layout: Layout, start: Assembly, stop: Stop) -> float:
    """Return the angle [rad], travel [m] or length [m] that a stop limits, at the start."""
    joint = layout.mechanism.joints[stop.joint]
    if stop.quantity == "length":
        return point_distance(start, joint)
    start_values = layout.starts[stop.joint]
    return start_values.angle if stop.quantity == "angle" else start_values.travel


def zero_inward_rates(mechanism: Mechanism, layout: Layout, start: Assembly) -> Mechanism | None:
    """Set the rates to zero that were chosen, not given, and would drive a body at a stop into it; None if there are
    none.

    Rates that are given, or follow from given ones, cause an impact instead.
    """
    joints, has_changed = list(mechanism.joints), False
    for stop in mechanism.stops:
        joint, start_values = mechanism.joints[stop.joint], layout.starts[stop.joint]
        tolerance = tolerances.AT_LIMIT * (1.0 if stop.quantity == "angle" else layout.size)
        rate, held = (start_values.rate, joint.rate) if stop.quantity == "angle" else (start_values.speed, joint.speed)
        value = stop_coordinate(layout, start, stop)
        low = stop.low is not None and value <= stop.low + tolerance and rate < 0.0
        high = stop.high is not None and value >= stop.high - tolerance and rate > 0.0
        if stop.quantity != "length" and held is None and (low or high):
            has_changed = True
            joints[stop.joint] = replace(joint, **{"rate" if stop.quantity == "angle" else "speed": 0.0})
    return replace(mechanism, joints=tuple(joints)) if has_changed else None


def _limit_problem(mechanism: Mechanism, stop: Stop, value: float, limit: float, side: str) -> Problem:
    joint = mechanism.joints[stop.joint].name
    unit = "rad" if stop.quantity == "angle" else "m"
    starts = f"{joint}.{stop.quantity} starts at {value:.9g} {unit}"
    message = f"{starts}, {side} the limit {limit:.9g} {unit} of stop {stop.name}"
    return Problem("beyond-stop", message, hint=f"start the joint {joint} within its limits, or change the limits",
                   entry_path=f"stops.{stop.name}")  # fmt: skip
