"""The format's block `couplings`, a class a type: keys as users write them, values read to SI."""

from __future__ import annotations

from typing import Literal

from heuncli.spec.entries import Entry
from heuncli.spec.fields import Number


class RatioEntry(Entry):
    """A linear relation of joints' coordinates."""

    type: Literal["ratio"]
    of: list[str]
    factors: list[Number]


CouplingEntry = RatioEntry
COUPLINGS: dict[str, type[CouplingEntry]] = {"ratio": RatioEntry}
