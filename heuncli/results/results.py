"""Results of a run: the JSON of manual/results.md, with arrays in place of lists.

Arrays are float64 with the instants first: (n_t,), (n_t, 3), (n_t, 3, 3); series of cuts (n_t, n_cuts). `nan` in an
array means that rigid-body mechanics leaves the component indeterminate (`null` in JSON). A block that does not apply,
or was not requested, is absent (an empty dict or None). This module does not depend on where the numbers come from.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, NotRequired, TypedDict

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


class DeterminateSum(TypedDict):
    """A determinate sum of indeterminate components, each times its factor: (n_t,); a factor is a number, or one per
    instant.
    """

    terms: Mapping[str, float | Array]
    value: Array
    unit: NotRequired[str]  # of frictions that stick as one, at their leader


class ErrorEstimate(TypedDict, total=False):
    """Estimated errors over the whole run, by kind: relative to the scene's size, and to the largest of each kind; 0:
    none.
    """

    motion: float
    reactions: float
    drives: float
    foundation: float
    sections: float
    energy: float


class Accuracy(TypedDict, total=False):
    """How accurately the equations are solved.

    horizon: the instant from which on results are not reliable [s], None if there is none
    estimate: the estimated errors, by kind
    unknown: instants near singular poses; numbers that rounding decides are nan there
    """

    energy_drift: float
    constraint_gap: float
    balance_residual: float
    horizon: float | None
    estimate: ErrorEstimate
    unknown: list[float]


class BodyBlock(TypedDict):
    """Motion of a body: its origin, its attitude (columns: its axes), its centre of mass; world axes."""

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

    open: components that are indeterminate at some instant (`force.z`)
    chosen: those that a split determines
    shares: by cause
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
    bearings: Block
    shares: Block


class ForceBlock(TypedDict, total=False):
    """An applied load: its value as in the spec, the length or angle and rate between its ends, and its power."""

    value: Array
    length: Array
    angle: Array
    rate: Array
    power: Array
    reserve: Array
    open: list[str]
    shift: Array
    turn: Array
    force: Array
    moment: Array


class Work(TypedDict, total=False):
    """The effort of the run."""

    kernel: str
    steps: int
    evaluations: int
    seconds: dict[str, float]


@dataclass(frozen=True, eq=False)
class Results:
    """All results of a run; field names and the nesting below them are those of manual/results.md.

    The contents of a block, with shapes and units, are in heuncli/results/results_schema.py.
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
    sensors: Block = field(default_factory=dict)
    stops: Block = field(default_factory=dict)
    couplings: Block = field(default_factory=dict)
    sections: Block = field(default_factory=dict)
    forces: dict[str, ForceBlock] = field(default_factory=dict)
    energy: Block = field(default_factory=dict)
    momentum: Block = field(default_factory=dict)
    system_vector: Block = field(default_factory=dict)
    impulses: list[Block] = field(default_factory=list)
    events: Block = field(default_factory=dict)
    certain_sums: list[DeterminateSum] = field(default_factory=list)
    accuracy: Accuracy = field(default_factory=Accuracy)
    work: Work = field(default_factory=Work)
    labels: dict[str, str] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    @property
    def horizon(self) -> float | None:
        """The first instant [s] from which on results are not reliable; None if there is none."""
        return self.accuracy.get("horizon")

    def relative_error(self, kind: str) -> float:
        """Return the estimated error of a kind, relative to its largest value, up to the horizon; at least that of
        rounding.
        """
        error = self.accuracy.get("estimate", ErrorEstimate()).get(kind)
        if not isinstance(error, float) or not math.isfinite(error):
            return tolerances.WRITTEN
        if self.horizon is not None:
            error = min(error, tolerances.CLAIMED)
        return max(error, tolerances.WRITTEN)

    def position_errors(self, size: float) -> dict[tuple[str, str], float]:
        """Return the errors of positions and angles by kind and unit, in a scene of a size [m]; large angles have
        larger errors.
        """
        blocks = (*self.coordinates.values(), *self.forces.values())
        angles = [np.abs(np.asarray(block["angle"])) for block in blocks if "angle" in block]
        largest_angle = max((float(a.max(initial=0.0, where=np.isfinite(a))) for a in angles), default=0.0)
        relative = self.relative_error("motion")
        if self.horizon is not None and self.time[0] >= self.horizon:
            relative = math.inf
        return {("motion", "m"): relative * size, ("motion", "rad"): relative * max(largest_angle, 1.0)}


# A cut in whose plane something acts is just before it, so that it is part of the piece, or just beyond it.
BEFORE, BEYOND = 1.0, -1.0
SIDE_WORDS: Mapping[float, str | None] = MappingProxyType({BEFORE: "before", BEYOND: "beyond", 0.0: None})
SIDE_SIGNS: Mapping[str | None, float] = MappingProxyType({word: sign for sign, word in SIDE_WORDS.items()})


class CutPosition(NamedTuple):
    """A position in a series of cuts: distance s [m], whether it is just before or just beyond what acts there, and the
    index of the requested cut, if it is one.
    """

    s: float
    side: str | None
    cut: int | None


NOWHERE = CutPosition(math.nan, None, None)


class Extremes(NamedTuple):
    """Lowest and highest value of each of n groups of columns over a run, (n,), with the instant and the column.

    is_searched: whether the instants between the samples were searched
    is_complete: whether all promising ones were
    places: of the lowest and highest of each group that runs along a body; empty if none does
    paths: of the groups, where they are channels of the results

    A group that is nan throughout stays nan.
    """

    low: Array
    low_at: Array
    low_column: Indices
    high: Array
    high_at: Array
    high_column: Indices
    is_searched: bool
    is_complete: bool = True
    places: tuple[tuple[CutPosition, CutPosition], ...] = ()
    paths: tuple[str, ...] = ()

    def select(self, groups: slice | Indices) -> Extremes:
        """Return the extremes of some groups."""
        chosen = np.arange(len(self.low))[groups].tolist()
        places = tuple(self.places[k] for k in chosen) if self.places else ()
        paths = tuple(self.paths[k] for k in chosen) if self.paths else ()
        return Extremes(
            self.low[groups], self.low_at[groups], self.low_column[groups],
            self.high[groups], self.high_at[groups], self.high_column[groups],
            self.is_searched, self.is_complete, places, paths,
        )  # fmt: skip

    def find(self, paths: Sequence[str]) -> Extremes:
        """Return the extremes of the channels at some paths, in their order."""
        index = {path: k for k, path in enumerate(self.paths)}
        return self.select(np.array([index[path] for path in paths], dtype=np.intp))

    def join(self, other: Extremes) -> Extremes:
        """Return the extremes of both, those of the other channels last."""
        low, low_at, low_column, high, high_at, high_column = (
            np.concatenate(both) for both in zip(self[:6], other[:6], strict=True)
        )
        places = (*self.all_places, *other.all_places) if self.places or other.places else ()
        return Extremes(
            low, low_at, low_column, high, high_at, high_column,
            self.is_searched, self.is_complete, places, (*self.paths, *other.paths),
        )  # fmt: skip

    @property
    def all_places(self) -> tuple[tuple[CutPosition, CutPosition], ...]:
        """The places of all groups, NOWHERE for those that do not run along a body."""
        return self.places or ((NOWHERE, NOWHERE),) * len(self.low)


class Magnitudes(NamedTuple):
    """The largest terms over a run, by unit, from which its numbers are summed; size and reach [m] of the scene.

    A number far below that of its unit is rounding of the sum, or of a difference.

    errors: estimated by a check run, by kind (of `accuracy.estimate`) and unit
    """

    by_unit: Mapping[str, float]
    size: float
    reach: float
    errors: Mapping[tuple[str, str], float]

    def rounding_errors(self) -> dict[str, float]:
        """Return the rounding error, by unit; far from the origin positions, and so levers, have fewer digits."""
        errors = {unit: tolerances.WRITTEN * scale for unit, scale in self.by_unit.items()}
        position_rounding = tolerances.GAP_ROUNDING * self.reach
        levers = {"N·m": "N", "N·m·s": "N·s"}
        far_moments = {
            unit: max(errors[unit], position_rounding * self.by_unit[force])
            for unit, force in levers.items()
            if unit in errors
        }
        return errors | {"m": max(errors["m"], position_rounding)} | far_moments
