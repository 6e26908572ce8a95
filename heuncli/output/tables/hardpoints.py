"""The hardpoints of a run: where joints, couplings and loads act, with force and moment at each one's greatest force.

A row is what acts ON one end: for a joint the reaction of `from` on `to` about the `to` point, for a spring or a
coupling the load on each of its ends. The other end of a joint feels the opposite at the same place. Weight and inertia
are not rows: of a body at rest without weight the rows add up to zero.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.load_kinds import LOAD_KINDS
from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.kinetostatics.actions import Action, ActionEnd
from heuncli.loads.kinetostatics.reactions import JointLoads
from heuncli.multibody.mechanism.loads import GROUND as GROUND_INDEX
from heuncli.output.documents.as_data import FORMAT
from heuncli.output.documents.document import Cell, OutputColumn, OutputDocument, OutputTable
from heuncli.output.tables.extremes_tables import NOT_SEARCHED, PART
from heuncli.results.results import Array, Results
from heuncli.results.results_schema import XYZ
from heuncli.scene.file_format.names import GROUND
from heuncli.study.compose.recovery import Recovery
from heuncli.study.quantities.channels import Channel, iter_channels
from heuncli.study.quantities.digits import (
    OPEN,
    OPEN_NOTE,
    StatedErrors,
    Style,
    find_stated_errors,
    largest_magnitude,
    write_numbers,
    write_times,
)
from heuncli.study.quantities.labels import Labels
from heuncli.study.queries.study import Study
from heuncli.study.search.columns import ChannelSearch
from heuncli.version import VERSION

REPORTS = frozenset({"joints", "forces"})
# What is searched for its greatest magnitude, by block; the first that is not zero decides.
QUANTITIES: Mapping[str, tuple[str, ...]] = {
    "joints": ("force", "moment", "drive"), "stops": ("force", "moment"), "couplings": ("force", "moment"),
    "forces": ("value",),
}  # fmt: skip
HEADING = (
    'HARDPOINTS  each joint and load at its greatest force: joints "from" on "to", others on the named end; '
    "moment about the point"
)
WEIGHT_NOTE = "weight and inertia of the bodies are not listed"
NO_ROWS = "nothing to show: no joint, coupling or load acts at an instant"
AXES = {"world": "world axes", "from": 'axes and origin of the "from" body', "to": 'axes and origin of the "to" body'}
VECTORS = (("position", "", "m"), ("force", "F", "N"), ("moment", "M", "N·m"))
CSV_NAMES = (
    "point", "kind", "on", "from", "axes", *XYZ, *(f"F{axis}" for axis in XYZ), *(f"M{axis}" for axis in XYZ),
    "time", "case",
)  # fmt: skip


class Hardpoint(NamedTuple):
    """What acts ON one end, SI.

    kind: what exerts it; name: of that; end, other_end: that it acts on, and the other, as body.point
    axes: name of the body in whose axes, and from whose origin, the numbers are given; `world`
    position, force, moment (3,): the moment about the position; nan where indeterminate
    """

    kind: str
    name: str
    end: str
    other_end: str
    axes: str
    position: Array
    force: Array
    moment: Array
    time: float
    case: str = ""


class HardpointRun(NamedTuple):
    """The hardpoints of a run, and its length [s]; is_searched: whether it was searched between the output times."""

    rows: Sequence[Hardpoint]
    stated_errors: StatedErrors
    span: float
    is_searched: bool = True


class EndLoad(NamedTuple):
    """What acts on one end over the evaluated instants, world axes, (n, 3) each; instant: the path that decides it."""

    kind: str
    name: str
    path: str
    end: str
    other_end: str
    bodies: tuple[int, int]  # acted on, and the other
    position: Array
    force: Array
    moment: Array


def make_hardpoints(study: Study, labels: Labels, axes: str, case: str = "") -> HardpointRun:
    """Make the hardpoints of a run solved with joint loads in world axes.

    axes: `world`, `from` or `to` (those of the bodies that a row connects), or the name of a body
    """
    stated_errors = find_stated_errors(study.results, labels, study.magnitudes)
    instants, is_searched = _find_instants(study, labels, stated_errors)
    first = float(study.results.time[0])
    times = np.unique([first, *instants.values()])
    if study.has_one_instant:
        recovery, results = study.recovery, study.results
    else:
        recovery = study.find_recovery(times, REPORTS)
        results = study.compose_reports(recovery, REPORTS)
    rows = []
    for acting in _iter_acting(study, labels, recovery, results):
        time = instants.get(acting.path, first)
        k = 0 if study.has_one_instant else int(np.searchsorted(times, time))
        rows.append(_make_row(acting, recovery, k, axes)._replace(time=time, case=case))
    return HardpointRun(rows, stated_errors, float(np.ptp(study.results.time)), is_searched)


def _find_instants(study: Study, labels: Labels, stated_errors: StatedErrors) -> tuple[dict[str, float], bool]:
    """Find the instant of the greatest force, else moment, of each thing, by `block.name`."""

    def collect(results: Results) -> list[Channel]:
        return [
            number
            for channel in iter_channels(results, labels)
            if channel.quantity in QUANTITIES.get(channel.kind, ()) and not channel.cause
            and (channel.kind != "couplings" or PART in channel.name)
            for number in channel.numbers[-1:]
        ]  # fmt: skip

    channels = collect(study.results)
    if study.has_one_instant or not channels:
        return {}, True
    found = study.search_extremes(ChannelSearch(collect, stated_errors.find_error), REPORTS, whole=True)
    order = [quantity for quantities in QUANTITIES.values() for quantity in quantities]
    instants: dict[str, float] = {}
    for k in sorted(range(len(channels)), key=lambda k: order.index(channels[k].quantity)):
        channel, ends = channels[k], (float(found.low[k]), float(found.high[k]))
        size = max(map(abs, ends))
        if size > stated_errors.rounding_of(channel.unit):  # never if it is indeterminate: nan
            lower = abs(ends[0]) > abs(ends[1])
            instants.setdefault(f"{channel.kind}.{channel.name}", float((found.low_at if lower else found.high_at)[k]))
    return instants, found.is_searched


def _iter_acting(study: Study, labels: Labels, recovery: Recovery, results: Results) -> Iterator[EndLoad]:
    """Yield what acts, in the order of the tables: joints with their drives and stops, couplings, loads."""
    joints = {load.joint.name: load for load in recovery.joints}
    for name, block in results.joints.items():
        load, info = joints[name], labels.joints[name]
        bodies, ends = (load.joint.b, load.joint.a), (info.second_end, info.first_end)
        position, path = np.asarray(block["point"]), f"joints.{name}"
        yield EndLoad(
            info.type, name, path, *ends, bodies, position, np.asarray(block["force"]), np.asarray(block["moment"])
        )
        yield from (EndLoad(kind, own, path, *ends, bodies, position, force, moment)
                    for kind, own, force, moment, path in _iter_joint_additions(load))  # fmt: skip
    indices = {GROUND: GROUND_INDEX} | {body.name: i for i, body in enumerate(recovery.setup.scene.mechanism.bodies)}
    for name, block in results.couplings.items():
        kind = study.spec.couplings[name].type if name in study.spec.couplings else "wheel"
        for body, part in block["on"].items():
            others = [end for end in block["on"] if end != body]
            by = others[0] if len(others) == 1 else ""
            bodies = indices[body], indices[others[0] if others else body]
            vectors = (np.asarray(part[key]) for key in ("point", "force", "moment"))
            yield EndLoad(kind, name, f"couplings.{name}{PART}{body}", body, by, bodies, *vectors)
    mechanism = recovery.setup.scene.mechanism
    for applied in recovery.loads:
        if mechanism.spec_block(applied.load) == "forces":
            yield from _iter_load_ends(study, applied.action, LOAD_KINDS[applied.load.kind].display_name)


def _iter_joint_additions(load: JointLoads) -> Iterator[tuple[str, str, Array, Array, str]]:
    """Yield kind, name, force and moment of the drive and the stops of a joint, with the path that decides."""
    drive = load.joint.drive
    if drive is not None and load.drive is not None and load.axis is not None:
        yield "drive", drive.name, load.drive_force, load.drive_moment, f"joints.{load.joint.name}"
    for own in load.stops:
        yield "stop", own.stop.name, own.force, own.moment, f"stops.{own.stop.name}"


def _iter_load_ends(study: Study, action: Action, kind: str) -> Iterator[EndLoad]:
    """Yield the ends of a load: both where they are apart, else its `to` end."""
    ends = [action.to_end] if action.from_end is None or action.from_end.is_offset else [action.from_end, action.to_end]
    for end in ends:
        other = action.from_end if end is action.to_end else action.to_end
        sign = 1.0 if end is action.to_end else -1.0
        moment = action.moment if end is action.to_end else action.opposite_moment
        by = "" if other is None else _name_end(study, other)
        bodies = end.body, end.body if other is None else other.body
        yield EndLoad(
            kind, action.name, f"forces.{action.name}", _name_end(study, end), by, bodies,
            end.position, sign * action.force, moment,
        )  # fmt: skip


def _name_end(study: Study, end: ActionEnd) -> str:
    """Name an end as body.point, or as its body if no named point is there."""
    spec = study.spec
    bodies = study.setup.scene.mechanism.bodies
    body = GROUND if end.body == GROUND_INDEX else bodies[end.body].name
    points = spec.ground.points if body == GROUND else spec.bodies[body].points
    name = next(
        (name for name, point in points.items() if end.point is not None and tuple(point) == tuple(end.point)), ""
    )
    return f"{body}.{name}" if name else body


def _make_row(acting: EndLoad, recovery: Recovery, k: int, axes: str) -> Hardpoint:
    """Make the row at an instant, by its index, in the axes of a body, from its origin."""
    names = [body.name for body in recovery.setup.scene.mechanism.bodies]
    body = {"world": GROUND_INDEX, GROUND: GROUND_INDEX, "to": acting.bodies[0], "from": acting.bodies[1]}.get(axes)
    body = names.index(axes) if body is None else body
    vectors = acting.position[k], acting.force[k], acting.moment[k]
    label = "world"
    if body != GROUND_INDEX:
        R, origin, label = recovery.states.R[k, body], recovery.states.x[k, body], names[body]
        vectors = R.T @ (vectors[0] - origin), rotate_known(R, vectors[1]), rotate_known(R, vectors[2])
    position, force, moment = (np.asarray(vector) + 0.0 for vector in vectors)
    return Hardpoint(acting.kind, acting.name, acting.end, acting.other_end, label, position, force, moment, 0.0)


def rotate_known(R: Array, vector: Array) -> Array:
    """Express a world vector (3,) in the axes R (3, 3); a component is nan where an indeterminate one enters it."""
    enters = (np.abs(R.T) > tolerances.ZERO_COMPONENT) & np.isnan(vector)
    return np.where(enters.any(axis=1), np.nan, R.T @ np.nan_to_num(vector))


def make_hardpoint_document(
    title: str, facts: Sequence[tuple[str, str]], runs: Sequence[HardpointRun], labels: Labels, axes: str
) -> OutputDocument:
    """Make the document of the hardpoints of one run, or of one for each load case."""
    rows = [row for run in runs for row in run.rows]
    table = make_hardpoint_table(runs, labels, axes)

    def make_block() -> dict[str, Any]:
        return {"heun": FORMAT, "version": VERSION, "title": title, "hardpoints": [_make_block(row) for row in rows]}

    return OutputDocument(title, facts, [table], make_block, lambda: _make_records(rows))


def make_hardpoint_table(runs: Sequence[HardpointRun], labels: Labels, axes: str) -> OutputTable:
    """Make the table: a title for each joint, coupling or load, below it a row an end and load case."""
    rows = [row for run in runs for row in run.rows]
    heading = f"{HEADING}; {AXES.get(axes, f'axes and origin of {axes}')}"
    if not rows:
        return OutputTable(heading, notes=(NO_ROWS,))
    units = {name: labels.units.find(unit) for name, _, unit in VECTORS}
    columns = [OutputColumn("on", "text"), OutputColumn("case", "text")]
    texts: list[list[str]] = []
    for name, symbol, unit in VECTORS:
        values = units[name][1] * np.array([getattr(row, name) for row in rows])
        style = _choose_style(runs, name, unit, values, units[name][1])
        cells = write_numbers(values.ravel().tolist(), style)
        texts += [cells[i::3] for i in range(3)]
        columns += [OutputColumn(f"{symbol}{axis} [{units[name][0]}]", vector=name) for axis in XYZ]
    texts.append(write_times([row.time for row in rows], max(run.span for run in runs)))
    columns.append(OutputColumn("at [s]"))
    groups: dict[tuple[str, str], list[int]] = {}
    for i, row in enumerate(rows):
        groups.setdefault((row.kind, row.name), []).append(i)
    has_cases = any(row.case for row in rows)
    shown = [i for i in range(len(columns)) if i != 1 or has_cases]
    body: list[Sequence[Cell] | str] = []
    for members in groups.values():
        body.append(_make_title([rows[i] for i in members]))
        for i in members:
            cells_of_row = [rows[i].end, rows[i].case, *(column[i] for column in texts)]
            body.append(tuple(cells_of_row[j] for j in shown))
    is_open = any(OPEN in column for column in texts)
    notes = [WEIGHT_NOTE, *[OPEN_NOTE] * is_open, *[NOT_SEARCHED] * (not all(run.is_searched for run in runs))]
    return OutputTable(heading, tuple(columns[j] for j in shown), tuple(body), tuple(notes))


def _make_title(rows: Sequence[Hardpoint]) -> str:
    first = rows[0]
    ends = {row.end for row in rows}
    between = f", {first.other_end} → {first.end}" if len(ends) == 1 and first.other_end else ""
    return f"{first.name}  {first.kind}{between}"


def _choose_style(
    runs: Sequence[HardpointRun], name: str, unit: str, values: np.ndarray[Any, Any], size: float
) -> Style:
    """Choose the decimals of all vectors of one unit."""
    kind = "motion" if name == "position" else "reactions"
    styles = [run.stated_errors.choose_style(kind, unit, largest_magnitude(values) / size) for run in runs]
    return min(styles, key=lambda style: style.decimals)


def _make_block(row: Hardpoint) -> dict[str, Any]:
    vectors = {name: dict(zip(XYZ, vector, strict=True)) for name, vector in
               (("", row.position), ("F", row.force), ("M", row.moment))}  # fmt: skip
    numbers = {f"{name}{axis}": float(value) for name, vector in vectors.items() for axis, value in vector.items()}
    return {"point": row.name, "kind": row.kind, "on": row.end, "from": row.other_end, "axes": row.axes, **numbers,
            "time": row.time, "case": row.case or None}  # fmt: skip


def _make_records(rows: Sequence[Hardpoint]) -> OutputTable:
    return OutputTable("", tuple(OutputColumn(name) for name in CSV_NAMES), tuple(_iter_records(rows)))


def _iter_records(rows: Sequence[Hardpoint]) -> Iterator[tuple[Cell, ...]]:
    for row in rows:
        block = _make_block(row)
        yield tuple(None if value != value else value for value in (block[name] for name in CSV_NAMES))
