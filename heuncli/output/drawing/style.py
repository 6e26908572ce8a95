"""The style sheet of all pictures: sizes, strokes, colours and spacing, for SVG, matplotlib and the terminal alike,
and how colours are chosen: of the pen of a curve, mixed with white, of a field from low to high.

A picture is 720 pixels wide. Printed as wide as the text of an A4 report, 178 mm, a pixel is 0.247 mm, and capitals
(0.72 of a face) are 3.2 mm high in titles, 2.7 mm in names and 2.5 mm in numbers, a height of DIN EN ISO 3098.
Colours are those of Okabe and Ito (2008), darkened until they are legible on white; curves differ by dashes, too, so
that a picture is readable in grey and by colour-blind readers.
"""

from __future__ import annotations

from string import ascii_lowercase

from heuncli.base.named_tuples import NamedTuple

# Letters: font sizes in pixels, and the shape of the face in font sizes.
FONT = "sans-serif"
TITLE_SIZE, NAME_SIZE, SMALL_SIZE = 18.0, 15.0, 14.0  # of titles, of names and axes, of numbers and notes
WIDTH_FACTOR, LETTER_WIDTH = 0.6, 0.54  # largest and usual mean width of letters
HEIGHT_FACTOR, BASE_FACTOR = 1.2, 0.92  # height of a line; from its top to its base
HALO = 3.0  # width of the white outline of words

# Places, in pixels.
WIDTH = 720.0  # of a picture
LEFT, RIGHT, TOP = 80.0, 24.0, 28.0  # margins of panels, and of the base of the title
BARE_TOP, BOTTOM = 10.0, 10.0  # above a figure without a title, as in a report; below one with a title
INDENT = 16.0  # left of titles and notes
LINE_HEIGHT, TITLE_HEIGHT = 18.0, 23.0
AXIS_SPACE, PANEL_SPACE = 48.0, 20.0  # below a panel with the label of its axis, and without
PANEL_HEIGHT = 170.0
PER_TICK_X, PER_TICK_Y = 84.0, 36.0  # smallest distance of ticks
TICK_LENGTH, EVENT_LENGTH = 4.0, 9.0  # of a number of an axis, of an event that repeats often

# Strokes and marks, in pixels.
CURVE_WIDTH, THIN_WIDTH, ENVELOPE_WIDTH = 2.0, 1.0, 0.9
AXIS_WIDTH, GRID_WIDTH, HATCH_WIDTH, SYMBOL_WIDTH = 1.0, 0.7, 0.6, 1.2
MARK_SIZE, POINT_SIZE = 3.2, 1.8  # half the size of a mark, and of a single point of a curve
MARK_EDGE, SIGN_SIZE = 1.2, 8.0  # the second half the disc of a sign
ARROW_WIDTH, ARROW_HEAD = 1.8, 9.0
HATCH_STEP = 9.0  # between the lines of a blank area
LINK_WIDTH, ARM_WIDTH, RIM_WIDTH, OUTLINE_WIDTH = 3.0, 2.0, 1.3, 0.7  # of bodies: lines, by shapes, on shapes, edges
DASH_DOT = (9.0, 3.0, 2.0, 3.0)  # strokes and gaps of pitch circles

# Colours; opacities of areas.
BLACK, GREY, DIM, GRID, FAINT, WHITE = "#000000", "#444444", "#888888", "#c4c4c4", "#d9d9d9", "#ffffff"
BAND_OPACITY, FILL_OPACITY, BAR_OPACITY = 0.12, 0.14, 0.85
TINT_SHARE, LIGHT_SHARE = 0.18, 0.07  # of its colour in the fill of a body, and of a large one
GHOST_SHARE, GHOST_LABEL = 0.3, 0.6  # of its colour in what is of another instant, and in its label
HATCH_SHARE = 0.4  # of the colour in the lines of a hatch, the rest is white
# From low to high, dark to light, which can be told apart in grey as well.
SHADE_COLOURS = ((0x1F, 0x2A, 0x5A), (0x1F, 0x7A, 0x8C), (0x8F, 0xB9, 0x6A), (0xFD, 0xE7, 0x9A))


class Pen(NamedTuple):
    """A colour, a dash (lengths of strokes and gaps [pixels]), the letter in its place, and the code of terminals."""

    colour: str
    dash: tuple[float, ...]
    letter: str
    code: str


PENS = (
    Pen("#0072b2", (), "a", "34"),
    Pen("#d55e00", (7.0, 3.0), "b", "31"),
    Pen("#007a5a", (2.0, 2.5), "c", "32"),
    Pen("#aa3377", (9.0, 3.0, 2.0, 3.0), "d", "35"),
    Pen("#8a6d00", (4.0, 2.0), "e", "33"),
    Pen("#000000", (12.0, 4.0), "f", "39"),
    Pen("#2a9fd6", (12.0, 3.0, 2.0, 3.0, 2.0, 3.0), "g", "36"),
    Pen("#666666", (1.5, 3.0), "h", "90"),
)


def find_pen(number: int) -> Pen:
    """Return the pen of a number; after the last pen the colours start again, with other dashes and letters."""
    turn, k = divmod(number, len(PENS))
    if not turn:
        return PENS[k]
    letter = ascii_lowercase[number % len(ascii_lowercase)]
    return PENS[k]._replace(dash=PENS[(k + turn) % len(PENS)].dash, letter=letter)


def find_colour(number: int | None) -> str:
    """Return the colour of a pen; None stands for black."""
    return BLACK if number is None else find_pen(number).colour


def mix_with_white(colour: str, share: float) -> str:
    """Mix a colour with white; share: of the colour."""
    parts = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
    return "#" + "".join(f"{round(255.0 + share * (part - 255.0)):02x}" for part in parts)


def find_shade(share: float) -> str:
    """Return the colour of a share of a field, 0 to 1."""
    position = min(max(share, 0.0), 1.0) * (len(SHADE_COLOURS) - 1)
    k = min(int(position), len(SHADE_COLOURS) - 2)
    return "#" + "".join(
        f"{round(a + (b - a) * (position - k)):02x}"
        for a, b in zip(SHADE_COLOURS[k], SHADE_COLOURS[k + 1], strict=True)
    )
