"""The file format of loads: a class per type; keys as users write them, values read to SI."""

from __future__ import annotations

from typing import Annotated, Literal

from heuncli.scene.file_format.entries import Entry, Tag, key
from heuncli.scene.file_format.fields import (
    FORM,
    AnEnd,
    Angle,
    BodyOrEnd,
    CouplingDampingRow,
    CouplingRow,
    Damping,
    DampingRow,
    Either,
    EitherInTime,
    Force,
    ForceInTime,
    Inertia,
    Length,
    LineForceInTime,
    Mass,
    Moment,
    MomentInTime,
    MotorCurve,
    Number,
    NumberInTime,
    OwnDamperForce,
    OwnDamperTorque,
    OwnSpringForce,
    OwnTurnTorque,
    PointOrName,
    Rate,
    ShiftLaw,
    Stiffness,
    StiffnessRow,
    TurningDamping,
    TurningDampingRow,
    TurningStiffness,
    TurningStiffnessRow,
    TurnLaw,
)
from heuncli.scene.file_format.format_shapes import Frame, Orientation


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
            | Annotated[tuple[StiffnessRow, StiffnessRow, StiffnessRow], Tag("rows")]
            | Annotated[ShiftLaws, Tag("mapping")],
            FORM,
        ]
        | None
    ) = None
    turning: (
        Annotated[
            Annotated[TurnLaw, Tag("single")]
            | Annotated[tuple[TurnLaw, TurnLaw, TurnLaw], Tag("list")]
            | Annotated[tuple[TurningStiffnessRow, TurningStiffnessRow, TurningStiffnessRow], Tag("rows")]
            | Annotated[TurnLaws, Tag("mapping")],
            FORM,
        ]
        | None
    ) = None
    coupling: tuple[CouplingRow, CouplingRow, CouplingRow] | None = None
    damping: (
        Annotated[
            Annotated[Damping, Tag("single")]
            | Annotated[DampingRow, Tag("list")]
            | Annotated[tuple[DampingRow, DampingRow, DampingRow], Tag("rows")],
            FORM,
        ]
        | None
    ) = None
    turning_damping: (
        Annotated[
            Annotated[TurningDamping, Tag("single")]
            | Annotated[TurningDampingRow, Tag("list")]
            | Annotated[tuple[TurningDampingRow, TurningDampingRow, TurningDampingRow], Tag("rows")],
            FORM,
        ]
        | None
    ) = None
    coupling_damping: tuple[CouplingDampingRow, CouplingDampingRow, CouplingDampingRow] | None = None
    preload: tuple[Force, Force, Force] | None = None
    turning_preload: tuple[Moment, Moment, Moment] | None = None
    orientation: Orientation | None = None
    to_orientation: Orientation | None = None


class ForceEntry(Entry):
    type: Literal["force"]
    on: AnEnd
    vector: tuple[ForceInTime, ForceInTime, ForceInTime]
    frame: Frame = "world"


class CoupleEntry(Entry):
    type: Literal["couple"]
    on: BodyOrEnd
    vector: tuple[MomentInTime, MomentInTime, MomentInTime]
    frame: Frame = "world"


class TorqueEntry(JointLoadEntry):
    type: Literal["torque"]
    value: EitherInTime


class ActuatorEntry(PairEntry):
    type: Literal["actuator"]
    value: ForceInTime


class SpringEntry(PairEntry):
    """A spring by its numbers, or by a law."""

    type: Literal["spring"]
    stiffness: Stiffness | None = None
    length: Length | None = None
    damping: Damping | None = None
    force: OwnSpringForce | None = None


class TurnSpringEntry(JointLoadEntry):
    type: Literal["turn_spring"]
    stiffness: TurningStiffness | None = None
    angle: Angle | None = None
    damping: TurningDamping | None = None
    torque: OwnTurnTorque | None = None


class DistributedEntry(Entry):
    type: Literal["distributed"]
    on: str
    from_: PointOrName = key(alias="from")
    to: PointOrName
    vector: tuple[LineForceInTime, LineForceInTime, LineForceInTime]
    to_vector: tuple[LineForceInTime, LineForceInTime, LineForceInTime] | None = None
    frame: Frame = "world"


class DamperEntry(JointLoadEntry):
    type: Literal["damper"]
    coefficient: Either | None = None
    sliding: Damping | None = None
    torque: OwnDamperTorque | None = None
    force: OwnDamperForce | None = None


class FrictionEntry(JointLoadEntry):
    type: Literal["friction"]
    torque: MomentInTime | None = None
    force: ForceInTime | None = None
    coefficient: Number | None = None
    static: EitherInTime | None = None
    radius: Length | None = None
    length: Length | None = None
    speed: Either | None = None


LoadEntry = (
    ForceEntry
    | CoupleEntry
    | TorqueEntry
    | ActuatorEntry
    | SpringEntry
    | TurnSpringEntry
    | DistributedEntry
    | DamperEntry
    | FrictionEntry
    | MotorEntry
    | BushingEntry
)
LOADS: dict[str, type[LoadEntry]] = {
    "force": ForceEntry,
    "couple": CoupleEntry,
    "torque": TorqueEntry,
    "actuator": ActuatorEntry,
    "spring": SpringEntry,
    "turn_spring": TurnSpringEntry,
    "distributed": DistributedEntry,
    "damper": DamperEntry,
    "friction": FrictionEntry,
    "motor": MotorEntry,
    "bushing": BushingEntry,
}
