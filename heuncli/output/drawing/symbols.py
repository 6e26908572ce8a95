"""Engineering symbols as strokes about a place: joints, supports, springs, dampers, centres of mass.

Lengths are in pixels; x is along the symbol's direction, y to the left of it. In a terminal a symbol is a letter; one
without a letter is drawn in dots, or left out if there are no dots.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping

from heuncli.base.named_tuples import NamedTuple

Points = tuple[tuple[float, float], ...]


class SymbolPart(NamedTuple):
    """A line through points.

    is_closed: whether it returns to its first point
    fill: "" (none), "paper", "tint" (a light shade of the ink) or "ink"
    """

    points: Points
    is_closed: bool = False
    fill: str = ""


class SymbolShape(NamedTuple):
    """A symbol: its parts, the first below the others, and its letter with and without braille."""

    parts: tuple[SymbolPart, ...]
    letter: str = ""
    plain: str = ""


def arc(radius: float, first: float, last: float, count: int = 20) -> Points:
    """Return points of a circle between two angles [degrees]."""
    angles = [math.radians(first + (last - first) * k / count) for k in range(count + 1)]
    return tuple((radius * math.cos(a), radius * math.sin(a)) for a in angles)


def ring(radius: float, fill: str = "") -> SymbolPart:
    """Make a circle."""
    return SymbolPart(arc(radius, 0.0, 360.0)[:-1], True, fill)


def box(x: float, y: float, fill: str = "") -> SymbolPart:
    """Make a rectangle with these half sides."""
    return SymbolPart(((-x, -y), (x, -y), (x, y), (-x, y)), True, fill)


def line(*points: tuple[float, float]) -> SymbolPart:
    """Make a line."""
    return SymbolPart(points)


def hatch(edge: float, half: float, step: float = 5.0) -> tuple[SymbolPart, ...]:
    """Make the ground at larger x: its edge, and slanted lines behind it."""
    count = round(2.0 * half / step)
    slants = (line((edge, -half + k * step), (edge + step, -half + (k + 1) * step)) for k in range(count))
    return (line((edge, -half), (edge, half)), *slants)


def head(x: float, y: float, angle: float, size: float = 6.0) -> SymbolPart:
    """Make the head of an arrow with its tip at (x, y); angle: its direction [degrees]."""
    a, b = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    back, side = (x - size * a, y - size * b), 0.42 * size
    return SymbolPart(
        ((x, y), (back[0] - side * b, back[1] + side * a), (back[0] + side * b, back[1] - side * a)), True, "ink"
    )


def shoe(inner: Points, outer: Points) -> SymbolPart:
    """Make a brake shoe or the like: the area between two lines."""
    return SymbolPart((*inner, *outer), True, "ink")


def radial(inner: float, outer: float, angle: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the ends of a radial stroke; angle [degrees]."""
    a, b = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return (inner * a, inner * b), (outer * a, outer * b)


def bearing(*, is_fixed: bool) -> Iterator[SymbolPart]:
    """Yield both halves of a rolling bearing, above and below its shaft: crossed if it is fixed, else one diagonal."""
    for y in (9.5, -9.5):
        corners = ((-6.0, y - 5.5), (6.0, y - 5.5), (6.0, y + 5.5), (-6.0, y + 5.5))
        yield SymbolPart(corners, True, "paper")
        yield line(corners[0], corners[2])
        if is_fixed:
            yield line(corners[1], corners[3])


QUARTERS = tuple(SymbolPart(((0.0, 0.0), *arc(3.6, a, a + 90.0, 6)), True, "ink") for a in (0.0, 180.0))
SPIRAL = tuple((r * math.cos(0.9 * r), r * math.sin(0.9 * r)) for r in (0.4 * k for k in range(5, 31)))
SYMBOLS: Mapping[str, SymbolShape] = {
    # how a joint turns: axis towards the viewer, axis across, all axes, two axes, none
    "circle": SymbolShape((ring(4.2, "paper"),), "○", "o"),
    "barrel": SymbolShape((box(8.0, 4.0, "paper"), line((-13.0, 0.0), (13.0, 0.0))), "○", "o"),
    "ball": SymbolShape((ring(5.2, "paper"), ring(2.6, "ink")), "◉", "@"),
    "cross": SymbolShape(
        (ring(5.2, "paper"), line((-3.7, -3.7), (3.7, 3.7)), line((-3.7, 3.7), (3.7, -3.7))), "⊗", "x"
    ),
    "rosette": SymbolShape((ring(5.2, "paper"), *(line(*radial(0.0, 5.2, a)) for a in (90.0, 210.0, 330.0))), "⊛", "%"),
    "square": SymbolShape((box(4.0, 4.0, "ink"),), "■", "#"),
    "dot": SymbolShape((ring(1.6, "paper"),), "•", "o"),
    "slider": SymbolShape((box(9.0, 4.5, "paper"),), "□", "="),
    # how a joint slides: guide from the side and along it, plane from the side and from above
    "guide": SymbolShape((line((-16.0, 7.0), (16.0, 7.0)), line((-16.0, -7.0), (16.0, -7.0)))),
    "bore": SymbolShape((ring(7.2),)),
    "table": SymbolShape((line((-7.0, -14.0), (-7.0, 14.0)),)),
    "field": SymbolShape((box(12.0, 9.0),)),
    # bearings of a shaft along x: fixed and floating
    "fixed bearing": SymbolShape((ring(1.4, "ink"), *bearing(is_fixed=True)), "⊠", "X"),
    "floating bearing": SymbolShape((ring(1.4, "ink"), *bearing(is_fixed=False)), "◫", "/"),
    # where gears mesh
    "pitch point": SymbolShape((ring(2.4, "ink"),), "•", "."),
    # supports on the ground, with x into the ground
    "foot": SymbolShape(
        (SymbolPart(((0.0, 0.0), (13.0, 7.5), (13.0, -7.5)), True, "paper"), *hatch(13.0, 12.5)), "", "/"
    ),
    "bed": SymbolShape(hatch(7.0, 15.0), "", "/"),
    "clamp": SymbolShape(hatch(4.0, 10.0), "", "/"),
    "road": SymbolShape(hatch(0.0, 15.0), "", "/"),
    # stop of a coordinate, with x into it; latch
    "stop": SymbolShape((SymbolPart(((0.0, -9.0), (5.0, -9.0), (5.0, 9.0), (0.0, 9.0)), True, "ink"),), "▌", "]"),
    "latch": SymbolShape((SymbolPart(((0.0, 0.0), (-9.0, 4.5), (-9.0, -4.5)), True, "paper"),), "◁", "<"),
    # where a reaction is read
    "sensor": SymbolShape((ring(6.5, "paper"), ring(4.0), ring(1.6, "ink")), "◎", "o"),
    # bodies
    "centre": SymbolShape((ring(3.6, "paper"), *QUARTERS), "⊕", "+"),
    "mass": SymbolShape((ring(3.4, "ink"),), "●", "*"),
    # drives and loads
    "turning": SymbolShape((line(*arc(12.0, -60.0, 205.0)), head(*arc(12.0, 0.0, 215.0)[-1], 305.0))),
    "turning back": SymbolShape((line(*arc(12.0, 240.0, -25.0)), head(*arc(12.0, 0.0, -35.0)[-1], 235.0))),
    "sliding": SymbolShape((line((-12.0, 12.5), (10.0, 12.5)), head(15.0, 12.5, 0.0))),
    "coil": SymbolShape((line(*SPIRAL),)),
    "brake": SymbolShape(
        tuple(shoe(arc(9.0, a - 40.0, a + 40.0), arc(13.0, a + 40.0, a - 40.0)) for a in (0.0, 180.0))
    ),
    "brake along": SymbolShape((shoe(((-7.0, 8.0), (7.0, 8.0)), ((7.0, 12.0), (-7.0, 12.0))),)),
    "damping": SymbolShape(
        (line((-9.0, 10.0), (-9.0, 17.0), (9.0, 17.0), (9.0, 10.0)), line((-6.0, 12.0), (6.0, 12.0)))
    ),
    # two sleeves with the elastic part between
    "bushing": SymbolShape(
        (ring(9.0, "paper"), ring(3.4, "paper"), *(line(*radial(4.0, 8.4, 60.0 * k)) for k in range(6))), "⊚", "o"
    ),
    "toward": SymbolShape((ring(4.4, "paper"), ring(1.4, "ink")), "⊙", "."),
    "away": SymbolShape((ring(4.4, "paper"), line((-3.1, -3.1), (3.1, 3.1)), line((-3.1, 3.1), (3.1, -3.1))), "⊗", "x"),
}


def spring(length: float, half_width: float = 6.0) -> tuple[SymbolPart, ...]:
    """A zigzag between two straight ends."""
    end = min(8.0, 0.2 * length)
    turns, high = max(5, round(length / (2.2 * half_width))), min(half_width, 0.25 * length)
    step = (length - 2.0 * end) / (2.0 * turns)
    zigzag = [(end + (k + 0.5) * step, high if k % 2 == 0 else -high) for k in range(2 * turns)]
    return (line((0.0, 0.0), (end, 0.0), *zigzag, (length - end, 0.0), (length, 0.0)),)


def damped_spring(length: float) -> tuple[SymbolPart, ...]:
    """A dashpot with a zigzag around it, both on the line of their points."""
    high, first, last = min(3.6, 0.15 * length), 0.3 * length, 0.7 * length
    barrel = SymbolPart(((0.0, -high), (last, -high), (last, high), (0.0, high)), True, "paper")
    piston = (line((first, high), (first, -high)), line((first, 0.0), (length, 0.0)))
    return barrel, *piston, *spring(length, 8.0)


def cylinder(length: float) -> tuple[SymbolPart, ...]:
    """A hydraulic cylinder with its rod."""
    high = min(5.0, 0.2 * length)
    x = 0.6 * length
    barrel = SymbolPart(((0.0, -high), (x, -high), (x, high), (0.0, high)), True, "paper")
    return barrel, line((0.45 * length, high), (0.45 * length, -high)), line((0.45 * length, 0.0), (length, 0.0))


def straight_line(length: float) -> tuple[SymbolPart, ...]:
    """A straight line."""
    return (line((0.0, 0.0), (length, 0.0)),)


def bar(length: float) -> tuple[SymbolPart, ...]:
    """A flat link between two eyes, which it surrounds."""
    high = min(4.5, 0.3 * length)
    last = tuple((a + length, b) for a, b in arc(high, -90.0, 90.0, 8))
    return (SymbolPart((*last, *arc(high, 90.0, 270.0, 8)), True, "tint"),)


def rod(length: float) -> tuple[SymbolPart, ...]:
    """A line between two eyes."""
    eye = tuple((a + length, b) for a, b in arc(2.6, 0.0, 360.0)[:-1])
    return line((0.0, 0.0), (length, 0.0)), ring(2.6, "paper"), SymbolPart(eye, True, "paper")


LINKS: Mapping[str, Callable[[float], tuple[SymbolPart, ...]]] = {
    "spring": spring, "damped spring": damped_spring, "actuator": cylinder, "rope": straight_line, "rod": rod,
    "bar": bar,
}  # fmt: skip
SHORT = 14.0  # pixels, below which a link is a line


def make_link(kind: str, length: float) -> tuple[SymbolPart, ...]:
    """Return the parts of a link between two places at a distance, x from the first to the second."""
    return LINKS[kind](length) if length >= SHORT else straight_line(length)
