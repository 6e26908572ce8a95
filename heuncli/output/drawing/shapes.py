"""A drawing as shapes in pixels, x to the right and y down, and as SVG without external fonts or scripts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Literal

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.style import (
    ARROW_HEAD,
    ARROW_WIDTH,
    BLACK,
    FONT,
    HALO,
    MARK_EDGE,
    MARK_SIZE,
    NAME_SIZE,
    WHITE,
)

MARKER_SHAPES: dict[
    str, tuple[tuple[float, float], ...]
] = {  # corners about the centre, of unit size; a circle has none
    "circle": (),
    "square": ((-0.88, -0.88), (0.88, -0.88), (0.88, 0.88), (-0.88, 0.88)),
    "triangle": ((0.0, -1.15), (1.05, 0.8), (-1.05, 0.8)),
    "diamond": ((0.0, -1.25), (1.1, 0.0), (0.0, 1.25), (-1.1, 0.0)),
    "tip": ((0.0, 1.15), (1.05, -0.8), (-1.05, -0.8)),
    "bow": ((-1.1, -0.8), (1.1, 0.8), (1.1, -0.8), (-1.1, 0.8)),
}


class Line(NamedTuple):
    """A polyline; dash: lengths of strokes and gaps; name: title shown to readers, if any."""

    points: tuple[tuple[float, float], ...]
    colour: str = BLACK
    width: float = 1.0
    dash: tuple[float, ...] = ()
    name: str = ""


class Area(NamedTuple):
    """A filled polygon; opacity: 0 to 1; name: as of a line."""

    points: tuple[tuple[float, float], ...]
    colour: str
    opacity: float = 1.0
    name: str = ""


class Mark(NamedTuple):
    """A marker at a place, filled with its colour or with white."""

    x: float
    y: float
    shape: str
    colour: str
    is_filled: bool
    size: float = MARK_SIZE


class Text(NamedTuple):
    """A line of text.

    y: of its base line
    is_vertical: whether it is rotated about its anchor, to be read from below
    has_halo: whether it has a white outline
    """

    x: float
    y: float
    text: str
    size: float = NAME_SIZE
    anchor: Literal["start", "middle", "end"] = "start"
    colour: str = BLACK
    is_bold: bool = False
    is_vertical: bool = False
    has_halo: bool = False


Shape = Line | Area | Mark | Text


class VectorDrawing(NamedTuple):
    """A drawing with its title and a description in words."""

    width: float
    height: float
    title: str
    description: str
    shapes: Sequence[Shape]


def to_svg(drawing: VectorDrawing) -> str:
    """Return the drawing as an SVG file."""
    w, h = format_length(drawing.width), format_length(drawing.height)
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{w}" height="{h}" viewBox="0 0 {w} {h}" role="img"'
        f' font-family="{FONT}">',
        f"<title>{escape_xml(drawing.title)}</title>",
        f"<desc>{escape_xml(drawing.description)}</desc>",
        f'<rect width="{w}" height="{h}" fill="{WHITE}"/>',
        *(format_element(shape) for shape in drawing.shapes),
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


def format_element(shape: Shape) -> str:
    """Format one shape."""
    if isinstance(shape, Line):
        dash = f' stroke-dasharray="{" ".join(map(format_length, shape.dash))}"' if shape.dash else ""
        return (
            f'<polyline points="{format_points(shape.points)}" fill="none" stroke="{shape.colour}"'
            f' stroke-width="{format_length(shape.width)}" stroke-linejoin="round"{dash}'
            f"{format_end('polyline', shape.name)}"
        )
    if isinstance(shape, Area):
        opacity = f' fill-opacity="{format_length(shape.opacity)}"' if shape.opacity < 1.0 else ""
        corners = format_points(shape.points)
        return f'<polygon points="{corners}" fill="{shape.colour}"{opacity}{format_end("polygon", shape.name)}'
    if isinstance(shape, Mark):
        fill = shape.colour if shape.is_filled else WHITE
        look = f'fill="{fill}" stroke="{shape.colour}" stroke-width="{format_length(MARK_EDGE)}"'
        if not MARKER_SHAPES[shape.shape]:
            x, y, radius = (format_length(length) for length in (shape.x, shape.y, shape.size))
            return f'<circle cx="{x}" cy="{y}" r="{radius}" {look}/>'
        return f'<polygon points="{format_points(find_corners(shape))}" {look}/>'
    rotation = (
        f' transform="rotate(-90 {format_length(shape.x)} {format_length(shape.y)})"' if shape.is_vertical else ""
    )
    bold = ' font-weight="bold"' if shape.is_bold else ""
    halo = (
        f' paint-order="stroke" stroke="{WHITE}" stroke-width="{format_length(HALO)}" stroke-linejoin="round"'
        if shape.has_halo
        else ""
    )
    return (
        f'<text x="{format_length(shape.x)}" y="{format_length(shape.y)}" font-size="{format_length(shape.size)}"'
        f' text-anchor="{shape.anchor}" fill="{shape.colour}"{bold}{halo}{rotation}>{escape_xml(shape.text)}</text>'
    )


def format_end(tag: str, name: str) -> str:
    """Format the end of an element, with the title of what it shows."""
    return f"><title>{escape_xml(name)}</title></{tag}>" if name else "/>"


def find_corners(mark: Mark) -> tuple[tuple[float, float], ...]:
    """Return the corners of a marker."""
    return tuple((mark.x + mark.size * a, mark.y + mark.size * b) for a, b in MARKER_SHAPES[mark.shape])


def format_points(points: Sequence[tuple[float, float]]) -> str:
    """Format points for SVG."""
    return " ".join(f"{format_length(x)},{format_length(y)}" for x, y in points)


def format_length(value: float) -> str:
    """Format a length to a hundredth of a pixel."""
    return f"{value:.2f}".rstrip("0").rstrip(".")


def escape_xml(text: str) -> str:
    """Escape a text for XML; characters that XML cannot hold become blanks."""
    text = "".join(c if is_xml_character(c) else " " for c in text)
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def is_xml_character(c: str) -> bool:
    """Return whether XML 1.0 allows a character."""
    code = ord(c)
    return c == "\t" or 0x20 <= code < 0x7F or 0xA0 <= code <= 0xD7FF or 0xE000 <= code <= 0xFFFD or code >= 0x10000


def draw_arrow(
    x: float,
    y: float,
    a: float,
    b: float,
    colour: str,
    name: str,
    *,
    is_double: bool = False,
    width: float = ARROW_WIDTH,
) -> Iterator[Line | Area]:
    """Draw an arrow from a place by (a, b) [pixels]; is_double: with two heads."""
    length = math.hypot(a, b)
    if not length > 0.0:
        return
    a, b = a / length, b / length
    head = min(ARROW_HEAD, (0.4 if is_double else 0.6) * length)
    tips = [length, length - head] if is_double else [length]
    back = tips[-1] - head
    yield Line(((x, y), (x + back * a, y + back * b)), colour, width, name=name)
    for k, tip in enumerate(tips):
        root_x, root_y, side = x + (tip - head) * a, y + (tip - head) * b, 0.4 * head
        corners = (
            (x + tip * a, y + tip * b), (root_x - side * b, root_y + side * a), (root_x + side * b, root_y - side * a)
        )  # fmt: skip
        yield Area(corners, colour, 1.0, "" if k else name)
