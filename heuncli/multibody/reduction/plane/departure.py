"""A departure: one thing of a scene that leaves a plane."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.multibody.reduction.plane.view import PlaneView
from heuncli.results.results import Array


@record
class Departure:
    """What leaves the plane, in words, and by how much relative to the largest possible; acts: it is a load, impulse or
    drive.
    """

    what: str
    size: float
    acts: bool = False


def height_departures(plane_view: PlaneView, height: float, body: int, point: Array, what: str) -> Iterator[Departure]:
    """Yield a departure if a body's point, described by `what`, does not lie in the plane."""
    distance = abs(plane_view.point_height(body, point) - height)
    if distance > tolerances.FLAT * plane_view.reach:
        yield Departure(f"{what} is {distance:.1g} m off the plane", distance / plane_view.reach)
