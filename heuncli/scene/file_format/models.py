"""A scene as it was meant: frozen, all numbers SI, all references known to lead somewhere.

What spec.load returns and the rest of the program reads. Vectors are tuples of three floats, matrices three rows of
them; "in time" values are expressions. None is what was left out. A joint's, force's or section's axes and points are
in the body axes that manual/format.md names. Keeps clear of pydantic and YAML, so that the numeric part may know these
types; named tuples, because they are made faster at the start than dataclasses.
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
from heuncli.scene.file_format.ends import End as End
from heuncli.scene.file_format.ends import Vec as Vec

if TYPE_CHECKING:
    from heuncli.scene.expressions.paths import Path
    from heuncli.scene.meshes.model import TriangleMesh

Matrix = tuple[Vec, Vec, Vec]
Vector = tuple[Expression, Expression, Expression]
Frame = Literal["world", "body"]
Coordinate = Literal["angle", "travel", "length"]
Ref = TypeVar("Ref")  # what a body or joint is called by: its name, or its number
V = TypeVar("V")  # a vector
M = TypeVar("M")  # a matrix
ZERO: Vec = (0.0, 0.0, 0.0)
X: Vec = (1.0, 0.0, 0.0)
Z: Vec = (0.0, 0.0, 1.0)
RIGID: Vec = (math.inf, math.inf, math.inf)  # a stiffness that is not given
NOWHERE: Mapping[str, SourceLocation] = MappingProxyType({})
NO_CASES: Mapping[str, str] = MappingProxyType({})
NO_COUPLINGS: Mapping[str, Coupling] = MappingProxyType({})


class Ground(NamedTuple):
    """The foundation and its points, in world axes."""

    points: Mapping[str, Vec]


class Shape(NamedTuple):
    """A part of a body: one of mass, density, line_density is given; of the measures those its type has.

    A mesh stands in the units and axes of its file: a corner x is at + rotation (scale x) [m].
    """

    type: Literal["rod", "cylinder", "cone", "box", "sphere", "point", "mesh"]
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


@record
class Directed(Generic[V]):
    """A vector in world axes, or in the body's own."""

    vector: V
    in_body: bool


class MassProperties(NamedTuple):
    """Mass properties of what a cut separates: mass [kg], centre of mass [m], inertia about it, body axes."""

    mass: float
    center: Vec
    inertia: Matrix


@record
class Body(Generic[V, M]):
    """A rigid body: mass [kg], centre of mass [m], inertia about it [kg m2], body axes; what of its start is held.

    rotation takes components in body axes to world axes. position and velocity are those of the body's origin.
    near_position, near_rotation: where the assembly starts to look, not held. shapes: what the body is built from
    instead; then mass, center and inertia are zero until multibody/mechanism/build.py has summed the shapes up.
    """

    name: str
    mass: float
    center: V
    inertia: M
    points: Mapping[str, V]
    position: V | None
    rotation: M | None
    velocity: Directed[V] | None
    angular_velocity: Directed[V] | None
    near_position: V | None
    near_rotation: M | None
    shapes: tuple[Shape, ...] | None = None


@record
class Drive:
    """A coordinate of a joint prescribed in time: angle [rad], travel [m] or length [m]; joint: its name.

    by_rate: the value is the coordinate's rate of change. from_start: the value is what is added to the coordinate
    since t = 0, whose start the assembly is yet to find; the integral of a rate is. zero_assembled: the coordinate is
    counted from the assembled start.
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
        """Whether the value is to be added to what the coordinate is at the assembled start.

        An angle counted from there is zero there; a travel is zero where the points are level.
        """
        return self.from_start or (self.zero_assembled and self.quantity == "travel")


@record
class Joint(Generic[Ref, V]):
    """A joint between the point p of body a ("from") and the point q of body b ("to"), each in its body's axes.

    kind: a name of joint_kinds.TYPES; in a mechanism of joint_kinds.JOINTS, what it is in the plane if that was
    declared. axis: direction in a's axes (of `plane` the normal), z where the kind has none; to_axis: direction in b's
    axes, the same components unless `to_axis_given`. As written in a spec, of unit length in a mechanism.
    Held start values of the coordinates are None where left out: angle [rad], rate [rad/s], travel [m], speed [m/s].
    length: of a rod [m], None = as assembled. stiffness: what shares out redundant reactions, of force [N/m] and moment
    [N m/rad] along the world's axes at the start, infinite where not given. drive: in a mechanism; a spec lists its
    drives by themselves. restitution: of a rope that goes slack and catches, or what flies off a path and strikes it;
    None: the run ends where it would push, or pull. one_sided: of a path, which only pushes, to its left.
    bearing: of its bearing diameter times width [m^2]. p_name, q_name: of the two points, where they have names. path:
    of a curve, from the point p on, a's axes; way: in a mechanism, its number among those along paths.
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
    way: int = -1
    one_sided: bool = False

    @property
    def opens(self) -> bool:
        """Whether it may open: a rope, or a path that only pushes."""
        return self.tension_only or self.one_sided


class PointForce(NamedTuple):
    """A force at a point of a body [N]."""

    on: End
    vector: Vector
    frame: Frame = "world"
    type: Literal["force"] = "force"


class Couple(NamedTuple):
    """A couple on a body [N m]; on is the point where it enters, if one was named."""

    body: str
    on: End | None
    vector: Vector
    frame: Frame = "world"
    type: Literal["couple"] = "couple"


class Torque(NamedTuple):
    """A torque about a pin's axis [N m] or a thrust along a slide [N], on `to`, opposite on `from`."""

    joint: str
    value: Expression
    type: Literal["torque"] = "torque"


class Actuator(NamedTuple):
    """A force along the line between two points [N], positive pushes apart."""

    from_: End
    to: End
    value: Expression
    type: Literal["actuator"] = "actuator"


class Spring(NamedTuple):
    """A spring and damper between two points: N/m, free length [m], N s/m; or its force [N], positive pushes apart."""

    from_: End
    to: End
    stiffness: float
    length: float
    damping: float = 0.0
    force: Expression | None = None
    type: Literal["spring"] = "spring"


class TurnSpring(NamedTuple):
    """A spring and damper about a joint's axis: N m/rad, relaxed angle [rad], N m s; or its torque [N m]."""

    joint: str
    stiffness: float
    angle: float
    damping: float = 0.0
    torque: Expression | None = None
    type: Literal["turn_spring"] = "turn_spring"


class Distributed(NamedTuple):
    """A force along a line of a body, N/m: `vector` at from_, `to_vector` at to, linear between."""

    body: str
    from_: Vec
    to: Vec
    vector: Vector
    to_vector: Vector
    frame: Frame = "world"
    type: Literal["distributed"] = "distributed"


@record
class Elastic(Generic[V]):
    """Three springs and dampers of a bushing, of its shift or of its turn, along its axes.

    stiffness [N/m] or [N m/rad], damping [N s/m] or [N m s]; preload [N] or [N m]; given: what it exerts beside the
    stiffness: the preload, and in place of a stiffness a table of the deflection, which has its areas.
    """

    stiffness: V
    damping: V
    preload: V
    given: Vector


class Bushing(NamedTuple):
    """Six springs and dampers between two bodies, in axes fixed in that of from_; to_rotation: in that of `to`."""

    from_: End
    to: End
    shift: Elastic[Vec]
    turn: Elastic[Vec]
    rotation: Matrix
    to_rotation: Matrix
    type: Literal["bushing"] = "bushing"


class Motor(NamedTuple):
    """A motor in a joint: torque ON `to` [N m], opposite on `from`, by the joint's rate."""

    joint: str
    value: Expression
    type: Literal["motor"] = "motor"


class Damper(NamedTuple):
    """Resistance of a joint: coefficient N m s (turning) or N s/m (slide, line, plane); sliding N s/m (cylinder).

    Or its torque [N m] or force [N] ON `to`, by the joint's rate.
    """

    joint: str
    coefficient: float
    sliding: float | None = None
    law: Expression | None = None
    type: Literal["damper"] = "damper"


class Friction(NamedTuple):
    """Coulomb friction in a joint, torque [N m] or force [N], in time, times tanh(rate/speed).

    Or coefficient: of what presses, the joint's own force; about a pin at a radius [m]. length [m]: of a guide at whose
    two ends it presses.
    """

    joint: str
    torque: Expression | None
    force: Expression | None
    speed: float
    coefficient: float | None = None
    radius: float | None = None
    length: float | None = None
    type: Literal["friction"] = "friction"


Force = (
    PointForce | Couple | Torque | Actuator | Spring | TurnSpring | Distributed | Damper | Friction | Motor | Bushing
)


@record
class Blow(Generic[Ref, V]):
    """An impulse [N s] at a body's point at one instant [s], or an impulsive couple [N m s] on it.

    when: the condition at which it strikes, in place of an instant: the first time that it becomes true, or every time.

    in_body: the vector is in the body's axes. Of a couple point is where it enters, which a cut asks for, or None.
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
    """What of a latch its stop does not tell: where it catches, from when on, and when it lets go.

    at: the coordinate at which it catches [rad] or [m]; stop: else at the limits of that stop which are told by their
    sides (-1 the lower, 1 the upper); neither: wherever the coordinate is. when: only while this is true, None: always;
    release: lets go, and does not catch, while this is true, None: never; every: again, after it was released.
    passes: that the coordinate is beyond `at`, so that a motion through it is met.
    """

    at: float | None
    stop: str | None
    sides: tuple[int, ...]
    when: Condition | None
    release: Condition | None
    passes: Condition | None
    every: bool

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """What it hangs on."""
        return tuple(c for c in (self.when, self.release, self.passes) if c is not None)


@record
class Stop(Generic[Ref]):
    """Limits of a joint's coordinate [rad] or [m], None where there is none; restitution: of its strikes, 0 to 1.

    latch: what holds the coordinate both ways, without limits of its own.
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
        """Where it stands in a spec."""
        return f"{'stops' if self.latch is None else 'latches'}.{self.name}"


class Properties(NamedTuple):
    """Of a section's shape, for stresses: SI values by name.

    circle: radius; tube: radius, inner_radius; rectangle: width (along e1), height (along e2); general: area, I1, I2,
    J, c1, c2 (half extents along e1, e2), and, where it is known, shear_factor; auto: those of the shapes that are cut.
    """

    kind: Literal["circle", "tube", "rectangle", "general", "auto"]
    values: Mapping[str, float]


@record
class Section:
    """A cut (`at`), or a run of `count` cuts from `from_` to `to`, all in body axes; normal is given or from -> to."""

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
    piece: MassProperties | None = None


class Condition(NamedTuple):
    """What is watched for during a motion: true or not (1 or 0), in time and coordinates; text: as written.

    ends: whether the motion ends where it becomes true.
    """

    name: str
    text: str
    ends: bool
    value: Expression


class ResultCondition(NamedTuple):
    """What is watched for in the results: the number at the path `of` is below the limit, or above it.

    text: as written. ends: whether the motion ends where it becomes true. why: of one that an entry brings with it, as
    wheels do, what it then means, in words. given: what of the entry is too small by as much as the number passes the
    limit; {} in the words is what it would have to be at least.
    """

    name: str
    text: str
    ends: bool
    of: str
    limit: float
    above: bool
    why: str = ""
    given: float | None = None


WatchedCondition = Condition | ResultCondition


ImpactModel = Literal["simultaneous", "sequential"]
SIMULTANEOUS: ImpactModel = "simultaneous"


class Analysis(NamedTuple):
    """What is solved: times are the instants asked for [s]; duration is the last of them in a motion.

    step is for methods of fixed step. tolerance_given: whether somebody asked for it, or it is the default. impacts:
    how a blow goes through several contacts that touch.
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


class Foundation(NamedTuple):
    """About which point M_s is taken, world axes; None is the origin."""

    about: Vec | None


class Curve(NamedTuple):
    """A measured curve: points x, y (n,) in SI, of the lines of a file; x is time, or the number at a path (x_of).

    within: the share of the points that must lie within the tolerance.
    """

    file: str
    x: array[float]
    y: array[float]
    lines: array[int]
    x_of: str | None
    within: float


class Expect(NamedTuple):
    """One expectation: the value found at `of` is `is_` (None: must be open) within rel and abs, or within bounds, or
    follows a curve within rel and abs."""

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
        """The paths into the results that it needs."""
        return (self.of,) if self.curve is None or self.curve.x_of is None else (self.of, self.curve.x_of)


class Spec(NamedTuple):
    """A validated scene. `location("joints.elbow")`: where in the file a value stands, for errors of later stages.

    cases: the titles of the load cases by their names; case: the one whose values hold; expect: what holds in it.
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
    impulses: Mapping[str, Blow[str, Vec]]
    stops: Mapping[str, Stop[str]]
    latches: Mapping[str, Stop[str]]
    sections: Mapping[str, Section]
    tables: Mapping[str, TableFunction]
    analysis: Analysis
    report: tuple[str, ...] | None
    foundation: Foundation
    expect: tuple[Expect, ...]
    warnings: tuple[Problem, ...]
    locations: Mapping[str, SourceLocation] = NOWHERE
    cases: Mapping[str, str] = NO_CASES
    case: str | None = None
    couplings: Mapping[str, Coupling] = NO_COUPLINGS

    @property
    def rolling(self) -> Mapping[str, RollingWheel]:
        """The couplings that are wheels, which stand in a block of their own."""
        return {name: given for name, given in self.couplings.items() if isinstance(given, RollingWheel)}

    def location(self, path: str) -> SourceLocation:
        """Where a dotted path stands, or the nearest thing around it that does."""
        while path and path not in self.locations:
            path = path.rpartition(".")[0]
        return self.locations.get(path) or SourceLocation(self.path, 1, 1)
