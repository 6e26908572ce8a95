"""Section loads all along a bar: at an instant, at an impact, and the lowest and highest over a run.

A series of cuts is evaluated along its whole length, not only at the cuts in the spec (loads/kinetostatics/stretch.py).
Between two of its corners (joints, loads, point masses, changes of shape) the loads are smooth in s, the distance along
it. At a corner they are evaluated on both sides, so that a jump has both its values at its exact place. The corner of a
load that moves over the body moves too, and is at its place of that instant.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from itertools import pairwise

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.cuts import BEFORE, BEYOND, Cuts, list_attachment_points
from heuncli.loads.kinetostatics.stretch import (
    DEGREE,
    SIDES,
    TO_COEFFICIENTS,
    Stretch,
    chebyshev_polynomials,
    make_cuts_at,
)
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.output.figures.courses import choose_instants
from heuncli.output.figures.summits import find_bounds, halve_steps
from heuncli.results.path_words import IMPULSE_UNITS
from heuncli.results.results import Array, Block, Mask, Results
from heuncli.results.results_schema import RESULTANT_UNITS, RESULTANTS
from heuncli.scene.file_format.couplings import Rope
from heuncli.study.model.setup import Setup
from heuncli.study.quantities.channels import Channel, make_section_channels
from heuncli.study.quantities.digits import StatedErrors, find_stated_errors
from heuncli.study.quantities.labels import make_labels
from heuncli.study.queries.study import Study
from heuncli.study.search import extremes
from heuncli.study.search.columns import ChannelSearch, StudyColumns
from heuncli.study.search.cuts import find_cut_extremes, find_stretch

SECTIONS = frozenset({"sections"})
N_PLACES, MIN_PLACES = 240, 8  # places along a bar, 3 pixels apart; minimum between two corners
MAX_HALVINGS, MAX_INSTANTS = 4, 16_000  # halvings of the time steps; maximum number of instants
SAME_MAGNITUDE = 1e-6  # relative difference of magnitudes that look equal in a figure


class Attachment(NamedTuple):
    """What acts on a bar at a place s [m]: a kind of ATTACHMENT_KINDS and its name."""

    s: float
    kind: str
    name: str


class Extreme(NamedTuple):
    """The lowest or highest value of a quantity along a bar, with its place s [m] and instant [s]."""

    value: float
    s: float
    time: float


BarExtremes = Mapping[str, tuple[Extreme, Extreme]]  # lowest and highest, by the six loads


class BarLine(NamedTuple):
    """A quantity along a bar at one instant.

    s: places (k,), twice where the quantity jumps
    values: (k,), nan where it is open
    """

    time: float
    s: Array
    values: Array
    low: Extreme
    high: Extreme


class BarRange(NamedTuple):
    """The lowest and highest values of a quantity over a run, at each place along a bar (k,), and of all places.

    at_lowest, at_highest: the quantity along the bar at the instants of the extremes
    """

    s: Array
    low: Array
    high: Array
    lowest: Extreme
    highest: Extreme
    at_lowest: BarLine
    at_highest: BarLine

    @property
    def main_line(self) -> BarLine:
        """The line at the instant of the largest magnitude; of two equal ones the first."""
        low, high = abs(self.lowest.value), abs(self.highest.value)
        if abs(high - low) <= SAME_MAGNITUDE * max(high, low):
            return min(self.at_lowest, self.at_highest, key=lambda line: line.time)
        return self.at_lowest if low > high else self.at_highest


class MovingEdges(NamedTuple):
    """Places of the loads that move over a bar, (n_t, m), and the quantities immediately beside them, (6, n_t, m).

    side (m,): on which side of the load
    fixed_places: of the loads that could move but stay at their places, such as of gears on a shaft
    """

    s: Array
    values: Array
    side: Array
    fixed_places: tuple[float, ...] = ()

    @classmethod
    def from_section(cls, section: Block, tolerance: float) -> MovingEdges | None:
        """Collect the ends of the pieces that move over a bar by more than a tolerance; None if none could move."""
        if section["s"].ndim == 1:
            return None
        ends = [..., [0, DEGREE]]
        s = section["s"].reshape(len(section["s"]), -1, DEGREE + 1)[*ends]
        values = np.stack([section[name].reshape(*s.shape[:2], DEGREE + 1)[*ends] for name in RESULTANTS])
        s = np.where(s[..., 1:] > s[..., :1], s, np.nan)  # a load at a corner has no values beside it
        is_known = np.isfinite(s)
        lowest, highest = np.min(np.where(is_known, s, np.inf), axis=0), np.max(np.where(is_known, s, -np.inf), axis=0)
        moves, is_fixed = highest > lowest + tolerance, np.isfinite(lowest) & (highest <= lowest + tolerance)
        sides = np.broadcast_to(SIDES[[0, DEGREE]], s.shape[1:])[moves]
        return cls(s[:, moves], values[:, :, moves], sides, tuple(lowest[is_fixed].tolist()))

    @property
    def end_places(self) -> list[float]:
        """The first and last place of all moving loads, and the places of those that stay."""
        moving = [float(f(self.s)) for f in (np.nanmin, np.nanmax)] if self.s.size else []
        return [*moving, *self.fixed_places]

    def find_passes(self, places: Array, tolerance: float) -> Mask:
        """Return whether a load passes places (k,), or comes as near as `tolerance`, between neighbouring instants,
        (n_t - 1, k).
        """
        has_passed = np.zeros((len(self.s) - 1, len(places)), dtype=bool)
        for s in self.s.T:
            low, high = np.minimum(s[:-1], s[1:]), np.maximum(s[:-1], s[1:])
            has_passed |= (low[:, None] - tolerance <= places) & (places <= high[:, None] + tolerance)
        return has_passed

    def widen_bounds(self, places: Array, side: Array, low: Array, high: Array) -> None:
        """Widen bounds (6, k) at places (k,), in place, by the values immediately beside a moving load when it is
        there.
        """
        a, b = self.s[:-1], self.s[1:]
        first = np.searchsorted(places, np.minimum(a, b), side="left")
        last = np.searchsorted(places, np.maximum(a, b), side="right")
        for k, j in zip(*np.nonzero((last > first) & (a != b)), strict=True):
            indices = np.arange(first[k, j], last[k, j])
            indices = indices[side[indices] != -self.side[j]]
            share = (places[indices] - a[k, j]) / (b[k, j] - a[k, j])
            values_there = (
                self.values[:, k, j, None] + share * (self.values[:, k + 1, j] - self.values[:, k, j])[:, None]
            )
            low[:, indices], high[:, indices] = (
                np.fmin(low[:, indices], values_there),
                np.fmax(high[:, indices], values_there),
            )


@record
class WholeBar:
    """A series of cuts of a solved scene as a bar, whose loads are computed anywhere along it."""

    study: Study
    name: str

    @cached_property
    def setup(self) -> Setup:
        """The scene with only this series of cuts, evaluated along its whole length."""
        whole = self.study.with_whole_cuts(False)
        return replace(whole, cuts=tuple(cuts for cuts in whole.cuts if cuts.name == self.name))

    @property
    def stretch(self) -> Stretch:
        """The run with its corners."""
        return find_stretch(self.setup, self.name)

    @property
    def corner_tolerance(self) -> float:
        """The distance within which two corners count as one [m]."""
        return 4.0 * self.stretch.cuts.plane_tolerance

    @property
    def length(self) -> float:
        """The distance from its first point to its last [m]."""
        s = self.stretch.cuts.s
        assert s is not None
        return float(s[-1])

    @property
    def has_impulses(self) -> bool:
        """Whether it carries impulses, in a scene that is only an impact."""
        return self.study.spec.analysis.type == "impulse" and bool(self.study.results.impulses)

    @cached_property
    def certain(self) -> StatedErrors:
        """The accuracy of its loads."""
        return find_stated_errors(self.study.results, make_labels(self.study.spec), self.study.magnitudes)

    def find_unit(self, quantity: str) -> str:
        """Return the SI unit of a quantity."""
        unit = RESULTANT_UNITS[quantity]
        return IMPULSE_UNITS[unit] if self.has_impulses else unit

    def find_error(self, quantity: str) -> float:
        """Return the stated error of a quantity, SI; not below the rounding error of the sums that it is computed
        from.
        """
        return self.certain.error_of("sections", self.find_unit(quantity))

    @cached_property
    def attachments(self) -> list[Attachment]:
        """The joints, loads, ropes and point masses along it, ascending by their place; those of one place share it."""
        stretch, n = self.stretch, self.stretch.cuts.n
        mechanism = self.setup.scene.mechanism
        assert stretch.cuts.form is not None
        tolerance, first = self.corner_tolerance, float(stretch.find_height(np.array(0.0)))
        masses = stretch.corners[stretch.cuts.form.has_mass_in_plane(n, stretch.corners)] - first
        supports = {
            f"joint {joint.name}": "clamp" if joint.kind == "weld" else "support"
            for joint in mechanism.joints
            if GROUND in (joint.a, joint.b)
        }
        ropes = [
            (f"rope {coupling.name}", np.asarray(point))
            for coupling in mechanism.couplings
            if isinstance(coupling.entry, Rope)
            for row in coupling.loading_rows
            for part in row.parts
            if not part.lies_on_sheave
            for owner, point in part.body_points
            if owner == stretch.body
        ]
        acting = [*list_attachment_points(mechanism, stretch.body), *ropes]
        found = [(float(point @ n) - first, what) for what, point in acting]
        found += [(s, "mass point mass") for s in masses.tolist()]
        found += self._find_gears([s for s, _ in found])
        distinct: dict[str, Attachment] = {}
        for s, what in found:
            if -tolerance <= s <= self.length + tolerance:
                same_place = next((other.s for other in distinct.values() if abs(other.s - s) <= tolerance), s)
                kind, _, name = what.partition(" ")
                distinct.setdefault(f"{name} {same_place}", Attachment(same_place, supports.get(what, kind), name))
        return sorted(distinct.values(), key=lambda attachment: attachment.s)

    def _find_gears(self, known_places: Sequence[float]) -> list[tuple[float, str]]:
        """Find the places where gears act that stay there: corners of the loads at both ends of the run, not known
        otherwise.
        """
        mechanism, body = self.setup.scene.mechanism, self.stretch.body
        names = [
            coupling.name
            for coupling in mechanism.couplings
            if any(part.kind == "mesh" and body in (part.a, part.b) for row in coupling.rows for part in row.parts)
        ]
        if not names:
            return []
        fixed = self.stretch.corners - float(self.stretch.find_height(np.array(0.0)))
        first, last = (
            find_corners(self.solve_cuts(self.setup.cuts[0], time)["s"], self.corner_tolerance)
            for time in (self.instants[[0, -1]]).tolist()
        )
        known = np.concatenate([fixed, known_places])
        places = [
            s
            for s in first.tolist()
            if np.abs(known - s).min() > self.corner_tolerance and np.abs(last - s).min() <= self.corner_tolerance
        ]
        return [(s, f"gear {names[0]}" if len(names) == 1 else "gear gear") for s in places]

    def is_open_somewhere(self, quantity: str) -> bool:
        """Return whether a quantity is open (indeterminate for rigid bodies) at some cut and instant of the results."""
        results = self.study.results
        blocks = [impulse["sections"] for impulse in results.impulses] if self.has_impulses else [results.sections]
        return any(quantity in block[self.name]["open"] for block in blocks)

    @property
    def instants(self) -> Array:
        """The default instants, (n,): that of an impact or of a state, else all of the run."""
        if self.has_impulses:
            return np.array([float(impulse["time"]) for impulse in self.study.results.impulses])
        return choose_instants(self.study)

    def solve_cuts(self, cuts: Cuts, time: float) -> Block:
        """Return the loads at some cuts, (k,) each, at an instant, or at the impact of that instant."""
        setup = replace(self.setup, cuts=(cuts,))
        if self.has_impulses:
            impulse = next(impulse for impulse in self.study.make_impulse_blocks(setup) if impulse["time"] == time)
            section: Block = impulse["sections"][self.name]
            return {name: np.asarray(section[name]) for name in ("s", *RESULTANTS)}
        section = self.study.compute_reports(np.array([time]), SECTIONS, setup).sections[self.name]
        return {"s": np.asarray(section["s"]).reshape(-1)} | {name: section[name][0] for name in RESULTANTS}

    def make_lines(self, time: float) -> dict[str, BarLine]:
        """Make the lines of all quantities along the bar at an instant."""
        nodes = self.solve_cuts(self.setup.cuts[0], time)
        s, side = make_places(find_corners(nodes["s"], self.corner_tolerance), self.corner_tolerance)
        loads = self.solve_cuts(make_cuts_at(self.stretch.cuts, s, side), time)
        lines = {}
        for name in RESULTANTS:
            extremes_of_line = [_find_extreme(s, side * loads[name], side, time) for side in (-1.0, 1.0)]
            if np.isfinite(nodes[name]).all():
                summits = find_cut_extremes(self.stretch, nodes["s"], nodes[name])
                extremes_of_line = [Extreme(summit.value, summit.place.s, time) for summit in summits]
            lines[name] = BarLine(time, s, loads[name], *extremes_of_line)
        return lines

    def make_ranges(self, known_extremes: BarExtremes | None = None) -> dict[str, BarRange]:
        """Make the ranges of all quantities along the bar over the run, up to its horizon.

        known_extremes: those, if they are searched already
        """
        times = choose_instants(self.study)
        searched_extremes = self._search_extremes() if known_extremes is None else known_extremes
        all_extremes = [extreme for both in searched_extremes.values() for extreme in both]
        lines = {
            time: self.make_lines(time)
            for time in extremes.sort_distinct(np.array([extreme.time for extreme in all_extremes])).tolist()
        }
        s, low, high = self._find_bounds(times, [extreme.s for extreme in all_extremes])
        return {
            name: BarRange(s, low[i], high[i], *both, lines[both[0].time][name], lines[both[1].time][name])
            for i, (name, both) in enumerate(searched_extremes.items())
        }

    def _search_extremes(self) -> dict[str, tuple[Extreme, Extreme]]:
        """Search the lowest and highest value of each quantity over the bar and the run, between places and samples."""

        def collect(results: Results) -> tuple[Channel, ...]:
            return make_section_channels(self.name, results.sections[self.name])[: len(RESULTANTS)]

        search = ChannelSearch(collect, self.certain.find_error)
        columns = StudyColumns(self.study, search, SECTIONS, self.setup)
        times, horizon = self.study.search_times, self.study.results.horizon
        times = times if horizon is None else times[times < horizon]
        found = columns.finish(extremes.search_extremes(columns.sample, times, columns.groups, errors=columns.errors))
        rows = zip(found.low, found.low_at, found.high, found.high_at, found.places, strict=True)
        return {
            name: (Extreme(float(a), low.s, float(a_at)), Extreme(float(b), high.s, float(b_at)))
            for name, (a, a_at, b, b_at, (low, high)) in zip(RESULTANTS, rows, strict=True)
        }

    def _find_bounds(self, times: Array, extra_places: Sequence[float]) -> tuple[Array, Array, Array]:
        """Return places along the bar (k,), including extra ones, and the lowest and highest values of all quantities
        (6, k).
        """
        for _ in range(MAX_HALVINGS):
            nodes = self.study.compute_reports(times, SECTIONS, self.setup).sections[self.name]
            jumps = extremes.find_jump_sides(times)
            moving = MovingEdges.from_section(nodes, self.corner_tolerance)
            moving_ends = np.array([] if moving is None else moving.end_places)
            corners = self.stretch.corners - float(self.stretch.find_height(np.array(0.0)))
            s, side = make_places(np.sort(np.append(corners, moving_ends)), self.corner_tolerance, extra_places)
            smooth = np.broadcast_to(~jumps[:, None], (len(jumps), len(s)))
            if moving is None:
                to_places = make_interpolation(nodes["s"], s, side)
                values = {name: nodes[name] @ to_places for name in RESULTANTS}
            else:
                cuts = make_cuts_at(self.stretch.cuts, s, side)
                values = self.study.compute_reports(times, SECTIONS, replace(self.setup, cuts=(cuts,))).sections[
                    self.name
                ]
                smooth = smooth & ~moving.find_passes(s, self.corner_tolerance)
            all_bounds = [find_bounds(times, values[name], smooth, self.find_error(name)) for name in RESULTANTS]
            if all(quantity_bounds.is_fine for quantity_bounds in all_bounds) or len(times) > MAX_INSTANTS:
                break
            times = halve_steps(times, jumps)
        low, high = (
            np.stack([quantity_bounds.low for quantity_bounds in all_bounds]),
            np.stack([quantity_bounds.high for quantity_bounds in all_bounds]),
        )
        if moving is not None:
            moving.widen_bounds(s, side, low, high)
        return s, low, high


def find_corners(nodes: Array, tolerance: float) -> Array:
    """Return the places where the pieces of a run with nodes (9 m,) begin, and where the last ends; without short
    pieces.
    """
    pieces = nodes.reshape(-1, DEGREE + 1)
    pieces = pieces[pieces[:, -1] - pieces[:, 0] > tolerance]
    return np.append(pieces[:, 0], pieces[-1, -1])


def make_interpolation(nodes: Array, s: Array, side: Array) -> Array:
    """Return the matrix (9 m, k) that interpolates values at the nodes (9 m,) to places (k,) on their sides."""
    corners = find_corners(nodes, 0.0)
    first, last = (np.searchsorted(corners[1:-1], s, side=side_name) for side_name in ("right", "left"))
    piece = np.where(side == BEFORE, last, first)
    a, b = corners[piece], corners[piece + 1]
    rows = chebyshev_polynomials((2.0 * s - a - b) / (b - a)) @ TO_COEFFICIENTS
    matrix = np.zeros((len(nodes), len(s)))
    for k in range(DEGREE + 1):
        matrix[(DEGREE + 1) * piece + k, np.arange(len(s))] = rows[:, k]
    return matrix


def make_places(corners: Array, tolerance: float, extra_places: Iterable[float] = ()) -> tuple[Array, Array]:
    """Return places along a bar with corners (m,), and their sides: both sides of each corner, close places between,
    extra ones.

    tolerance: corners that are no farther apart count as one
    """
    length = float(corners[-1] - corners[0])
    s, side = list[Array](), list[Array]()
    for a, b in pairwise(corners.tolist()):
        if b - a <= tolerance:
            continue
        count = max(MIN_PLACES, math.ceil(N_PLACES * (b - a) / length))
        inner_places = [a + (b - a) * k / count for k in range(1, count)] + [
            x for x in extra_places if a + tolerance < x < b - tolerance
        ]
        s.append(np.array([a, *sorted(inner_places), b]))
        side.append(np.array([BEYOND, *[0.0] * len(inner_places), BEFORE]))
    return np.concatenate(s), np.concatenate(side)


def _find_extreme(s: Array, heights: Array, side: float, time: float) -> Extreme:
    """Return the lowest (side -1, heights with their sign changed) or highest of the known values along a bar."""
    if np.isnan(heights).all():
        return Extreme(math.nan, math.nan, time)
    k = int(np.nanargmax(heights))
    return Extreme(side * float(heights[k]), float(s[k]), time)
