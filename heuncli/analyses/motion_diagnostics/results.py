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
    """A body that rotates freely: its name, number of half turns, and the largest conditions of its Euler angles."""

    body: str
    half_turns: int
    euler: dict[str, tuple[float, float]]  # by sequence: condition, and when

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

    rate [1/s]: of the growth; logarithm: ln of the factor up to `end_time`; exponential: whether it is exponential
    directions: number of independent disturbances
    horizon [s]: of double precision; expected_horizon: the horizon after the run if the growth goes on
    """

    rate: float
    logarithm: float  # ln of it
    exponential: bool
    directions: int
    horizon: float | None
    expected_horizon: float | None
    end_time: float  # [s]
    stop_reason: str | None = None


@record
class Probe:
    """Results of a probe.

    reasons: why results are missing, by JSON key
    further_events: numbers of events beyond those listed
    """

    title: str
    duration: float
    model: dict[str, Any]
    run_horizon: float | None
    error: float  # estimate of the run's motion
    status: str
    events: tuple[Event, ...]
    attitudes: tuple[AttitudeResults, ...]
    mass: LargestCondition | None
    closure: LargestCondition | None
    stiffness: StiffnessResults | None
    growth: GrowthResults | None
    out_of_plane: GrowthResults | None  # out of the plane
    reasons: dict[str, str]
    further_events: tuple[tuple[str, str, int], ...]
    trouble: tuple[str, ...] = ()  # of the default method, worst first
    others: tuple[str, ...] = ()  # of other methods

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
            "steps": {
                s.method: {"stability": to_json_number(s.stability), "accuracy": to_json_number(s.accuracy)}
                for s in stiffness.steps
            }
            if stiffness is not None
            else {},
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
