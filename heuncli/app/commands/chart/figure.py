"""Draw a chart: error of the motion over time, both logarithmic, one line per method, legible in black and white.

Methods differ by dashes and markers; their kinds differ by dark colours. Names stand at the lines. The front is a
heavier line beneath. A failed run is a cross above the field, with its reason in a note.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from heuncli.analyses.work_precision.results import FAILED, ChartResults, ChartRun
from heuncli.app.commands.chart.label_placement import LabelBox, estimate_width, is_inside, place_labels
from heuncli.app.commands.chart.page import format_setting, make_remark
from heuncli.app.commands.chart.scale import (
    Scale,
    choose_scales,
    format_power,
    format_seconds,
    list_failures,
    list_points,
)
from heuncli.base.method_rows import find_method
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.base.tolerances import LOST
from heuncli.base.wrapping import wrap_text
from heuncli.output.drawing.shapes import MARKER_SHAPES, Line, Mark, Shape, Text, VectorDrawing

WIDTH, FIELD = 986.0, 480.0  # pixels: width of the drawing, height of the field
LEFT, RIGHT, BELOW = 84.0, 176.0, 56.0  # pixels: margins of the field
TITLE, SMALL, NAME = 17.0, 11.0, 12.5  # sizes of letters
LINE = 15.0  # of small text
LETTER = 0.6  # mean width of a letter, relative to its size
GRID, FAINT, GREY = "#b0b0b0", "#e2e2e2", "#444444"
FRONT = "#c8c8c8"
COLOURS = {"explicit": "#000000", "implicit": "#8c1515", "SciPy": "#555555"}
FIXED = "#123f7a"  # explicit, with fixed steps
DASHES: tuple[tuple[float, ...], ...] = ((), (7.0, 3.0), (2.0, 2.5), (9.0, 3.0, 2.0, 3.0), (4.0, 2.0), (12.0, 4.0))
CROSS = 4.0
CROSS_DISTANCE = 30.0  # pixels between two crosses on a line, with room for the number of a note
LABEL_POSITIONS = 24  # for the label of the reference's error, those near the borders first
ON_LINE = 8  # points checked on each stretch of a line
MAX_NOTES = 12


class ChartFrame(NamedTuple):
    """The field in pixels, and its scales."""

    box: LabelBox
    time_scale: Scale
    error_scale: Scale

    def x(self, value: float) -> float:
        """Return the pixel column of a time."""
        return self.box.left + self.time_scale.locate(value) * (self.box.right - self.box.left)

    def y(self, value: float) -> float:
        """Return the pixel row of an error."""
        return self.box.bottom - self.error_scale.locate(value) * (self.box.bottom - self.box.top)


def draw_figure(chart: ChartResults) -> VectorDrawing:
    """Draw the chart."""
    head = draw_heading(chart)
    groups = group_failures(chart)
    time_scale, error_scale = choose_scales(chart)
    levels = assign_levels([find_cross_positions(group, time_scale) for group in groups])
    top = head[-1].y + 22.0 + LINE * (max(levels, default=-1) + 1)
    box = LabelBox(LEFT, top, WIDTH - RIGHT, top + FIELD)
    frame = ChartFrame(box, time_scale, error_scale)
    notes = draw_notes(chart, groups, box.bottom + BELOW)
    bottom, occupied = draw_reference_error(chart, frame)
    shapes: list[Shape] = [*draw_grid(frame), *bottom, *draw_front(chart, frame), *draw_curves(chart, frame, occupied)]
    shapes += [*head, *draw_crosses(groups, levels, frame), *notes]
    height = max(text.y for text in notes) + 14.0
    return VectorDrawing(
        WIDTH, height, f"{escape(chart.title)}: speed versus accuracy", chart.reference.description, shapes
    )


def draw_heading(chart: ChartResults) -> list[Text]:
    """Return the title, and how well the reference is known."""
    title = wrap_lines(chart.title or "Speed against accuracy", TITLE)
    texts = [Text(20.0, 28.0 + 21.0 * k, text, TITLE, is_bold=True) for k, text in enumerate(title)]
    y = texts[-1].y
    reference = chart.reference
    sentences = (
        f"Compared up to t = {reference.last_time:.6g} s with a reference: {reference.description}",
        *reference.notes,
    )
    for sentence in sentences:
        for text in wrap_lines(sentence, SMALL):
            y += LINE
            texts.append(Text(20.0, y + 4.0, text, SMALL, colour=GREY))
    return texts


def wrap_lines(text: str, size: float) -> list[str]:
    """Split a text into lines that fit the drawing."""
    return wrap_text(escape(text), int((WIDTH - 40.0) / (LETTER * size)), 0)


def draw_grid(frame: ChartFrame) -> list[Shape]:
    """Draw the decades, their labels, and the titles of the axes."""
    box, shapes = frame.box, list[Shape]()
    for k, value in enumerate(reversed(frame.error_scale.decades)):
        y = frame.y(value)
        shapes.append(Line(((box.left, y), (box.right, y)), FAINT if k % 2 else GRID, 0.8))
        shapes.append(Text(box.left - 8.0, y + 4.0, format_power(value), SMALL, "end"))
    for value in frame.time_scale.minor_ticks:
        x = frame.x(value)
        shapes.append(Line(((x, box.top), (x, box.bottom)), FAINT, 0.8))
    label_boxes: list[LabelBox] = []
    for value in (*frame.time_scale.decades, *frame.time_scale.minor_ticks):
        x, text = frame.x(value), format_seconds(value)
        if value in frame.time_scale.decades:
            shapes.append(Line(((x, box.top), (x, box.bottom)), GRID, 0.8))
        half = estimate_width(text, SMALL) / 2 + 3.0
        label_box = LabelBox(x - half, 0.0, x + half, 1.0)
        if not any(label_box.overlaps(other) for other in label_boxes):
            label_boxes.append(label_box)
            shapes.append(Text(x, box.bottom + 16.0, text, SMALL, "middle"))
    edge = ((box.left, box.top), (box.right, box.top), (box.right, box.bottom), (box.left, box.bottom))
    shapes.append(Line((*edge, edge[0]), "#000000", 1.0))
    middle = (box.left + box.right) / 2
    shapes.append(Text(middle, box.bottom + 36.0, "processor time of the integration only", NAME, "middle"))
    y = (box.top + box.bottom) / 2
    shapes.append(
        Text(24.0, y, "largest error of any point, relative to the model size", NAME, "middle", is_vertical=True)
    )
    return shapes


def draw_reference_error(chart: ChartResults, frame: ChartFrame) -> tuple[list[Shape], list[LabelBox]]:
    """Draw the line of the reference's own error, below which errors cannot be told; returns the shapes and the box of
    its label.
    """
    reference_error, text = chart.reference.error["motion"], "error of the reference"
    if not reference_error:
        return [], []
    y, box, label_width = frame.y(reference_error), frame.box, estimate_width(text, SMALL)
    free_width = box.right - box.left - label_width - 12.0
    lefts = [
        box.left + 6.0 + free_width * k / LABEL_POSITIONS
        for k in sorted(range(LABEL_POSITIONS + 1), key=lambda k: min(k, LABEL_POSITIONS - k))
    ]
    rooms = [
        LabelBox(x, y + offset - SMALL, x + label_width, y + offset + 3.0) for offset in (13.0, -5.0) for x in lefts
    ]
    marks = [mark for runs in chart.runs_by_method.values() for mark in sample_line(runs, frame)]
    candidates = [each for each in rooms if is_inside(each, box)]
    best = min(candidates, key=lambda each: sum(each.expand(5.0).contains(*mark) for mark in marks))
    name = Text(best.left, best.bottom - 3.0, text, SMALL, colour=GREY)
    return [Line(((box.left, y), (box.right, y)), GREY, 1.2, (1.5, 3.0)), name], [best]


def sample_line(runs: Sequence[ChartRun], frame: ChartFrame) -> list[tuple[float, float]]:
    """Return points along the line of a method, including its markers."""
    ends = [(frame.x(p.seconds), frame.y(p.error)) for p in list_points(runs)]
    parts = [k / ON_LINE for k in range(1, ON_LINE + 1)]
    stretch_points = [(a + (c - a) * s, b + (d - b) * s) for (a, b), (c, d) in pairwise(ends) for s in parts]
    return [*ends[:1], *stretch_points]


def draw_front(chart: ChartResults, frame: ChartFrame) -> list[Shape]:
    """Draw the front as a heavy line."""
    best = sorted((p.seconds, p.error) for p in list_points(chart.runs) if p.front)
    if len(best) < 2:
        return []
    return [Line(tuple((frame.x(t), frame.y(e)) for t, e in best), FRONT, 9.0)]


def draw_curves(chart: ChartResults, frame: ChartFrame, occupied: Sequence[LabelBox]) -> list[Shape]:
    """Draw a line per method, with markers and name.

    occupied: boxes where no name may stand
    """
    shapes: list[Shape] = []
    names: list[tuple[str, Sequence[tuple[float, float]]]] = []
    colours: dict[str, str] = {}
    for k, (name, runs) in enumerate(chart.runs_by_method.items()):
        chart_points = list_points(runs)
        if not chart_points:
            continue
        colour, shape, filled = (
            choose_colour(name),
            list(MARKER_SHAPES)[k % len(MARKER_SHAPES)],
            k // len(MARKER_SHAPES) % 2 == 0,
        )
        places = tuple((frame.x(p.seconds), frame.y(p.error)) for p in chart_points)
        colours[name] = colour
        names.append((name, places))
        if len(places) > 1:
            shapes.append(Line(places, colour, 1.6, DASHES[k % len(DASHES)]))
        shapes += [Mark(x, y, shape, colour, filled) for x, y in places]
    for label in place_labels(names, frame.box, NAME, occupied):
        box = label.box
        if label.anchor is not None:
            shapes.append(Line((label.anchor, (box.left - 3.0, (box.top + box.bottom) / 2)), GRID, 0.8))
        shapes.append(
            Text(box.left, box.bottom - 0.3 * NAME, label.text, NAME, colour=colours[label.text], is_bold=True)
        )
    return shapes


def choose_colour(name: str) -> str:
    """Return the colour of a method's kind."""
    row = find_method(name)
    if row is None:
        return COLOURS["explicit"]
    return FIXED if row.kind == "explicit" and row.steps == "fixed" else COLOURS[row.kind]


class FailedRuns(NamedTuple):
    """Runs of a method that failed for the same reason, and the number of their note."""

    number: int
    runs: tuple[ChartRun, ...]


def group_failures(chart: ChartResults) -> list[FailedRuns]:
    """Group the runs that failed or were not run, by method and reason."""
    groups: dict[tuple[str, str, str], list[ChartRun]] = {}
    for run in list_failures(chart.runs):
        groups.setdefault((run.row.method, run.status, run.code), []).append(run)
    return [FailedRuns(k + 1, tuple(runs)) for k, runs in enumerate(groups.values())]


def find_cross_positions(group: FailedRuns, time_scale: Scale) -> list[float]:
    """Return the pixel columns of the crosses of a group, ascending; runs without a known time stand at the right
    border.
    """
    right = WIDTH - RIGHT
    return sorted(
        LEFT + time_scale.locate(run.seconds) * (right - LEFT) if run.seconds else right for run in group.runs
    )


def assign_levels(groups: Sequence[Sequence[float]]) -> list[int]:
    """Return the level above the field, from 0 on, of each group's crosses, so that none hides another."""
    lines: list[list[float]] = []
    levels = []
    for xs in groups:
        free_levels = (
            k
            for k, columns in enumerate(lines)
            if all(abs(x - other) > CROSS_DISTANCE for x in xs for other in columns)
        )
        k = next(free_levels, len(lines))
        if k == len(lines):
            lines.append([])
        lines[k] += xs
        levels.append(k)
    return levels


def draw_crosses(groups: Sequence[FailedRuns], levels: Sequence[int], frame: ChartFrame) -> list[Shape]:
    """Draw a cross for each failed run above the field, at the time of its end, with the note's number after the last
    cross.
    """
    shapes: list[Shape] = []
    for group, level in zip(groups, levels, strict=True):
        y = frame.box.top - 8.0 - LINE * level
        xs = find_cross_positions(group, frame.time_scale)
        for x in xs:
            for slope in (-CROSS, CROSS):
                shapes.append(
                    Line(((x - CROSS, y - slope), (x + CROSS, y + slope)), choose_colour(group.runs[0].row.method), 1.6)
                )
        shapes.append(Text(xs[-1] + CROSS + 3.0, y + 4.0, str(group.number), SMALL))
    return shapes


def draw_notes(chart: ChartResults, groups: Sequence[FailedRuns], y: float) -> list[Text]:
    """Return the notes below the field."""
    has_lost = any(point.error >= LOST for point in list_points(chart.runs))
    marks = "Heavy grey: Pareto front; no other run is better in both."
    marks += f" At the upper edge: errors of {LOST:g} or more." if has_lost else ""
    sentences = [marks, *chart.notes, *(format_note(group) for group in groups[:MAX_NOTES])]
    if len(groups) > MAX_NOTES:
        sentences.append(f"and {len(groups) - MAX_NOTES} more")
    texts = []
    for sentence in sentences:
        for text in wrap_lines(sentence, SMALL):
            texts.append(Text(20.0, y, text, SMALL, colour=GREY))
            y += LINE
    return texts


def format_note(group: FailedRuns) -> str:
    """Return which runs a cross stands for, and why they failed."""
    first = group.runs[0]
    kind = "step" if first.row.has_fixed_step else "tolerance"
    values = ", ".join(format_setting(run.row) for run in group.runs)
    others = " (the first)" if len(group.runs) > 1 and first.status == FAILED else ""
    return f"× {group.number}  {first.row.method}, {kind} {values}{others}: {make_remark(first)}"
