"""Results of a run: the JSON of manual/results.md, with arrays in place of lists.

Arrays are float64 and run over the instants first: (n_t,), (n_t, 3), (n_t, 3, 3); runs of cuts (n_t, n_cuts).
`nan` in an array means that the laws of rigid bodies leave the component open (`null` in JSON). A block that does not
apply, or was not asked for, is absent (an empty dict or None). Knows nothing of where numbers come from.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, TypedDict

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple

Array = np.ndarray[tuple[Any, ...], np.dtype[np.float64]]  # the NDArray of numpy.typing, which takes 1 ms
Mask = np.ndarray[tuple[Any, ...], np.dtype[np.bool_]]
Indices = np.ndarray[tuple[Any, ...], np.dtype[np.intp]]
Block = dict[str, Any]


class Status(TypedDict):
    """How the run ended: completed or stopped, and a sentence."""

    code: str
    message: str


class CertainSum(TypedDict):
    """A sum of open components, each by its factor, which is known: (n_t,); a factor is a number, or one an instant."""

    terms: Mapping[str, float | Array]
    value: Array


class Estimate(TypedDict, total=False):
    """Estimated errors over the whole run, by kind: of the scene's size, and of the largest of each kind; 0: none."""

    motion: float
    reactions: float
    drives: float
    foundation: float
    sections: float
    energy: float


class Accuracy(TypedDict, total=False):
    """How well the equations are solved; horizon: None where there is none.

    unknown: instants beside singular poses at which rounding reaches some numbers, which are nan there.
    """

    energy_drift: float
    constraint_gap: float
    balance_residual: float
    horizon: float | None
    estimate: Estimate
    unknown: list[float]


class BodyBlock(TypedDict):
    """Motion of a body: of its origin, its attitude (columns: its axes), its centre of mass; world axes."""

    position: Array
    velocity: Array
    rotation: Array
    quaternion: Array
    center: Array
    center_velocity: Array
    center_acceleration: Array
    angular_velocity: Array
    angular_acceleration: Array
    rodrigues: Array
    momentum: Array
    moment_of_momentum: Array


class JointBlock(TypedDict, total=False):
    """Reaction of a joint ON `to`, moment about `point`; axial, radial, tilting where it has an axis.

    open: components that are open at some instant (`force.z`); chosen: those that a split gives. shares: by cause.
    """

    point: Array
    force: Array
    moment: Array
    open: list[str]
    chosen: list[str]
    drive: Array
    axial: Array
    radial: Array
    tilting: Array
    tension: Array
    torque: Array
    pressure: Array
    contact_point: Array
    shares: Block


class ForceBlock(TypedDict, total=False):
    """An applied load: its value as in the spec, length or angle and rate of what it acts between, power put in."""

    value: Array
    length: Array
    angle: Array
    rate: Array
    power: Array
    shift: Array
    turn: Array
    force: Array
    moment: Array


class Work(TypedDict, total=False):
    """What the run took."""

    kernel: str
    steps: int
    evaluations: int
    seconds: dict[str, float]


@dataclass(frozen=True, eq=False)
class Results:
    """Everything a run reports; field names and the nesting below them are those of manual/results.md.

    What stands in a block, in which shape and unit, says heuncli/results/results_schema.py.
    """

    title: str
    spec: Block
    version: str
    model: Block
    status: Status
    time: Array
    bodies: dict[str, BodyBlock] = field(default_factory=dict)
    points: Block = field(default_factory=dict)
    coordinates: Block = field(default_factory=dict)
    foundation: Block = field(default_factory=dict)
    joints: dict[str, JointBlock] = field(default_factory=dict)
    stops: Block = field(default_factory=dict)
    couplings: Block = field(default_factory=dict)
    sections: Block = field(default_factory=dict)
    forces: dict[str, ForceBlock] = field(default_factory=dict)
    energy: Block = field(default_factory=dict)
    momentum: Block = field(default_factory=dict)
    system_vector: Block = field(default_factory=dict)
    impulses: list[Block] = field(default_factory=list)
    events: Block = field(default_factory=dict)
    certain_sums: list[CertainSum] = field(default_factory=list)
    accuracy: Accuracy = field(default_factory=Accuracy)
    work: Work = field(default_factory=Work)
    warnings: tuple[str, ...] = ()

    @property
    def horizon(self) -> float | None:
        """The first instant [s] from which on nothing is claimed; None where there is none."""
        return self.accuracy.get("horizon")

    def relative_error(self, kind: str) -> float:
        """The estimated error of a kind, of its own largest, up to the horizon; not below that of rounding."""
        error = self.accuracy.get("estimate", Estimate()).get(kind)
        if not isinstance(error, float) or not math.isfinite(error):
            return tolerances.WRITTEN
        if self.horizon is not None:
            error = min(error, tolerances.CLAIMED)
        return max(error, tolerances.WRITTEN)

    def errors_of_places(self, size: float) -> dict[tuple[str, str], float]:
        """The errors of places and angles by kind and unit, in a scene of some size [m]; of large angles of these."""
        blocks = (*self.coordinates.values(), *self.forces.values())
        angles = [np.abs(np.asarray(block["angle"])) for block in blocks if "angle" in block]
        turned = max((float(a.max(initial=0.0, where=np.isfinite(a))) for a in angles), default=0.0)
        relative = self.relative_error("motion")
        if self.horizon is not None and self.time[0] >= self.horizon:
            relative = math.inf
        return {("motion", "m"): relative * size, ("motion", "rad"): relative * max(turned, 1.0)}


class Place(NamedTuple):
    """A place in a run of cuts: distance s [m], side of what acts there, and which of the asked cuts it is, if any."""

    s: float
    side: str | None
    cut: int | None


class Extremes(NamedTuple):
    """Lowest and highest value of each of n groups of columns over a run, (n,), with the instant and the column.

    `searched`: whether the instants between the samples were looked at, `complete`: all that promised more. A group
    that is nan throughout stays nan. places: of the lowest and highest of each run of cuts, the last groups.
    """

    low: Array
    low_at: Array
    low_column: Indices
    high: Array
    high_at: Array
    high_column: Indices
    searched: bool
    complete: bool = True
    places: tuple[tuple[Place, Place], ...] = ()

    def part(self, groups: slice) -> Extremes:
        """Those of some of the groups."""
        return Extremes(
            self.low[groups], self.low_at[groups], self.low_column[groups],
            self.high[groups], self.high_at[groups], self.high_column[groups], self.searched, self.complete,
        )  # fmt: skip


class Magnitudes(NamedTuple):
    """The largest over a run, by unit, of what its numbers are summed from; size and reach [m] of the scene.

    A number far below its unit's is rounding of the sum, or of a difference. errors: estimated by a check run, by kind
    (of `accuracy.estimate`) and unit.
    """

    by_unit: Mapping[str, float]
    size: float
    reach: float
    errors: Mapping[tuple[str, str], float]

    def lost(self) -> dict[str, float]:
        """What is lost by rounding, by unit; far from the origin places, and so levers, have fewer digits."""
        lost = {unit: tolerances.WRITTEN * scale for unit, scale in self.by_unit.items()}
        far = tolerances.GAP_ROUNDING * self.reach
        levers = {"N·m": "N", "N·m·s": "N·s"}
        far_moments = {unit: max(lost[unit], far * self.by_unit[on]) for unit, on in levers.items() if unit in lost}
        return lost | {"m": max(lost["m"], far)} | far_moments
