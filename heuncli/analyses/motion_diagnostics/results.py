"""Results of a probe: events, condition numbers, stiffness and growth of disturbances."""

from __future__ import annotations

import math
from typing import Any

from heuncli.base.method_rows import find_method
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record

HALF_TURN, GIMBAL, DEAD_CENTRE, SINGULAR, NO_MASS = (
    "half turn", "gimbal lock", "dead centre", "singular pose", "singular mass",
)  # fmt: skip


class Event(NamedTuple):
    """An event at an instant [s].

    kind: one of the kinds above
    where: a body, joint or loop, by its path
    message: a sentence
    """

    time: float
    kind: str
    where: str
    message: str


class AttitudeResults(NamedTuple):
    """A body that rotates freely.

    half_turns: number of its half turns
    euler: largest condition of its Euler angles, and its instant [s], by their sequence
    """

    body: str
    half_turns: int
    euler: dict[str, tuple[float, float]]

    def to_block(self) -> dict[str, Any]:
        """Return the results as a JSON block."""
        euler = {name: {"condition": to_json_number(k), "time": t} for name, (k, t) in self.euler.items()}
        return {"half_turns": self.half_turns, **euler}


class LargestCondition(NamedTuple):
    """The largest condition number over the run, with time and place; infinite if singular."""

    value: float
    time: float
    where: str = ""


class StepLimits(NamedTuple):
    """The steps [s] that stability permits a method and that accuracy requires of it; infinite means no limit."""

    method: str
    order: int
    stability: float
    accuracy: float


@record
class StiffnessResults:
    """How fast disturbances of the motion decay and oscillate, compared with the motion itself.

    decay, oscillation [1/s]: largest -Re and |Im| over the run of the eigenvalues of the tangent, on the motions that
    closed chains admit
    time [s]: when stability requires the shortest step
    motion_rate [1/s]: rate of the motion itself
    steps: of explicit methods
    ratio: largest factor by which stability shortens the steps of the default method
    share: share of the run in which it does
    """

    decay: float
    oscillation: float
    time: float
    motion_rate: float
    steps: tuple[StepLimits, ...]
    ratio: float
    share: float


@record
class GrowthResults:
    """Growth of disturbances.

    rate [1/s]: mean rate over the second half of the run
    logarithm: ln of the factor up to `end_time` [s]
    exponential: whether the growth is exponential
    directions: number of independent disturbances
    horizon [s]: of double precision
    expected_horizon [s]: the horizon after the run if the growth goes on
    stop_reason: why the growth is not known up to the end of the run, or None
    """

    rate: float
    logarithm: float
    exponential: bool
    directions: int
    horizon: float | None
    expected_horizon: float | None
    end_time: float
    stop_reason: str | None = None


@record
class Probe:
    """Results of a probe.

    run_horizon [s]: up to which the run is reliable, None: to its end
    error: estimate of the error of the run's motion
    status: why the run ended early, empty if it did not
    mass, closure: largest conditions of the mass matrix and of the closures
    growth, out_of_plane: growth of disturbances within the integrated freedoms, and out of the plane of the motion
    reasons: why results are missing, by JSON key
    further_events: kind and place of events beyond those listed, with their number
    trouble, others: sentences on what is difficult for the default method, worst first, and for others
    """

    title: str
    duration: float
    model: dict[str, Any]
    run_horizon: float | None
    error: float
    status: str
    events: tuple[Event, ...]
    attitudes: tuple[AttitudeResults, ...]
    mass: LargestCondition | None
    closure: LargestCondition | None
    stiffness: StiffnessResults | None
    growth: GrowthResults | None
    out_of_plane: GrowthResults | None
    reasons: dict[str, str]
    further_events: tuple[tuple[str, str, int], ...]
    trouble: tuple[str, ...] = ()
    others: tuple[str, ...] = ()

    @property
    def implicit_method(self) -> str | None:
        """The method of the run if it is implicit, else None."""
        row = find_method(str(self.model.get("method")))
        return row.name if row is not None and row.kind != "explicit" else None

    @property
    def verdict(self) -> str:
        """One sentence for the top of the page."""
        if not self.trouble:
            return (
                f"no difficulties for heun's default method {'in this motion' if self.duration else 'at this instant'}"
            )
        return self.trouble[0]

    def to_block(self) -> dict[str, Any]:
        """Return the probe as a JSON block."""
        growth, stiffness = self.growth, self.stiffness
        return {
            "verdict": self.verdict,
            "trouble": list(self.trouble),
            "others": list(self.others),
            "horizon": growth.horizon if growth is not None else None,
            "stiffness": to_json_number(stiffness.ratio) if stiffness is not None else None,
            "growth_rate": to_json_number(growth.rate) if growth is not None else None,
            "condition": {"mass": to_json_condition(self.mass), "closure": to_json_condition(self.closure)},
            "events": [event._asdict() for event in self.events],
            "more": [{"kind": kind, "where": where, "count": count} for kind, where, count in self.further_events],
            "growth": to_growth_block(growth),
            "out_of_plane": to_growth_block(self.out_of_plane),
            "rates": to_rates_block(stiffness),
            "steps": {} if stiffness is None else to_steps_block(stiffness),
            "condition_at": {
                name: at._asdict() | {"value": to_json_number(at.value)} for name, at in self.list_conditions()
            },
            "attitudes": {turned.body: turned.to_block() for turned in self.attitudes},
            "run": {"method": self.model.get("method"), "horizon": self.run_horizon, "error": self.error},
            "not_told": dict(self.reasons),
        }

    def list_conditions(self) -> list[tuple[str, LargestCondition]]:
        """Return the known largest condition numbers with their names: mass, closure."""
        return [(name, at) for name, at in (("mass", self.mass), ("closure", self.closure)) if at is not None]


def to_json_number(x: float) -> float | None:
    """Return a number for JSON: null if it is not finite."""
    return x if math.isfinite(x) else None


def to_json_condition(largest: LargestCondition | None) -> float | None:
    """Return the largest condition as a JSON number."""
    return to_json_number(largest.value) if largest is not None else None


def to_growth_block(growth: GrowthResults | None) -> dict[str, Any] | None:
    """Return a growth as a JSON block."""
    if growth is None:
        return None
    return {
        "rate": growth.rate,
        "logarithm": growth.logarithm,
        "exponential": growth.exponential,
        "directions": growth.directions,
        "horizon": growth.horizon,
        "expected": growth.expected_horizon,
        "until": growth.end_time,
    }


def to_rates_block(stiffness: StiffnessResults | None) -> dict[str, Any] | None:
    """Return the rates as a JSON block."""
    if stiffness is None:
        return None
    return {
        "decay": stiffness.decay,
        "oscillation": stiffness.oscillation,
        "time": stiffness.time,
        "motion": to_json_number(stiffness.motion_rate),
        "share": stiffness.share,
    }


def to_steps_block(stiffness: StiffnessResults) -> dict[str, Any]:
    """Return the limits of the steps by method as a JSON block."""
    return {
        limits.method: {"stability": to_json_number(limits.stability), "accuracy": to_json_number(limits.accuracy)}
        for limits in stiffness.steps
    }
