"""A validated scene: frozen records, all numbers in SI, all references resolved.

`load` returns these records and the rest of the program reads them. Vectors are tuples of three floats, matrices three
rows of them; values in time are expressions. None marks what the spec leaves out. Axes and points of a joint, load or
section are in the body axes that manual/format.md names. Free of pydantic and YAML, so that the numeric modules may
import these types; named tuples, because they are created faster at start-up than dataclasses.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Generic, Literal, TypeVar

from heuncli.base.errors import Problem, SourceLocation
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.scene.expressions.programs import Expression, TableFunction
from heuncli.scene.file_format.couplings import Coupling, RollingWheel
from heuncli.scene.file_format.couplings import End as End
from heuncli.scene.file_format.couplings import Vec as Vec
from heuncli.scene.file_format.labels import NO_LABELS
from heuncli.scene.file_format.loads import (
    Actuator,
    Bushing,
    Couple,
    Damper,
    Distributed,
    Friction,
    Matrix,
    PointForce,
    Spring,
    Torque,
    TurnSpring,
    V,
)
from heuncli.scene.file_format.profiles import Family, Measures

if TYPE_CHECKING:
    from heuncli.scene.expressions.paths import Path
    from heuncli.scene.meshes.model import TriangleMesh

Coordinate = Literal["angle", "travel", "length"]
Ref = TypeVar("Ref")  # reference to a body or joint: its name or its index
M = TypeVar("M")  # a matrix
ZERO: Vec = (0.0, 0.0, 0.0)
X: Vec = (1.0, 0.0, 0.0)
Z: Vec = (0.0, 0.0, 1.0)
RIGID: Vec = (math.inf, math.inf, math.inf)  # default stiffness
NO_LOCATIONS: Mapping[str, SourceLocation] = MappingProxyType({})
NO_CASES: Mapping[str, str] = MappingProxyType({})
NO_COUPLINGS: Mapping[str, Coupling] = MappingProxyType({})
NO_SENSORS: Mapping[str, Sensor] = MappingProxyType({})


class Ground(NamedTuple):
    """The foundation and its points, in world axes."""

    points: Mapping[str, Vec]


class Member(NamedTuple):
    """A straight member: its measures at its two ends, and the direction of its width, body axes."""

    family: Family
    start: Measures
    end: Measures
    first_axis: Vec | None


class Shape(NamedTuple):
    """A part of a body: one of mass, density and line_density is given, and the dimensions of its type.

    A mesh is in the units and axes of its file: a vertex x of the file is at `at` + rotation (scale x) [m].
    """

    type: Literal["rod", "cylinder", "cone", "box", "sphere", "point", "mesh", "member"]
    mass: float | None = None
    density: float | None = None
    line_density: float | None = None
    from_: Vec | None = None
    to: Vec | None = None
    at: Vec | None = None
    center: Vec | None = None
    size: Vec | None = None
    rotation: Matrix | None = None
    radius: float | None = None
    inner_radius: float | None = None
    to_radius: float | None = None
    scale: float | None = None
    mesh: TriangleMesh | None = None
    member: Member | None = None


@record
class FramedVector(Generic[V]):
    """A vector in world axes, or in the axes of its body."""

    vector: V
    in_body: bool


class MassProperties(NamedTuple):
    """Mass properties of the piece that a cut separates: mass [kg], centre of mass [m], inertia about it; body axes."""

    mass: float
    center: Vec
    inertia: Matrix


@record
class Body(Generic[V, M]):
    """A rigid body and its prescribed start values.

    mass [kg], center [m], inertia [kg m2]: inertia about the centre of mass; body axes
    position, velocity: of the body's origin
    rotation: takes components in body axes to world axes
    near_position, near_rotation: where the assembly starts its search; not prescribed
    shapes: instead; then mass, center, inertia are zero until multibody/mechanism/build.py has summed the shapes
    """

    name: str
    mass: float
    center: V
    inertia: M
    points: Mapping[str, V]
    position: V | None
    rotation: M | None
    velocity: FramedVector[V] | None
    angular_velocity: FramedVector[V] | None
    near_position: V | None
    near_rotation: M | None
    shapes: tuple[Shape, ...] | None = None


@record
class Drive:
    """A coordinate of a joint prescribed in time: angle [rad], travel [m] or length [m].

    joint: name of the joint
    by_rate: the value is the coordinate's rate of change
    from_start: the value is added to the coordinate at t = 0, which the assembly finds; so is the integral of a rate
    zero_assembled: the coordinate is counted from the assembled pose
    """

    name: str
    joint: str
    quantity: Coordinate
    value: Expression
    zero_assembled: bool = False
    by_rate: bool = False
    from_start: bool = False

    @property
    def adds_to_start(self) -> bool:
        """Whether the value is added to the coordinate of the assembled pose.

        An angle counted from that pose is zero there; a travel is zero where the two points are level.
        """
        return self.from_start or (self.zero_assembled and self.quantity == "travel")


class BearingPair(NamedTuple):
    """Two bearings of a joint, at distances from its `to` point along its axis [m], fixed in `to`.

    axial: which of them carries the force along the axis, 0 or 1; None: indeterminate
    """

    at: tuple[float, float]
    axial: int | None = None


@record
class Joint(Generic[Ref, V]):
    """A joint between the point p of body a ("from") and the point q of body b ("to"), each in the axes of its body.

    kind: a name of joint_kinds.TYPES; in a mechanism of joint_kinds.JOINTS (the planar kind in a planar scene)
    axis: direction in a's axes (of a `plane` the normal), z if the kind has none; in a mechanism of unit length
    to_axis: direction in b's axes, with the same components unless `to_axis_given`
    angle, rate, travel, speed: prescribed start values [rad], [rad/s], [m], [m/s], or None
    length: of a rod [m]; None: as assembled
    stiffness: of force [N/m] and moment [N m/rad] along world axes at the start; distributes redundant reactions
    drive: only in a mechanism; a spec lists its drives separately
    restitution: of a rope that catches, or a point that hits its path again; None: the run ends where it would open
    one_sided: the path only pushes, to its left
    bearing: bearing diameter times width [m^2]
    bearings: the two bearings that carry its loads, or None
    p_name, q_name: names of the two points, if they have any
    path: of a curve joint, from the point p, in a's axes
    path_index: in a mechanism, the index of the joint among those with a path, else -1
    """

    name: str
    kind: str
    a: Ref
    p: V
    b: Ref
    q: V
    axis: V
    to_axis: V
    to_axis_given: bool
    angle: float | None
    rate: float | None
    travel: float | None
    speed: float | None
    length: float | None
    tension_only: bool
    stiffness: tuple[V, V] | None
    drive: Drive | None
    restitution: float | None = None
    bearing: float | None = None
    p_name: str | None = None
    q_name: str | None = None
    path: Path | None = None
    path_index: int = -1
    one_sided: bool = False
    bearings: BearingPair | None = None

    @property
    def can_open(self) -> bool:
        """Whether the joint may open: a rope, or a path that only pushes."""
        return self.tension_only or self.one_sided


PairForce = Actuator | Spring | Bushing  # between two points or bodies
JointForce = Torque | TurnSpring | Damper | Friction
Force = PointForce | Couple | Distributed | PairForce | JointForce


@record
class AppliedImpulse(Generic[Ref, V]):
    """An impulse [N s] at a point of a body at one instant [s], or an impulsive couple [N m s] on a body.

    time: the instant [s], if `when` is None
    when: it acts the first time that this becomes true, or every time if `every`
    in_body: the vector is in the body's axes
    point: of a couple the point of application, which only section forces need, or None
    """

    name: str
    body: Ref
    point: V | None
    vector: V
    in_body: bool
    time: float
    kind: Literal["impulse", "couple"] = "impulse"
    when: Condition | None = None
    every: bool = False


@record
class Latch:
    """The properties of a latch beyond those of a stop: where it catches, when it is active, when it lets go.

    position: coordinate at which it catches [rad] or [m]
    stop, sides: else at these limits of a stop (-1 lower, 1 upper); without both it catches at any coordinate
    when: it only catches while this is true; None: always
    release: it lets go, and does not catch, while this is true; None: never
    passes: the coordinate is above `position`; detects a motion through it
    every: it catches again after it was released
    """

    position: float | None
    stop: str | None
    sides: tuple[int, ...]
    when: Condition | None
    release: Condition | None
    passes: Condition | None
    every: bool

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """The conditions that the latch depends on."""
        return tuple(c for c in (self.when, self.release, self.passes) if c is not None)


@record
class Stop(Generic[Ref]):
    """Limits of a joint's coordinate [rad] or [m]; None: no limit on that side.

    restitution: of its impacts, 0 to 1
    latch: holds the coordinate in both directions; such a stop has no limits of its own
    """

    name: str
    joint: Ref
    quantity: Coordinate
    low: float | None
    high: float | None
    restitution: float = 0.0
    latch: Latch | None = None

    @property
    def path(self) -> str:
        """Its path in the spec."""
        return f"{'stops' if self.latch is None else 'latches'}.{self.name}"


class Properties(NamedTuple):
    """Properties of a cross-section, for stresses: SI values by name.

    circle: radius; tube: radius, inner_radius; rectangle: width (along e1), height (along e2); general: area, I1, I2,
    J, c1, c2 (half extents along e1, e2) and, if known, shear_factor; auto: those of the shapes that are cut; I, C, L,
    T, box: the measures of a member, width along e1, height along e2
    """

    kind: Literal["circle", "tube", "rectangle", "general", "auto", "I", "C", "L", "T", "box"]
    values: Mapping[str, float]


class BeamTheory(NamedTuple):
    """How the deflection of a run of cuts is computed.

    modulus: Young's modulus [Pa]
    reference: where the deflection is zero: at both ends (chord), or with its slope at the start or the end
    length_factor: buckling length over the length of the run
    """

    modulus: float
    reference: Literal["chord", "start", "end"] = "chord"
    length_factor: float = 1.0


@record
class Section:
    """A cut (`at`), or a run of `count` cuts from `from_` to `to`, in body axes; the normal is given or points from ->
    to.
    """

    body: str
    normal: Vec
    at: Vec | None = None
    from_: Vec | None = None
    to: Vec | None = None
    count: int = 1
    first_axis: Vec | None = None
    reduce_to: Literal["at", "centroid", "line"] | End = "at"
    side: Literal["before", "beyond"] | None = None
    properties: Properties | None = None
    strength: float | None = None
    beam_theory: BeamTheory | None = None
    piece: MassProperties | None = None


class Condition(NamedTuple):
    """A condition on time and coordinates that is monitored during a motion; its value is 1 (true) or 0.

    text: as written
    ends: whether the motion ends where the condition becomes true
    """

    name: str
    text: str
    ends: bool
    value: Expression


class ResultCondition(NamedTuple):
    """A condition on a result that is monitored during a motion: the number at the path `of` is below or above the
    limit.

    text: as written
    ends: whether the motion ends where the condition becomes true
    is_above: the number is above the limit, else below
    why: what it means, in words, for a condition that an entry such as a wheel brings with it
    entry_value: value of that entry that is too small by the excess over the limit; {} in `why` is the value needed
    """

    name: str
    text: str
    ends: bool
    of: str
    limit: float
    is_above: bool
    why: str = ""
    entry_value: float | None = None


WatchedCondition = Condition | ResultCondition


ImpactModel = Literal["simultaneous", "sequential"]
SIMULTANEOUS: ImpactModel = "simultaneous"


class Analysis(NamedTuple):
    """What is solved.

    times: the output instants [s]
    duration: the last of them in a motion
    step: step size of methods with a fixed step [s]
    tolerance_given: whether the user gave the tolerance, or it is the default
    impacts: how an impulse passes through several touching contacts
    start: whether a motion starts as it is drawn (None), at rest under the loads at t = 0, or steady
    """

    type: Literal["motion", "impulse", "state", "rest"]
    times: tuple[float, ...]
    duration: float | None
    tolerance: float
    method: str
    step: float | None
    conditions: tuple[WatchedCondition, ...] = ()
    tolerance_given: bool = False
    impacts: ImpactModel = SIMULTANEOUS
    start: Literal["rest", "steady"] | None = None


class Foundation(NamedTuple):
    """The reference point of M_s, world axes; None is the origin."""

    about: Vec | None


class Curve(NamedTuple):
    """A measured curve: points x, y (n,) in SI and their line numbers in a file; x is time, or the result at the path
    x_of.

    within: share of the points that must lie within the tolerance
    """

    file: str
    x: array[float]
    y: array[float]
    lines: array[int]
    x_of: str | None
    within: float


class Expect(NamedTuple):
    """One expectation: the result at `of` equals `is_` (None: it must be indeterminate) within rel and abs, or lies
    within bounds, or follows a curve within rel and abs.
    """

    of: str
    at: float | None
    peak: Literal["max", "min", "abs"] | None
    is_: float | tuple[object, ...] | None
    rel: float | None
    abs: float | None
    location: SourceLocation
    below: float | None = None
    above: float | None = None
    curve: Curve | None = None

    @property
    def paths(self) -> tuple[str, ...]:
        """The result paths that the expectation needs."""
        return (self.of,) if self.curve is None or self.curve.x_of is None else (self.of, self.curve.x_of)


class Logo(NamedTuple):
    """A picture for the report: its file name, its content, and the media type, image/png or image/svg+xml."""

    name: str
    content: bytes
    media_type: str


class ReportSettings(NamedTuple):
    """What the report of a scene shows besides its results; an empty text shows nothing.

    chapters: names of the chapters in their order, or None for all
    results: the blocks of results to compute, or None for the default
    """

    company: str = ""
    project: str = ""
    author: str = ""
    revision: str = ""
    part: str = ""
    logo: Logo | None = None
    chapters: tuple[str, ...] | None = None
    results: tuple[str, ...] | None = None


class Sensor(NamedTuple):
    """What reads a reaction: that of a joint, or of a single cut.

    point: about which the moment is taken; None: as the joint or section has it
    body: in whose axes; the ground's are the world's
    """

    joint: str | None
    section: str | None
    point: End | None
    body: str


class Spec(NamedTuple):
    """A validated scene.

    labels: texts for readers by paths of the results, such as joints.main or points.crank.pin
    locations: location in the file of every path that later stages may report
    cases: titles of the load cases by name
    case, expect: the load case whose values apply, or None; the expectations that hold in it
    """

    title: str
    path: str
    sha256: str
    space: Literal["auto", "spatial", "planar"]
    parameters: Mapping[str, float]
    gravity: Vec
    ground: Ground
    bodies: Mapping[str, Body[Vec, Matrix]]
    joints: Mapping[str, Joint[str, Vec]]
    drives: Mapping[str, Drive]
    forces: Mapping[str, Force]
    impulses: Mapping[str, AppliedImpulse[str, Vec]]
    stops: Mapping[str, Stop[str]]
    latches: Mapping[str, Stop[str]]
    sections: Mapping[str, Section]
    tables: Mapping[str, TableFunction]
    analysis: Analysis
    report: ReportSettings
    foundation: Foundation
    expect: tuple[Expect, ...]
    warnings: tuple[Problem, ...]
    locations: Mapping[str, SourceLocation] = NO_LOCATIONS
    cases: Mapping[str, str] = NO_CASES
    case: str | None = None
    couplings: Mapping[str, Coupling] = NO_COUPLINGS
    labels: Mapping[str, str] = NO_LABELS
    sensors: Mapping[str, Sensor] = NO_SENSORS

    @property
    def rolling(self) -> Mapping[str, RollingWheel]:
        """The couplings that are wheels; they have a block of their own."""
        return {name: coupling for name, coupling in self.couplings.items() if isinstance(coupling, RollingWheel)}

    def location(self, path: str) -> SourceLocation:
        """Return the location of a dotted path such as joints.elbow, or of the nearest enclosing one."""
        while path and path not in self.locations:
            path = path.rpartition(".")[0]
        return self.locations.get(path) or SourceLocation(self.path, 1, 1)


def format_case_title(title: str, case: str | None, case_titles: Mapping[str, str]) -> str:
    """Return the title of a scene; in a load case extended by the title of the case."""
    if case is None:
        return title
    case_title = case_titles.get(case, "")
    return f"{title} (case {case}{': ' if case_title else ''}{case_title})".strip()
