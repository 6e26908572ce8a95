"""Options, results and labels of a balance: orders with verdicts, residuals, counterweights, a flywheel."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from heuncli.analyses.balancing.cycle import MassEffects
from heuncli.base.records import fields, record
from heuncli.results.results import Array, Block


@record
class OrderRow:
    """One order of a quantity: component i is amplitude_i · cos(order · φ - phase_i).

    with_turn, against_turn: amplitudes of the two rotating vectors across the cycle's axis; None if the axis is not
    fixed
    is_across_axis: whether nothing acts along the axis
    body_sum: sum of the bodies' own amplitudes
    error: error of any amplitude
    parts: amplitudes and phases of the orbital and spin parts of a moment
    """

    order: float
    amplitude: Array
    phase: Array
    size: float
    body_sum: float
    verdict: str
    error: float = 0.0
    with_turn: float | None = None
    against_turn: float | None = None
    is_across_axis: bool = False
    parts: Mapping[str, tuple[Array, Array]] | None = None

    @property
    def peak(self) -> float:
        """The largest magnitude over a turn: the amplitude of a linear vibration, the radius of a circular one."""
        a = self.amplitude * np.exp(-1j * self.phase)
        return float(np.sqrt(0.5 * (np.sum(np.abs(a) ** 2) + abs(np.sum(a * a)))))

    def to_block(self) -> Block:
        """Return the row as a JSON block."""
        block: Block = {"order": self.order, "amplitude": self.amplitude, "phase": self.phase}
        if self.parts is not None:
            block |= {name: {"amplitude": a, "phase": p} for name, (a, p) in self.parts.items()}
        if len(self.amplitude) == 3:
            block |= {"with": self.with_turn, "against": self.against_turn}
        return block | {"own": self.body_sum, "verdict": self.verdict, "error": self.error}


@record
class Residual:
    """What acts over a cycle: root mean square, peak, the angle of the peak [rad], and the error of rms and peak."""

    rms: float
    peak: float
    peak_angle: float
    error: float = 0.0

    def to_block(self) -> Block:
        """Return the residual as a JSON block."""
        return {"rms": self.rms, "peak": self.peak, "at": self.peak_angle, "error": self.error}


@record
class CycleLoad:
    """Root mean square and peak of a load over a cycle, with the error of both; None if redundant joints leave it
    indeterminate.
    """

    rms: float | None
    peak: float | None
    error: float | None = None

    def to_block(self) -> Block:
        """Return the load as a JSON block."""
        return {"rms": self.rms, "peak": self.peak, "error": self.error}


@record
class CounterweightResult:
    """A counterweight: product [kg m] = mass · radius at an angle [rad] from a direction of the body's axes.

    place: name of its point
    vector (3,) [kg m]: the product, body axes
    reference_direction (3,): the direction from which `angle` is counted
    position (3,) [m]: centre of its mass, body axes
    """

    body: str
    place: str
    product: float
    angle: float
    mass: float
    radius: float
    vector: Array
    reference_direction: Array
    position: Array

    def to_block(self) -> Block:
        """Return the counterweight as a JSON block."""
        return {
            "body": self.body, "place": self.place, "product": self.product, "angle": self.angle, "mass": self.mass,
            "radius": self.radius, "vector": self.vector, "from": self.reference_direction, "at": self.position,
        }  # fmt: skip


@record
class Counterbalance:
    """The counterweights that minimise force, moment, or both combined by a lever [m], with the remaining orders and
    the loads.

    objective: force, moment or mix
    several: whether other weights would serve as well; these are the smallest
    orders: the remaining orders, by quantity
    loads_without, loads_with: loads without and with the counterweights
    notes: remarks on these loads
    """

    weights: tuple[CounterweightResult, ...]
    objective: str
    lever: float | None
    several: bool
    orders: Mapping[str, tuple[OrderRow, ...]]
    summaries: Mapping[str, str]
    loads_without: Mapping[str, CycleLoad]
    loads_with: Mapping[str, CycleLoad]
    notes: tuple[str, ...] = ()


@record
class Flywheel:
    """A flywheel for a degree of unevenness, and how the machine runs with it at the mean rate [rad/s].

    delta, present: permitted unevenness, and unevenness without the flywheel
    energy [J]: ΔE, the energy exchanged by loads and inertia at a constant rate
    own, added, textbook [kg m2]: mean reduced inertia of the machine; inertia of the flywheel; its textbook value
    even [N m]: constant torque added so that the cycle closes
    start, fastest, slowest [rad/s]: rates with the flywheel
    error: error of each number, by name
    notes: what could not be determined about the loads
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

    def to_block(self) -> Block:
        """Return the flywheel as a JSON block; `inertia` is the total."""
        numbers = {name: value for name, value in fields(self).items() if name != "notes"}
        return {**numbers, "error": dict(self.error), "inertia": self.own + self.added}


@record
class Period:
    """A period of time [s] with which a motion repeats, and the relative difference of the last two periods."""

    seconds: float
    relative_difference: float


@record
class BalanceResults:
    """The balance of a scene over a cycle; forces are at `rate` [rad/s], or at 1 rad/s if no rate is known.

    is_resolved: whether the nodes resolve all numbers
    reference_point (3,) [m]: where moments are taken; place: its name
    orders: by quantity (force, moment, torque)
    mean_error: errors of the means
    shown_orders: orders shown in tables; are_orders_requested: whether the user chose them
    """

    title: str
    spec: Mapping[str, str]
    coordinate: str
    turns: int
    rate: float | None
    samples: int
    is_resolved: bool
    reference_point: Array
    place: str
    axis: Array | None
    effects: MassEffects
    orders: Mapping[str, tuple[OrderRow, ...]]
    summaries: Mapping[str, str]
    mean: Mapping[str, Any]
    mean_error: Mapping[str, float]
    residual: Mapping[str, Residual]
    shown_orders: tuple[float, ...]
    are_orders_requested: bool = False
    notes: tuple[str, ...] = ()
    counterbalance: Counterbalance | None = None
    flywheel: Flywheel | None = None
    period: Period | None = None


UNITS = {"force": "N", "moment": "N·m", "torque": "N·m", "load": "N·m"}
UNITS_PER_RATE = {
    "force": "kg·m",
    "moment": "kg·m²",
    "torque": "kg·m²",
    "load": "N·m",
}  # at 1 rad/s, if no rate is known
UNIT_RATE_TEXT = "at 1 rad/s (loads grow with its square; in kg·m)"
RPM = 30.0 / math.pi


def format_cycle(results: BalanceResults) -> str:
    """Describe the cycle in words."""
    if results.period is not None:
        period = results.period
        difference = f"the previous period differs by {period.relative_difference:.1g} of the mean"
        return f"the last {period.seconds:.6g} s of the motion, {results.samples} samples; order k is k/T; {difference}"
    turns = "one revolution" if results.turns == 1 else "two revolutions"
    rate = f"at {results.rate:.6g} rad/s ({results.rate * RPM:.6g} rpm)" if results.rate is not None else UNIT_RATE_TEXT
    return f"{turns} of {results.coordinate} {rate}, {results.samples} angles"


def get_unit(results: BalanceResults, quantity: str) -> str:
    """Return the unit of a quantity's amplitudes."""
    return (UNITS if results.rate is not None else UNITS_PER_RATE)[quantity]


def format_reference_point(results: BalanceResults) -> str:
    """Describe the point about which moments are taken."""
    x, y, z = (f"{value:.6g}" for value in results.reference_point + 0.0)
    return (
        f"{results.place or 'O' if results.place or not results.reference_point.any() else 'the point'} = "
        f"({x}, {y}, {z}) m"
    )


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
