"""Collect the named points of all bodies of a spec; names are unique within a body."""

from __future__ import annotations

from heuncli.scene.file_format.models import Vec
from heuncli.scene.importers.description import DescribedPoint
from heuncli.scene.importers.names import Namer


class BodyPoints:
    """Points by body, in the order in which they are added."""

    def __init__(self) -> None:
        self.namers: dict[str, Namer] = {}
        self.points: dict[str, list[DescribedPoint]] = {}

    def add(self, body: str, original: str, place: Vec, remark: str = "") -> str:
        """Add a point and return its end, `body.point`. original: its name, if that is still free."""
        name = self.namers.setdefault(body, Namer("point")).assign(original)
        self.points.setdefault(body, []).append(DescribedPoint(name, place, remark))
        return f"{body}.{name}"

    def get_points(self, body: str) -> tuple[DescribedPoint, ...]:
        """Return the points of a body."""
        return tuple(self.points.get(body, ()))
