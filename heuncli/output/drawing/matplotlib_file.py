"""A drawing as PNG or PDF, by matplotlib, which is an extra of its own (heuncli[plot])."""

from __future__ import annotations

import importlib.util
import io
from typing import Any

from heuncli.base.errors import Problem, SpecError
from heuncli.output.drawing.picture import SHAPES, Area, Line, Mark, Picture, Text, corners

PER_INCH = 96.0  # pixels
AS_IT_IS: dict[str, Any] = {"scalex": False, "scaley": False}  # the axes are those of the drawing
POINTS = 72.0 / PER_INCH  # in a pixel
FINE = 2.0  # pixels of a PNG in one of the drawing
INSTALL = 'pip install "heuncli[plot]"; or a name that ends in .svg, which needs nothing'


def require_plot(what: str) -> None:
    """Say before the work that matplotlib is missing."""
    if importlib.util.find_spec("matplotlib") is None:
        message = f"{what} is drawn by matplotlib, which is not installed"
        raise SpecError(Problem("missing-extra", message, hint=INSTALL))


def rendered(picture: Picture, form: str) -> bytes:
    """The drawing as a file of that form."""
    require_plot(f"a {form} file")
    from matplotlib.figure import Figure
    from matplotlib.patches import Circle, Polygon

    figure = Figure(figsize=(picture.width / PER_INCH, picture.height / PER_INCH), facecolor="#ffffff")
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_xlim(0.0, picture.width)
    axes.set_ylim(picture.height, 0.0)
    axes.set_axis_off()
    for place, shape in enumerate(picture.shapes):
        if isinstance(shape, Line):
            xs, ys = zip(*shape.points, strict=True)
            width = shape.width * POINTS
            style = (0.0, tuple(x * POINTS / width for x in shape.dash)) if shape.dash else "solid"
            axes.plot(xs, ys, color=shape.colour, linewidth=width, linestyle=style, zorder=place, **AS_IT_IS)
        elif isinstance(shape, Area):
            filled: dict[str, Any] = {
                "facecolor": shape.colour,
                "alpha": shape.opacity,
                "linewidth": 0.0,
                "zorder": place,
            }
            axes.add_patch(Polygon(shape.points, **filled))
        elif isinstance(shape, Mark):
            face = shape.colour if shape.filled else "#ffffff"
            own: dict[str, Any] = {
                "facecolor": face,
                "edgecolor": shape.colour,
                "linewidth": 1.2 * POINTS,
                "zorder": place,
            }
            round_ = not SHAPES[shape.shape]
            axes.add_patch(Circle((shape.x, shape.y), shape.size, **own) if round_ else Polygon(corners(shape), **own))
        else:
            write(axes, shape, place)
    file = io.BytesIO()
    dates = {"CreationDate": None} if form == "pdf" else {"Software": None}
    figure.savefig(file, format=form, dpi=PER_INCH * FINE, metadata=dates)
    return file.getvalue()


def write(axes: object, text: Text, place: int) -> None:
    """A line of text."""
    where = {"start": "left", "middle": "center", "end": "right"}[text.anchor]
    from matplotlib.patheffects import withStroke

    halo = [withStroke(linewidth=3.0 * POINTS, foreground="#ffffff")] if text.halo else None
    axes.text(  # type: ignore[attr-defined]
        text.x, text.y, text.text, parse_math=False, fontsize=text.size * POINTS, color=text.colour, ha=where,
        va="baseline", fontweight="bold" if text.bold else "normal", rotation=90 if text.turned else 0,
        rotation_mode="anchor", zorder=place, path_effects=halo,
    )  # fmt: skip
