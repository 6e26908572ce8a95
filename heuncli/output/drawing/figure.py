"""A figure: panels under each other, each with two axes, and in them curves, bands, marks and outlines.

Everything stands in the units of the axes; where it comes to stand in pixels or in the cells of a terminal is told by
output/drawing/layout.py and output/drawing/letters.py. A number that is not known (nan) is drawn by nobody: curves are
broken there.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import log

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array

HEIGHT = 170.0  # pixels of a panel, as a rule


class Trace(NamedTuple):
    """A line through points (n,), broken where one is nan; thin: what stands beside a curve that matters more."""

    name: str
    x: Array
    y: Array
    pen: int = 0
    thin: bool = False


class Band(NamedTuple):
    """What lies between two courses (n,), lightly filled."""

    name: str
    x: Array
    low: Array
    high: Array
    pen: int = 0


class Strokes(NamedTuple):
    """Short lines that belong together, (n, 2, 2): of each its two ends (x, y). Hatches, ordinates, symbols."""

    ends: Array
    pen: int | None = None
    width: float = 0.7


class Polygon(NamedTuple):
    """A closed line through corners (n, 2), filled lightly or not at all; solid: what lies beneath hardly shows.

    outlined: whether the line itself is drawn.
    """

    name: str
    corners: Array
    pen: int | None = None
    filled: bool = False
    solid: bool = False
    width: float = 1.0
    outlined: bool = True


class Arrow(NamedTuple):
    """An arrow, to scale, from a place by so much; name: what stands at its tip; told: what a reader is told of it."""

    x: float
    y: float
    by_x: float
    by_y: float
    pen: int | None = None
    name: str = ""
    told: str = ""


class Spot(NamedTuple):
    """A marked place with its words; shape: one of output/drawing/picture.py.

    note: what is told of it under the panels where the words find no room; the words where it is empty.
    """

    x: float
    y: float
    text: str = ""
    pen: int | None = None
    shape: str = "circle"
    filled: bool = False
    note: str = ""


class Words(NamedTuple):
    """A few words, or a sign, about a place, without a mark."""

    x: float
    y: float
    text: str
    pen: int | None = None


class Symbol(NamedTuple):
    """A symbol of output/drawing/symbols.py about a place, as large on paper whatever the scale.

    along: where its x points in the panel, of any length; name: what a reader is told of it.
    """

    x: float
    y: float
    symbol: str
    along: tuple[float, float] = (1.0, 0.0)
    pen: int | None = None
    name: str = ""


class Link(NamedTuple):
    """What joins two places: a kind of output/drawing/symbols.py, as wide on paper whatever the scale."""

    x: float
    y: float
    to_x: float
    to_y: float
    kind: str
    pen: int | None = None
    name: str = ""


class PlaceLabel(NamedTuple):
    """Words that are to stand beside a place where there is room; letter: what stands there in letters, and is told.

    spare: nobody misses it where there is none.
    """

    x: float
    y: float
    text: str
    letter: str = ""
    pen: int | None = None
    spare: bool = False


class Upright(NamedTuple):
    """A vertical mark across a panel: an event, a blow, a jump, and its words; note: as of a spot.

    above: the words stand above the panel.
    """

    x: float
    text: str
    note: str = ""
    above: bool = False


class Blank(NamedTuple):
    """A stretch along x of which nothing is claimed: hatched and empty, and why."""

    low: float
    high: float
    text: str


class Bars(NamedTuple):
    """A bar from zero at each place (n,)."""

    name: str
    x: Array
    y: Array
    pen: int = 0


class Cells(NamedTuple):
    """A field: values (n_y, n_x) in cells with edges (n_x + 1,) and (n_y + 1,), shaded by value; nan is empty."""

    name: str
    x_edges: Array
    y_edges: Array
    values: Array


Item = (
    Trace
    | Band
    | Strokes
    | Polygon
    | Arrow
    | Spot
    | Words
    | Symbol
    | Link
    | PlaceLabel
    | Upright
    | Blank
    | Bars
    | Cells
)


class Scaling(NamedTuple):
    """An axis: what it tells, with its unit, and its ends; named: places that have names in place of numbers.

    unlabelled: whether another panel shows the label; the numbers along it are the same.
    """

    label: str
    low: float
    high: float
    logarithmic: bool = False
    named: tuple[tuple[float, str], ...] = ()
    unlabelled: bool = False

    @property
    def shown_label(self) -> str:
        """The label, where this panel shows it."""
        return "" if self.unlabelled else self.label

    def at(self, value: float) -> float:
        """Where a value stands, 0 to 1; beyond the ends beyond these."""
        if self.logarithmic:
            return (log(value) - log(self.low)) / (log(self.high) - log(self.low))
        return (value - self.low) / (self.high - self.low)


class Panel(NamedTuple):
    """Axes with what stands in them, the first beneath the others; equal: one unit is as long on both axes.

    height [pixels]; of equal axes the most. bare: without axes. layered: what stands behind covers what stands before
    it, else lines lie on what is filled.
    """

    x: Scaling
    y: Scaling
    items: tuple[Item, ...]
    height: float = HEIGHT
    equal: bool = False
    bare: bool = False
    title: str = ""
    layered: bool = False


def over_one_axis(panels: Sequence[Panel]) -> list[Panel]:
    """Panels under each other whose axes across are one, which the last of them names."""
    return [*(panel._replace(x=panel.x._replace(unlabelled=True)) for panel in panels[:-1]), *panels[-1:]]


class Figure(NamedTuple):
    """Panels under each other, a title, what it is of in sentences, and notes below.

    legend: names of pens, in their order; marks: names of marks, with their pens and shapes.
    """

    title: str
    words: Sequence[str]
    panels: Sequence[Panel]
    legend: Sequence[tuple[str, int]] = ()
    notes: Sequence[str] = ()
    marks: Sequence[tuple[str, int, str]] = ()
