"""The machine on the first page, and the chapter on its model: bodies, joints and loads as tables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base.load_kinds import LOAD_KINDS
from heuncli.output.client_report.extremes import DASH, MINUS, format_instant, format_power
from heuncli.output.client_report.report_data import ReportData
from heuncli.output.client_report.summary_table import choose_drawn_run
from heuncli.output.documents.document import (
    Drawing,
    Fill,
    OutputColumn,
    OutputTable,
    Part,
    Sentence,
    TextCell,
    append_unit,
)
from heuncli.output.figures.courses import FigureSource, is_claimed
from heuncli.output.figures.scenes import make_scene_figure
from heuncli.output.machine_geometry.poses import Poses, extract_poses
from heuncli.output.tables.nouns import format_count
from heuncli.results.results import Array
from heuncli.results.results_schema import XYZ
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format.couplings import End
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.digits import choose_reader_style

SHEET_WIDTH = 672.0  # pixels: the width of an A4 sheet without its margins
HALF_WIDTH = 330.0
MAX_PARAMETERS, MAX_PARAMETER_CASES = 30, 6
PARAMETER_DIGITS = 5
MAX_HALF_CASES = 3  # beside the bodies
RATES = {"angle": "rate", "travel": "speed", "length": "speed"}  # of a drive that prescribes them
LAW_KEYS = ("value", "vector", "to_vector", "torque", "force")  # of loads
FIRST_HEIGHT = 330.0  # pixels of the machine on the first page
NO_POSITIONS = "No positions are claimed: all output times are past the horizon."
BODIES_HEADING = "BODIES  mass and centre of mass at the first instant"
JOINTS_HEADING = "JOINTS  with their points at the first instant"


def make_drawing_parts(data: ReportData, *, is_first_page: bool = True) -> list[Part]:
    """Make the figure of the machine at the instant of the greatest force; on the first page it is smaller."""
    run, time = choose_drawn_run(data)
    if not is_claimed(run.study):
        return [Sentence(NO_POSITIONS)]
    case = f", load case {run.case_label}" if run.name else ""
    times = None if time is None or run.study.has_one_instant else np.array([time])
    figure = make_scene_figure(FigureSource("", run.study), data.units, times)
    if is_first_page:
        panels = [panel._replace(height=min(panel.height, FIRST_HEIGHT)) for panel in figure.panels]
        figure = figure._replace(panels=panels)
    figure = figure._replace(title="", words=())
    instant = format_instant(time, run)
    where = f" at the instant of the greatest force, t = {instant} s" if instant else ""
    return [Drawing(figure, f"The machine{where}{case}", SHEET_WIDTH, "first" if is_first_page else "")]


def make_model_parts(data: ReportData) -> list[Part]:
    """Make the tables of bodies, joints and loads, and the degrees of freedom of the model."""
    run = data.runs[0]
    poses = extract_poses(run.worst_results)
    bodies, parameters = _make_body_table(data, poses), _make_parameter_table(data)
    if bodies is not None and parameters is not None and parameters.fill == "half":
        bodies = bodies._replace(fill="half")
    tables = [bodies, parameters, _make_joint_table(data, poses), _make_force_table(data)]
    model = run.results.model
    counts = [format_count(int(model["freedoms"]), "degree of freedom")] if "freedoms" in model else []
    redundant = model.get("redundant")
    counts += [format_count(redundant, "redundant constraint")] if isinstance(redundant, int) and redundant else []
    space = "Planar model" if "planar" in str(model.get("space", "")) else "Spatial model"
    return [Sentence(f"{', '.join([space, *counts])}."), *(table for table in tables if table is not None)]


def _make_body_table(data: ReportData, poses: Poses) -> OutputTable | None:
    """Make the table of the bodies of the model as it was solved."""
    bodies = [body for body in data.runs[0].study.setup.scene.mechanism.bodies if body.name in poses.positions]
    if not bodies:
        return None
    unit, per_si = data.units.find("m") if data.units.is_chosen("m") else ("mm", 1e3)
    columns = [OutputColumn("", "text"), OutputColumn("mass [kg]"), *(OutputColumn(f"{a} [{unit}]") for a in XYZ)]
    rows = []
    for body in bodies:
        place = poses.locate_points(body.name, np.asarray(body.center, dtype=np.float64), 0)
        mass = choose_reader_style("kg", float(body.mass), data.units).write(float(body.mass))
        name = describe_object("bodies", body.name, data.labels)
        rows.append([TextCell(name), TextCell(mass), *_make_place_cells(place, per_si, unit)])
    return OutputTable(BODIES_HEADING, columns, rows, (), "page")


def _make_joint_table(data: ReportData, poses: Poses) -> OutputTable | None:
    """Make the table of the joints with their kinds, bodies and places."""
    joints = data.runs[0].study.spec.joints
    if not joints:
        return None
    unit, per_si = data.units.find("m") if data.units.is_chosen("m") else ("mm", 1e3)
    columns = [OutputColumn(head, "text") for head in ("", "kind", "between")]
    columns += [OutputColumn(f"{axis} [{unit}]") for axis in XYZ]
    rows = []
    for name, joint in joints.items():
        known = joint.b in poses.positions or joint.b == "ground"
        place = poses.locate_points(joint.b, np.asarray(joint.q, dtype=np.float64), 0) if known else np.full(3, np.nan)
        bodies = " and ".join(describe_object("bodies", body, data.labels) for body in (joint.a, joint.b))
        words = (describe_object("joints", name, data.labels), joint.kind, bodies)
        rows.append([*map(TextCell, words), *_make_place_cells(place, per_si, unit)])
    return OutputTable(JOINTS_HEADING, columns, rows, (), "page")


def _make_force_table(data: ReportData) -> OutputTable | None:
    """Make the table of gravity, forces and drives, with the laws that the model gives them."""
    rows = [[TextCell(text) for text in row] for row in _iter_loads(data)]
    columns = [OutputColumn(head, "text") for head in ("", "kind", "acts on", "law, SI units")]
    kept = [k for k in range(len(columns)) if k < 3 or any(row[k].text for row in rows)]
    rows = [[row[k] for k in kept] for row in rows]
    return OutputTable("LOADS AND DRIVES", [columns[k] for k in kept], rows, (), "page") if rows else None


def _make_parameter_table(data: ReportData) -> OutputTable | None:
    """Make the table of the parameters; of several load cases with a column each, bold where a case has its own."""
    values = [run.study.spec.parameters for run in data.runs]
    if not values[0] or len(values[0]) > MAX_PARAMETERS or len(values) > MAX_PARAMETER_CASES:
        return None
    heads = [run.case_label for run in data.runs] if data.has_cases else ["value"]
    rows = []
    for name, usual in data.spec.parameters.items():
        numbers = [own.get(name, usual) for own in values]
        texts = [format_power(number, PARAMETER_DIGITS).replace("-", MINUS) for number in numbers]
        cells = [TextCell(text, number != usual) for text, number in zip(texts, numbers, strict=True)]
        label = data.labels.captions.get(f"parameters.{name}")
        rows.append([TextCell(f"{name} ({label})" if label else name), *cells])
    fill: Fill = "half" if len(heads) <= MAX_HALF_CASES else "page"
    return OutputTable("PARAMETERS  in SI units", [OutputColumn("", "text"), *map(OutputColumn, heads)], rows, (), fill)


def _iter_loads(data: ReportData) -> Iterator[Sequence[str]]:
    """Yield gravity, the forces and the drives of the model: name, kind, place, law."""
    spec = data.spec
    size = float(np.linalg.norm(spec.gravity))
    if size > 0.0:
        direction = ", ".join(f"{part:.4g}".replace("-", MINUS) for part in spec.gravity)
        yield "gravity", "acceleration", "all bodies", append_unit(f"({direction})", "m/s²")
    for name, force in spec.forces.items():
        ends = [getattr(force, key, None) for key in ("from_", "to", "on")]
        bodies = [describe_object("bodies", end.body, data.labels) for end in ends if isinstance(end, End)]
        joint, body = getattr(force, "joint", None), getattr(force, "body", None)
        place = " and ".join(bodies) or (joint and f"joint {joint}") or (body if isinstance(body, str) else "")
        kind = LOAD_KINDS[force.type].display_name
        yield describe_object("forces", name, data.labels), kind, str(place), _find_law(force)
    for name, drive in spec.drives.items():
        quantity = RATES.get(drive.quantity, drive.quantity) if drive.by_rate else drive.quantity
        place = f"joint {describe_object('joints', drive.joint, data.labels)}"
        yield describe_object("drives", name, data.labels), "drive", place, f"{quantity} = {drive.value.source}"


def _find_law(force: object) -> str:
    """Return the expressions of a load as the model states them; of a vector its three."""
    laws = []
    for key in LAW_KEYS:
        value = getattr(force, key, None)
        if isinstance(value, Expression):
            laws.append(f"{key} = {value.source}")
        elif isinstance(value, tuple) and value and all(isinstance(part, Expression) for part in value):
            laws.append(f"{key} = ({', '.join(part.source.removesuffix('.0') for part in value)})")
    return ", ".join(laws)


def _make_place_cells(place: Array, per_si: float, unit: str) -> list[TextCell]:
    """Make the cells of a place; a tenth of a millimetre counts."""
    decimals = 1 if unit == "mm" else 3 if unit == "m" else 4
    texts = []
    for value in (per_si * place).tolist():
        text = f"{value:.{decimals}f}".rstrip("0").rstrip(".")
        texts.append(DASH if text == "nan" else "0" if text in ("-0", "") else text.replace("-", MINUS))
    return [TextCell(text) for text in texts]
