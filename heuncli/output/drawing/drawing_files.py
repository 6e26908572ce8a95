"""Encode drawings as files, by the ending of the name: SVG, which needs no library, or PNG or PDF by matplotlib."""

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


def encode_drawing(drawing: VectorDrawing, form: str) -> bytes:
    """Encode the drawing in a form. Raises SpecError if the library that it needs is not installed."""
    if form == "svg":
        return to_svg(drawing).encode()
    from heuncli.output.drawing.matplotlib_file import render

    return render(drawing, form)
