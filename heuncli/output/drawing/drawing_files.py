"""Encode drawings as files, by the ending of the name: SVG, which needs no library, or PNG and PDF.

A program on PATH makes PNG and PDF (output/drawing/svg_converters.py), else matplotlib, an optional dependency.
"""

from __future__ import annotations

import os.path

from heuncli.base.errors import Problem, UsageError
from heuncli.output.drawing.shapes import VectorDrawing, to_svg

FORMS = {".svg": "svg", ".png": "png", ".pdf": "pdf"}


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
    from heuncli.output.drawing.svg_converters import find_converters

    if next(find_converters(form), None) is None:
        require_plot(what)


def encode_drawing(drawing: VectorDrawing, form: str) -> bytes:
    """Encode the drawing in a form. Raises SpecError if nothing is installed that writes it."""
    if form == "svg":
        return to_svg(drawing).encode()
    from heuncli.output.drawing.svg_converters import convert

    content = convert(drawing, form)
    if content is not None:
        return content
    from heuncli.output.drawing.matplotlib_file import render

    return render(drawing, form)
