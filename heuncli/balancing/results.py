"""What is found of a cycle: orders of force, moment and torque with verdicts, what remains, weights, a flywheel."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from heuncli.balancing.effects import MassEffects
from heuncli.records import fields, record
from heuncli.results import Array, Block


@record
class OrderRow:
    """One order of a quantity: component i is amplitude_i · cos(order · φ - phase_i).

    with_turn, against: the amplitudes of the two vectors that turn across the cycle's axis; None where it has no fixed
    one. across: whether nothing acts along the axis. own: the sum of the bodies' own amplitudes. error: what any of the
    amplitudes may be off by. parts: amplitudes and phases of orbital and spin, of a moment.
    """

    order: float
    amplitude: Array
    phase: Array
    size: float
    own: float
    verdict: str
    error: float = 0.0
    with_turn: float | None = None
    against: float | None = None
    across: bool = False
    parts: Mapping[str, tuple[Array, Array]] | None = None

    @property
    def reach(self) -> float:
        """The largest magnitude over a turn: of what swings along a line its amplitude, of a circle its radius."""
        a = self.amplitude * np.exp(-1j * self.phase)
        return float(np.sqrt(0.5 * (np.sum(np.abs(a) ** 2) + abs(np.sum(a * a)))))

    def block(self) -> Block:
        """As the JSON has it."""
        found: Block = {"order": self.order, "amplitude": self.amplitude, "phase": self.phase}
        if self.parts is not None:
            found |= {name: {"amplitude": a, "phase": p} for name, (a, p) in self.parts.items()}
        if len(self.amplitude) == 3:
            found |= {"with": self.with_turn, "against": self.against}
        return found | {"own": self.own, "verdict": self.verdict, "error": self.error}


@record
class Residual:
    """What acts over a cycle: root of the mean square, largest, and the angle of that [rad]; error: of both."""

    rms: float
    peak: float
    at: float
    error: float = 0.0

    def block(self) -> Block:
        """As the JSON has it."""
        return {"rms": self.rms, "peak": self.peak, "at": self.at, "error": self.error}


@record
class OverCycle:
    """Root of the mean square and largest magnitude over a cycle; None where redundant joints leave some of it open.

    error: of both.
    """

    rms: float | None
    peak: float | None
    error: float | None = None

    def block(self) -> Block:
        """As the JSON has it."""
        return {"rms": self.rms, "peak": self.peak, "error": self.error}


@record
class PlacedWeight:
    """A counterweight: product [kg m] = mass · radius at an angle [rad] from a direction of the body's axes.

    place: its name; vector (3,) [kg m], at (3,) [m]: product and where its mass stands, body axes.
    """

    body: str
    place: str
    product: float
    angle: float
    mass: float
    radius: float
    vector: Array
    first: Array
    at: Array

    def block(self) -> Block:
        """As the JSON has it."""
        return {
            "body": self.body, "place": self.place, "product": self.product, "angle": self.angle, "mass": self.mass,
            "radius": self.radius, "vector": self.vector, "from": self.first, "at": self.at,
        }  # fmt: skip


@record
class Counterbalance:
    """The counterweights of least square: of force, moment or both by a lever [m]; what is left, and what they cost.

    several: others would serve as well, these are the least; orders: what is left, by quantity; before, after: loads;
    notes: what is to be told beside these.
    """

    weights: tuple[PlacedWeight, ...]
    minimised: str
    lever: float | None
    several: bool
    orders: Mapping[str, tuple[OrderRow, ...]]
    words: Mapping[str, str]
    before: Mapping[str, OverCycle]
    after: Mapping[str, OverCycle]
    notes: tuple[str, ...] = ()


@record
class Flywheel:
    """A flywheel for a degree of unevenness, and how the machine runs with it, at the mean rate [rad/s].

    energy: ΔE [J], what work loads and inertia give and take at an even rate; own: the machine's mean reduced inertia,
    added, and textbook's [kg m2];
    delta: asked, present: without the wheel; even [N m]: the torque that was added so that the cycle closes; start,
    fastest, slowest [rad/s]: with the wheel. error: of each of them, by its name; notes: what is not known of loads.
    """

    joint: str
    delta: float
    present: float
    mean_rate: float
    energy: float
    own: float
    added: float
    textbook: float
    even: float
    start: float
    fastest: float
    slowest: float
    error: Mapping[str, float]
    notes: tuple[str, ...] = ()

    def block(self) -> Block:
        """As the JSON has it; inertia: all that turns."""
        own = {name: value for name, value in fields(self).items() if name != "notes"}
        return {**own, "error": dict(self.error), "inertia": self.own + self.added}


@record
class Period:
    """A period of time [s] with which a motion comes back; off: how much the last differs from the one before."""

    seconds: float
    off: float


@record
class BalanceResults:
    """A scene's balance over a cycle; forces at `rate` [rad/s], where none is known at 1 rad/s.

    about (3,) [m]: where moments are taken; place: its name; orders: by quantity (force, moment, torque);
    mean_error: what the means are off by; shown: the orders that tables show;
    asked: whether these were asked for.
    """

    title: str
    spec: Mapping[str, str]
    coordinate: str
    turns: int
    rate: float | None
    samples: int
    settled: bool
    about: Array
    place: str
    axis: Array | None
    effects: MassEffects
    orders: Mapping[str, tuple[OrderRow, ...]]
    words: Mapping[str, str]
    mean: Mapping[str, Any]
    mean_error: Mapping[str, float]
    residual: Mapping[str, Residual]
    shown: tuple[float, ...]
    asked: bool = False
    notes: tuple[str, ...] = ()
    counterbalance: Counterbalance | None = None
    flywheel: Flywheel | None = None
    period: Period | None = None
