"""Orientations, and the shapes that may give a body its mass: a part of the file format."""

from __future__ import annotations

from typing import Literal

from heuncli.scene.file_format.entries import Entry, key
from heuncli.scene.file_format.fields import (
    Angle,
    Density,
    Direction,
    Length,
    LineDensity,
    Mass,
    Matrix,
    Number,
    Position,
)

Frame = Literal["world", "body"]


class Orientation(Entry):
    """An orientation in one of its five forms."""

    axis: Direction | None = None
    angle: Angle | None = None
    quaternion: tuple[Number, Number, Number, Number] | None = None
    rodrigues: Direction | None = None
    euler: tuple[Angle, Angle, Angle] | None = None
    sequence: str | None = None
    matrix: Matrix | None = None


class RodShape(Entry):
    type: Literal["rod"]
    from_: Position = key(alias="from")
    to: Position
    mass: Mass | None = None
    line_density: LineDensity | None = None


class CylinderShape(Entry):
    type: Literal["cylinder"]
    from_: Position = key(alias="from")
    to: Position
    radius: Length
    inner_radius: Length | None = None
    mass: Mass | None = None
    density: Density | None = None


class ConeShape(Entry):
    type: Literal["cone"]
    from_: Position = key(alias="from")
    to: Position
    radius: Length
    to_radius: Length
    mass: Mass | None = None
    density: Density | None = None


class BoxShape(Entry):
    type: Literal["box"]
    center: Position
    size: Position
    orientation: Orientation | None = None
    wall: Length | None = None
    mass: Mass | None = None
    density: Density | None = None


class MemberShape(Entry):
    """A straight member by its measures, at its other end those with `to_` where they differ."""

    from_: Position = key(alias="from")
    to: Position
    height: Length
    width: Length
    web: Length
    flange: Length
    radius: Length | None = None
    toe_radius: Length | None = None
    to_height: Length | None = None
    to_width: Length | None = None
    to_web: Length | None = None
    to_flange: Length | None = None
    first_axis: Direction | None = None
    mass: Mass | None = None
    density: Density | None = None


class IShape(MemberShape):
    type: Literal["I"]


class CShape(MemberShape):
    type: Literal["C"]


class LShape(MemberShape):
    type: Literal["L"]


class TShape(MemberShape):
    type: Literal["T"]


class ProfileShape(Entry):
    """A straight member by its name, at its other end by another one of its family."""

    type: Literal["profile"]
    from_: Position = key(alias="from")
    to: Position
    profile: str
    to_profile: str | None = None
    first_axis: Direction | None = None
    mass: Mass | None = None
    density: Density | None = None


class SphereShape(Entry):
    type: Literal["sphere"]
    center: Position
    radius: Length
    mass: Mass | None = None
    density: Density | None = None


class PointShape(Entry):
    type: Literal["point"]
    at: Position
    mass: Mass


class MeshShape(Entry):
    type: Literal["mesh"]
    file: str
    scale: Length | None = None
    at: Position | None = None
    orientation: Orientation | None = None
    mass: Mass | None = None
    density: Density | None = None


ShapeEntry = (
    RodShape | CylinderShape | ConeShape | BoxShape | MemberShape | ProfileShape | SphereShape | PointShape | MeshShape
)
SHAPES: dict[str, type[ShapeEntry]] = {
    "rod": RodShape, "cylinder": CylinderShape, "cone": ConeShape, "box": BoxShape, "I": IShape, "C": CShape,
    "L": LShape, "T": TShape, "profile": ProfileShape, "sphere": SphereShape, "point": PointShape, "mesh": MeshShape,
}  # fmt: skip
