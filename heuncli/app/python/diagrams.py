"""A diagram of a solved scene, which notebooks show and files take."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from heuncli.app.python.arguments import FILE, check_arguments
from heuncli.base.errors import Problem, UsageError
from heuncli.output.drawing.as_file import as_file, form_of
from heuncli.output.drawing.layout import laid_out
from heuncli.output.drawing.picture import Picture, svg
from heuncli.output.figures.courses import Pictured
from heuncli.output.figures.histories import history
from heuncli.output.snapshots.asked_units import asked_units
from heuncli.output.snapshots.measure import check
from heuncli.study.ask.measure import MeasureRequest
from heuncli.study.ask.study import Study


class Diagram:
    """A diagram as `heun plot` draws it; the last value of a cell of a notebook, it is shown."""

    def __init__(self, picture: Picture) -> None:
        self._picture = picture

    @property
    def svg(self) -> str:
        """The drawing as a file of SVG: no fonts or scripts from elsewhere."""
        return svg(self._picture)

    def save(self, file: str | os.PathLike[str]) -> None:
        """Write it by the name's end: .svg, or .png or .pdf by matplotlib. Raises UsageError, OSError."""
        check_arguments(("file", file, FILE), optional=False)
        name = os.fspath(file)
        Path(name).write_bytes(as_file(self._picture, form_of(name, "save")))

    def _repr_svg_(self) -> str:
        return self.svg.partition("?>\n")[2]

    def __repr__(self) -> str:
        return f"<heuncli.Diagram {self._picture.title!r}>"


def diagram_of(study: Study, paths: Sequence[str], over: str | None, units: str | None) -> Diagram:
    """Numbers over time, or over another number. Raises UsageError, NotDrawable, NotOneNumber, SpecError."""
    if not paths:
        hint = "such as study.plot('energy.kinetic')"
        raise UsageError(Problem("bad-option", "plot: no path says what is drawn", hint=hint))
    asked = [MeasureRequest("", path) for path in (*paths, *([] if over is None else [over]))]
    check(asked, study.spec, "plot")
    return Diagram(laid_out(history([Pictured("", study)], paths, asked_units("units", units), over)))
