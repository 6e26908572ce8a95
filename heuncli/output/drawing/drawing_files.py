"""Encode drawings as files, by the ending of the name: SVG, which needs no library, or PNG and PDF.

PNG and PDF are made by a program on PATH (rsvg-convert, resvg, or a Chromium), which gets a file in a temporary folder;
a Chromium resolves no names. Without one they are made by matplotlib, an optional dependency. Impure: runs a program.
"""

from __future__ import annotations

import math
import os.path
import tempfile
from collections.abc import Iterator
from pathlib import Path

from heuncli.base.errors import Problem, UsageError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.process import BROWSERS, find_program, list_browser_options, run_program
from heuncli.output.drawing.shapes import VectorDrawing, to_svg

FORMS = {".svg": "svg", ".png": "png", ".pdf": "pdf"}
ZOOM = 2  # PNG pixels for a pixel of the drawing
MAX_SECONDS = 60.0
MAGIC = {"png": b"\x89PNG", "pdf": b"%PDF"}  # how a file of a form begins
PAGE = """<!doctype html><meta charset="utf-8"><style>@page{{size:{width}px {height}px;margin:0}}
html,body{{margin:0}}svg{{display:block}}</style>{svg}"""


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
    from heuncli.output.drawing.matplotlib_file import require_plot

    if next(find_converters(form), None) is None:
        require_plot(what)


def encode_drawing(drawing: VectorDrawing, form: str) -> bytes:
    """Encode the drawing in a form. Raises SpecError if nothing is installed that writes it."""
    if form == "svg":
        return to_svg(drawing).encode()

    content = convert(drawing, form)
    if content is not None:
        return content
    from heuncli.output.drawing.matplotlib_file import render

    return render(drawing, form)


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
