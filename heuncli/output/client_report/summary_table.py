"""The summary table of the first page: the greatest load of each joint, coupling and force, where and when."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.client_report.extremes import (
    DASH,
    MINUS,
    NOISE,
    GreatestOfCases,
    find_greatest_of_cases,
    find_uncertain_cases,
)
from heuncli.output.client_report.load_groups import iter_loaded_objects
from heuncli.output.client_report.report_data import ReportData, ReportedRun
from heuncli.output.documents.document import OutputColumn, OutputTable, TextCell, join_names
from heuncli.output.figures.turning import TURN, find_span, is_monotonic, list_angle_paths
from heuncli.output.tables.extremes_tables import MARK
from heuncli.results.results_schema import XYZ
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.digits import OPEN

MAX_LINES = 12
MIN_TURN = 0.75 * TURN  # of a joint that keeps turning
FOUNDATION = "foundation"
HEADING = "SUMMARY  greatest load of each, and its components there"
MORE_NOTE = "{} smaller ones: chapter Loads"
ALIKE_NOTE = "several names: the same greatest load; components and instant of the first"
MAX_ALIKE = 5  # further names in a line
DIGITS = re.compile(r"\d+")
UNCERTAIN_NOTE = "{}: open or unknown in {}, where it may be larger"


class SummaryLine(NamedTuple):
    """The greatest load of one object.

    type: of a coupling or force, if its name does not tell it
    greatest: None if it is open or unknown in all cases
    alike: names of objects of the same kind, such as small2 beside small1, with the same greatest load
    """

    name: str
    type: str
    greatest: GreatestOfCases | None
    paths: Sequence[str]
    alike: Sequence[str] = ()

    @property
    def rank(self) -> float:
        """The size by which lines are chosen, forces before moments [SI]."""
        return -1.0 if self.greatest is None else abs(self.greatest.value) * self.weight

    @property
    def weight(self) -> float:
        """1 for forces; moments count little, as they have no common size with forces."""
        return 1.0 if self.greatest is not None and self.greatest.ends.unit == "N" else 1e-6


def find_summary_lines(data: ReportData) -> list[SummaryLine]:
    """Find the greatest load of the foundation and of all that carries a load, the largest first."""
    lines = [_make_line(data, *each) for each in iter_loaded_objects(data)]
    lines = [line for line in lines if line.greatest is not None or _is_uncertain(data, line)]
    lines = _join_alike(lines)
    lines.sort(key=lambda line: -line.rank)
    foundation = _make_line(data, FOUNDATION, "", ["foundation.force"])
    if foundation.greatest is None:
        return lines
    return [*lines[: MAX_LINES - 1], foundation, *lines[MAX_LINES - 1 :]]


def _join_alike(lines: Sequence[SummaryLine]) -> list[SummaryLine]:
    """Join the lines of objects that differ by a number in their names alone, and have the same greatest load."""
    joined: dict[tuple[str, ...], SummaryLine] = {}
    for k, line in enumerate(lines):
        key: tuple[str, ...] = (str(k),)
        if line.greatest is not None:
            stem = DIGITS.sub("", line.name)
            key = (stem, line.greatest.path.partition(".")[0], line.greatest.text.lstrip(MINUS), line.greatest.run.name)
        first = joined.get(key)
        if first is None:
            joined[key] = line
        elif line.name not in (first.name, *first.alike):  # a rod and its drive, a joint and a coupling of one name
            joined[key] = first._replace(alike=(*first.alike, line.name))
    return list(joined.values())


def _make_line(data: ReportData, name: str, type_name: str, paths: Sequence[str]) -> SummaryLine:
    found = [each for path in paths if (each := find_greatest_of_cases(data, path, name)) is not None]
    return SummaryLine(name, type_name, max(found, key=lambda each: abs(each.value), default=None), paths)


def _is_uncertain(data: ReportData, line: SummaryLine) -> bool:
    return any(find_uncertain_cases(data, path) for path in line.paths)


def find_worst_instant(data: ReportData) -> tuple[ReportedRun, float | None]:
    """Find the case and the instant of the greatest force; without one the first of the first case."""
    lines = [line for line in find_summary_lines(data) if line.greatest is not None and line.greatest.ends.unit == "N"]
    if not lines:
        return data.runs[0], None
    inner = [line for line in lines if line.name != FOUNDATION] or lines
    greatest = max(inner, key=lambda line: line.rank).greatest
    assert greatest is not None
    return greatest.run, greatest.extreme.time


def make_summary_table(data: ReportData) -> OutputTable | None:
    """Make the table of at most MAX_LINES lines; None without any load."""
    lines = find_summary_lines(data)
    shown = lines[:MAX_LINES]
    if not any(line.greatest for line in shown):
        return None
    crank = find_crank(data)
    heads = [OutputColumn("", "text"), OutputColumn("greatest load")]
    heads += [OutputColumn(f"F{axis}") for axis in XYZ]
    heads += [OutputColumn("instant" if crank is None else "angle, instant")]
    heads += [OutputColumn("case", "text")] * data.has_cases
    rows = [_make_row(data, line, crank) for line in shown]
    kept = [k for k in range(len(heads)) if k < 2 or any(row[k].text not in ("", DASH) for row in rows)]
    notes = [MORE_NOTE.format(len(lines) - len(shown))] if len(lines) > len(shown) else []
    notes += [ALIKE_NOTE] if any(line.alike for line in shown) else []
    notes += [f"angle: of {describe_object('joints', crank, data.labels)}"] if crank is not None else []
    for line in shown:
        cases = list(dict.fromkeys(case for path in line.paths for case in find_uncertain_cases(data, path)))
        if cases and line.greatest is not None:
            notes.append(UNCERTAIN_NOTE.format(line.name, join_names(cases)))
    notes += dict.fromkeys(
        line.greatest.run.uncertain_instants.note
        for line in shown
        if line.greatest is not None and _mark(line.greatest).endswith(MARK)
    )
    return OutputTable(HEADING, [heads[k] for k in kept], [[row[k] for k in kept] for row in rows], notes, "page")


def _mark(greatest: GreatestOfCases) -> str:
    """Return the number with its unit, marked if smoothed friction has not reached its full value there."""
    if greatest.extreme.time is None or greatest.is_steady:
        return greatest.text
    kind = greatest.path.partition(".")[0]
    return greatest.run.uncertain_instants.add_mark(greatest.text, greatest.extreme.time, kind, greatest.ends.unit)


def _make_row(data: ReportData, line: SummaryLine, crank: str | None) -> list[TextCell]:
    """Make the cells of a line."""
    greatest = line.greatest
    blank = ["", "", ""]
    if greatest is None:
        cells = [_name_line(line), OPEN, *blank, "", *[""] * data.has_cases]
    else:
        instant = greatest.instant
        if instant:
            instant = f"{instant} s"
            if crank is not None:
                instant = f"{_format_angle(greatest.run, crank, greatest.extreme.time)}, {instant}"
        cells = [_name_line(line), _mark(greatest), *_format_components(greatest), instant]
        cells += [greatest.run.case_label] * data.has_cases
    return [TextCell(cell) for cell in cells]


def _name_line(line: SummaryLine) -> str:
    """Return the name of an object, those of others with the same load, and its type."""
    names = ", ".join((line.name, *line.alike[:MAX_ALIKE])) + " …" * (len(line.alike) > MAX_ALIKE)
    return f"{names} ({line.type})" if line.type else names


def _format_components(greatest: GreatestOfCases) -> list[str]:
    """Format the components of a force at the instant of its greatest magnitude; of a number without any: blanks."""
    if f"{greatest.path}.x" not in greatest.run.snapshot.numbers:
        return ["", "", ""]
    vector = greatest.run.find_vector(greatest.path, greatest.extreme.time)
    limit = NOISE * abs(greatest.value)
    return [
        OPEN if math.isnan(value) else DASH if abs(value) < limit else greatest.family.style.write(value)
        for value in vector.tolist()
    ]


def find_crank(data: ReportData) -> str | None:
    """Find the name of the joint whose angle tells the instants of a machine that keeps turning: the most loaded of
    those that are driven, or else supported by the ground; None if none turns far enough in all cases.
    """
    best, largest = None, -1.0
    for path in list_angle_paths(data.spec):
        name = path.split(".")[1]
        angles = [np.asarray(run.results.coordinates.get(name, {}).get("angle", [0.0])) for run in data.runs]
        if not all(np.isfinite(own).all() and is_monotonic(own) and find_span(own) > MIN_TURN for own in angles):
            continue
        greatest = find_greatest_of_cases(data, f"joints.{name}.force", name)
        force = abs(greatest.value) if greatest is not None else 0.0
        if force > largest:
            best, largest = name, force
    return best


def _format_angle(run: ReportedRun, crank: str, time: float | None) -> str:
    """Format the angle of the turning joint at the instant of an extreme."""
    angle = float(run.worst_results.coordinates[crank]["angle"][run.find_index(time)])
    return f"{math.degrees(angle):.0f}°".replace("-", MINUS)
