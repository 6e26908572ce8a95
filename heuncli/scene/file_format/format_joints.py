"""The file format of joints: a class per kind; keys as users write them, values read to SI."""

from __future__ import annotations

from typing import Annotated, Literal

from heuncli.scene.file_format.entries import Entry, Tag, key
from heuncli.scene.file_format.fields import (
    FORM,
    AnEnd,
    Angle,
    Direction,
    Length,
    Number,
    PathPart,
    Rate,
    Stiffness,
    Switch,
    TurningStiffness,
    Velocity,
)


class StiffnessParts(Entry):
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


class BearingPairEntry(Entry):
    """Two bearings or rollers on the axis of a joint, at distances from its `to` point; one may carry the thrust."""

    at: tuple[Length, Length]
    axial: Literal["first", "second"] | None = None


class AnyJoint(Entry):
    """What all joints have."""

    from_: AnEnd = key(alias="from")
    to: AnEnd
    stiffness: (
        Annotated[Annotated[Stiffness, Tag("single")] | Annotated[StiffnessParts, Tag("mapping")], FORM] | None
    ) = None
    bearings: BearingPairEntry | None = None


class BearingEntry(Entry):
    diameter: Length
    width: Length


class Bearing(AnyJoint):
    """A joint that may have a bearing."""

    bearing: BearingEntry | None = None


class Turning(Entry):
    angle: Angle | None = None
    rate: Rate | None = None


class Sliding(Entry):
    travel: Length | None = None
    speed: Velocity | None = None


class TurningAndSliding(Turning, Sliding):
    """Held start values of a cylinder, which turns and slides."""


class BallJoint(Bearing):
    type: Literal["ball"]


class PinJoint(Bearing):
    type: Literal["pin"]
    axis: Direction
    to_axis: Direction | None = None
    initial: Turning | None = None


class SlideJoint(AnyJoint):
    type: Literal["slide"]
    axis: Direction
    to_axis: Direction | None = None
    initial: Sliding | None = None


class CylinderJoint(Bearing):
    type: Literal["cylinder"]
    axis: Direction
    to_axis: Direction | None = None
    initial: TurningAndSliding | None = None


class UniversalJoint(AnyJoint):
    type: Literal["universal"]
    axis: Direction
    to_axis: Direction


class ConstantVelocityJoint(AnyJoint):
    type: Literal["cv"]
    axis: Direction
    to_axis: Direction | None = None


class WeldJoint(AnyJoint):
    type: Literal["weld"]


class LineJoint(Bearing):
    type: Literal["line"]
    axis: Direction


class PlaneJoint(AnyJoint):
    type: Literal["plane"]
    normal: Direction


class CurveJoint(Bearing):
    type: Literal["curve"]
    x: PathPart = 0.0
    y: PathPart = 0.0
    z: PathPart = 0.0
    radius: Length | None = None
    normal: Direction | None = None
    one_sided: Switch = False
    restitution: Number | None = None
    initial: Sliding | None = None


class RodJoint(AnyJoint):
    type: Literal["rod"]
    length: Length | None = None
    tension_only: Switch = False
    restitution: Number | None = None


JointEntry = (
    BallJoint | PinJoint | SlideJoint | CylinderJoint | UniversalJoint | ConstantVelocityJoint | WeldJoint | LineJoint
    | PlaneJoint | CurveJoint | RodJoint
)  # fmt: skip
JOINTS: dict[str, type[JointEntry]] = {
    "ball": BallJoint,
    "pin": PinJoint,
    "slide": SlideJoint,
    "cylinder": CylinderJoint,
    "universal": UniversalJoint,
    "cv": ConstantVelocityJoint,
    "weld": WeldJoint,
    "line": LineJoint,
    "plane": PlaneJoint,
    "curve": CurveJoint,
    "rod": RodJoint,
}
