"""One thing of a scene that leaves a plane."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.multibody.reduction.plane.view import View
from heuncli.results.results import Array


@record
class Departure:
    """What leaves the plane, in words, and by how much, of the largest it could; acts: it is a load, blow or drive."""

    what: str
    size: float
    acts: bool = False


def beside(seen: View, height: float, body: int, point: Array, what: str) -> Iterator[Departure]:
    """A body's point, `what`, that should lie in the plane."""
    off = abs(seen.height(body, point) - height)
    if off > tolerances.FLAT * seen.reach:
        yield Departure(f"{what} lies {off:.1g} m beside it", off / seen.reach)
