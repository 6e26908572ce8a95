"""Pictures as files: by the end of a name as SVG, which needs nothing, or as PNG or PDF by matplotlib."""

from __future__ import annotations

import os.path

from heuncli.base.errors import Problem, UsageError
from heuncli.output.drawing.picture import Picture, svg

PICTURES = {".svg": "svg", ".png": "png", ".pdf": "pdf"}


def form_of(name: str, option: str) -> str:
    """The form of a picture by the end of its name. Raises UsageError."""
    form = PICTURES.get(os.path.splitext(name)[1].lower())  # noqa: PTH122 - a name, not a file
    if form is None:
        hint = f"known endings: {', '.join(PICTURES)}"
        raise UsageError(Problem("bad-option", f"{option} {name}: no picture is known by that ending", hint=hint))
    return form


def as_file(picture: Picture, form: str) -> bytes:
    """The picture in a form. Raises SpecError where what draws it is not installed."""
    if form == "svg":
        return svg(picture).encode()
    from heuncli.output.drawing.matplotlib_file import rendered

    return rendered(picture, form)
