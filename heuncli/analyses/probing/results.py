"""What a motion comes near to, as it is told: instants, conditions, stiffness, growth."""

from __future__ import annotations

import math
from typing import Any

from heuncli.base.method_rows import row_of
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record

HALF_TURN, GIMBAL, DEAD_CENTRE, SINGULAR, NO_MASS = (
    "half turn", "gimbal lock", "dead centre", "singular pose", "singular mass",
)  # fmt: skip


class Event(NamedTuple):
    """An instant [s]; kind: one of those above; where: a body, joint or loop by its path; message: a sentence."""

    time: float
    kind: str
    where: str
    message: str


class AttitudeResults(NamedTuple):
    """Of a body whose turns are all free: its name, its half turns, and the largest conditions of its Euler angles."""

    body: str
    half_turns: int
    euler: dict[str, tuple[float, float]]  # by sequence: condition, and when

    def block(self) -> dict[str, Any]:
        """As JSON has it."""
        euler = {name: {"condition": number(k), "time": t} for name, (k, t) in self.euler.items()}
        return {"half_turns": self.half_turns, **euler}


class LargestCondition(NamedTuple):
    """The largest of a condition number over the run, when, and where; infinite of what is singular."""

    value: float
    time: float
    where: str = ""


class Step(NamedTuple):
    """The steps [s] that a method is allowed by stability and that accuracy asks of it; infinite: any."""

    method: str
    order: int
    stability: float
    accuracy: float


@record
class StiffnessResults:
    """How fast what is near the motion decays and oscillates, against the motion itself.

    decay, oscillation [1/s]: largest over the run of -Re and |Im| of the eigenvalues of the tangent, on what the closed
    chains admit; time [s]: when stability asks for the shortest step; own [1/s]: the motion's own rate; steps: of
    explicit methods; ratio: by how much stability shortens the steps of the default method, at most; share of the run
    in which it does.
    """

    decay: float
    oscillation: float
    time: float
    own: float
    steps: tuple[Step, ...]
    ratio: float
    share: float


@record
class GrowthResults:
    """How a disturbance grows: rate [1/s], how many times until an instant, whether exponentially; directions: how many
    there are; horizon [s]: of double precision; expected: the one beyond the run, if it goes on so.
    """

    rate: float
    times: float  # ln of it
    exponential: bool
    directions: int
    horizon: float | None
    expected: float | None
    until: float  # [s]
    stopped: str | None = None


@record
class Probe:
    """What a probe found. reasons: why something is not told, by its key in JSON; more: events beyond those listed."""

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
    across: GrowthResults | None  # out of the plane
    reasons: dict[str, str]
    more: tuple[tuple[str, str, int], ...]
    trouble: tuple[str, ...] = ()  # of the default method, worst first
    others: tuple[str, ...] = ()  # of other methods

    @property
    def implicit(self) -> str | None:
        """The method by which the run went, where that bears what is stiff; None of an explicit one."""
        row = row_of(str(self.model.get("method")))
        return row.name if row is not None and row.kind != "explicit" else None

    @property
    def verdict(self) -> str:
        """One sentence at the top."""
        if not self.trouble:
            return f"nothing {'in this motion' if self.duration else 'at this instant'} troubles heun's default method"
        return self.trouble[0]

    def block(self) -> dict[str, Any]:
        """As JSON has it."""
        growth, stiff = self.growth, self.stiffness
        return {
            "verdict": self.verdict,
            "trouble": list(self.trouble),
            "others": list(self.others),
            "horizon": growth.horizon if growth is not None else None,
            "stiffness": number(stiff.ratio) if stiff is not None else None,
            "growth_rate": number(growth.rate) if growth is not None else None,
            "condition": {"mass": number_of(self.mass), "closure": number_of(self.closure)},
            "events": [event._asdict() for event in self.events],
            "more": [{"kind": kind, "where": where, "count": count} for kind, where, count in self.more],
            "growth": growing_block(growth),
            "out_of_plane": growing_block(self.across),
            "rates": stiff_block(stiff),
            "steps": {s.method: {"stability": number(s.stability), "accuracy": number(s.accuracy)} for s in stiff.steps}
            if stiff is not None
            else {},
            "condition_at": {name: at._asdict() | {"value": number(at.value)} for name, at in self.conditions()},
            "attitudes": {turned.body: turned.block() for turned in self.attitudes},
            "run": {"method": self.model.get("method"), "horizon": self.run_horizon, "error": self.error},
            "not_told": dict(self.reasons),
        }

    def conditions(self) -> list[tuple[str, LargestCondition]]:
        """The largest condition numbers that are known, with what of: mass matrix, closures."""
        return [(name, at) for name, at in (("mass", self.mass), ("closure", self.closure)) if at is not None]


def number(x: float) -> float | None:
    """A number as JSON has it: what is without bound is null."""
    return x if math.isfinite(x) else None


def number_of(largest: LargestCondition | None) -> float | None:
    """The largest as JSON has it."""
    return number(largest.value) if largest is not None else None


def growing_block(growth: GrowthResults | None) -> dict[str, Any] | None:
    """A growth as JSON has it."""
    if growth is None:
        return None
    return {
        "rate": growth.rate, "logarithm": growth.times, "exponential": growth.exponential,
        "directions": growth.directions, "horizon": growth.horizon, "expected": growth.expected, "until": growth.until,
    }  # fmt: skip


def stiff_block(stiff: StiffnessResults | None) -> dict[str, Any] | None:
    """Rates as JSON has them."""
    if stiff is None:
        return None
    return {
        "decay": stiff.decay, "oscillation": stiff.oscillation, "time": stiff.time, "motion": number(stiff.own),
        "share": stiff.share,
    }  # fmt: skip
