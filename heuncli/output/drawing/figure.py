"""A figure: panels below each other, each with two axes, and with curves, bands, marks and outlines.

All places are in the units of the axes; output/drawing/layout.py and output/drawing/letters.py convert them to pixels
or to cells of a terminal. An unknown number (nan) is not drawn: curves are interrupted there.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import log

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.style import PANEL_HEIGHT
from heuncli.results.results import Array


class Trace(NamedTuple):
    """A curve through points (n,), interrupted where one is nan; is_thin: it is less important than another curve."""

    name: str
    x: Array
    y: Array
    pen: int = 0
    is_thin: bool = False


class Band(NamedTuple):
    """The area between two courses (n,), lightly filled; has_edges: whether the courses are drawn as thin lines."""

    name: str
    x: Array
    low: Array
    high: Array
    pen: int = 0
    has_edges: bool = False


class Strokes(NamedTuple):
    """Short lines that belong together, (n, 2, 2): of each its two ends (x, y). For hatches, ordinates, symbols.

    dash: lengths of strokes and gaps [pixels]
    is_hatch: whether they fill an area, thin and pale
    is_faint: whether they are lines of a grid
    is_ghost: whether they are pale: of another instant than the one that is shown
    name: title shown to readers
    """

    ends: Array
    pen: int | None = None
    width: float = 0.7
    dash: tuple[float, ...] = ()
    is_hatch: bool = False
    is_faint: bool = False
    is_ghost: bool = False
    name: str = ""


class Polygon(NamedTuple):
    """A closed line through corners (n, 2), lightly filled or empty.

    is_opaque: whether it hides what lies below
    is_light: whether its fill is fainter than that of others
    has_outline: whether the line itself is drawn
    is_ghost: as of strokes
    is_faint: whether it is a line of a grid
    """

    name: str
    corners: Array
    pen: int | None = None
    is_filled: bool = False
    is_opaque: bool = False
    width: float = 1.0
    has_outline: bool = True
    is_ghost: bool = False
    is_light: bool = False
    is_faint: bool = False


class Arrow(NamedTuple):
    """An arrow, to scale, from a place by a difference.

    name: label at its tip
    description: title shown to readers
    is_double: whether it has two heads, as of a moment
    is_thin: whether it is less important than the curves beside it
    """

    x: float
    y: float
    by_x: float
    by_y: float
    pen: int | None = None
    name: str = ""
    description: str = ""
    is_double: bool = False
    is_thin: bool = False


class Spot(NamedTuple):
    """A marked place with its words; shape: one of output/drawing/shapes.py, "" for none, as at the end of a bar.

    note: text listed under the panels if the words find no room there; if empty, the words themselves
    """

    x: float
    y: float
    text: str = ""
    pen: int | None = None
    shape: str = "circle"
    is_filled: bool = False
    note: str = ""


class Words(NamedTuple):
    """A few words at a place, without a mark.

    is_sign: a + or − in a white disc
    is_optional: whether they are left out where they would stand over others that come before them
    """

    x: float
    y: float
    text: str
    pen: int | None = None
    is_sign: bool = False
    is_optional: bool = False


class Symbol(NamedTuple):
    """A symbol of output/drawing/symbols.py at a place, of the same size on paper at any scale.

    direction: of its x axis in the panel, of any length
    name: title shown to readers
    """

    x: float
    y: float
    symbol: str
    direction: tuple[float, float] = (1.0, 0.0)
    pen: int | None = None
    name: str = ""


class Link(NamedTuple):
    """A connection between two places: a kind of output/drawing/symbols.py, of the same width on paper at any scale."""

    x: float
    y: float
    to_x: float
    to_y: float
    kind: str
    pen: int | None = None
    name: str = ""


class PlaceLabel(NamedTuple):
    """Words to be placed near a place if there is room.

    letter: short form for terminals, which is explained below the panel
    is_optional: whether it may be left out without a note
    number: stands in a circle in place of the words, which the key of the panel lists
    is_ghost: as of strokes
    """

    x: float
    y: float
    text: str
    letter: str = ""
    pen: int | None = None
    is_optional: bool = False
    number: str = ""
    is_ghost: bool = False


class VerticalMark(NamedTuple):
    """A vertical mark across a panel with its words: an event, an impact, a jump.

    note: as of a Spot
    is_above: whether the words stand above the panel
    is_tick: whether it is only a short stroke on the axis, as of events that repeat often
    """

    x: float
    text: str
    note: str = ""
    is_above: bool = False
    is_tick: bool = False


class Blank(NamedTuple):
    """An interval along x of which nothing is claimed: hatched and empty, with the reason."""

    low: float
    high: float
    text: str


class Bars(NamedTuple):
    """A bar from zero at each place (n,); width: in units of the axis, None for a share of the smallest step."""

    name: str
    x: Array
    y: Array
    pen: int = 0
    width: float | None = None


class Cells(NamedTuple):
    """A field: values (n_y, n_x) in cells with edges (n_x + 1,) and (n_y + 1,), shaded by value; nan is empty."""

    name: str
    x_edges: Array
    y_edges: Array
    values: Array

    def find_shares(self) -> Array:
        """Return the values as shares between the lowest and the highest, (n_y, n_x); 0.5 if all are equal."""
        known = self.values[np.isfinite(self.values)]
        low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
        if high > low:
            return (self.values - low) / (high - low)
        return np.where(np.isfinite(self.values), 0.5, self.values)


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
    | VerticalMark
    | Blank
    | Bars
    | Cells
)


class Scaling(NamedTuple):
    """An axis: its label with the unit, and its ends.

    tick_texts: places with names instead of numbers
    hides_label: whether another panel shows the label and the same numbers
    """

    label: str
    low: float
    high: float
    is_logarithmic: bool = False
    tick_texts: tuple[tuple[float, str], ...] = ()
    hides_label: bool = False

    @property
    def shown_label(self) -> str:
        """The label, if this panel shows it."""
        return "" if self.hides_label else self.label

    def to_share(self, value: float) -> float:
        """Return the place of a value as a share of the axis, 0 to 1; values outside the ends are outside this
        range.
        """
        if self.is_logarithmic:
            return (log(value) - log(self.low)) / (log(self.high) - log(self.low))
        return (value - self.low) / (self.high - self.low)


class KeyArrow(NamedTuple):
    """An arrow in a key: its length in the unit of the panel, its pen and words; is_double: as of an arrow."""

    length: float
    pen: int | None
    text: str
    is_double: bool = False


class SpaceKey(NamedTuple):
    """What stands outside of a view of a machine in place of axes.

    axes: names of the world's axes with their directions in the view; one in its plane has length 1
    gravity: its direction in the view, of length 1 in its plane; None if it is not visible
    bar: length of the scale bar in the unit of the panel, and its words
    names: what the numbers of labels stand for
    """

    axes: tuple[tuple[str, float, float], ...]
    gravity: tuple[float, float] | None
    bar: tuple[float, str]
    arrows: tuple[KeyArrow, ...] = ()
    names: tuple[tuple[str, str], ...] = ()


class Panel(NamedTuple):
    """Axes with their items; the first items are below the others.

    height: in pixels; with equal scales the maximum
    has_equal_scales: whether a unit has the same length on both axes
    is_bare: whether it has no axes
    is_layered: whether items cover those before them; else lines are drawn over filled areas
    key: stands outside of a view of a machine, which has no axes
    title: lines after the first are smaller
    legend: names of its pens, shown above it
    """

    x: Scaling
    y: Scaling
    items: tuple[Item, ...]
    height: float = PANEL_HEIGHT
    has_equal_scales: bool = False
    is_bare: bool = False
    title: str = ""
    is_layered: bool = False
    key: SpaceKey | None = None
    legend: tuple[tuple[str, int], ...] = ()


def share_x_axis(panels: Sequence[Panel]) -> list[Panel]:
    """Return panels that share one horizontal axis, whose label only the last one shows."""
    return [*(panel._replace(x=panel.x._replace(hides_label=True)) for panel in panels[:-1]), *panels[-1:]]


LegendEntry = tuple[str, int, str]  # a name, its pen, and the shape of its mark: "" for a stroke, BAR for a bar
BAR = "bar"


class Figure(NamedTuple):
    """Panels below each other, with a title, sentences that describe the figure, and notes below.

    legend: names of pens, in their order
    marks: names of marks, with their pens and shapes
    n_columns: panels in a row
    """

    title: str
    words: Sequence[str]
    panels: Sequence[Panel]
    legend: Sequence[tuple[str, int]] = ()
    notes: Sequence[str] = ()
    marks: Sequence[LegendEntry] = ()
    n_columns: int = 1
