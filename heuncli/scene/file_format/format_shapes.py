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


ShapeEntry = RodShape | CylinderShape | ConeShape | BoxShape | SphereShape | PointShape | MeshShape
SHAPES: dict[str, type[ShapeEntry]] = {
    "rod": RodShape, "cylinder": CylinderShape, "cone": ConeShape, "box": BoxShape, "sphere": SphereShape,
    "point": PointShape, "mesh": MeshShape,
}  # fmt: skip
