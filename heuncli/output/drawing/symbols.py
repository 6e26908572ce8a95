"""The field's symbols: joints, supports, springs, dampers, centres of mass, as strokes about a place.

Lengths in pixels; x along the symbol's direction, y to the left of it. What is drawn in letters has a letter each; what
has none there is drawn in dots, or left out where there are none.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from heuncli.base.named_tuples import NamedTuple

Points = tuple[tuple[float, float], ...]


class SymbolPart(NamedTuple):
    """A line through points; closed: back to its first; fill: with nothing, with paper, or with ink."""

    points: Points
    closed: bool = False
    fill: str = ""


class SymbolRow(NamedTuple):
    """A symbol: its parts, the first beneath the others; and its letter, with and without braille."""

    parts: tuple[SymbolPart, ...]
    letter: str = ""
    plain: str = ""


def arc(radius: float, first: float, last: float, count: int = 20) -> Points:
    """Points of a circle between two angles [degrees]."""
    angles = [math.radians(first + (last - first) * k / count) for k in range(count + 1)]
    return tuple((radius * math.cos(a), radius * math.sin(a)) for a in angles)


def ring(radius: float, fill: str = "") -> SymbolPart:
    """A circle."""
    return SymbolPart(arc(radius, 0.0, 360.0)[:-1], True, fill)


def box(x: float, y: float, fill: str = "") -> SymbolPart:
    """A rectangle of half these sides."""
    return SymbolPart(((-x, -y), (x, -y), (x, y), (-x, y)), True, fill)


def line(*points: tuple[float, float]) -> SymbolPart:
    """A line."""
    return SymbolPart(points)


def hatched(at: float, half: float, step: float = 5.0) -> tuple[SymbolPart, ...]:
    """The ground beyond x: its edge across, and slanted lines behind it."""
    count = round(2.0 * half / step)
    slants = (line((at, -half + k * step), (at + step, -half + (k + 1) * step)) for k in range(count))
    return (line((at, -half), (at, half)), *slants)


def head(x: float, y: float, angle: float, size: float = 6.0) -> SymbolPart:
    """The head of an arrow with its tip there; angle: where it points [degrees]."""
    a, b = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    back, side = (x - size * a, y - size * b), 0.42 * size
    return SymbolPart(
        ((x, y), (back[0] - side * b, back[1] + side * a), (back[0] + side * b, back[1] - side * a)), True, "ink"
    )


def shoe(inner: Points, outer: Points) -> SymbolPart:
    """What presses on something: between two lines."""
    return SymbolPart((*inner, *outer), True, "ink")


def radial(inner: float, outer: float, angle: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """A stroke away from the middle; angle [degrees]."""
    a, b = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return (inner * a, inner * b), (outer * a, outer * b)


QUARTERS = tuple(SymbolPart(((0.0, 0.0), *arc(3.6, a, a + 90.0, 6)), True, "ink") for a in (0.0, 180.0))
SPIRAL = tuple((r * math.cos(0.9 * r), r * math.sin(0.9 * r)) for r in (0.4 * k for k in range(5, 31)))
SYMBOLS: Mapping[str, SymbolRow] = {
    # how a joint lets turn: about what is seen along, about what is seen across, all ways, about two axes, not at all
    "circle": SymbolRow((ring(4.2, "paper"),), "○", "o"),
    "barrel": SymbolRow((box(8.0, 4.0, "paper"), line((-13.0, 0.0), (13.0, 0.0))), "○", "o"),
    "ball": SymbolRow((ring(5.2, "paper"), ring(2.6, "ink")), "◉", "@"),
    "cross": SymbolRow((ring(5.2, "paper"), line((-3.7, -3.7), (3.7, 3.7)), line((-3.7, 3.7), (3.7, -3.7))), "⊗", "x"),
    "rosette": SymbolRow((ring(5.2, "paper"), *(line(*radial(0.0, 5.2, a)) for a in (90.0, 210.0, 330.0))), "⊛", "%"),
    "square": SymbolRow((box(4.0, 4.0, "ink"),), "■", "#"),
    "dot": SymbolRow((ring(1.6, "paper"),), "•", "o"),
    "slider": SymbolRow((box(9.0, 4.5, "paper"),), "□", "="),
    # along what it lets slide: a guide from its side and from its end, a plane from its side and from above
    "guide": SymbolRow((line((-16.0, 7.0), (16.0, 7.0)), line((-16.0, -7.0), (16.0, -7.0)))),
    "bore": SymbolRow((ring(7.2),)),
    "table": SymbolRow((line((-7.0, -14.0), (-7.0, 14.0)),)),
    "field": SymbolRow((box(12.0, 9.0),)),
    # where it stands on the ground, x into it
    "foot": SymbolRow(
        (SymbolPart(((0.0, 0.0), (13.0, 7.5), (13.0, -7.5)), True, "paper"), *hatched(13.0, 12.5)), "", "/"
    ),
    "bed": SymbolRow(hatched(7.0, 15.0), "", "/"),
    "clamp": SymbolRow(hatched(4.0, 10.0), "", "/"),
    "road": SymbolRow(hatched(0.0, 15.0), "", "/"),
    # what a coordinate comes up against, x into it; what holds it there
    "stop": SymbolRow((SymbolPart(((0.0, -9.0), (5.0, -9.0), (5.0, 9.0), (0.0, 9.0)), True, "ink"),), "▌", "]"),
    "latch": SymbolRow((SymbolPart(((0.0, 0.0), (-9.0, 4.5), (-9.0, -4.5)), True, "paper"),), "◁", "<"),
    # of bodies
    "centre": SymbolRow((ring(3.6, "paper"), *QUARTERS), "⊕", "+"),
    "mass": SymbolRow((ring(3.4, "ink"),), "●", "*"),
    # what acts
    "turning": SymbolRow((line(*arc(12.0, -60.0, 205.0)), head(*arc(12.0, 0.0, 215.0)[-1], 305.0))),
    "turning back": SymbolRow((line(*arc(12.0, 240.0, -25.0)), head(*arc(12.0, 0.0, -35.0)[-1], 235.0))),
    "sliding": SymbolRow((line((-12.0, 12.5), (10.0, 12.5)), head(15.0, 12.5, 0.0))),
    "coil": SymbolRow((line(*SPIRAL),)),
    "brake": SymbolRow(tuple(shoe(arc(9.0, a - 40.0, a + 40.0), arc(13.0, a + 40.0, a - 40.0)) for a in (0.0, 180.0))),
    "brake along": SymbolRow((shoe(((-7.0, 8.0), (7.0, 8.0)), ((7.0, 12.0), (-7.0, 12.0))),)),
    "damping": SymbolRow((line((-9.0, 10.0), (-9.0, 17.0), (9.0, 17.0), (9.0, 10.0)), line((-6.0, 12.0), (6.0, 12.0)))),
    # two sleeves, and between them what gives way
    "bushing": SymbolRow(
        (ring(9.0, "paper"), ring(3.4, "paper"), *(line(*radial(4.0, 8.4, 60.0 * k)) for k in range(6))), "⊚", "o"
    ),
    "toward": SymbolRow((ring(4.4, "paper"), ring(1.4, "ink")), "⊙", "."),
    "away": SymbolRow((ring(4.4, "paper"), line((-3.1, -3.1), (3.1, 3.1)), line((-3.1, 3.1), (3.1, -3.1))), "⊗", "x"),
}


def spring(length: float) -> tuple[SymbolPart, ...]:
    """A zigzag between two ends that are straight."""
    end = min(8.0, 0.2 * length)
    turns, high = 7, min(5.5, 0.25 * length)
    step = (length - 2.0 * end) / (2.0 * turns)
    zigzag = [(end + (k + 0.5) * step, high if k % 2 == 0 else -high) for k in range(2 * turns)]
    return (line((0.0, 0.0), (end, 0.0), *zigzag, (length - end, 0.0), (length, 0.0)),)


def dashpot(length: float) -> tuple[SymbolPart, ...]:
    """A piston in a cup."""
    cup, high = min(9.0, 0.2 * length), min(5.0, 0.2 * length)
    m = 0.5 * length
    return (
        line((0.0, 0.0), (m - cup, 0.0)),
        line((m + cup, high), (m - cup, high), (m - cup, -high), (m + cup, -high)),
        line((m, high - 1.2), (m, 1.2 - high)),
        line((m, 0.0), (length, 0.0)),
    )


def damped_spring(length: float) -> tuple[SymbolPart, ...]:
    """A zigzag beside a dashpot."""
    end, off = min(8.0, 0.15 * length), min(6.5, 0.25 * length)

    def beside(parts: tuple[SymbolPart, ...], y: float) -> tuple[SymbolPart, ...]:
        return tuple(part._replace(points=tuple((a + end, 0.8 * b + y) for a, b in part.points)) for part in parts)

    inner = length - 2.0 * end
    plates = (line((end, off), (end, -off)), line((length - end, off), (length - end, -off)))
    ends = (line((0.0, 0.0), (end, 0.0)), line((length - end, 0.0), (length, 0.0)))
    return (*ends, *plates, *beside(spring(inner), off), *beside(dashpot(inner), -off))


def cylinder(length: float) -> tuple[SymbolPart, ...]:
    """A rod that goes into a cylinder, as those that push hydraulically."""
    high = min(5.0, 0.2 * length)
    x = 0.6 * length
    barrel = SymbolPart(((0.0, -high), (x, -high), (x, high), (0.0, high)), True, "paper")
    return barrel, line((0.45 * length, high), (0.45 * length, -high)), line((0.45 * length, 0.0), (length, 0.0))


def straight(length: float) -> tuple[SymbolPart, ...]:
    """A line."""
    return (line((0.0, 0.0), (length, 0.0)),)


def rod(length: float) -> tuple[SymbolPart, ...]:
    """A line between two eyes."""
    eye = tuple((a + length, b) for a, b in arc(2.6, 0.0, 360.0)[:-1])
    return line((0.0, 0.0), (length, 0.0)), ring(2.6, "paper"), SymbolPart(eye, True, "paper")


LINKS: Mapping[str, Callable[[float], tuple[SymbolPart, ...]]] = {
    "spring": spring, "damped spring": damped_spring, "actuator": cylinder, "rope": straight, "rod": rod,
}  # fmt: skip
SHORT = 14.0  # pixels, below which a link is a line


def link(kind: str, length: float) -> tuple[SymbolPart, ...]:
    """The parts of what joins two places so far apart, x from the first to the second."""
    return LINKS[kind](length) if length >= SHORT else straight(length)
