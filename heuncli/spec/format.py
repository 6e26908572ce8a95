"""The file format, version 1: the whole of it as pydantic models, keys as users write them, values read to SI.

A model's validator is built when the first entry of its kind is read: a scene pays for what it has. Reading here looks
at one value at a time; what concerns several of them together stands in `rules`, the meaning in `resolve`. Nothing
outside `spec` sees these models.
"""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import Field, StrictBool, Tag, model_validator

from heuncli.errors import Finding
from heuncli.spec.fields import (
    FORM,
    Acceleration,
    AnEnd,
    Angle,
    AngleInTime,
    AngleLimits,
    AngularImpulse,
    Anything,
    Area,
    AreaMoment,
    BodyOrEnd,
    Count,
    Damping,
    Density,
    Direction,
    Either,
    EitherInTime,
    Expected,
    Force,
    ForceInTime,
    FormatVersion,
    Impulse,
    Inertia,
    InParts,
    Length,
    LengthInTime,
    LengthLimits,
    LineDensity,
    LineForceInTime,
    Mass,
    Matrix,
    Model,
    Moment,
    MomentInTime,
    Number,
    PointOrName,
    Position,
    Pressure,
    Rate,
    RateInTime,
    Stiffness,
    Tensor,
    Time,
    TruthInTime,
    TurningDamping,
    TurningStiffness,
    Velocity,
    VelocityInTime,
)
from heuncli.spec.words import SEVERAL

Frame = Literal["world", "body"]
Report = Literal[
    "motion", "points", "foundation", "joints", "sections", "forces", "energy", "impulses", "events", "shares"
]  # fmt: skip
Points = dict[str, Position]


class Orientation(Model):
    """An attitude, in one of its forms."""

    axis: Direction | None = None
    angle: Angle | None = None
    quaternion: tuple[Number, Number, Number, Number] | None = None
    rodrigues: Direction | None = None
    euler: tuple[Angle, Angle, Angle] | None = None
    sequence: str | None = None
    matrix: Matrix | None = None


class Ground(Model):
    """What does not move."""

    points: Points = Field(default_factory=dict)


class Rod(Model):
    type: Literal["rod"]
    from_: Position = Field(alias="from")
    to: Position
    mass: Mass | None = None
    line_density: LineDensity | None = None


class Cylinder(Model):
    type: Literal["cylinder"]
    from_: Position = Field(alias="from")
    to: Position
    radius: Length
    inner_radius: Length | None = None
    mass: Mass | None = None
    density: Density | None = None


class Cone(Model):
    type: Literal["cone"]
    from_: Position = Field(alias="from")
    to: Position
    radius: Length
    to_radius: Length
    mass: Mass | None = None
    density: Density | None = None


class Box(Model):
    type: Literal["box"]
    center: Position
    size: Position
    orientation: Orientation | None = None
    mass: Mass | None = None
    density: Density | None = None


class Sphere(Model):
    type: Literal["sphere"]
    center: Position
    radius: Length
    mass: Mass | None = None
    density: Density | None = None


class Point(Model):
    type: Literal["point"]
    at: Position
    mass: Mass


Shape = Rod | Cylinder | Cone | Box | Sphere | Point
SHAPES: dict[str, type[Shape]] = {
    "rod": Rod, "cylinder": Cylinder, "cone": Cone, "box": Box, "sphere": Sphere, "point": Point,
}  # fmt: skip
InertiaForms = Annotated[
    Annotated[Inertia, Tag("single")]
    | Annotated[tuple[Inertia, Inertia, Inertia], Tag("list")]
    | Annotated[Tensor, Tag("rows")],
    FORM,
]


class Near(Model):
    """Where the assembly starts to look."""

    position: Position | None = None
    orientation: Orientation | None = None


class VelocityInFrame(Model):
    vector: tuple[Velocity, Velocity, Velocity]
    frame: Frame = "world"


class RateInFrame(Model):
    vector: tuple[Rate, Rate, Rate]
    frame: Frame = "world"


class Piece(Model):
    """What a cut separates from a body without shapes."""

    mass: Mass
    center: Position
    inertia: InertiaForms
    deviation: tuple[Inertia, Inertia, Inertia] | None = None


class Body(Model):
    mass: Mass | None = None
    center: Position | None = None
    inertia: InertiaForms | None = None
    deviation: tuple[Inertia, Inertia, Inertia] | None = None
    shapes: Annotated[list[Shape], InParts()] | None = None
    points: Points = Field(default_factory=dict)
    position: Position | None = None
    orientation: Orientation | None = None
    near: Near | None = None
    velocity: (
        Annotated[
            Annotated[tuple[Velocity, Velocity, Velocity], Tag("list")] | Annotated[VelocityInFrame, Tag("mapping")],
            FORM,
        ]
        | None
    ) = None
    angular_velocity: (
        Annotated[Annotated[tuple[Rate, Rate, Rate], Tag("list")] | Annotated[RateInFrame, Tag("mapping")], FORM] | None
    ) = None
    piece: Piece | None = None


class StiffnessParts(Model):
    force: (
        Annotated[
            Annotated[Stiffness, Tag("single")] | Annotated[tuple[Stiffness, Stiffness, Stiffness], Tag("list")], FORM
        ]
        | None
    ) = None
    moment: (
        Annotated[
            Annotated[TurningStiffness, Tag("single")]
            | Annotated[tuple[TurningStiffness, TurningStiffness, TurningStiffness], Tag("list")],
            FORM,
        ]
        | None
    ) = None


class AnyJoint(Model):
    """What all joints have."""

    from_: AnEnd = Field(alias="from")
    to: AnEnd
    stiffness: (
        Annotated[Annotated[Stiffness, Tag("single")] | Annotated[StiffnessParts, Tag("mapping")], FORM] | None
    ) = None


class Turning(Model):
    angle: Angle | None = None
    rate: Rate | None = None


class Sliding(Model):
    travel: Length | None = None
    speed: Velocity | None = None


class TurningAndSliding(Turning, Sliding):
    """All four, of a cylinder."""


class Ball(AnyJoint):
    type: Literal["ball"]


class Pin(AnyJoint):
    type: Literal["pin"]
    axis: Direction
    to_axis: Direction | None = None
    initial: Turning | None = None


class Slide(AnyJoint):
    type: Literal["slide"]
    axis: Direction
    to_axis: Direction | None = None
    initial: Sliding | None = None


class CylinderJoint(AnyJoint):
    type: Literal["cylinder"]
    axis: Direction
    to_axis: Direction | None = None
    initial: TurningAndSliding | None = None


class Universal(AnyJoint):
    type: Literal["universal"]
    axis: Direction
    to_axis: Direction


class Weld(AnyJoint):
    type: Literal["weld"]


class Line(AnyJoint):
    type: Literal["line"]
    axis: Direction


class Plane(AnyJoint):
    type: Literal["plane"]
    normal: Direction


class RodJoint(AnyJoint):
    type: Literal["rod"]
    length: Length | None = None
    tension_only: StrictBool = False
    restitution: Number | None = None


Joint = Ball | Pin | Slide | CylinderJoint | Universal | Weld | Line | Plane | RodJoint
JOINTS: dict[str, type[Joint]] = {
    "ball": Ball, "pin": Pin, "slide": Slide, "cylinder": CylinderJoint, "universal": Universal, "weld": Weld,
    "line": Line, "plane": Plane, "rod": RodJoint,
}  # fmt: skip


class Drive(Model):
    joint: str
    angle: AngleInTime | None = None
    travel: LengthInTime | None = None
    length: LengthInTime | None = None
    rate: RateInTime | None = None
    speed: VelocityInTime | None = None
    zero: Literal["assembled"] | None = None


class PointForce(Model):
    type: Literal["force"]
    on: AnEnd
    vector: tuple[ForceInTime, ForceInTime, ForceInTime]
    frame: Frame = "world"


class Couple(Model):
    type: Literal["couple"]
    on: BodyOrEnd
    vector: tuple[MomentInTime, MomentInTime, MomentInTime]
    frame: Frame = "world"


class Torque(Model):
    type: Literal["torque"]
    joint: str
    value: EitherInTime


class Actuator(Model):
    type: Literal["actuator"]
    from_: AnEnd = Field(alias="from")
    to: AnEnd
    value: ForceInTime


class Spring(Model):
    type: Literal["spring"]
    from_: AnEnd = Field(alias="from")
    to: AnEnd
    stiffness: Stiffness
    length: Length
    damping: Damping = 0.0


class TurnSpring(Model):
    type: Literal["turn_spring"]
    joint: str
    stiffness: TurningStiffness
    angle: Angle = 0.0
    damping: TurningDamping = 0.0


class Distributed(Model):
    type: Literal["distributed"]
    on: str
    from_: PointOrName = Field(alias="from")
    to: PointOrName
    vector: tuple[LineForceInTime, LineForceInTime, LineForceInTime]
    to_vector: tuple[LineForceInTime, LineForceInTime, LineForceInTime] | None = None
    frame: Frame = "world"


class Damper(Model):
    type: Literal["damper"]
    joint: str
    coefficient: Either | None = None
    sliding: Damping | None = None


class Friction(Model):
    type: Literal["friction"]
    joint: str
    torque: Moment | None = None
    force: Force | None = None
    speed: Either


Load = PointForce | Couple | Torque | Actuator | Spring | TurnSpring | Distributed | Damper | Friction
LOADS: dict[str, type[Load]] = {
    "force": PointForce, "couple": Couple, "torque": Torque, "actuator": Actuator, "spring": Spring,
    "turn_spring": TurnSpring, "distributed": Distributed, "damper": Damper, "friction": Friction,
}  # fmt: skip


class Blow(Model):
    on: BodyOrEnd | None = None
    vector: tuple[Impulse, Impulse, Impulse] | None = None
    body: str | None = None
    couple: tuple[AngularImpulse, AngularImpulse, AngularImpulse] | None = None
    time: Time = 0.0
    frame: Frame = "world"


class Stop(Model):
    joint: str
    angle: AngleLimits | None = None
    travel: LengthLimits | None = None
    length: LengthLimits | None = None
    restitution: Number = 0.0
    friction: Number | None = None


class Circle(Model):
    radius: Length


class Tube(Model):
    radius: Length
    inner_radius: Length


class Rectangle(Model):
    width: Length
    height: Length


class Properties(Model):
    """Of a section: one of the named shapes, or all of the numbers."""

    circle: Circle | None = None
    tube: Tube | None = None
    rectangle: Rectangle | None = None
    area: Area | None = None
    I1: AreaMoment | None = None
    I2: AreaMoment | None = None
    J: AreaMoment | None = None
    c1: Length | None = None
    c2: Length | None = None
    shear_factor: Number | None = None


class Section(Model):
    body: str
    at: PointOrName | None = None
    normal: Direction | None = None
    from_: PointOrName | None = Field(default=None, alias="from")
    to: PointOrName | None = None
    count: Count | None = None
    first_axis: Direction | None = None
    reduce_to: Annotated[Annotated[str, Tag("single")] | Annotated[AnEnd, Tag("mapping")], FORM] = "at"
    side: Literal["before", "beyond"] | None = None
    properties: (
        Annotated[Annotated[Literal["auto"], Tag("single")] | Annotated[Properties, Tag("mapping")], FORM] | None
    ) = None
    strength: Pressure | None = None
    piece: Piece | None = None


Column = Annotated[Annotated[list[Any], Tag("list")] | Annotated[str | int, Tag("single")], FORM]


class Table(Model):
    file: str | None = None
    x: Column | None = None
    y: Column | None = None
    x_unit: str | None = None
    y_unit: str | None = None
    period: Anything | None = None
    interpolation: Literal["linear", "cubic", "pchip"] = "linear"
    outside: Literal["hold"] | None = None


class OfResults(Model):
    """A condition on a number of the results."""

    of: str
    below: Either | None = None
    above: Either | None = None


Condition = Annotated[Annotated[TruthInTime, Tag("single")] | Annotated[OfResults, Tag("mapping")], FORM]


class Analysis(Model):
    type: Literal["motion", "impulse", "state", "rest"] | None = None
    duration: Time | None = None
    samples: Count | None = None
    times: list[Time] | None = None
    tolerance: Number | None = None
    method: str = "auto"
    step: Time | None = None
    until: Condition | None = None
    events: dict[str, Condition] = Field(default_factory=dict)


class Foundation(Model):
    about: PointOrName | None = None


class Expect(Model):
    of: str
    at: Time | None = None
    peak: Literal["max", "min", "abs"] | None = None
    is_: Expected = Field(default=None, alias="is")
    rel: Number | None = None
    abs: Either | None = None
    below: Either | None = None
    above: Either | None = None

    @property
    def is_bounded(self) -> bool:
        """Whether it is expected to stay below or above something, and not to be something."""
        return self.below is not None or self.above is not None

    @model_validator(mode="before")
    @classmethod
    def says_what(cls, data: Any) -> Any:
        """It is something, or it stays below or above something: null is something, too."""
        if type(data) is dict and not {"is", "below", "above"} & data.keys() and "of" in data:
            other = next((key for key in data if {"is", "below", "above"} & {*SEVERAL.get(str(key), ())}), None)
            hint = "is: a number, a list or null; or below: and above: bounds"
            raise Finding("missing-key", "'is' is missing", f"{hint} ('{other}' means nothing)" if other else hint)
        return data


class Head(Model):
    """What a spec has beside its blocks of entries."""

    heun: FormatVersion
    title: str = ""
    gravity: tuple[Acceleration, Acceleration, Acceleration] = (0.0, 0.0, 0.0)
    space: Literal["auto", "spatial", "planar"] = "auto"
    report: list[Report] | None = None


ENTRIES: dict[str, type[Model] | Mapping[str, type[Model]]] = {  # blocks of named entries: their models, or by type
    "bodies": Body, "joints": JOINTS, "drives": Drive, "forces": LOADS, "impulses": Blow, "stops": Stop,
    "sections": Section,
}  # fmt: skip
SINGLE: dict[str, type[Model]] = {"ground": Ground, "analysis": Analysis, "foundation": Foundation}
READ_BEFORE = ("parameters", "tables")  # by themselves: the rest refers to them


class Document(NamedTuple):
    """A spec as it was read; entries in error are left out."""

    head: Head
    ground: Ground
    bodies: dict[str, Body]
    joints: dict[str, Joint]
    drives: dict[str, Drive]
    forces: dict[str, Load]
    impulses: dict[str, Blow]
    stops: dict[str, Stop]
    sections: dict[str, Section]
    analysis: Analysis
    foundation: Foundation
    expect: dict[int, Expect]
