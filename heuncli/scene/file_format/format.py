"""The file format, version 1: one class of entries per kind; its keys as users write them, its values read to SI.

The validator of a kind is built when its first entry is read. Reading checks single values; checks of several values
are in `rules`, their meaning is in `resolve`. Only the package `file_format` uses these classes.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Annotated, Any, Literal

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.entries import Entry, Tag, key
from heuncli.scene.file_format.fields import (
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
    CutOff,
    Direction,
    Either,
    Expected,
    FormatVersion,
    Impulse,
    Inertia,
    Length,
    LengthInTime,
    LengthLimits,
    Mass,
    Number,
    PartList,
    PointOrName,
    Position,
    Pressure,
    Rate,
    RateInTime,
    StrikeInTime,
    Switch,
    Tensor,
    Text,
    Time,
    TruthInTime,
    Velocity,
    VelocityInTime,
)
from heuncli.scene.file_format.foreign_words import AMBIGUOUS_WORDS
from heuncli.scene.file_format.format_couplings import COUPLINGS, CouplingEntry, RollingEntry
from heuncli.scene.file_format.format_joints import JOINTS, JointEntry
from heuncli.scene.file_format.format_loads import LOADS, LoadEntry
from heuncli.scene.file_format.format_shapes import Frame, Orientation, ShapeEntry
from heuncli.scene.file_format.segment_entries import DriveSegmentEntry

Report = Literal[
    "motion", "points", "foundation", "joints", "sections", "forces", "energy", "impulses", "events", "shares"
]  # fmt: skip
ReportChapter = Literal[
    "machine", "loads", "sections", "histories", "polar", "events", "checks", "accuracy", "open", "model", "spec"
]  # fmt: skip
Points = dict[str, Position]


class GroundEntry(Entry):
    """What does not move."""

    points: Points = key(default_factory=dict)


InertiaForms = Annotated[
    Annotated[Inertia, Tag("single")]
    | Annotated[tuple[Inertia, Inertia, Inertia], Tag("list")]
    | Annotated[Tensor, Tag("rows")],
    FORM,
]


class NearEntry(Entry):
    """Where the assembly starts to look."""

    position: Position | None = None
    orientation: Orientation | None = None


class VelocityInFrame(Entry):
    vector: tuple[Velocity, Velocity, Velocity]
    frame: Frame = "world"


class RateInFrame(Entry):
    vector: tuple[Rate, Rate, Rate]
    frame: Frame = "world"


class PieceEntry(Entry):
    """What a cut separates from a body without shapes."""

    mass: Mass
    center: Position
    inertia: InertiaForms
    deviation: tuple[Inertia, Inertia, Inertia] | None = None


class BodyEntry(Entry):
    mass: Mass | None = None
    center: Position | None = None
    inertia: InertiaForms | None = None
    deviation: tuple[Inertia, Inertia, Inertia] | None = None
    shapes: Annotated[list[ShapeEntry], PartList()] | None = None
    points: Points = key(default_factory=dict)
    position: Position | None = None
    orientation: Orientation | None = None
    near: NearEntry | None = None
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
    piece: PieceEntry | None = None


class DriveEntry(Entry):
    joint: str
    segments: list[DriveSegmentEntry] | None = None
    base: Either | None = None
    repeat: Switch = False
    angle: AngleInTime | None = None
    travel: LengthInTime | None = None
    length: LengthInTime | None = None
    rate: RateInTime | None = None
    speed: VelocityInTime | None = None
    zero: Literal["assembled"] | None = None


class ImpulseEntry(Entry):
    on: BodyOrEnd | None = None
    vector: tuple[Impulse, Impulse, Impulse] | None = None
    body: str | None = None
    couple: tuple[AngularImpulse, AngularImpulse, AngularImpulse] | None = None
    time: Time = 0.0
    when: StrikeInTime | None = None
    every: Switch = False
    frame: Frame = "world"


class StopEntry(Entry):
    joint: str
    angle: AngleLimits | None = None
    travel: LengthLimits | None = None
    length: LengthLimits | None = None
    restitution: Number = 0.0
    friction: Number | None = None


class LatchEntry(Entry):
    stop: str | None = None
    limit: Literal["lower", "upper"] | None = None
    joint: str | None = None
    angle: Angle | None = None
    travel: Length | None = None
    when: StrikeInTime | None = None
    release: StrikeInTime | None = None
    every: Switch = False


class CircleEntry(Entry):
    radius: Length


class TubeEntry(Entry):
    radius: Length
    inner_radius: Length


class RectangleEntry(Entry):
    width: Length
    height: Length


class MemberEntry(Entry):
    """The measures of an I, C, L or T, its width along e1 and its height along e2."""

    height: Length
    width: Length
    web: Length
    flange: Length
    radius: Length = 0.0
    toe_radius: Length = 0.0


class HollowEntry(Entry):
    height: Length
    width: Length
    wall: Length
    radius: Length = 0.0


class PropertiesEntry(Entry):
    """Of a section: one of the named shapes, or all of the numbers."""

    circle: CircleEntry | None = None
    tube: TubeEntry | None = None
    rectangle: RectangleEntry | None = None
    I: MemberEntry | None = None
    C: MemberEntry | None = None
    L: MemberEntry | None = None
    T: MemberEntry | None = None
    box: HollowEntry | None = None
    profile: str | None = None
    area: Area | None = None
    I1: AreaMoment | None = None
    I2: AreaMoment | None = None
    J: AreaMoment | None = None
    c1: Length | None = None
    c2: Length | None = None
    shear_factor: Number | None = None


class SectionEntry(Entry):
    body: str
    at: PointOrName | None = None
    normal: Direction | None = None
    from_: PointOrName | None = key(default=None, alias="from")
    to: PointOrName | None = None
    count: Count | None = None
    first_axis: Direction | None = None
    reduce_to: Annotated[Annotated[str, Tag("single")] | Annotated[AnEnd, Tag("mapping")], FORM] = "at"
    side: Literal["before", "beyond"] | None = None
    properties: (
        Annotated[Annotated[Literal["auto"], Tag("single")] | Annotated[PropertiesEntry, Tag("mapping")], FORM] | None
    ) = None
    strength: Pressure | None = None
    deflection: Switch = False
    modulus: Pressure | None = None
    reference: Literal["chord", "start", "end"] | None = None
    length_factor: Number | None = None
    piece: PieceEntry | None = None


ColumnName = str | int
Column = Annotated[Annotated[list[Any], Tag("list")] | Annotated[str | int, Tag("single")], FORM]


class TableEntry(Entry):
    file: str | None = None
    skip: Count | None = None
    gaps: Literal["refuse", "skip", "linear"] = "refuse"
    sheet: str | None = None
    x: Column | None = None
    y: Column | None = None
    x_unit: str | None = None
    y_unit: str | None = None
    period: Anything | None = None
    smooth: CutOff | None = None
    resample: CutOff | None = None
    derivative: Count | None = None
    integral: Count | None = None
    drift: Literal["keep", "rest", "mean"] | None = None
    interpolation: Literal["linear", "cubic", "pchip"] = "linear"
    ends: Literal["not-a-knot", "natural"] | None = None
    outside: Literal["hold"] | None = None


class ResultConditionEntry(Entry):
    """A condition that compares a number of the results with a bound."""

    of: str
    below: Either | None = None
    above: Either | None = None


ConditionEntry = Annotated[
    Annotated[TruthInTime, Tag("single")] | Annotated[ResultConditionEntry, Tag("mapping")], FORM
]


class AnalysisEntry(Entry):
    type: Literal["motion", "impulse", "state", "rest"] | None = None
    duration: Time | None = None
    samples: Count | None = None
    times: list[Time] | None = None
    tolerance: Number | None = None
    method: str = "auto"
    step: Time | None = None
    impacts: Literal["simultaneous", "sequential"] = "simultaneous"
    start: Literal["rest", "steady"] | None = None
    until: ConditionEntry | None = None
    events: dict[str, ConditionEntry] = key(default_factory=dict)


class FoundationEntry(Entry):
    about: PointOrName | None = None


class SensorEntry(Entry):
    """A reaction as a load cell reads it: about a point, in the axes of a body."""

    of: str
    point: AnEnd | None = None
    axes: str = "ground"


class ExpectEntry(Entry):
    of: str
    at: Time | None = None
    peak: Literal["max", "min", "abs"] | None = None
    is_: Expected = key(default=None, alias="is")
    rel: Number | None = None
    abs: Either | None = None
    below: Either | None = None
    above: Either | None = None
    curve: str | None = None
    skip: Count | None = None
    gaps: Literal["refuse", "skip", "linear"] | None = None
    sheet: str | None = None
    x: ColumnName | None = None
    y: ColumnName | None = None
    x_unit: str | None = None
    y_unit: str | None = None
    within: Number | None = None
    case: str | None = None

    @property
    def is_bounded(self) -> bool:
        """Whether the expectation gives bounds instead of a value."""
        return self.below is not None or self.above is not None

    @classmethod
    def before(cls, data: Any) -> Any:
        """Require one of `is` (even null), `below`, `above` and `curve`. Raises Finding [missing-key]."""
        if type(data) is dict and not {"is", "below", "above", "curve"} & data.keys() and "of" in data:
            synonym = next(
                (key for key in data if {"is", "below", "above"} & {*AMBIGUOUS_WORDS.get(str(key), ())}), None
            )
            hint = "give is: (a number, a list or null), below: or above: (bounds), or curve: (a file)"
            raise Finding("missing-key", "'is' is missing", f"{hint} ('{synonym}' is not a key)" if synonym else hint)
        return data


class CaseEntry(Entry):
    """A load case: values that hold in it in the place of others, by the names that --set takes."""

    title: str = ""
    set: dict[str, Any]


class ReportEntry(Entry):
    """What a client's report shows besides the results, and which results to compute."""

    company: Text | None = None
    project: Text | None = None
    author: Text | None = None
    revision: Text | None = None
    part: Text | None = None
    logo: Text | None = None
    chapters: list[ReportChapter] | None = None
    results: list[Report] | None = None


class HeadEntry(Entry):
    """What a spec has beside its blocks of entries."""

    heun: FormatVersion
    title: str = ""
    gravity: tuple[Acceleration, Acceleration, Acceleration] = (0.0, 0.0, 0.0)
    space: Literal["auto", "spatial", "planar"] = "auto"
    report: Annotated[Annotated[list[Report], Tag("list")] | Annotated[ReportEntry, Tag("mapping")], FORM] | None = None


ENTRY_BLOCKS: dict[str, type[Entry] | Mapping[str, type[Entry]]] = {  # named entries: model, or models by type
    "bodies": BodyEntry, "joints": JOINTS, "drives": DriveEntry, "forces": LOADS, "impulses": ImpulseEntry,
    "stops": StopEntry, "latches": LatchEntry, "couplings": COUPLINGS, "rolling": RollingEntry,
    "sections": SectionEntry, "sensors": SensorEntry, "cases": CaseEntry,
}  # fmt: skip
SINGLE_BLOCKS: dict[str, type[Entry]] = {
    "ground": GroundEntry,
    "analysis": AnalysisEntry,
    "foundation": FoundationEntry,
}
BLOCKS_READ_FIRST = ("parameters", "tables")  # the other blocks refer to them


@cache
def list_labelled_models() -> frozenset[type[Entry]]:
    """List the models whose entries may have the key `label`, which is taken out before they are read."""
    models = {GroundEntry, TableEntry}
    for block in ENTRY_BLOCKS.values():
        models |= {*block.values()} if isinstance(block, Mapping) else {block}
    return frozenset(models)


class Document(NamedTuple):
    """A spec as read; wrong entries are left out."""

    head: HeadEntry
    ground: GroundEntry
    bodies: dict[str, BodyEntry]
    joints: dict[str, JointEntry]
    drives: dict[str, DriveEntry]
    forces: dict[str, LoadEntry]
    impulses: dict[str, ImpulseEntry]
    stops: dict[str, StopEntry]
    couplings: dict[str, CouplingEntry]
    rolling: dict[str, RollingEntry]
    latches: dict[str, LatchEntry]
    sections: dict[str, SectionEntry]
    sensors: dict[str, SensorEntry]
    cases: dict[str, CaseEntry]
    analysis: AnalysisEntry
    foundation: FoundationEntry
    expect: dict[int, ExpectEntry]
