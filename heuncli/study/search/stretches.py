"""Extremes over runs of cuts: of the whole stretch, not of the cuts that were asked for.

For a search the runs of a scene are looked at between their corners instead (loads/kinetostatics/stretch.py). Of each
quantity the highest and the lowest along the stretch are then two numbers over the instants, smooth but for kinks where
the place leaps, which no extreme is at.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.cuts import BEFORE, BEYOND, Cuts, attached, spread_on
from heuncli.loads.kinetostatics.stretch import DEGREE, Stretch, laid, stretch_of, summits
from heuncli.results.results import Array, Block, Extremes, Place
from heuncli.study.model.setup import Setup

HALVED = 2  # how often pieces are halved for what bends where loads change their sign: stresses, reduction lines


def stretched(setup: Setup, bent: bool) -> Setup:
    """The scene with its runs of cuts as whole stretches; bent: for what is no polynomial of loads."""
    mechanism, halved = setup.scene.mechanism, HALVED if bent else 0

    def whole(cuts: Cuts) -> Cuts | Stretch:
        if cuts.s is None or cuts.form is None:
            return cuts
        points = [point for _, point in attached(mechanism, cuts.body)]
        return stretch_of(cuts, points, [line for _, line in spread_on(mechanism, cuts.body)], halved=halved)

    return replace(setup, cuts=tuple(map(whole, setup.cuts)))


def stretch_named(setup: Setup, name: str) -> Stretch:
    """The stretch of the run of cuts with that name."""
    known: tuple[Cuts | Stretch, ...] = setup.cuts
    return next(cuts for cuts in known if isinstance(cuts, Stretch) and cuts.name == name)


def cut_at(setup: Setup, name: str, s: Array, ends: tuple[float, float]) -> Setup:
    """The scene cut once more: a stretch as cuts at distances (k,) [m] between the ends of one of its pieces."""
    return replace(setup, cuts=(laid(stretch_named(setup, name).asked, s, side_of(s, ends)),))


def at_places(setup: Setup, name: str, places: Sequence[Place]) -> Setup:
    """The scene with a run of cuts at these places alone, on the sides that they name."""
    asked = next(cuts for cuts in setup.cuts if cuts.name == name)
    side = np.array([{"before": BEFORE, "beyond": BEYOND}.get(place.side or "", 0.0) for place in places])
    return replace(setup, cuts=(laid(asked, np.array([place.s for place in places]), side),))


def side_of(s: Array, ends: tuple[float, float]) -> Array:
    """On which side of what acts at the ends of a piece cuts lie there."""
    return np.where(s <= ends[0], BEYOND, np.where(s >= ends[1], BEFORE, 0.0))


def envelope(values: Array) -> Array:
    """The lowest and the highest along a stretch, (n_t, 2), of what takes these values at its nodes, (n_t, 9 m)."""
    low, high = summits(values)
    return np.stack([-low.height, high.height], axis=1)


def extremes_at_a_blow(setup: Setup, blow: Block, quantities: Sequence[str]) -> dict[str, Extremes]:
    """The lowest and the highest of some quantities along each stretch, at a blow that was met with these cuts."""
    found: dict[str, Extremes] = {}
    for cuts in setup.cuts:
        if isinstance(cuts, Stretch):
            section = blow["sections"][cuts.name]
            both = [at_one_instant(cuts, section["s"], section[name]) for name in quantities]
            low, high = (np.array([one[side].value for one in both]) for side in (0, 1))
            at, column = np.full(len(both), float(blow["time"])), np.zeros(len(both), dtype=np.intp)
            places = tuple((low.place, high.place) for low, high in both)
            found[cuts.name] = Extremes(low, at, column, high, at, column, searched=True, places=places)
    return found


class Summit(NamedTuple):
    """An extreme along a stretch, and where it is."""

    value: float
    place: Place


def at_one_instant(stretch: Stretch, s: Array, values: Array) -> tuple[Summit, Summit]:
    """The lowest and the highest along a stretch of what takes the values (9 m,) at its nodes s."""
    low, high = envelope(values[None])[0].tolist()
    places = [stretch.place(*summit(s, values, side)[:2]) for side in (-1.0, 1.0)]
    return Summit(low + 0.0, places[0]), Summit(high + 0.0, places[1])


def summit(s: Array, values: Array, side: float) -> tuple[float, float, tuple[float, float]]:
    """Where the highest (side 1) or lowest (-1) of values at nodes (9 m,) lies: distance, side, ends of its piece."""
    top = summits(values[None])[side > 0.0]
    k, x = int(top.piece[0]) * (DEGREE + 1), float(top.at[0])
    a, b = float(s[k]), float(s[k + DEGREE])
    if x in (-1.0, 1.0):
        return (b, BEFORE, (a, b)) if x > 0.0 else (a, BEYOND, (a, b))
    return a + 0.5 * (b - a) * (x + 1.0), 0.0, (a, b)
