"""A drawing as shapes in pixels, x to the right and y down, and its text as SVG: no fonts or scripts from elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from heuncli.base.named_tuples import NamedTuple

FONT = "sans-serif"
SHAPES: dict[str, tuple[tuple[float, float], ...]] = {  # corners about the middle, of unit size; "circle" has none
    "circle": (),
    "square": ((-0.88, -0.88), (0.88, -0.88), (0.88, 0.88), (-0.88, 0.88)),
    "triangle": ((0.0, -1.15), (1.05, 0.8), (-1.05, 0.8)),
    "diamond": ((0.0, -1.25), (1.1, 0.0), (0.0, 1.25), (-1.1, 0.0)),
    "tip": ((0.0, 1.15), (1.05, -0.8), (-1.05, -0.8)),
    "bow": ((-1.1, -0.8), (1.1, 0.8), (1.1, -0.8), (-1.1, 0.8)),
}


class Line(NamedTuple):
    """A polyline; dash: lengths of strokes and gaps; name: what a reader is told of it, where it is of something."""

    points: tuple[tuple[float, float], ...]
    colour: str = "#000000"
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
    """A marker about a place, filled with its colour or with white."""

    x: float
    y: float
    shape: str
    colour: str
    filled: bool
    size: float = 4.0


class Text(NamedTuple):
    """A line of text; y is that of its base line, turned: read from below, about its anchor; halo: white about it."""

    x: float
    y: float
    text: str
    size: float = 12.0
    anchor: Literal["start", "middle", "end"] = "start"
    colour: str = "#000000"
    bold: bool = False
    turned: bool = False
    halo: bool = False


Shape = Line | Area | Mark | Text


class Picture(NamedTuple):
    """A drawing with its title and what it shows, in words."""

    width: float
    height: float
    title: str
    words: str
    shapes: Sequence[Shape]


def svg(picture: Picture) -> str:
    """The drawing as a file of SVG."""
    w, h = number(picture.width), number(picture.height)
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{w}" height="{h}" viewBox="0 0 {w} {h}" role="img"'
        f' font-family="{FONT}">',
        f"<title>{escaped(picture.title)}</title>",
        f"<desc>{escaped(picture.words)}</desc>",
        f'<rect width="{w}" height="{h}" fill="#ffffff"/>',
        *(element(shape) for shape in picture.shapes),
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


def element(shape: Shape) -> str:
    """One shape."""
    if isinstance(shape, Line):
        dash = f' stroke-dasharray="{" ".join(map(number, shape.dash))}"' if shape.dash else ""
        return (
            f'<polyline points="{places(shape.points)}" fill="none" stroke="{shape.colour}"'
            f' stroke-width="{number(shape.width)}" stroke-linejoin="round"{dash}{closing("polyline", shape.name)}'
        )
    if isinstance(shape, Area):
        opacity = f' fill-opacity="{number(shape.opacity)}"' if shape.opacity < 1.0 else ""
        return (
            f'<polygon points="{places(shape.points)}" fill="{shape.colour}"{opacity}{closing("polygon", shape.name)}'
        )
    if isinstance(shape, Mark):
        look = f'fill="{shape.colour if shape.filled else "#ffffff"}" stroke="{shape.colour}" stroke-width="1.2"'
        if not SHAPES[shape.shape]:
            return f'<circle cx="{number(shape.x)}" cy="{number(shape.y)}" r="{number(shape.size)}" {look}/>'
        return f'<polygon points="{places(corners(shape))}" {look}/>'
    turned = f' transform="rotate(-90 {number(shape.x)} {number(shape.y)})"' if shape.turned else ""
    bold = ' font-weight="bold"' if shape.bold else ""
    halo = ' paint-order="stroke" stroke="#ffffff" stroke-width="3" stroke-linejoin="round"' if shape.halo else ""
    return (
        f'<text x="{number(shape.x)}" y="{number(shape.y)}" font-size="{number(shape.size)}"'
        f' text-anchor="{shape.anchor}" fill="{shape.colour}"{bold}{halo}{turned}>{escaped(shape.text)}</text>'
    )


def closing(tag: str, name: str) -> str:
    """The end of an element, which holds the name of what it shows."""
    return f"><title>{escaped(name)}</title></{tag}>" if name else "/>"


def corners(mark: Mark) -> tuple[tuple[float, float], ...]:
    """The corners of a marker."""
    return tuple((mark.x + mark.size * a, mark.y + mark.size * b) for a, b in SHAPES[mark.shape])


def places(points: Sequence[tuple[float, float]]) -> str:
    """Points as SVG lists them."""
    return " ".join(f"{number(x)},{number(y)}" for x, y in points)


def number(value: float) -> str:
    """A length to a hundredth of a pixel."""
    return f"{value:.2f}".rstrip("0").rstrip(".")


def escaped(text: str) -> str:
    """A text as XML holds it; what XML cannot hold is a blank."""
    text = "".join(c if is_text(c) else " " for c in text)
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def is_text(c: str) -> bool:
    """Whether XML 1.0 allows a character."""
    code = ord(c)
    return c == "\t" or 0x20 <= code < 0x7F or 0xA0 <= code <= 0xD7FF or 0xE000 <= code <= 0xFFFD or code >= 0x10000
