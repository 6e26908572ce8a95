"""Named points of bodies and of the ground, gathered first and named then: a body names each of its points once."""

from __future__ import annotations

from collections.abc import Mapping

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import Vec
from heuncli.scene.importers.described import DescribedPoint
from heuncli.scene.importers.names import called, names_of
from heuncli.scene.importers.urdf.carriers import GROUND


class PointKey(NamedTuple):
    """A point that was gathered: who carries it, and its number there."""

    carrier: str
    number: int


class RobotPoints:
    """The points of one machine; kinds of names: `joint`, `link`."""

    def __init__(self) -> None:
        self.wanted: dict[str, list[tuple[str, str, Vec]]] = {}
        self.given: dict[str, list[str]] = {}
        self.bodies: Mapping[str, str] = {}

    def add(self, carrier: str, kind: str, wanted: str, place: Vec) -> PointKey:
        """A point of a carrier, by the name of the joint or link that it is of; place from the carrier's origin [m]."""
        own = self.wanted.setdefault(carrier, [])
        own.append((kind, wanted, place))
        return PointKey(carrier, len(own) - 1)

    def name_all(self, bodies: Mapping[str, str]) -> None:
        """Name them; bodies: the names of the carriers in the spec."""
        self.bodies = bodies
        self.given = {
            carrier: names_of("point", [wanted for _, wanted, _ in own]) for carrier, own in self.wanted.items()
        }

    def end(self, key: PointKey) -> str:
        """The point as an end of a joint: `arm.elbow`."""
        body = "ground" if key.carrier == GROUND else self.bodies[key.carrier]
        return f"{body}.{self.given[key.carrier][key.number]}"

    def of(self, carrier: str) -> tuple[DescribedPoint, ...]:
        """The points of a carrier."""
        own = zip(self.given.get(carrier, ()), self.wanted.get(carrier, ()), strict=True)
        return tuple(DescribedPoint(name, place, called(kind, name, wanted)) for name, (kind, wanted, place) in own)
