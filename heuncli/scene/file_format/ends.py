"""Points of bodies, as joints, loads, couplings and sections name them."""

from __future__ import annotations

from heuncli.base.named_tuples import NamedTuple

Vec = tuple[float, float, float]


class End(NamedTuple):
    """A point of a body ("ground" or a body's name), in its axes; name is None for one given by coordinates."""

    body: str
    point: Vec
    name: str | None = None
