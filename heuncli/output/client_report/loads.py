"""The chapter of loads: the points of joints and bushings with their load at the instant of the greatest force, and the
extremes of foundation, joints, stops, couplings and forces.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.client_report.cases_table import (
    TOTAL,
    LoadGroup,
    drop_components,
    has_instants,
    iter_groups,
    make_cases_table,
)
from heuncli.output.client_report.extremes import (
    DASH,
    MINUS,
    NOISE,
    choose_style_in_unit,
    find_extremes,
    format_instant,
)
from heuncli.output.client_report.report_data import ReportData, ReportedRun
from heuncli.output.documents.document import OutputColumn, OutputTable, Part, Sentence, TextCell
from heuncli.output.machine_geometry.poses import extract_poses
from heuncli.output.tables.extremes_tables import MAX_FULL_GROUPS
from heuncli.output.tables.table_blocks import describe_chosen_components
from heuncli.output.tables.table_plans import COUPLINGS, FORCES, FOUNDATION, JOINTS, STOPS, TablePlan
from heuncli.results.results import Array
from heuncli.results.results_schema import XYZ
from heuncli.scene.file_format.loads import Bushing
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.digits import OPEN, choose_reader_style

MAX_CASES = 4  # with a row each for a point; if there are more, the governing one
MAX_POINTS = 40
HEADING = "POINTS  position, and load at the greatest force in each case; {}"
BUSHING_AXES = "bushings in their own axes"
PLACE_DECIMALS = {"m": 3, "mm": 1}
KIND_WORDS = {"joints": "joint", "forces": "bushing"}

NO_JOINTS_NOTE = "No joints, and no connection to the ground."
ONLY_IMPACTS_NOTE = "Only impulses are requested: see the impulses for the joints and the ground."
MAGNITUDES_NOTE = "{} {}: only magnitudes of vectors; components: heun run SPEC --format csv"
SUPPORTS_NOTE = "supports on the ground: the reactions of their joints, with the opposite sign"


class HardpointLoad(NamedTuple):
    """The load at a point of a joint or bushing at an instant: force and moment (3,), place in the world (3,), SI."""

    name: str
    run: ReportedRun
    time: float | None
    place: Array
    force: Array
    moment: Array
    error: tuple[float, float]


def make_hardpoint_table(data: ReportData) -> OutputTable | None:
    """Make the table of the points of joints and bushings; None if there are none, or too many."""
    things = [("joints", name) for name in data.runs[0].results.joints]
    things += [("forces", name) for name, force in data.spec.forces.items() if isinstance(force, Bushing)]
    if not things or len(things) > MAX_POINTS:
        return None
    captions = Counter(describe_object(kind, name, data.labels) for kind, name in things)
    loads = [load for kind, name in things for load in _iter_point_loads(data, kind, name, captions)]
    return _make_table(data, loads) if loads else None


def _iter_point_loads(data: ReportData, kind: str, name: str, captions: Counter[str]) -> Iterator[HardpointLoad]:
    """Yield the load of a point in each case, or in the governing one of many; captions: how often each occurs."""
    prefix, words = f"{kind}.{name}", describe_object(kind, name, data.labels)
    words = f"{KIND_WORDS[kind]} {words}" if captions[words] > 1 else words
    found = []
    for run in data.runs:
        ends = find_extremes(run, f"{prefix}.force")
        if ends is None or not isinstance(ends.high.value, float):
            continue
        time = ends.high.time
        k = run.find_index(time)
        force = run.find_vector(f"{prefix}.force", time)
        has_moment = "moment" in getattr(run.results, kind)[name]
        moment = run.find_vector(f"{prefix}.moment", time) if has_moment else np.zeros(3)
        moment_ends = find_extremes(run, f"{prefix}.moment") if has_moment else None
        errors = ends.error, moment_ends.error if moment_ends is not None else 0.0
        place = _locate(run, kind, name, k)
        found.append((ends.high.value, HardpointLoad(words, run, time, place, force, moment, errors)))
    if len(data.runs) > MAX_CASES and found:
        found = [max(found, key=lambda pair: pair[0])]
    yield from (load for _, load in found)


def _locate(run: ReportedRun, kind: str, name: str, k: int) -> Array:
    """Return the place in the world of a joint's "to" point, or of a bushing's "from" point, at instant number k."""
    if kind == "joints":
        joint = run.study.spec.joints[name]
        body, point = joint.b, joint.q
    else:
        force = run.study.spec.forces[name]
        assert isinstance(force, Bushing)
        body, point = force.from_.body, force.from_.point
    return extract_poses(run.worst_results).locate_points(body, np.asarray(point, dtype=np.float64), k)


def _make_table(data: ReportData, loads: Sequence[HardpointLoad]) -> OutputTable:
    """Make the table; a column in which nothing acts is left out."""
    largest_force = max((_find_length(load.force) for load in loads), default=0.0)
    largest_moment = max((_find_length(load.moment) for load in loads), default=0.0)
    force_unit = choose_reader_style("N", largest_force, data.units).unit
    moment_unit = choose_reader_style("N·m", largest_moment, data.units).unit
    place_unit, place_size = _choose_place_unit(data)
    decimals = PLACE_DECIMALS.get(place_unit, 4)
    columns = [OutputColumn("point", "text"), *([OutputColumn("case", "text")] if data.has_cases else [])]
    columns += [OutputColumn(f"{axis} [{place_unit}]") for axis in XYZ]
    columns += [OutputColumn(f"F{axis} [{force_unit}]") for axis in XYZ] + [OutputColumn(f"|F| [{force_unit}]")]
    columns += [OutputColumn(f"M{axis} [{moment_unit}]") for axis in XYZ]
    columns += [OutputColumn("at t [s]")] * has_instants(data)
    rows = []
    previous = ""
    for load in loads:
        cells = [load.name if load.name != previous else "", *([load.run.case_label] if data.has_cases else [])]
        previous = load.name
        cells += [_format_place(value * place_size, decimals) for value in load.place.tolist()]
        cells += _format_vector(data, "N", load.force, largest_force, load.error[0], has_length=True)
        cells += _format_vector(data, "N·m", load.moment, largest_moment, load.error[1])
        cells += [format_instant(load.time, load.run)] * has_instants(data)
        rows.append(cells)
    kept = [k for k, column in enumerate(columns) if k == 0 or any(row[k] not in (DASH, "0", "") for row in rows)]
    axes = data.runs[0].results.model.get("axes")
    words = f'reaction of "from" on "to", {f"axes of the {axes} body" if axes else "world axes"}'
    if any(isinstance(force, Bushing) for force in data.spec.forces.values()):
        words += f"; {BUSHING_AXES}"
    text_rows = [[TextCell(row[k]) for k in kept] for row in rows]
    return OutputTable(HEADING.format(words), [columns[k] for k in kept], text_rows, (), "page")


def _choose_place_unit(data: ReportData) -> tuple[str, float]:
    """Return the unit of places, and how many of it make a metre: mm unless the user chose another."""
    return data.units.find("m") if data.units.is_chosen("m") else ("mm", 1e3)


def _format_place(value: float, decimals: int) -> str:
    text = f"{value:.{decimals}f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text.replace("-", MINUS)


def _format_vector(
    data: ReportData, unit: str, vector: Array, unit_scale: float, error: float, *, has_length: bool = False
) -> list[str]:
    """Format the components of a vector, and its magnitude: four digits of this vector."""
    length = _find_length(vector)
    values = [*vector.tolist(), *([length] if has_length else [])]
    rounding = max(run.page.stated_errors.rounding_of(unit) for run in data.runs)
    style = choose_style_in_unit(data, unit, length, unit_scale, error)
    texts = []
    for value in values:
        if math.isnan(value):
            texts.append(OPEN)
        elif abs(value) < NOISE * length or length <= rounding:
            texts.append(DASH)
        else:
            texts.append(style.write_with_error(value))
    return texts


def _find_length(vector: Array) -> float:
    """Return the magnitude of the known components of a vector."""
    return float(np.sqrt(np.nansum(vector * vector)))


def make_load_parts(data: ReportData) -> list[Part]:
    """Make the tables of loads, or a sentence if there are none."""
    hardpoints = make_hardpoint_table(data)
    tables: list[Part] = [hardpoints] if hardpoints is not None else []
    tables += [part for plan in (FOUNDATION, JOINTS, STOPS, COUPLINGS, FORCES) for part in _iter_table(data, plan)]
    tables.sort(key=lambda table: isinstance(table, OutputTable) and table.fill == "half")
    tables = gather_notes(tables)
    if not any(data.runs[0].results.joints) and not data.spec.joints:
        return tables or [Sentence(NO_JOINTS_NOTE)]
    return tables or [Sentence(ONLY_IMPACTS_NOTE)]


def gather_notes(parts: Sequence[Part]) -> list[Part]:
    """Gather the notes that stand below several tables: once, below the last."""
    notes = [note for part in parts if isinstance(part, OutputTable) for note in part.notes]
    shared = [note for note in dict.fromkeys(notes) if notes.count(note) > 1]
    if not shared:
        return list(parts)
    own = [
        part._replace(notes=[note for note in part.notes if note not in shared])
        if isinstance(part, OutputTable)
        else part
        for part in parts
    ]
    return [*own, OutputTable("", notes=shared)]


def _iter_table(data: ReportData, plan: TablePlan) -> Iterator[Part]:
    """Yield the table of one kind of results, if the scene has it. What stands in another table is left out: supports
    of the foundation, components of bushings.
    """
    groups = list(iter_groups(data, plan))
    if not groups:
        return
    notes = []
    if plan.kind == "joints":
        notes = list(dict.fromkeys(note for run in data.runs for note in describe_chosen_components(run.results)))
    if plan is FOUNDATION:
        notes = [SUPPORTS_NOTE] if len(groups) > 1 else []
        groups = [group._replace(name="total") for group in groups if group.name == TOTAL]
    if plan is FORCES:
        groups = [_shorten_bushing(data, group) for group in groups]
    if len(groups) > MAX_FULL_GROUPS:
        groups = [drop_components(group) for group in groups]
        notes.append(MAGNITUDES_NOTE.format(len(groups), f"{plan.what or 'support'}s"))
    yield make_cases_table(data, plan.heading(data.runs[0].results, data.labels), groups, notes)


def _shorten_bushing(data: ReportData, group: LoadGroup) -> LoadGroup:
    """Drop the components of a bushing, which stand in the table of points."""
    return drop_components(group) if isinstance(data.spec.forces.get(group.key), Bushing) else group
