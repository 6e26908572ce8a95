"""The format's block `rolling`: keys as users write them, values read to SI; centre and axle of a wheel."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from heuncli.scene.file_format.entries import Entry
from heuncli.scene.file_format.fields import AnEnd, Direction, EndEntry, Length, Number, Switch

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
