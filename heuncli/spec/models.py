"""A scene as it was meant: frozen, all numbers SI, all references known to lead somewhere.

What spec.load returns and the rest of the program reads. Vectors are tuples of three floats, matrices three rows of
them; "in time" values are expressions. None is what was left out. A joint's, force's or section's axes and points are
in the body axes that manual/format.md names. Keeps clear of pydantic and YAML, so that the numeric part may know these
types; named tuples, because they are made faster at the start than dataclasses.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal, NamedTuple

from heuncli.errors import Problem, SourceLocation
from heuncli.expressions.programs import Expression, Table
from heuncli.records import record

Vec = tuple[float, float, float]
Matrix = tuple[Vec, Vec, Vec]
Vector = tuple[Expression, Expression, Expression]
Frame = Literal["world", "body"]
NOWHERE: Mapping[str, SourceLocation] = MappingProxyType({})


class End(NamedTuple):
    """A point of a body ("ground" or a body's name), in its axes; name is None for one given by coordinates."""

    body: str
    point: Vec
    name: str | None = None


class Ground(NamedTuple):
    """The foundation and its points, in world axes."""

    points: Mapping[str, Vec]


class Shape(NamedTuple):
    """A part of a body: one of mass, density, line_density is given; of the measures those its type has."""

    type: Literal["rod", "cylinder", "cone", "box", "sphere", "point"]
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


class Directed(NamedTuple):
    """A vector in world axes or in the body's own."""

    vector: Vec
    frame: Frame


class Near(NamedTuple):
    """Where the assembly starts to look; not held."""

    position: Vec | None
    rotation: Matrix | None


class Piece(NamedTuple):
    """Mass properties of what a cut separates: mass [kg], centre of mass [m], inertia about it, body axes."""

    mass: float
    center: Vec
    inertia: Matrix


class Body(NamedTuple):
    """A rigid body: mass, center, inertia (about the centre of mass, deviation merged), or shapes instead of the three.

    rotation takes components in body axes to world axes.
    """

    mass: float | None
    center: Vec | None
    inertia: Matrix | None
    shapes: tuple[Shape, ...] | None
    points: Mapping[str, Vec]
    position: Vec | None = None
    rotation: Matrix | None = None
    near: Near | None = None
    velocity: Directed | None = None
    angular_velocity: Directed | None = None
    piece: Piece | None = None


class Initial(NamedTuple):
    """Held start values of a joint's coordinates."""

    angle: float | None = None
    rate: float | None = None
    travel: float | None = None
    speed: float | None = None


class Stiffness(NamedTuple):
    """What shares out a redundant joint's reactions: N/m and N m/rad along the world's axes at the start."""

    force: Vec | None
    moment: Vec | None


class Joint(NamedTuple):
    """A joint; directions as given, not zero, not normalised, in the axes of `from` (to_axis: of `to`)."""

    type: str  # a name of joint_kinds.TYPES
    from_: End
    to: End
    axis: Vec | None = None
    to_axis: Vec | None = None
    normal: Vec | None = None
    initial: Initial | None = None
    length: float | None = None
    tension_only: bool = False
    stiffness: Stiffness | None = None
    restitution: float | None = None


class Drive(NamedTuple):
    """A coordinate of a joint prescribed in time; by_rate: its rate of change is, from where it starts."""

    joint: str
    quantity: Literal["angle", "travel", "length"]
    value: Expression
    zero: Literal["assembled"] | None = None
    by_rate: bool = False


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
    """A spring and damper between two points: N/m, free length [m], N s/m."""

    from_: End
    to: End
    stiffness: float
    length: float
    damping: float = 0.0
    type: Literal["spring"] = "spring"


class TurnSpring(NamedTuple):
    """A spring and damper about a joint's axis: N m/rad, angle where it is relaxed [rad], N m s."""

    joint: str
    stiffness: float
    angle: float
    damping: float = 0.0
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


class Damper(NamedTuple):
    """Resistance of a joint: coefficient N m s (turning) or N s/m (slide, line, plane); sliding N s/m (cylinder)."""

    joint: str
    coefficient: float
    sliding: float | None = None
    type: Literal["damper"] = "damper"


class Friction(NamedTuple):
    """Coulomb friction in a joint, torque [N m] or force [N] times tanh(rate/speed)."""

    joint: str
    torque: float | None
    force: float | None
    speed: float
    type: Literal["friction"] = "friction"


Force = PointForce | Couple | Torque | Actuator | Spring | TurnSpring | Distributed | Damper | Friction


class Impulse(NamedTuple):
    """A blow: an impulse [N s] at a point, or an impulsive couple [N m s] on a body (on: where it enters, if named)."""

    body: str
    on: End | None
    vector: Vec
    time: float
    frame: Frame = "world"
    type: Literal["impulse", "couple"] = "impulse"


class Stop(NamedTuple):
    """Limits of a joint's coordinate [rad] or [m], None where there is none, and the restitution of its strikes."""

    joint: str
    quantity: Literal["angle", "travel", "length"]
    low: float | None
    high: float | None
    restitution: float = 0.0


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
    piece: Piece | None = None


class Condition(NamedTuple):
    """What is watched for during a motion, by its name; ends: whether the motion ends where it becomes true.

    text: as written. value: what is true or not, in time and coordinates; or None, and the number of the results at the
    path `of` is below the limit, or above it.
    """

    name: str
    text: str
    ends: bool
    value: Expression | None
    of: str = ""
    limit: float = 0.0
    above: bool = False


class Analysis(NamedTuple):
    """What is solved: times are the instants asked for [s]; duration is the last of them in a motion.

    step is for methods of fixed step. tolerance_given: whether somebody asked for it, or it is the default.
    """

    type: Literal["motion", "impulse", "state", "rest"]
    times: tuple[float, ...]
    duration: float | None
    tolerance: float
    method: str
    step: float | None
    conditions: tuple[Condition, ...] = ()
    tolerance_given: bool = False


class Foundation(NamedTuple):
    """About which point M_s is taken, world axes; None is the origin."""

    about: Vec | None


class Expect(NamedTuple):
    """One expectation: the value found at `of` is `is_` (None: must be open) within rel and abs, or within bounds."""

    of: str
    at: float | None
    peak: Literal["max", "min", "abs"] | None
    is_: float | tuple[object, ...] | None
    rel: float | None
    abs: float | None
    location: SourceLocation
    below: float | None = None
    above: float | None = None


class Spec(NamedTuple):
    """A validated scene. `location("joints.elbow")`: where in the file a value stands, for errors of later stages."""

    title: str
    path: str
    sha256: str
    space: Literal["auto", "spatial", "planar"]
    parameters: Mapping[str, float]
    gravity: Vec
    ground: Ground
    bodies: Mapping[str, Body]
    joints: Mapping[str, Joint]
    drives: Mapping[str, Drive]
    forces: Mapping[str, Force]
    impulses: Mapping[str, Impulse]
    stops: Mapping[str, Stop]
    sections: Mapping[str, Section]
    tables: Mapping[str, Table]
    analysis: Analysis
    report: tuple[str, ...] | None
    foundation: Foundation
    expect: tuple[Expect, ...]
    warnings: tuple[Problem, ...]
    locations: Mapping[str, SourceLocation] = NOWHERE

    def location(self, path: str) -> SourceLocation:
        """Where a dotted path stands, or the nearest thing around it that does."""
        while path and path not in self.locations:
            path = path.rpartition(".")[0]
        return self.locations.get(path) or SourceLocation(self.path, 1, 1)
