"""Section loads all along a bar: at an instant, at a blow, and the lowest and highest over a run.

A run of cuts is looked at as a whole stretch, not at the cuts that were asked for (loads/kinetostatics/stretch.py):
between two of its corners (joints, loads, point masses, changes of shape) the loads are smooth in s, the way along it;
at a corner they are taken on either side, so that a jump has both its values at its very place. Of what moves over the
body the corner moves, too, and is where it stands at that instant.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import cached_property
from itertools import pairwise

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.cuts import BEFORE, BEYOND, Cuts, attached
from heuncli.loads.kinetostatics.stretch import DEGREE, SIDES, TO_COEFFICIENTS, Stretch, chebyshev, laid
from heuncli.output.figures.courses import instants
from heuncli.output.figures.summits import bounds_of, halved
from heuncli.results.results import Array, Block, Mask, Results
from heuncli.results.results_schema import AT_A_BLOW, RESULTANT_UNITS, RESULTANTS
from heuncli.study.ask.study import Study
from heuncli.study.model.setup import Setup
from heuncli.study.quantities.digits import Certainty, certainty
from heuncli.study.quantities.labels import labels_of
from heuncli.study.search import extremes
from heuncli.study.search.columns import StudyColumns
from heuncli.study.search.extremes import ColumnSearch, no_columns
from heuncli.study.search.stretches import at_one_instant, stretch_named

SECTIONS = frozenset({"sections"})
ALONG, LEAST = 240, 8  # places along a bar, three pixels apart; and between two corners at least
HALVINGS, MOST = 4, 16_000  # of the steps between instants, and how many of these at most
SAME = 1e-6  # of the larger of two magnitudes: what is as large as the other in a picture


class Extreme(NamedTuple):
    """The lowest or the highest of a quantity along a bar: its value, place [m] and instant [s]."""

    value: float
    s: float
    at: float


class AlongBar(NamedTuple):
    """A quantity along a bar at one instant (k,): places, twice where it jumps; values, nan where it is open."""

    at: float
    s: Array
    values: Array
    low: Extreme
    high: Extreme


class Reach(NamedTuple):
    """The lowest and the highest of a quantity over a run, at each place along a bar (k,), and of all of them.

    at_lowest, at_highest: the quantity along the bar at the instants of these.
    """

    s: Array
    low: Array
    high: Array
    lowest: Extreme
    highest: Extreme
    at_lowest: AlongBar
    at_highest: AlongBar

    @property
    def line(self) -> AlongBar:
        """At the instant of the largest magnitude; of two that are as large, the first."""
        low, high = abs(self.lowest.value), abs(self.highest.value)
        if abs(high - low) <= SAME * max(high, low):
            return min(self.at_lowest, self.at_highest, key=lambda line: line.at)
        return self.at_lowest if low > high else self.at_highest


class Edges(NamedTuple):
    """Places at which loads that move over a bar stand, (n_t, m), and the quantities just beside them (6, n_t, m).

    side (m,): on which side of the load.
    """

    s: Array
    values: Array
    side: Array

    @classmethod
    def of(cls, section: Block) -> Edges | None:
        """The ends of the pieces of a stretch that move over it, of its block; None where all stand still."""
        if section["s"].ndim == 1:
            return None
        ends = [..., [0, DEGREE]]
        s = section["s"].reshape(len(section["s"]), -1, DEGREE + 1)[*ends]
        values = np.stack([section[name].reshape(*s.shape[:2], DEGREE + 1)[*ends] for name in RESULTANTS])
        s = np.where(s[..., 1:] > s[..., :1], s, np.nan)  # where it stands at a corner there is nothing beside it
        known = np.isfinite(s)
        moves = np.max(np.where(known, s, -np.inf), axis=0) > np.min(np.where(known, s, np.inf), axis=0)
        return cls(s[:, moves], values[:, :, moves], np.broadcast_to(SIDES[[0, DEGREE]], s.shape[1:])[moves])

    @property
    def turns(self) -> list[float]:
        """The first and the last place at which any of them stands, if one moves."""
        return [float(f(self.s)) for f in (np.nanmin, np.nanmax)] if self.s.size else []

    def passes(self, places: Array, near: float) -> Mask:
        """Between which neighbouring instants a load passes places (k,), or comes so near to them, (n_t - 1, k)."""
        found = np.zeros((len(self.s) - 1, len(places)), dtype=bool)
        for s in self.s.T:
            low, high = np.minimum(s[:-1], s[1:]), np.maximum(s[:-1], s[1:])
            found |= (low[:, None] - near <= places) & (places <= high[:, None] + near)
        return found

    def pass_over(self, places: Array, side: Array, low: Array, high: Array) -> None:
        """Widen bounds (6, k) at places (k,), in place, by what they are when a load stands there, just beside it."""
        a, b = self.s[:-1], self.s[1:]
        first = np.searchsorted(places, np.minimum(a, b), side="left")
        last = np.searchsorted(places, np.maximum(a, b), side="right")
        for k, j in zip(*np.nonzero((last > first) & (a != b)), strict=True):
            own = np.arange(first[k, j], last[k, j])
            own = own[side[own] != -self.side[j]]
            share = (places[own] - a[k, j]) / (b[k, j] - a[k, j])
            there = self.values[:, k, j, None] + share * (self.values[:, k + 1, j] - self.values[:, k, j])[:, None]
            low[:, own], high[:, own] = np.fmin(low[:, own], there), np.fmax(high[:, own], there)


@record
class WholeBar:
    """A run of cuts of a solved scene: a bar, of which the loads are told anywhere along it."""

    study: Study
    name: str

    @cached_property
    def setup(self) -> Setup:
        """The scene with this run alone, as a whole stretch."""
        whole = self.study.stretched(False)
        return replace(whole, cuts=tuple(cuts for cuts in whole.cuts if cuts.name == self.name))

    @property
    def stretch(self) -> Stretch:
        """The run with its corners."""
        return stretch_named(self.setup, self.name)

    @property
    def near(self) -> float:
        """How far apart corners along it are told apart [m]."""
        return 4.0 * self.stretch.asked.near

    @property
    def length(self) -> float:
        """From its first point to its last [m]."""
        s = self.stretch.asked.s
        assert s is not None
        return float(s[-1])

    @property
    def struck(self) -> bool:
        """Whether impulses are told of it, of a scene that is nothing but a blow."""
        return self.study.spec.analysis.type == "impulse" and bool(self.study.results.impulses)

    @cached_property
    def certain(self) -> Certainty:
        """How well its loads are known."""
        return certainty(self.study.results, labels_of(self.study.spec), self.study.magnitudes)

    def unit(self, quantity: str) -> str:
        """The SI unit of a quantity."""
        own = RESULTANT_UNITS[quantity]
        return AT_A_BLOW[own] if self.struck else own

    def error(self, quantity: str) -> float:
        """The stated error of a quantity, in SI; not below what the sums that it is of lose by rounding."""
        return self.certain.error("sections", self.unit(quantity))

    @cached_property
    def standing(self) -> list[tuple[float, list[str]]]:
        """What stands along it, joints, loads and point masses, by its place [m], ascending."""
        stretch, n = self.stretch, self.stretch.asked.n
        assert stretch.asked.form is not None
        near, first = self.near, float(stretch.height(np.array(0.0)))
        masses = stretch.corners[stretch.asked.form.masses_in_plane(n, stretch.corners)] - first
        acting = [
            (float(point @ n) - first, what) for what, point in attached(self.setup.scene.mechanism, stretch.body)
        ]
        found: dict[float, list[str]] = {}
        for s, what in [*acting, *((s, "point mass") for s in masses.tolist())]:
            if -near <= s <= self.length + near:
                at = next((other for other in found if abs(other - s) <= near), s)
                name = what.partition(" ")[2] if what != "point mass" else what
                if name not in found.setdefault(at, []):
                    found[at].append(name)
        return sorted(found.items())

    def open_somewhere(self, quantity: str) -> bool:
        """Whether the laws of rigid bodies leave a quantity open at some cut and instant that is asked for."""
        results = self.study.results
        blocks = [blow["sections"] for blow in results.impulses] if self.struck else [results.sections]
        return any(quantity in block[self.name]["open"] for block in blocks)

    @property
    def instants(self) -> Array:
        """The instants at which it is told without being asked: that of a blow, a state, else all of the run, (n,)."""
        if self.struck:
            return np.array([float(blow["time"]) for blow in self.study.results.impulses])
        return instants(self.study)

    def block(self, cuts: Cuts, at: float) -> Block:
        """The loads at some cuts, (k,) each, at an instant, or at the blow of that instant."""
        setup = replace(self.setup, cuts=(cuts,))
        if self.struck:
            blow = next(blow for blow in self.study.impulses(setup) if blow["time"] == at)
            own: Block = blow["sections"][self.name]
            return {name: np.asarray(own[name]) for name in ("s", *RESULTANTS)}
        own = self.study.reports_at(np.array([at]), SECTIONS, setup).sections[self.name]
        return {"s": np.asarray(own["s"]).reshape(-1)} | {name: own[name][0] for name in RESULTANTS}

    def at(self, at: float) -> dict[str, AlongBar]:
        """All quantities along the bar at an instant."""
        nodes = self.block(self.setup.cuts[0], at)
        s, side = places(corners_of(nodes["s"], self.near), self.near)
        told = self.block(laid(self.stretch.asked, s, side), at)
        found = {}
        for name in RESULTANTS:
            both = [_extreme(s, side * told[name], side, at) for side in (-1.0, 1.0)]
            if np.isfinite(nodes[name]).all():
                summits = at_one_instant(self.stretch, nodes["s"], nodes[name])
                both = [Extreme(one.value, one.place.s, at) for one in summits]
            found[name] = AlongBar(at, s, told[name], *both)
        return found

    def reaches(self) -> dict[str, Reach]:
        """All quantities along the bar over the run, up to its horizon."""
        times = instants(self.study)
        whole = self._searched()
        marked = [one for both in whole.values() for one in both]
        lines = {at: self.at(at) for at in extremes.distinct(np.array([one.at for one in marked])).tolist()}
        s, low, high = self._bounds(times, [one.s for one in marked])
        return {
            name: Reach(s, low[i], high[i], *both, lines[both[0].at][name], lines[both[1].at][name])
            for i, (name, both) in enumerate(whole.items())
        }

    def _searched(self) -> dict[str, tuple[Extreme, Extreme]]:
        """The lowest and the highest of each quantity along the bar and over the run, searched between all of it."""
        errors = np.array([self.error(name) for name in RESULTANTS])

        def along(results: Results) -> list[tuple[str, Array]]:
            return [(self.name, results.sections[self.name][name]) for name in RESULTANTS]

        searched = ColumnSearch(no_columns, (), errors, np.zeros(len(errors), dtype=bool), along)
        sampled = StudyColumns(self.study, searched, SECTIONS, self.setup)
        times, horizon = self.study.search_times, self.study.results.horizon
        times = times if horizon is None else times[times < horizon]
        found = sampled.placed(extremes.search(sampled.columns, times, sampled.groups, errors=errors))
        rows = zip(found.low, found.low_at, found.high, found.high_at, found.places, strict=True)
        return {
            name: (Extreme(float(a), low.s, float(a_at)), Extreme(float(b), high.s, float(b_at)))
            for name, (a, a_at, b, b_at, (low, high)) in zip(RESULTANTS, rows, strict=True)
        }

    def _bounds(self, times: Array, more: Sequence[float]) -> tuple[Array, Array, Array]:
        """Places along the bar (k,), some more among them, and the lowest and the highest of all quantities (6, k)."""
        for _ in range(HALVINGS):
            nodes = self.study.reports_at(times, SECTIONS, self.setup).sections[self.name]
            jumps = extremes.sides_of_jumps(times)
            moving = Edges.of(nodes)
            turns = np.array([] if moving is None else moving.turns)
            corners = self.stretch.corners - float(self.stretch.height(np.array(0.0)))
            s, side = places(np.sort(np.append(corners, turns)), self.near, more)
            smooth = np.broadcast_to(~jumps[:, None], (len(jumps), len(s)))
            if moving is None:
                to_places = between_nodes(nodes["s"], s, side)
                values = {name: nodes[name] @ to_places for name in RESULTANTS}
            else:
                cuts = laid(self.stretch.asked, s, side)
                values = self.study.reports_at(times, SECTIONS, replace(self.setup, cuts=(cuts,))).sections[self.name]
                smooth = smooth & ~moving.passes(s, self.near)
            found = [bounds_of(times, values[name], smooth, self.error(name)) for name in RESULTANTS]
            if all(own.fine for own in found) or len(times) > MOST:
                break
            times = halved(times, jumps)
        low, high = np.stack([own.low for own in found]), np.stack([own.high for own in found])
        if moving is not None:
            moving.pass_over(s, side, low, high)
        return s, low, high


def corners_of(nodes: Array, near: float) -> Array:
    """Where along a bar the pieces of a stretch with nodes (9 m,) begin, and the last ends; without short ones."""
    pieces = nodes.reshape(-1, DEGREE + 1)
    pieces = pieces[pieces[:, -1] - pieces[:, 0] > near]
    return np.append(pieces[:, 0], pieces[-1, -1])


def between_nodes(nodes: Array, s: Array, side: Array) -> Array:
    """What leads from values at the nodes (9 m,) of a stretch to those at places (k,) on their sides: (9 m, k)."""
    corners = corners_of(nodes, 0.0)
    first, last = (np.searchsorted(corners[1:-1], s, side=way) for way in ("right", "left"))
    piece = np.where(side == BEFORE, last, first)
    a, b = corners[piece], corners[piece + 1]
    rows = chebyshev((2.0 * s - a - b) / (b - a)) @ TO_COEFFICIENTS
    found = np.zeros((len(nodes), len(s)))
    for k in range(DEGREE + 1):
        found[(DEGREE + 1) * piece + k, np.arange(len(s))] = rows[:, k]
    return found


def places(corners: Array, near: float, more: Iterable[float] = ()) -> tuple[Array, Array]:
    """Places along a bar with corners (m,), and their sides: both sides of each corner, close places between, and more.

    near: corners that are no farther apart are one.
    """
    length = float(corners[-1] - corners[0])
    s, side = list[Array](), list[Array]()
    for a, b in pairwise(corners.tolist()):
        if b - a <= near:
            continue
        count = max(LEAST, math.ceil(ALONG * (b - a) / length))
        own = [a + (b - a) * k / count for k in range(1, count)] + [x for x in more if a + near < x < b - near]
        s.append(np.array([a, *sorted(own), b]))
        side.append(np.array([BEYOND, *[0.0] * len(own), BEFORE]))
    return np.concatenate(s), np.concatenate(side)


def _extreme(s: Array, heights: Array, side: float, at: float) -> Extreme:
    """The lowest (side -1, of values with their sign turned) or highest of what is known of values along a bar."""
    if np.isnan(heights).all():
        return Extreme(math.nan, math.nan, at)
    k = int(np.nanargmax(heights))
    return Extreme(side * float(heights[k]), float(s[k]), at)
