"""The format's block `couplings`, a class a type: keys as users write them, values read to SI."""

from __future__ import annotations

from typing import Literal

from heuncli.spec.entries import Entry
from heuncli.spec.fields import AnEnd, Direction, Length, Lift, Number, Switch


class RatioEntry(Entry):
    """A linear relation of joints' coordinates."""

    type: Literal["ratio"]
    of: list[str]
    factors: list[Number]


class CamEntry(Entry):
    """A disc that moves a follower."""

    type: Literal["cam"]
    of: list[str]
    lift: Lift
    at: AnEnd
    contact: Literal["roller", "flat", "point"]
    radius: Length | None = None
    normal: Direction | None = None
    two_sided: Switch = False
    restitution: Number | None = None


CouplingEntry = RatioEntry | CamEntry
COUPLINGS: dict[str, type[CouplingEntry]] = {"ratio": RatioEntry, "cam": CamEntry}
