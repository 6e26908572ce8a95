"""Series of cuts as results hold them: their channels, the cuts that a table shows, and their extremes.

study/queries/bars.py evaluates the same loads anywhere along a bar.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, CutPosition, Extremes, Indices, Results
from heuncli.results.results_schema import RESULTANTS
from heuncli.study.quantities.channels import NO_UNITS, Channel, make_section_channels
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.table_units import DisplayUnit

MAX_CUTS = 25  # cuts of a diagram, evenly spaced; jumps and extremes are added


class CutSeries(NamedTuple):
    """One series of cuts.

    s: positions along the body [m]
    side: of each cut, which side of a load that acts there; None elsewhere
    channels: section forces, then stresses, (n_t, n_cuts) each
    length: the unit in which positions are shown
    """

    name: str
    heading: str
    s: Array
    side: tuple[str | None, ...]
    channels: tuple[Channel, ...]
    length: DisplayUnit = ("m", 1.0)

    @property
    def loads(self) -> tuple[Channel, ...]:
        """The section forces: N, Q1, Q2, T, M1, M2."""
        return self.channels[: len(RESULTANTS)]

    @property
    def stresses(self) -> tuple[Channel, ...]:
        """The stresses, after the section forces; none without section properties."""
        return self.channels[len(RESULTANTS) :]

    def find_nearest_cut(self, place: CutPosition) -> int:
        """Return the index of the cut at a place, or of the nearest one."""
        return int(np.argmin(np.abs(self.s - place.s))) if place.cut is None else place.cut


def collect_cut_series(results: Results, labels: Labels, units: Mapping[str, str] = NO_UNITS) -> list[CutSeries]:
    """Collect the series of cuts among the sections.

    units: replacements of units, for impulses instead of forces
    """
    found = []
    for name, section in results.sections.items():
        if "s" not in section:
            continue
        info = labels.sections.get(name)
        subject = f"{name}, body {info.body}" if info else name
        axis = f"e1 = {info.first_axis}, e2 = n × e1" if info else "e2 = n × e1"
        reference_point = info.moment_point if info else "the cut's point"
        meaning = f"{'impulse' if units else 'force'} of the far side on the near side of the cut; N > 0 tension"
        heading = f"SECTION {subject}  {meaning}; {axis}; moments about {reference_point}"
        side = tuple(section.get("side") or [None] * len(section["s"]))
        s = np.asarray(section["s"], dtype=np.float64)
        channels = make_section_channels(name, section, units)
        found.append(CutSeries(name, heading, s, side, channels, labels.units.find("m")))
    return found


def split_into_cuts(channels: Iterable[Channel], cuts: Indices) -> list[Channel]:
    """Return the channels at some single cuts of a series, quantity by quantity."""
    return [
        channel._replace(component=str(cut), values=channel.values[:, cut], axes=())
        for channel in channels
        for cut in cuts.tolist()
    ]


def choose_cuts(series: CutSeries) -> Indices:
    """Choose the cuts that a diagram shows, about MAX_CUTS: evenly spaced ones, both ends, all jumps and extremes."""
    n = len(series.s)
    if n <= MAX_CUTS:
        return np.arange(n)
    chosen = set(np.linspace(0, n - 1, MAX_CUTS // 2 + 1).round().astype(int).tolist())
    chosen |= {i for i, side in enumerate(series.side) if side is not None}
    for channel in series.channels:
        values = np.nan_to_num(channel.values)
        chosen |= {int(np.argmax(values.max(axis=0))), int(np.argmin(values.min(axis=0)))}
    return np.array(sorted(chosen))


def select_extremes(series: CutSeries, extremes: Extremes) -> Extremes:
    """Select the extremes of the section forces along a series, and of its stresses if these were searched."""
    known = set(extremes.paths)
    return extremes.find([channel.path for channel in series.channels if channel.path in known])


def find_sample_extremes(times: Array, values: Array) -> Extremes:
    """Return the lowest and highest of each column (n_t, n) among the samples."""
    low = np.argmin(np.nan_to_num(values, nan=np.inf), axis=0)
    high = np.argmax(np.nan_to_num(values, nan=-np.inf), axis=0)
    column = np.arange(values.shape[1])
    return Extremes(
        values[low, column], times[low], column, values[high, column], times[high], column, is_searched=False
    )


def merge_extremes(series: CutSeries, shown_cuts: Indices, head: Extremes, cuts: Extremes) -> tuple[Extremes, Extremes]:
    """Merge the extremes of the whole length and of its cuts, so that each is the better result of two searches."""
    ends, ends_at = np.stack([head.low, head.high]), np.stack([head.low_at, head.high_at])
    bounds, instants = np.stack([cuts.low, cuts.high]), np.stack([cuts.low_at, cuts.high_at])
    best_places = [list(both) for both in head.places]
    for i in range(len(best_places)):
        for side, sign in ((0, -1.0), (1, 1.0)):
            columns = slice(i * len(shown_cuts), (i + 1) * len(shown_cuts))
            best = int(np.argmax(np.nan_to_num(sign * bounds[side, columns], nan=-np.inf)))
            cut = int(shown_cuts[best])
            if sign * bounds[side, columns][best] > sign * ends[side, i]:
                ends[side, i], ends_at[side, i] = bounds[side, columns][best], instants[side, columns][best]
                best_places[i][side] = CutPosition(float(series.s[cut]), series.side[cut], cut)
            elif best_places[i][side].cut in shown_cuts:
                bounds[side, columns][shown_cuts == best_places[i][side].cut] = ends[side, i]
    places = tuple((low, high) for low, high in best_places)
    merged = head._replace(low=ends[0], high=ends[1], low_at=ends_at[0], high_at=ends_at[1], places=places)
    return merged, cuts._replace(low=bounds[0], high=bounds[1])
