"""Pens of curves: colours that colour-blind readers can distinguish (Okabe and Ito, 2008), and dashes.

The colours are dark enough on white; with dashes and letters a figure is readable in black and white, too.
"""

from __future__ import annotations

from string import ascii_lowercase

from heuncli.base.named_tuples import NamedTuple

BLACK, GREY, DIM, GRID, FAINT, WHITE = "#000000", "#444444", "#888888", "#c4c4c4", "#e6e6e6", "#ffffff"


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
