"""The format's block `couplings`, a class a type: keys as users write them, values read to SI."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from heuncli.spec.entries import Before, Entry
from heuncli.spec.fields import AnEnd, AsText, Direction, Length, Number, Switch


class RatioEntry(Entry):
    """A linear relation of joints' coordinates."""

    type: Literal["ratio"]
    of: list[str]
    factors: list[Number]


class PassageEntry(Entry):
    """Where a rope passes: a point, or a sheave about one."""

    point: AnEnd | None = None
    sheave: AnEnd | None = None
    radius: Length | None = None
    axis: Direction | None = None
    side: Literal["over", "under", "left", "right"] | None = None
    slip: Literal["free", "none"] = "free"


def passage(value: Any, info: Any) -> Any:
    """'cage.top', or {body: cage, at: [0, 0, 2]}, as {point: ...}."""
    return {"point": value} if type(value) is str or (type(value) is dict and "body" in value) else value


class RopeEntry(Entry):
    """A rope through points and over sheaves."""

    type: Literal["rope"]
    through: list[Annotated[PassageEntry, Before(passage), AsText()]]
    length: Length | None = None
    tension_only: Switch = False
    restitution: Number | None = None


CouplingEntry = RatioEntry | RopeEntry
COUPLINGS: dict[str, type[CouplingEntry]] = {"ratio": RatioEntry, "rope": RopeEntry}
