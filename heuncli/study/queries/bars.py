"""Section loads all along a bar: at an instant, at an impact, and the lowest and highest over a run.

A series of cuts is evaluated along its whole length, not only at the cuts in the spec (loads/kinetostatics/stretch.py).
Between two of its corners (joints, loads, point masses, changes of shape) the loads are smooth in s, the distance along
it. At a corner they are evaluated on both sides, so that a jump has both its values at its exact place. The corner of a
load that moves over the body moves too, and is at its place of that instant.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.cut_planes import list_attachments
from heuncli.loads.kinetostatics.cuts import Cuts
from heuncli.loads.kinetostatics.stretch import Stretch, make_cuts_at
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.results.path_words import IMPULSE_UNITS
from heuncli.results.results import Array, Block, Results
from heuncli.results.results_schema import DEFLECTIONS, RESULTANT_UNITS, RESULTANTS
from heuncli.scene.file_format.couplings import Rope
from heuncli.study.model.setup import Setup
from heuncli.study.quantities.channels import Channel, make_section_channels
from heuncli.study.quantities.digits import StatedErrors, find_stated_errors
from heuncli.study.quantities.labels import make_labels
from heuncli.study.queries.bar_curves import (
    BarAttachment,
    BarExtremes,
    BarLine,
    BarRange,
    Extreme,
    MovingEdges,
    find_corners,
    find_line_extreme,
    make_interpolation,
    make_places,
)
from heuncli.study.queries.curves import choose_curve_instants, find_bounds, halve_steps
from heuncli.study.queries.study import Study
from heuncli.study.search import extremes
from heuncli.study.search.columns import ChannelSearch, StudyColumns
from heuncli.study.search.cuts import find_cut_extremes, find_stretch
from heuncli.study.search.grid import find_jump_sides, sort_distinct

SECTIONS = frozenset({"sections"})
DEFLECTION_PATHS = tuple(f"deflection.{name}" for name in DEFLECTIONS)
MAX_HALVINGS, MAX_INSTANTS = 4, 16_000  # halvings of the time steps; maximum number of instants


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
    def stated_errors(self) -> StatedErrors:
        """The stated errors of its loads."""
        return find_stated_errors(self.study.results, make_labels(self.study.spec), self.study.magnitudes)

    @property
    def quantities(self) -> tuple[str, ...]:
        """The six section forces; and deflections and slopes, if they are computed."""
        has_deflection = self.stretch.cuts.beam is not None and not self.has_impulses
        return RESULTANTS + DEFLECTION_PATHS * has_deflection

    def find_unit(self, quantity: str) -> str:
        """Return the SI unit of a quantity."""
        if quantity in DEFLECTION_PATHS:
            return "rad" if "slope" in quantity else "m"
        unit = RESULTANT_UNITS[quantity]
        return IMPULSE_UNITS[unit] if self.has_impulses else unit

    def find_error(self, quantity: str) -> float:
        """Return the stated error of a quantity, SI; not below the rounding error of the sums that it is computed
        from.
        """
        kind = "deflections" if quantity in DEFLECTION_PATHS else "sections"
        return self.stated_errors.error_of(kind, self.find_unit(quantity))

    @cached_property
    def attachments(self) -> list[BarAttachment]:
        """The joints, loads, ropes and point masses along it, ascending by their place; those of one place share it."""
        stretch, n = self.stretch, self.stretch.cuts.n
        mechanism = self.setup.scene.mechanism
        assert stretch.cuts.form is not None
        first = float(stretch.find_height(np.array(0.0)))
        masses = stretch.corners[stretch.cuts.form.has_mass_in_plane(n, stretch.corners)] - first
        supports = {
            ("joint", joint.name): "clamp" if joint.kind == "weld" else "support"
            for joint in mechanism.joints
            if GROUND in (joint.a, joint.b)
        }
        found = [
            BarAttachment(float(own.place @ n) - first, supports.get((own.kind, own.name), own.kind), own.name)
            for own in list_attachments(mechanism, stretch.body)
        ]
        found += [BarAttachment(float(point @ n) - first, "rope", name) for name, point in self._list_ropes()]
        found += [BarAttachment(s, "mass", "point mass") for s in masses.tolist()]
        found += self._find_gears([own.s for own in found])
        return self._merge_places(found)

    def _list_ropes(self) -> list[tuple[str, Array]]:
        """Return the ropes that act at points of the bar: name, and the point (3,) in its axes."""
        return [
            (coupling.name, np.asarray(point))
            for coupling in self.setup.scene.mechanism.couplings
            if isinstance(coupling.entry, Rope)
            for row in coupling.loading_rows
            for part in row.parts
            if not part.lies_on_sheave
            for owner, point in part.body_points
            if owner == self.stretch.body
        ]

    def _merge_places(self, attachments: Sequence[BarAttachment]) -> list[BarAttachment]:
        """Return what is along the bar, ascending: names once at each place, places within the tolerance as one."""
        tolerance = self.corner_tolerance
        distinct: dict[str, BarAttachment] = {}
        for own in attachments:
            if -tolerance <= own.s <= self.length + tolerance:
                same_place = next((other.s for other in distinct.values() if abs(other.s - own.s) <= tolerance), own.s)
                distinct.setdefault(f"{own.name} {same_place}", own._replace(s=same_place))
        return sorted(distinct.values(), key=lambda attachment: attachment.s)

    def _find_gears(self, known_places: Sequence[float]) -> list[BarAttachment]:
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
        return [BarAttachment(s, "gear", names[0] if len(names) == 1 else "gear") for s in places]

    def is_open_somewhere(self, quantity: str) -> bool:
        """Return whether a quantity is open (indeterminate for rigid bodies) at some cut and instant of the results."""
        results = self.study.results
        if quantity in DEFLECTION_PATHS:
            return bool(np.isnan(read_quantity(results.sections[self.name], quantity)).any())
        blocks = [impulse["sections"] for impulse in results.impulses] if self.has_impulses else [results.sections]
        return any(quantity in block[self.name]["open"] for block in blocks)

    @property
    def instants(self) -> Array:
        """The default instants, (n,): that of an impact or of a state, else all of the run."""
        if self.has_impulses:
            return np.array([float(impulse["time"]) for impulse in self.study.results.impulses])
        return choose_curve_instants(self.study)

    def solve_cuts(self, cuts: Cuts, time: float) -> Block:
        """Return the loads at some cuts, (k,) each, at an instant, or at the impact of that instant."""
        setup = replace(self.setup, cuts=(cuts,))
        if self.has_impulses:
            impulse = next(impulse for impulse in self.study.make_impulse_blocks(setup) if impulse["time"] == time)
            section: Block = impulse["sections"][self.name]
            return {name: np.asarray(section[name]) for name in ("s", *RESULTANTS)}
        section = self._compute_section(np.array([time]), setup)
        values = {name: read_quantity(section, name)[0] for name in self.quantities}
        return {"s": np.asarray(section["s"]).reshape(-1)} | values

    def _compute_section(self, times: Array, setup: Setup) -> Block:
        """Return its block at some instants; what does not depend on cuts stays for others, also of other bars."""
        recovery = self.study.find_recovery(times, SECTIONS, setup, keep=True)
        section: Block = self.study.compose_reports(recovery, SECTIONS).sections[self.name]
        return section

    def make_lines(self, time: float) -> dict[str, BarLine]:
        """Make the lines of all quantities along the bar at an instant."""
        nodes = self.solve_cuts(self.setup.cuts[0], time)
        s, side = make_places(find_corners(nodes["s"], self.corner_tolerance), self.corner_tolerance)
        loads = self.solve_cuts(make_cuts_at(self.stretch.cuts, s, side), time)
        lines = {}
        for name in self.quantities:
            extremes_of_line = [find_line_extreme(s, sign * loads[name], sign, time) for sign in (-1.0, 1.0)]
            if np.isfinite(nodes[name]).all():
                summits = find_cut_extremes(self.stretch, nodes["s"], nodes[name])
                extremes_of_line = [Extreme(summit.value, summit.place.s, time) for summit in summits]
            lines[name] = BarLine(time, s, loads[name], *extremes_of_line)
        return lines

    def make_ranges(self, known_extremes: BarExtremes | None = None) -> dict[str, BarRange]:
        """Make the ranges of all quantities along the bar over the run, up to its horizon.

        known_extremes: those, if they are searched already
        """
        times = choose_curve_instants(self.study)
        searched_extremes = {**(known_extremes or {})}
        for names in (RESULTANTS, self.quantities[len(RESULTANTS) :]):
            if not searched_extremes.keys() >= {*names}:
                searched_extremes |= self._search_extremes(names)
        all_extremes = [extreme for both in searched_extremes.values() for extreme in both]
        lines = {
            time: self.make_lines(time)
            for time in sort_distinct(np.array([extreme.time for extreme in all_extremes])).tolist()
        }
        s, low, high = self._find_bounds(times, [extreme.s for extreme in all_extremes])
        return {
            name: BarRange(s, low[i], high[i], *both, lines[both[0].time][name], lines[both[1].time][name])
            for i, (name, both) in enumerate((name, searched_extremes[name]) for name in self.quantities)
        }

    def _search_extremes(self, names: Sequence[str]) -> dict[str, tuple[Extreme, Extreme]]:
        """Search the lowest and highest value of quantities over the bar and the run, between places and samples."""
        name_of = {f"sections.{self.name}.{name}": name for name in names}

        def collect(results: Results) -> list[Channel]:
            """Return the channels of these quantities along this bar."""
            channels = make_section_channels(self.name, results.sections[self.name])
            return [channel for channel in channels if channel.path in name_of]

        search = ChannelSearch(collect, self.stated_errors.find_error)
        columns = StudyColumns(self.study, search, SECTIONS, self.setup)
        times, horizon = self.study.search_times, self.study.results.horizon
        times = times if horizon is None else times[times < horizon]
        found = columns.finish(extremes.search_extremes(columns.sample, times, columns.groups, errors=columns.errors))
        lows, highs = zip(found.low, found.low_at, strict=True), zip(found.high, found.high_at, strict=True)
        return {
            name_of[path]: (Extreme(float(low), place.s, float(low_at)), Extreme(float(high), other.s, float(high_at)))
            for path, (low, low_at), (high, high_at), (place, other) in zip(
                found.paths, lows, highs, found.places, strict=True
            )
        }

    def _find_bounds(self, times: Array, extra_places: Sequence[float]) -> tuple[Array, Array, Array]:
        """Return places along the bar (k,), including extra ones, and the lowest and highest values of all quantities,
        (n, k).
        """
        for _ in range(MAX_HALVINGS):
            nodes = self._compute_section(times, self.setup)
            jumps = find_jump_sides(times)
            moving = MovingEdges.from_section(nodes, self.corner_tolerance)
            moving_ends = find_corners(nodes["s"], 0.0) if moving is None else np.array(moving.end_places)
            corners = self.stretch.corners - float(self.stretch.find_height(np.array(0.0)))
            s, side = make_places(np.sort(np.append(corners, moving_ends)), self.corner_tolerance, extra_places)
            smooth = np.broadcast_to(~jumps[:, None], (len(jumps), len(s)))
            if moving is None:
                to_places = make_interpolation(nodes["s"], s, side)
                values = {name: read_quantity(nodes, name) @ to_places for name in self.quantities}
            else:
                cuts = make_cuts_at(self.stretch.cuts, s, side)
                section = self._compute_section(times, replace(self.setup, cuts=(cuts,)))
                values = {name: read_quantity(section, name) for name in self.quantities}
                smooth = smooth & ~moving.find_passes(s, self.corner_tolerance)
            all_bounds = [find_bounds(times, values[name], smooth, self.find_error(name)) for name in self.quantities]
            if all(quantity_bounds.is_fine for quantity_bounds in all_bounds) or len(times) > MAX_INSTANTS:
                break
            times = halve_steps(times, jumps)
        low, high = (
            np.stack([quantity_bounds.low for quantity_bounds in all_bounds]),
            np.stack([quantity_bounds.high for quantity_bounds in all_bounds]),
        )
        if moving is not None:
            moving.widen_bounds(s, side, low[: len(RESULTANTS)], high[: len(RESULTANTS)])  # deflections do not jump
        return s, low, high


def read_quantity(section: Block, quantity: str) -> Array:
    """Read a quantity of a section's block by its path, such as M1 or deflection.w2."""
    part, _, name = quantity.rpartition(".")
    return np.asarray(section[part][name] if part else section[name])
