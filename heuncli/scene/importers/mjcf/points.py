"""The named points of all bodies of a spec while it is made: each name once in a body."""

from __future__ import annotations

from heuncli.scene.file_format.models import Vec
from heuncli.scene.importers.described import DescribedPoint
from heuncli.scene.importers.names import Namer


class PointsMade:
    """Points by body, in the order in which they are added."""

    def __init__(self) -> None:
        self.namers: dict[str, Namer] = {}
        self.points: dict[str, list[DescribedPoint]] = {}

    def add(self, body: str, wanted: str, place: Vec, remark: str = "") -> str:
        """The end `body.point` of a new point. wanted: what it is called if that is free."""
        name = self.namers.setdefault(body, Namer("point")).name(wanted)
        self.points.setdefault(body, []).append(DescribedPoint(name, place, remark))
        return f"{body}.{name}"

    def of(self, body: str) -> tuple[DescribedPoint, ...]:
        """Those of a body."""
        return tuple(self.points.get(body, ()))
