"""The summary of a run as rows: for each loaded thing its greatest load, with direction, instant and crank angle.

The extremes are those that the tables show; nothing is searched again. Directions and angles are evaluated at the
instants that were found. All numbers are SI.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.kinetostatics.actions import Action
from heuncli.output.tables.event_tables import make_impact_results
from heuncli.output.tables.extremes_tables import DoubtfulInstants
from heuncli.output.tables.page import Page, SearchedPage
from heuncli.output.tables.table_blocks import build_block
from heuncli.output.tables.table_plans import BEARING
from heuncli.output.tables.table_plans import IMPULSES as IMPULSE_PLANS
from heuncli.results.path_words import IMPULSE_UNITS
from heuncli.results.results import Array, CutPosition, Extremes, Results
from heuncli.results.results_schema import IMPULSES, SECTION_FORCES, SECTION_MOMENTS
from heuncli.scene.file_format.names import GROUND
from heuncli.study.quantities.captions import describe_path
from heuncli.study.quantities.channels import Channel, iter_impulse_channels
from heuncli.study.quantities.cut_series import collect_cut_series
from heuncli.study.queries.study import Study
from heuncli.study.search.grid import sort_distinct

MIN_TURN = 0.75 * 2.0 * math.pi  # of a joint whose angle tells the instants
DIRECTION_DECIMALS = 2  # shown of a unit vector; what is equal in these is one direction


class SummaryKind(NamedTuple):
    """A kind of things that get one line each.

    word: what they are
    alternatives: groups of quantities; the first group in which one is not zero tells, by its greatest
    repeats: a quantity beside which the line would say the same twice
    """

    word: str
    block: str
    alternatives: tuple[tuple[str, ...], ...]
    repeats: str = ""


KINDS = (
    SummaryKind("joint", "joints", (("tension",), ("force",), ("moment",))),
    SummaryKind("bearing", "joints", (("radial_force",), ("axial",))),
    SummaryKind("sensor", "sensors", (("force",), ("moment",))),
    SummaryKind("drive", "joints", (("drive",),), repeats="tension"),
    SummaryKind("stop", "stops", (("force",), ("moment",))),
    SummaryKind(
        "coupling", "couplings",
        (("tension", "last_tension", "tight", "normal", "contact", "force"), ("torque", "moment")),
    ),
    SummaryKind("load", "forces", (("force",), ("moment",), ("value",))),
    SummaryKind("", "foundation", (("force",), ("moment",))),
    SummaryKind(
        "section", "sections", (("stress.utilisation",), ("stress.mises",), SECTION_MOMENTS, SECTION_FORCES),
    ),
)  # fmt: skip


class SummaryRow(NamedTuple):
    """The greatest load of one thing, SI.

    kind: the word of its kind; name: of the thing
    value: of the greatest magnitude, with its sign unless it is a magnitude
    error: of the value
    direction (3,): of a vector, in the axes of the tables; None where there is none
    time: of the value; is_constant: it is equal at all instants
    angle: of the crank at that instant [rad]
    place: along a series of cuts
    is_partly_open: at other instants it is indeterminate
    is_doubtful: friction is not at its full value there
    is_given: it acts from outside, as the spec says
    share: of the greatest of its family, by which rows are ranked
    """

    kind: str
    name: str
    path: str
    label: str
    unit: str
    value: float
    error: float
    direction: tuple[float, ...] | None = None
    time: float = 0.0
    is_constant: bool = False
    angle: float | None = None
    place: CutPosition | None = None
    case: str = ""
    is_partly_open: bool = False
    is_doubtful: bool = False
    is_given: bool = False
    share: float = 0.0

    @property
    def block_path(self) -> str:
        """The path from its block on, without the number of an impulse."""
        return self.path.split(".", 2)[2] if self.path.startswith(f"{IMPULSES}.") else self.path


class Crank(NamedTuple):
    """The joint whose angle tells the instants, and its angles at given instants."""

    joint: str
    angles: Mapping[float, float]


class RunSummary(NamedTuple):
    """The rows of one run.

    crank: name of the joint whose angles the rows give, or empty
    is_searched: whether the extremes were searched between the output times
    doubtful_note: explains the mark of doubtful values
    """

    rows: Sequence[SummaryRow]
    crank: str = ""
    is_searched: bool = True
    doubtful_note: str = ""


def make_run_summary(
    study: Study, searched: SearchedPage, searched_channels: Sequence[Channel], case: str = ""
) -> RunSummary:
    """Make the summary of a run from the extremes of its tables.

    searched_channels: of the page, at the output times
    """
    page = searched.page
    channels = {channel.path: channel for channel in searched_channels}
    for series in collect_cut_series(page.results, page.labels):
        channels |= {channel.path: channel for channel in series.stresses}
    values = GreatestValues(searched, channels, {path: k for k, path in enumerate(searched.extremes.paths)}
                     if searched.extremes is not None else {})  # fmt: skip
    rows = [row for kind in KINDS for name in _list_names(kind, page.results)
            if (row := values.find_greatest(kind, name)) is not None]  # fmt: skip
    if not rows and page.results.impulses:
        rows = _make_impulse_rows(page)
        return RunSummary([row._replace(case=case) for row in _add_shares(rows, page.magnitudes.size)])
    rows = _add_shares(rows, page.magnitudes.size)
    crank = ""
    if rows:
        instants = sort_distinct(np.array([*(row.time for row in rows), *page.results.time[[0, -1]]]))
        rows, crank = _add_directions(study, rows, instants)
    is_searched = searched.extremes is None or searched.extremes.is_searched
    note = page.doubtful.note if any(row.is_doubtful for row in rows) else ""
    return RunSummary([row._replace(case=case) for row in rows], crank, is_searched, note)


def _make_impulse_rows(page: Page) -> list[SummaryRow]:
    """Make the rows of a scene that is struck alone: the greatest impulse of each thing over all impacts."""
    found: dict[tuple[str, str], SummaryRow] = {}
    for number, impulse in enumerate(page.results.impulses):
        view = make_impact_results(page.results, impulse)
        own = page._replace(results=view)
        channels = list(iter_impulse_channels(impulse, page.labels))
        blocks = [build_block(plan, view, page.labels, channels) for plan in IMPULSE_PLANS if plan.has_extremes]
        numbers = {
            row.path: row for block in blocks if block is not None for group in block.groups for row in group.rows
        }
        extremes: Extremes | None = None
        series_extremes = page.impact_extremes[number] if page.impact_extremes else {}
        for series in collect_cut_series(view, page.labels, IMPULSE_UNITS):
            numbers |= {channel.path: channel for channel in series.loads if series.name in series_extremes}
        for each in series_extremes.values():
            extremes = each if extremes is None else extremes.join(each)
        places = {path: k for k, path in enumerate(extremes.paths)} if extremes is not None else {}
        values = GreatestValues(SearchedPage(own, extremes), numbers, places)
        for kind in KINDS:
            for name in _list_names(kind, view):
                row = values.find_greatest(kind, name)
                best = found.get((kind.word, name))
                if row is None or (best is not None and abs(best.value) >= abs(row.value)):
                    continue
                vectors = _find_vectors(row, view, {})
                direction = None if vectors is None else _find_direction(vectors, 0)[0]
                time = float(impulse["time"])
                path = f"{IMPULSES}.{number}.{row.path}"
                found[kind.word, name] = row._replace(path=path, direction=direction, time=time, is_constant=False)
    return list(found.values())


def _list_names(kind: SummaryKind, results: Results) -> Sequence[str]:
    block = getattr(results, kind.block)
    if kind.word == "bearing":
        return [f"{name}{BEARING}{key}" for name, joint in block.items() for key in joint.get("bearings", ())]
    return [""] * bool(block) if kind.block == "foundation" else list(block)


class GreatestValues(NamedTuple):
    """The greatest values of a run: from the search, or at the only instant."""

    searched: SearchedPage
    channels: Mapping[str, Channel]
    numbers: Mapping[str, int]

    def find_greatest(self, kind: SummaryKind, name: str) -> SummaryRow | None:
        """Find the greatest load of a thing; None if it has none, or if it is indeterminate throughout."""
        if kind.repeats and f"{kind.block}.{name}.{kind.repeats}" in self.channels:
            return None
        for quantities in kind.alternatives:
            paths = [".".join(part for part in (kind.block, name, quantity) if part) for quantity in quantities]
            known_paths = [path for path in paths if path in self.channels]
            rows = [row for path in known_paths if (row := self._make_row(kind, name, path)) is not None]
            if rows:
                return max(rows, key=_compute_magnitude)
            if any(np.isnan(self.channels[path].values).all() for path in known_paths):
                return None
        return None

    def _make_row(self, kind: SummaryKind, name: str, path: str) -> SummaryRow | None:
        """Make the row of one quantity; None if it is zero or indeterminate throughout."""
        page, channel = self.searched.page, self.channels[path]
        low, high = self._find_extremes(path, channel)
        value, time, place = max(low, high, key=lambda end: (abs(end[0]), end[0] > 0.0))
        if math.isnan(value) or abs(value) <= page.stated_errors.rounding_of(channel.unit):
            return None
        error = page.stated_errors.find_error(channel)
        return SummaryRow(
            kind.word, name, path, describe_path(path, page.labels), channel.unit, value + 0.0, error, time=time,
            is_constant=high[0] - low[0] <= error and not channel.has_cuts, place=place,
            is_partly_open=bool(np.isnan(channel.values).any()), is_doubtful=_is_doubtful(page.doubtful, time, channel),
        )  # fmt: skip

    def _find_extremes(self, path: str, channel: Channel) -> Sequence[tuple[float, float, CutPosition | None]]:
        """Return lowest and highest value, each with its instant, and its place along a series of cuts."""
        extremes = self.searched.extremes
        if extremes is None or path not in self.numbers:
            at = float(self.searched.page.results.time[0])
            return [(float(channel.values.flat[0]), at, None)] * 2
        k = self.numbers[path]
        places = extremes.places[k] if channel.has_cuts and extremes.places else (None, None)
        return [
            (float(extremes.low[k]), float(extremes.low_at[k]), places[0]),
            (float(extremes.high[k]), float(extremes.high_at[k]), places[1]),
        ]


def _compute_magnitude(row: SummaryRow) -> float:
    return abs(row.value)


def _is_doubtful(doubtful: DoubtfulInstants, time: float, channel: Channel) -> bool:
    return bool(doubtful.add_mark("", time, channel.kind, channel.unit))


def _add_shares(rows: Sequence[SummaryRow], size: float) -> list[SummaryRow]:
    """Add to each row its share of the greatest of its family; a moment counts as a force with the scene's size as
    lever.
    """
    families = [(row.kind == "section", "load" if row.unit.startswith("N") else row.unit) for row in rows]
    weights = [abs(row.value) / (size if row.unit.startswith("N·m") else 1.0) for row in rows]
    largest: dict[tuple[bool, str], float] = {}
    for family, weight in zip(families, weights, strict=True):
        largest[family] = max(largest.get(family, 0.0), weight)
    return [row._replace(share=weight / largest[family])
            for row, family, weight in zip(rows, families, weights, strict=True)]  # fmt: skip


def _add_directions(study: Study, rows: Sequence[SummaryRow], instants: Array) -> tuple[list[SummaryRow], str]:
    """Add directions and angles of the crank, evaluated at the instants (n,) of the rows and the ends of the run."""
    blocks = {row.path.partition(".")[0] for row in rows}
    reports = frozenset({"motion", *(blocks & {"joints", "foundation"})})
    if study.has_one_instant:
        recovery, results = study.recovery, study.results
    else:
        recovery = study.find_recovery(instants, reports)
        results = study.compose_reports(recovery, reports)
    crank = _find_crank(study, results, instants, rows)
    loads = {own.load.name: own.action for own in recovery.loads} if "forces" in blocks else {}
    found = []
    for row in rows:
        k = 0 if study.has_one_instant else int(np.searchsorted(instants, row.time))
        vectors = _find_vectors(row, results, loads)
        angle = crank.angles.get(row.time) if crank is not None else None
        direction, is_steady = (None, True) if vectors is None else _find_direction(vectors, k)
        is_given = row.kind == "load" and row.name in loads and loads[row.name].from_end is None
        row = row._replace(direction=direction, angle=angle, is_given=is_given)
        found.append(row._replace(is_constant=row.is_constant and is_steady))
    return found, crank.joint if crank is not None else ""


def _find_vectors(row: SummaryRow, results: Results, loads: Mapping[str, Action]) -> Array | None:
    """Return the vectors (n, 3) at the evaluated instants whose magnitude, or value along a line, the row gives."""
    quantity = "moment" if row.unit.startswith("N·m") else "force"
    if row.kind == "joint":
        vectors = results.joints.get(row.name, {}).get(quantity)
        return None if vectors is None else np.asarray(vectors)
    if row.kind == "load" and row.name in loads:
        return loads[row.name].moment if row.unit == "N·m" else loads[row.name].force
    return results.foundation.get(quantity) if row.path.startswith("foundation.") else None


def _find_direction(vectors: Array, k: int) -> tuple[tuple[float, ...] | None, bool]:
    """Return the unit vector at instant k, None if it is not known, and whether all instants have the same."""
    sizes = np.sqrt(np.sum(vectors * vectors, axis=1, keepdims=True))
    if not (np.isfinite(sizes[k]) and sizes[k] > 0.0):
        return None, True
    units = vectors / np.where(sizes > 0.0, sizes, 1.0)
    shown = np.round(units, DIRECTION_DECIMALS)
    is_steady = bool((shown == shown[k]).all())
    return tuple((units[k] + 0.0).tolist()), is_steady


def _find_crank(study: Study, results: Results, instants: Array, rows: Sequence[SummaryRow]) -> Crank | None:
    """Find the joint whose angle tells the instants: a driven one, else one on the ground that turns round; of several
    the most loaded.
    """
    if study.has_one_instant:
        return None
    driven = set(_iter_driven_angles(study))
    angles = {name: np.asarray(block["angle"]) for name, block in results.coordinates.items() if "angle" in block}
    grounded = [name for name in angles if GROUND in (study.spec.joints[name].a, study.spec.joints[name].b)]
    turning = [name for name in grounded if abs(angles[name][-1] - angles[name][0]) > MIN_TURN]
    names = [name for name in angles if name in driven] or turning
    forces = {row.name: abs(row.value) for row in rows if row.kind == "joint"}
    if not names:
        return None
    name = max(names, key=lambda name: forces.get(name, 0.0))
    return Crank(name, dict(zip(instants.tolist(), angles[name].tolist(), strict=True)))


def _iter_driven_angles(study: Study) -> Iterator[str]:
    for drive in study.spec.drives.values():
        if "angle" in JOINTS[study.spec.joints[drive.joint].kind].coordinates:
            yield drive.joint
