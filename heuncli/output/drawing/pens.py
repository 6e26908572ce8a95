"""Choose colours: of the pen of a curve, mixed with white, and of a field from low to high."""

from __future__ import annotations

from string import ascii_lowercase

from heuncli.output.drawing.style import BLACK, PENS, SHADE_COLOURS, Pen


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
