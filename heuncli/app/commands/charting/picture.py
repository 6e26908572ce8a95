"""A chart as a drawing: error of the motion over time, both logarithmic, a line a method, legible in black and white.

Methods differ by dashes and markers, their kinds by colours that are dark on paper, too; names stand at the lines. The
front is a heavier line beneath; what failed is a cross above the field, with its reason in a note.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from heuncli.analyses.charting.results import FAILED, ChartedRun, ChartResults
from heuncli.app.commands.charting.labels import LabelBox, inside, placed, wide
from heuncli.app.commands.charting.page import local, remark
from heuncli.app.commands.charting.scale import Scale, failures, points, power, scales, seconds
from heuncli.base.foreign_text import shown
from heuncli.base.method_rows import row_of
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.tolerances import LOST
from heuncli.base.wrapping import wrapped
from heuncli.output.drawing.picture import SHAPES, Line, Mark, Picture, Shape, Text

WIDTH, FIELD = 986.0, 480.0  # pixels: of the whole, and how high the field is
LEFT, RIGHT, BELOW = 84.0, 176.0, 56.0  # of the field
TITLE, SMALL, NAME = 17.0, 11.0, 12.5  # sizes of letters
LINE = 15.0  # of small text
LETTER = 0.6  # of the size of letters: their mean width in a sentence
GRID, FAINT, GREY = "#b0b0b0", "#e2e2e2", "#444444"
FRONT = "#c8c8c8"
COLOURS = {"explicit": "#000000", "implicit": "#8c1515", "SciPy": "#555555"}
FIXED = "#123f7a"  # explicit, with fixed steps
DASHES: tuple[tuple[float, ...], ...] = ((), (7.0, 3.0), (2.0, 2.5), (9.0, 3.0, 2.0, 3.0), (4.0, 2.0), (12.0, 4.0))
CROSS = 4.0
APART = 30.0  # of two crosses in a line, with the number of a note between
PLACES = 24  # in which the name of the reference's error may stand, those by the borders first
ON_LINE = 8  # places looked at on each stretch of a line
MOST_NOTES = 12


class Frame(NamedTuple):
    """The field in pixels, and its scales."""

    box: LabelBox
    across: Scale
    up: Scale

    def x(self, value: float) -> float:
        """Where a time stands."""
        return self.box.left + self.across.at(value) * (self.box.right - self.box.left)

    def y(self, value: float) -> float:
        """Where an error stands."""
        return self.box.bottom - self.up.at(value) * (self.box.bottom - self.box.top)


def picture(chart: ChartResults) -> Picture:
    """The drawing of a chart."""
    head = heading(chart)
    groups = failed(chart)
    across, up = scales(chart)
    levels = stacked([ends_of(group, across) for group in groups])
    top = head[-1].y + 22.0 + LINE * (max(levels, default=-1) + 1)
    box = LabelBox(LEFT, top, WIDTH - RIGHT, top + FIELD)
    frame = Frame(box, across, up)
    notes = foot(chart, groups, box.bottom + BELOW)
    bottom, taken = floor(chart, frame)
    shapes: list[Shape] = [*grid(frame), *bottom, *front(chart, frame), *curves(chart, frame, taken)]
    shapes += [*head, *crosses(groups, levels, frame), *notes]
    height = max(text.y for text in notes) + 14.0
    return Picture(WIDTH, height, f"{shown(chart.title)}: speed against accuracy", chart.reference.words, shapes)


def heading(chart: ChartResults) -> list[Text]:
    """The scene, and how well the reference is known."""
    title = lines_of(chart.title or "Speed against accuracy", TITLE)
    found = [Text(20.0, 28.0 + 21.0 * k, text, TITLE, bold=True) for k, text in enumerate(title)]
    y = found[-1].y
    reference = chart.reference
    told = (f"Judged up to t = {reference.until:.6g} s against a reference: {reference.words}", *reference.notes)
    for sentence in told:
        for text in lines_of(sentence, SMALL):
            y += LINE
            found.append(Text(20.0, y + 4.0, text, SMALL, colour=GREY))
    return found


def lines_of(text: str, size: float) -> list[str]:
    """A text in lines that fit the drawing."""
    return wrapped(shown(text), int((WIDTH - 40.0) / (LETTER * size)), 0)


def grid(frame: Frame) -> list[Shape]:
    """The decades, their names, and what the axes are."""
    box, found = frame.box, list[Shape]()
    for k, value in enumerate(reversed(frame.up.decades)):
        y = frame.y(value)
        found.append(Line(((box.left, y), (box.right, y)), FAINT if k % 2 else GRID, 0.8))
        found.append(Text(box.left - 8.0, y + 4.0, power(value), SMALL, "end"))
    for value in frame.across.between:
        x = frame.x(value)
        found.append(Line(((x, box.top), (x, box.bottom)), FAINT, 0.8))
    named: list[LabelBox] = []
    for value in (*frame.across.decades, *frame.across.between):
        x, text = frame.x(value), seconds(value)
        if value in frame.across.decades:
            found.append(Line(((x, box.top), (x, box.bottom)), GRID, 0.8))
        half = wide(text, SMALL) / 2 + 3.0
        room = LabelBox(x - half, 0.0, x + half, 1.0)
        if not any(room.meets(other) for other in named):
            named.append(room)
            found.append(Text(x, box.bottom + 16.0, text, SMALL, "middle"))
    edge = ((box.left, box.top), (box.right, box.top), (box.right, box.bottom), (box.left, box.bottom))
    found.append(Line((*edge, edge[0]), "#000000", 1.0))
    middle = (box.left + box.right) / 2
    found.append(Text(middle, box.bottom + 36.0, "processor time of the integration alone", NAME, "middle"))
    y = (box.top + box.bottom) / 2
    found.append(Text(24.0, y, "largest error of any point, of the scene's size", NAME, "middle", turned=True))
    return found


def floor(chart: ChartResults, frame: Frame) -> tuple[list[Shape], list[LabelBox]]:
    """What the reference may err by: below, nobody can tell. Its line, and its name with where that stands."""
    own, text = chart.reference.own["motion"], "the reference's own error"
    if not own:
        return [], []
    y, box, room = frame.y(own), frame.box, wide(text, SMALL)
    way = box.right - box.left - room - 12.0
    lefts = [box.left + 6.0 + way * k / PLACES for k in sorted(range(PLACES + 1), key=lambda k: min(k, PLACES - k))]
    rooms = [LabelBox(x, y + up - SMALL, x + room, y + up + 3.0) for up in (13.0, -5.0) for x in lefts]
    marks = [mark for runs in chart.by_method.values() for mark in along(runs, frame)]
    free = [each for each in rooms if inside(each, box)]
    best = min(free, key=lambda each: sum(each.wider(5.0).holds(*mark) for mark in marks))
    name = Text(best.left, best.bottom - 3.0, text, SMALL, colour=GREY)
    return [Line(((box.left, y), (box.right, y)), GREY, 1.2, (1.5, 3.0)), name], [best]


def along(runs: Sequence[ChartedRun], frame: Frame) -> list[tuple[float, float]]:
    """Places along the line of a method, its markers among them."""
    ends = [(frame.x(p.seconds), frame.y(p.error)) for p in points(runs)]
    parts = [k / ON_LINE for k in range(1, ON_LINE + 1)]
    between = [(a + (c - a) * s, b + (d - b) * s) for (a, b), (c, d) in pairwise(ends) for s in parts]
    return [*ends[:1], *between]


def front(chart: ChartResults, frame: Frame) -> list[Shape]:
    """The front as a heavy line."""
    best = sorted((p.seconds, p.error) for p in points(chart.runs) if p.front)
    if len(best) < 2:
        return []
    return [Line(tuple((frame.x(t), frame.y(e)) for t, e in best), FRONT, 9.0)]


def curves(chart: ChartResults, frame: Frame, taken: Sequence[LabelBox]) -> list[Shape]:
    """A line a method, with its markers and its name; taken: where no name can stand."""
    found: list[Shape] = []
    names: list[tuple[str, Sequence[tuple[float, float]]]] = []
    colours: dict[str, str] = {}
    for k, (name, runs) in enumerate(chart.by_method.items()):
        known = points(runs)
        if not known:
            continue
        colour, shape, filled = colour_of(name), list(SHAPES)[k % len(SHAPES)], k // len(SHAPES) % 2 == 0
        places = tuple((frame.x(p.seconds), frame.y(p.error)) for p in known)
        colours[name] = colour
        names.append((name, places))
        if len(places) > 1:
            found.append(Line(places, colour, 1.6, DASHES[k % len(DASHES)]))
        found += [Mark(x, y, shape, colour, filled) for x, y in places]
    for label in placed(names, frame.box, NAME, taken):
        box = label.box
        if label.to is not None:
            found.append(Line((label.to, (box.left - 3.0, (box.top + box.bottom) / 2)), GRID, 0.8))
        found.append(Text(box.left, box.bottom - 0.3 * NAME, label.text, NAME, colour=colours[label.text], bold=True))
    return found


def colour_of(name: str) -> str:
    """The colour of a method's kind."""
    row = row_of(name)
    if row is None:
        return COLOURS["explicit"]
    return FIXED if row.kind == "explicit" and row.steps == "fixed" else COLOURS[row.kind]


class FailedRuns(NamedTuple):
    """Runs of a method that failed for one reason; the note's number."""

    number: int
    runs: tuple[ChartedRun, ...]


def failed(chart: ChartResults) -> list[FailedRuns]:
    """What failed or was not run, by method and reason."""
    found: dict[tuple[str, str, str], list[ChartedRun]] = {}
    for run in failures(chart.runs):
        found.setdefault((run.row.method, run.status, run.code), []).append(run)
    return [FailedRuns(k + 1, tuple(runs)) for k, runs in enumerate(found.values())]


def ends_of(group: FailedRuns, across: Scale) -> list[float]:
    """Where the crosses of a group stand from left to right; what took no time that is known at the border."""
    right = WIDTH - RIGHT
    return sorted(LEFT + across.at(run.seconds) * (right - LEFT) if run.seconds else right for run in group.runs)


def stacked(groups: Sequence[Sequence[float]]) -> list[int]:
    """The line above the field, from 0 on, in which the crosses of each group stand so that none hides another."""
    lines: list[list[float]] = []
    found = []
    for xs in groups:
        free = (k for k, taken in enumerate(lines) if all(abs(x - other) > APART for x in xs for other in taken))
        k = next(free, len(lines))
        if k == len(lines):
            lines.append([])
        lines[k] += xs
        found.append(k)
    return found


def crosses(groups: Sequence[FailedRuns], levels: Sequence[int], frame: Frame) -> list[Shape]:
    """A cross for each run that failed, above the field where its time ended; beside the first its note's number."""
    found: list[Shape] = []
    for group, level in zip(groups, levels, strict=True):
        y = frame.box.top - 8.0 - LINE * level
        xs = ends_of(group, frame.across)
        for x in xs:
            for up in (-CROSS, CROSS):
                found.append(Line(((x - CROSS, y - up), (x + CROSS, y + up)), colour_of(group.runs[0].row.method), 1.6))
        found.append(Text(xs[-1] + CROSS + 3.0, y + 4.0, str(group.number), SMALL))
    return found


def foot(chart: ChartResults, groups: Sequence[FailedRuns], y: float) -> list[Text]:
    """The notes below the field."""
    lost = any(point.error >= LOST for point in points(chart.runs))
    marks = "Heavy grey: the front, which no other run beats in both."
    marks += f" At the upper border: errors of {LOST:g} and more." if lost else ""
    told = [marks, *chart.notes, *(note(group) for group in groups[:MOST_NOTES])]
    if len(groups) > MOST_NOTES:
        told.append(f"and {len(groups) - MOST_NOTES} more")
    found = []
    for sentence in told:
        for text in lines_of(sentence, SMALL):
            found.append(Text(20.0, y, text, SMALL, colour=GREY))
            y += LINE
    return found


def note(group: FailedRuns) -> str:
    """Which runs a cross is, and why."""
    first = group.runs[0]
    kind = "step" if first.row.fixed else "tolerance"
    values = ", ".join(local(run.row) for run in group.runs)
    others = " (the first)" if len(group.runs) > 1 and first.status == FAILED else ""
    return f"× {group.number}  {first.row.method}, {kind} {values}{others}: {remark(first)}"
