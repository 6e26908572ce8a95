"""Points of bodies, as joints, loads, couplings and sections refer to them."""

from __future__ import annotations

from heuncli.base.named_tuples import NamedTuple

Vec = tuple[float, float, float]


class End(NamedTuple):
    """A point of a body ("ground" or a body's name), in the body's axes; name is None for a point given by
    coordinates.
    """

    body: str
    point: Vec
    name: str | None = None
