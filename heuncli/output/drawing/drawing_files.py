"""Encode drawings as files, by the ending of the name: SVG, which needs no library, or PNG and PDF.

PNG and PDF are made by a program on PATH (rsvg-convert, resvg, or a Chromium), which gets a file in a temporary folder;
a Chromium resolves no names. Without one they are made by matplotlib, an optional dependency (heuncli[plot]), imported
only then. Impure: runs a program.
"""

from __future__ import annotations

import importlib.util
import io
import math
import os.path
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from heuncli.base.errors import Problem, SpecError, UsageError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.programs import BROWSERS, find_program, list_browser_options, run_program
from heuncli.output.drawing.shapes import MARKER_SHAPES, Area, Line, Mark, Text, VectorDrawing, find_corners, to_svg
from heuncli.output.drawing.style import HALO, MARK_EDGE, WHITE

FORMS = {".svg": "svg", ".png": "png", ".pdf": "pdf"}
ZOOM = 2  # PNG pixels for a pixel of the drawing
MAX_SECONDS = 60.0
MAGIC = {"png": b"\x89PNG", "pdf": b"%PDF"}  # how a file of a form begins
PAGE = """<!doctype html><meta charset="utf-8"><style>@page{{size:{width}px {height}px;margin:0}}
html,body{{margin:0}}svg{{display:block}}</style>{svg}"""
PER_INCH = 96.0  # pixels
FIXED_AXES: dict[str, Any] = {"scalex": False, "scaley": False}  # keep the limits of the axes
POINTS = 72.0 / PER_INCH  # in a pixel
RESOLUTION = 2.0  # PNG pixels for a pixel of the drawing
INSTALL_HINT = (
    'pip install "heuncli[plot]", or have rsvg-convert, resvg or Chromium on PATH; or use a file name ending in .svg, '
    "which needs none of them"
)


class Converter(NamedTuple):
    """A program: its names on PATH, and its options by the form that it writes, with {svg}, {page}, {out} and sizes."""

    names: tuple[str, ...]
    options: dict[str, tuple[str, ...]]


CONVERTERS = (
    Converter(
        ("rsvg-convert",),
        {
            "png": ("--format=png", f"--zoom={ZOOM}", "--output={out}", "{svg}"),
            "pdf": ("--format=pdf", "--output={out}", "{svg}"),
        },
    ),
    Converter(("resvg",), {"png": (f"--zoom={ZOOM}", "{svg}", "{out}")}),
    Converter(
        BROWSERS,
        {
            "png": (
                f"--force-device-scale-factor={ZOOM}", "--window-size={width},{height}",
                "--screenshot={out}", "{page}",
            ),
            "pdf": ("--no-pdf-header-footer", "--print-to-pdf={out}", "{page}"),
        },
    ),
)  # fmt: skip


def find_form(name: str, option: str) -> str:
    """Return the form of a drawing by the ending of a file name. Raises UsageError."""
    form = FORMS.get(os.path.splitext(name)[1].lower())  # noqa: PTH122 - a name, not a file
    if form is None:
        hint = f"accepted file extensions: {', '.join(FORMS)}"
        raise UsageError(Problem("bad-option", f"{option} {name}: unknown picture format", hint=hint))
    return form


def require_encoder(form: str, what: str) -> None:
    """Raise SpecError before the work if nothing is installed that writes a form; what: the file, in messages."""
    if form == "svg":
        return
    if next(find_converters(form), None) is None:
        require_plot(what)


def encode_drawing(drawing: VectorDrawing, form: str) -> bytes:
    """Encode the drawing in a form. Raises SpecError if nothing is installed that writes it."""
    if form == "svg":
        return to_svg(drawing).encode()
    content = convert(drawing, form)
    if content is not None:
        return content
    return render_by_matplotlib(drawing, form)


def find_converters(form: str) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield the programs on PATH that write a form, the best first, each with its options."""
    for converter in CONVERTERS:
        path = find_program(converter.names) if form in converter.options else None
        if path is not None:
            yield path, (list_browser_options() if converter.names is BROWSERS else ()) + converter.options[form]


def convert(drawing: VectorDrawing, form: str) -> bytes | None:
    """Convert a drawing with the first program that succeeds; None if none does."""
    svg = to_svg(drawing)
    width, height = (str(math.ceil(length)) for length in (drawing.width, drawing.height))
    for path, options in find_converters(form):
        with tempfile.TemporaryDirectory() as folder:
            files = {name: Path(folder, name) for name in ("drawing.svg", "page.html", f"drawing.{form}")}
            source, page, target = files.values()
            source.write_text(svg, encoding="utf-8")
            body = svg.partition("\n")[2]  # without the declaration of XML
            page.write_text(PAGE.format(width=width, height=height, svg=body), encoding="utf-8")
            values = {"svg": source, "page": page.as_uri(), "out": target, "folder": folder}
            words = [option.format(**values, width=width, height=height) for option in options]
            _, failure = run_program([path, *words], folder, MAX_SECONDS)
            content = target.read_bytes() if target.is_file() and not failure else b""
        if content.startswith(MAGIC[form]):
            return content
    return None


def require_plot(what: str) -> None:
    """Raise SpecError before the work if matplotlib is not installed."""
    if importlib.util.find_spec("matplotlib") is None:
        message = f"{what} requires rsvg-convert, resvg, Chromium or matplotlib, none of which is installed"
        raise SpecError(Problem("missing-extra", message, hint=INSTALL_HINT))


def render_by_matplotlib(drawing: VectorDrawing, form: str) -> bytes:
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
            _write_text(axes, shape, place)
    file = io.BytesIO()
    dates = {"CreationDate": None} if form == "pdf" else {"Software": None}
    figure.savefig(file, format=form, dpi=PER_INCH * RESOLUTION, metadata=dates)
    return file.getvalue()


def _write_text(axes: object, text: Text, place: int) -> None:
    """Write a line of text."""
    where = {"start": "left", "middle": "center", "end": "right"}[text.anchor]
    from matplotlib.patheffects import withStroke

    halo = [withStroke(linewidth=HALO * POINTS, foreground=WHITE)] if text.has_halo else None
    axes.text(  # type: ignore[attr-defined]
        text.x, text.y, text.text, parse_math=False, fontsize=text.size * POINTS, color=text.colour, ha=where,
        va="baseline", fontweight="bold" if text.is_bold else "normal", rotation=90 if text.is_vertical else 0,
        rotation_mode="anchor", zorder=place, path_effects=halo,
    )  # fmt: skip
