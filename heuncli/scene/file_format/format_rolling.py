"""The format's block `rolling`: keys as users write them, values read to SI; what a wheel's centre and axle are."""

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


def pin_end(entry: RollingEntry, joints: Mapping[str, Any]) -> tuple[EndEntry, tuple[float, float, float]] | None:
    """Where the pin `axle` meets the wheel, and its axis there; None: there is no such pin on it."""
    joint = joints.get(entry.axle or "")
    if joint is None or joint.type not in AXLES:
        return None
    if joint.to.body == entry.body:
        return joint.to, joint.axis if joint.to_axis is None else joint.to_axis
    return (joint.from_, joint.axis) if joint.from_.body == entry.body else None


def centre(entry: RollingEntry, joints: Mapping[str, Any]) -> EndEntry | None:
    """The wheel's centre, as it is named or by its axle."""
    by_axle = pin_end(entry, joints) if entry.wheel is None else None
    return entry.wheel if by_axle is None else by_axle[0]


def axle(entry: RollingEntry, joints: Mapping[str, Any]) -> tuple[float, float, float] | None:
    """The direction of a disc's axle in its own axes, as it is given or by its pin."""
    by_axle = pin_end(entry, joints) if entry.axis is None else None
    return entry.axis if by_axle is None else by_axle[1]
