"""Collect the named points of bodies and of the ground, and name them at the end; names are unique within a body."""

from __future__ import annotations

from collections.abc import Mapping

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import Vec
from heuncli.scene.importers.description import DescribedPoint
from heuncli.scene.importers.names import assign_names, format_original_name
from heuncli.scene.importers.urdf.carriers import GROUND


class PointKey(NamedTuple):
    """Identifies a collected point: its carrier, and its number there."""

    carrier: str
    number: int


class RobotPoints:
    """The points of one machine; kinds of names: `joint`, `link`."""

    def __init__(self) -> None:
        self.entries: dict[str, list[tuple[str, str, Vec]]] = {}
        self.point_names: dict[str, list[str]] = {}
        self.bodies: Mapping[str, str] = {}

    def add(self, carrier: str, kind: str, original: str, place: Vec) -> PointKey:
        """Add a point to a carrier. original: the name of its joint or link; place: relative to the carrier's origin
        [m].
        """
        carrier_points = self.entries.setdefault(carrier, [])
        carrier_points.append((kind, original, place))
        return PointKey(carrier, len(carrier_points) - 1)

    def assign_names(self, bodies: Mapping[str, str]) -> None:
        """Assign the names. bodies: the names of the carriers in the spec."""
        self.bodies = bodies
        self.point_names = {
            carrier: assign_names("point", [wanted for _, wanted, _ in own]) for carrier, own in self.entries.items()
        }

    def format_end(self, key: PointKey) -> str:
        """Format a point as the end of a joint: `arm.elbow`."""
        body = "ground" if key.carrier == GROUND else self.bodies[key.carrier]
        return f"{body}.{self.point_names[key.carrier][key.number]}"

    def get_points(self, carrier: str) -> tuple[DescribedPoint, ...]:
        """Return the points of a carrier."""
        own = zip(self.point_names.get(carrier, ()), self.entries.get(carrier, ()), strict=True)
        return tuple(
            DescribedPoint(name, place, format_original_name(kind, name, wanted)) for name, (kind, wanted, place) in own
        )
