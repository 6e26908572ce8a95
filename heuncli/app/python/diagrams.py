"""A diagram of a solved scene, for notebooks and files."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

from heuncli.app.python.arguments import FILE, check_arguments
from heuncli.base.errors import Problem, UsageError
from heuncli.base.records import replace
from heuncli.output.drawing.drawing_files import encode_drawing, find_form
from heuncli.output.drawing.layout import lay_out
from heuncli.output.drawing.shapes import VectorDrawing, to_svg
from heuncli.output.figures.courses import FigureSource
from heuncli.output.figures.histories import make_history
from heuncli.output.snapshots.measure import require_known_paths
from heuncli.study.quantities.captions import set_captions
from heuncli.study.quantities.table_units import read_display_units
from heuncli.study.queries.measure import MeasureRequest
from heuncli.study.queries.study import Study


class Diagram:
    """A diagram as `heun plot` draws it; a notebook shows it as the last value of a cell."""

    def __init__(self, picture: VectorDrawing) -> None:
        self._picture = picture

    @property
    def svg(self) -> str:
        """The drawing as the text of an SVG file, without external fonts or scripts."""
        return to_svg(self._picture)

    def save(self, file: str | os.PathLike[str]) -> None:
        """Write the diagram in the format of the file's ending: .svg, .png or .pdf. Raises UsageError,
        OSError.
        """
        check_arguments(("file", file, FILE), optional=False)
        name = os.fspath(file)
        Path(name).write_bytes(encode_drawing(self._picture, find_form(name, "save")))

    def _repr_svg_(self) -> str:
        return self.svg.partition("?>\n")[2]

    def __repr__(self) -> str:
        return f"<heuncli.Diagram {self._picture.title!r}>"


def make_diagram(
    study: Study,
    paths: Sequence[str],
    x_path: str | None,
    units: str | None,
    title: str | None = None,
    labels: Mapping[str, str] = MappingProxyType({}),
) -> Diagram:
    """Draw numbers over time, or over the number at `x_path`; labels: of what is drawn, by path. Raises UsageError,
    NotDrawable, NotOneNumber, SpecError.
    """
    if not paths:
        hint = "for example study.plot('energy.kinetic')"
        raise UsageError(Problem("bad-option", "plot: no path is given", hint=hint))
    requests = [MeasureRequest("", path) for path in (*paths, *([] if x_path is None else [x_path]))]
    require_known_paths(requests, study.spec, "plot")
    spec = set_captions(study.spec, title, labels.items())
    drawn = replace(study, spec=spec) if labels else study
    figure = make_history([FigureSource("", drawn)], paths, read_display_units("units", units), x_path)
    study.later_warnings.update(drawn.later_warnings)
    return Diagram(lay_out(figure if title is None else figure._replace(title=spec.title)))
