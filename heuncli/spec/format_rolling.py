"""The format's block `rolling`: keys as users write them, values read to SI."""

from __future__ import annotations

from typing import Literal

from heuncli.spec.entries import Entry
from heuncli.spec.fields import AnEnd, Direction, Length, Number, Switch


class RollingEntry(Entry):
    """A wheel that rolls on the plane of another body, or of the ground."""

    wheel: AnEnd
    axis: Direction | None = None
    radius: Length
    on: AnEnd
    normal: Direction
    shape: Literal["disc", "sphere"] = "disc"
    friction: Number | None = None
    slides: Literal["along"] | None = None
    held: Switch = False
