"""The format's blocks `couplings`, one class per type, and `rolling`: keys as users write them, values read to SI."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from heuncli.base.errors import Finding
from heuncli.scene.file_format.entries import Entry, Preprocessor, key
from heuncli.scene.file_format.fields import (
    AnEnd,
    Angle,
    Anything,
    Damping,
    Direction,
    Either,
    EndEntry,
    Force,
    ForceInTime,
    Length,
    LengthInTime,
    Lift,
    Number,
    Rate,
    Stiffness,
    Switch,
    TextOrMapping,
)
from heuncli.scene.file_format.foreign_words import MISSING_KEY_HINTS
from heuncli.scene.file_format.segment_entries import CamSegmentEntry

# Format couplings


class RatioEntry(Entry):
    """A linear relation of joints' coordinates."""

    type: Literal["ratio"]
    of: list[str]
    factors: list[Anything]
    is_: Anything | None = key("is", None)


class GearEntry(Entry):
    """Two gears, or a gear and a rack."""

    type: Literal["gear"]
    of: list[str]
    ratio: Anything | None = None
    teeth: list[Number] | None = None
    internal: Switch = False
    at: AnEnd | None = None
    pressure_angle: Angle = math.radians(20.0)
    helix: Angle = 0.0


class ThreadFrictionEntry(Entry):
    """What rubs in a thread."""

    coefficient: Number | None = None
    efficiency: Number | None = None
    radius: Length
    flank_angle: Angle = 0.0
    static: Number | None = None
    speed: Rate | None = None


class ScrewEntry(Entry):
    """A thread."""

    type: Literal["screw"]
    of: list[str]
    lead: Length
    friction: Annotated[ThreadFrictionEntry, TextOrMapping()] | None = None


class BeltEntry(Entry):
    """A belt over two pulleys."""

    type: Literal["belt"]
    of: list[str]
    radii: list[Length]
    pretension: Force
    crossed: Switch = False


class DifferentialEntry(Entry):
    """Two shafts and their carrier."""

    type: Literal["differential"]
    of: list[str]
    ratio: Number = -1.0


class CamEntry(Entry):
    """A disc that moves a follower."""

    type: Literal["cam"]
    of: list[str]
    lift: Lift | None = None
    segments: list[CamSegmentEntry] | None = None
    base: Either | None = None
    at: AnEnd
    contact: Literal["roller", "flat", "point"]
    radius: Length | None = None
    normal: Direction | None = None
    phase: Angle = 0.0
    two_sided: Switch = False
    restitution: Number | None = None

    @classmethod
    def before(cls, data: Any) -> Any:
        """Require a lift or segments. Raises Finding [missing-key]."""
        if type(data) is dict and not {"lift", "segments"} & data.keys():
            raise Finding("missing-key", "'lift' is missing", MISSING_KEY_HINTS["lift"])
        return data


class PassageEntry(Entry):
    """Where a rope passes: a point, or a sheave about one."""

    point: AnEnd | None = None
    sheave: AnEnd | None = None
    radius: Length | None = None
    axis: Direction | None = None
    side: Literal["over", "under", "left", "right"] | None = None
    slip: Literal["free", "none"] = "free"


def wrap_point(value: Any, info: Any) -> Any:
    """Convert 'cage.top', or {body: cage, at: [0, 0, 2]}, to {point: ...}."""
    return {"point": value} if type(value) is str or (type(value) is dict and "body" in value) else value


class RopeEntry(Entry):
    """A rope through points and over sheaves."""

    type: Literal["rope"]
    through: list[Annotated[PassageEntry, Preprocessor(wrap_point), TextOrMapping()]]
    length: LengthInTime | None = None
    tension_only: Switch = False
    restitution: Number | None = None
    stiffness: Stiffness | None = None
    damping: Damping | None = None
    tension: ForceInTime | None = None


CouplingEntry = RatioEntry | GearEntry | ScrewEntry | BeltEntry | DifferentialEntry | CamEntry | RopeEntry
COUPLINGS: dict[str, type[CouplingEntry]] = {
    "ratio": RatioEntry, "gear": GearEntry, "screw": ScrewEntry, "belt": BeltEntry, "differential": DifferentialEntry,
    "cam": CamEntry, "rope": RopeEntry,
}  # fmt: skip


# Format rolling

AXLES = ("pin", "cylinder")  # joints in which a wheel turns about its axle


class RollingEntry(Entry):
    """A wheel that rolls on the plane of another body, or of the ground."""

    wheel: AnEnd | None = None
    axis: Direction | None = None
    body: str | None = None
    axle: str | None = None
    radius: Length
    on: AnEnd
    normal: Direction
    shape: Literal["disc", "sphere"] = "disc"
    friction: Number | None = None
    slides: Literal["along"] | None = None
    held: Switch = False


def find_pin_end(entry: RollingEntry, joints: Mapping[str, Any]) -> tuple[EndEntry, tuple[float, float, float]] | None:
    """Return the point where the pin `axle` meets the wheel, and the pin's axis there. None: the wheel has no such
    pin.
    """
    joint = joints.get(entry.axle or "")
    if joint is None or joint.type not in AXLES:
        return None
    if joint.to.body == entry.body:
        return joint.to, joint.axis if joint.to_axis is None else joint.to_axis
    return (joint.from_, joint.axis) if joint.from_.body == entry.body else None


def find_centre(entry: RollingEntry, joints: Mapping[str, Any]) -> EndEntry | None:
    """Return the wheel's centre, as given or from its axle."""
    by_axle = find_pin_end(entry, joints) if entry.wheel is None else None
    return entry.wheel if by_axle is None else by_axle[0]


def find_axle_direction(entry: RollingEntry, joints: Mapping[str, Any]) -> tuple[float, float, float] | None:
    """Return the direction of a disc's axle in its own axes, as given or from its pin."""
    by_axle = find_pin_end(entry, joints) if entry.axis is None else None
    return entry.axis if by_axle is None else by_axle[1]
