"""Loads between two points or in a joint, bushings and motors: a part of the file format."""

from __future__ import annotations

from typing import Annotated, Literal

from heuncli.scene.file_format.entries import Entry, Tag, key
from heuncli.scene.file_format.fields import (
    FORM,
    AnEnd,
    Damping,
    Force,
    Inertia,
    Mass,
    Moment,
    MotorCurve,
    Number,
    NumberInTime,
    Rate,
    ShiftLaw,
    TurningDamping,
    TurnLaw,
)
from heuncli.scene.file_format.format_shapes import Orientation


class PairEntry(Entry):
    """A load between two points or bodies."""

    type: str
    from_: AnEnd = key(alias="from")
    to: AnEnd


class JointLoadEntry(Entry):
    """A load in a joint."""

    type: str
    joint: str


class RotorEntry(Entry):
    """What turns in a motor."""

    mass: Mass
    inertia: Inertia


class MotorEntry(JointLoadEntry):
    type: Literal["motor"]
    curve: MotorCurve | None = None
    stall: Moment | None = None
    idle: Rate | None = None
    ratio: Number = 1.0
    limit: Moment | None = None
    value: NumberInTime | None = None
    rotor: RotorEntry | None = None


class ShiftLaws(Entry):
    """Of a bushing's shift, axis by axis."""

    x: ShiftLaw = 0.0
    y: ShiftLaw = 0.0
    z: ShiftLaw = 0.0


class TurnLaws(Entry):
    """Of a bushing's turning, axis by axis."""

    x: TurnLaw = 0.0
    y: TurnLaw = 0.0
    z: TurnLaw = 0.0


class BushingEntry(PairEntry):
    type: Literal["bushing"]
    stiffness: (
        Annotated[
            Annotated[ShiftLaw, Tag("single")]
            | Annotated[tuple[ShiftLaw, ShiftLaw, ShiftLaw], Tag("list")]
            | Annotated[ShiftLaws, Tag("mapping")],
            FORM,
        ]
        | None
    ) = None
    turning: (
        Annotated[
            Annotated[TurnLaw, Tag("single")]
            | Annotated[tuple[TurnLaw, TurnLaw, TurnLaw], Tag("list")]
            | Annotated[TurnLaws, Tag("mapping")],
            FORM,
        ]
        | None
    ) = None
    damping: (
        Annotated[Annotated[Damping, Tag("single")] | Annotated[tuple[Damping, Damping, Damping], Tag("list")], FORM]
        | None
    ) = None
    turning_damping: (
        Annotated[
            Annotated[TurningDamping, Tag("single")]
            | Annotated[tuple[TurningDamping, TurningDamping, TurningDamping], Tag("list")],
            FORM,
        ]
        | None
    ) = None
    preload: tuple[Force, Force, Force] | None = None
    turning_preload: tuple[Moment, Moment, Moment] | None = None
    orientation: Orientation | None = None
    to_orientation: Orientation | None = None
