"""Encode a drawing as PNG or PDF by matplotlib, which is an optional dependency (heuncli[plot])."""

from __future__ import annotations

import importlib.util
import io
from typing import Any

from heuncli.base.errors import Problem, SpecError
from heuncli.output.drawing.shapes import MARKER_SHAPES, Area, Line, Mark, Text, VectorDrawing, find_corners
from heuncli.output.drawing.style import HALO, MARK_EDGE, WHITE

PER_INCH = 96.0  # pixels
FIXED_AXES: dict[str, Any] = {"scalex": False, "scaley": False}  # keep the limits of the axes
POINTS = 72.0 / PER_INCH  # in a pixel
RESOLUTION = 2.0  # PNG pixels for a pixel of the drawing
INSTALL_HINT = (
    'pip install "heuncli[plot]", or have rsvg-convert, resvg or Chromium on PATH; or use a file name ending in .svg, '
    "which needs none of them"
)


def require_plot(what: str) -> None:
    """Raise SpecError before the work if matplotlib is not installed."""
    if importlib.util.find_spec("matplotlib") is None:
        message = f"{what} requires rsvg-convert, resvg, Chromium or matplotlib, none of which is installed"
        raise SpecError(Problem("missing-extra", message, hint=INSTALL_HINT))


def render(drawing: VectorDrawing, form: str) -> bytes:
    """Encode the drawing as a file of this form."""
    require_plot(f"a {form} file")
    from matplotlib.figure import Figure
    from matplotlib.patches import Circle, Polygon

    figure = Figure(figsize=(drawing.width / PER_INCH, drawing.height / PER_INCH), facecolor=WHITE)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_xlim(0.0, drawing.width)
    axes.set_ylim(drawing.height, 0.0)
    axes.set_axis_off()
    for place, shape in enumerate(drawing.shapes):
        if isinstance(shape, Line):
            xs, ys = zip(*shape.points, strict=True)
            width = shape.width * POINTS
            style = (0.0, tuple(x * POINTS / width for x in shape.dash)) if shape.dash else "solid"
            axes.plot(xs, ys, color=shape.colour, linewidth=width, linestyle=style, zorder=place, **FIXED_AXES)
        elif isinstance(shape, Area):
            style_of_area: dict[str, Any] = {
                "facecolor": shape.colour,
                "alpha": shape.opacity,
                "linewidth": 0.0,
                "zorder": place,
            }
            axes.add_patch(Polygon(shape.points, **style_of_area))
        elif isinstance(shape, Mark):
            face = shape.colour if shape.is_filled else WHITE
            style_of_mark: dict[str, Any] = {
                "facecolor": face,
                "edgecolor": shape.colour,
                "linewidth": MARK_EDGE * POINTS,
                "zorder": place,
            }
            round_ = not MARKER_SHAPES[shape.shape]
            axes.add_patch(
                Circle((shape.x, shape.y), shape.size, **style_of_mark)
                if round_
                else Polygon(find_corners(shape), **style_of_mark)
            )
        else:
            write_text(axes, shape, place)
    file = io.BytesIO()
    dates = {"CreationDate": None} if form == "pdf" else {"Software": None}
    figure.savefig(file, format=form, dpi=PER_INCH * RESOLUTION, metadata=dates)
    return file.getvalue()


def write_text(axes: object, text: Text, place: int) -> None:
    """Write a line of text."""
    where = {"start": "left", "middle": "center", "end": "right"}[text.anchor]
    from matplotlib.patheffects import withStroke

    halo = [withStroke(linewidth=HALO * POINTS, foreground=WHITE)] if text.has_halo else None
    axes.text(  # type: ignore[attr-defined]
        text.x, text.y, text.text, parse_math=False, fontsize=text.size * POINTS, color=text.colour, ha=where,
        va="baseline", fontweight="bold" if text.is_bold else "normal", rotation=90 if text.is_vertical else 0,
        rotation_mode="anchor", zorder=place, path_effects=halo,
    )  # fmt: skip
