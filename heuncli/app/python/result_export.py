"""Export a solved scene as text, HTML, a file, a diagram or a pandas.DataFrame.

The tables are those of `heun run`. pandas is an optional extra (heuncli[pandas]).
"""

from __future__ import annotations

import dataclasses
import importlib.util
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from heuncli.app.python.arguments import FILE, check_arguments
from heuncli.base.errors import Problem, UsageError
from heuncli.base.records import replace
from heuncli.output.documents.as_html import escape_text, make_element, render_table
from heuncli.output.documents.as_text import render_text
from heuncli.output.documents.document import format_head
from heuncli.output.drawing.drawing_files import encode_drawing, find_form
from heuncli.output.drawing.layout import lay_out
from heuncli.output.drawing.shapes import VectorDrawing, to_svg
from heuncli.output.figures.courses import FigureSource
from heuncli.output.figures.histories import make_history
from heuncli.output.tables.measure import require_known_paths
from heuncli.output.tables.page import TablesQuery
from heuncli.output.tables.report_selection import ReportChoice, find_default_reports, parse_choice, select_reports
from heuncli.output.tables.summary_document import RunParts, make_run_parts
from heuncli.results.results import Array
from heuncli.results.results_schema import EVENTS, IMPULSES, REPORT_OF
from heuncli.study.model.selection import Selection
from heuncli.study.quantities.captions import set_captions
from heuncli.study.quantities.labels import make_labels
from heuncli.study.quantities.table_units import Units, read_display_units
from heuncli.study.queries.measure import MeasureRequest
from heuncli.study.queries.study import Study

if TYPE_CHECKING:
    import pandas as pd

    from heuncli.app.python.locked_run import LockedRun
    from heuncli.app.python.signals import Signal


# no colours, so that light and dark notebooks keep theirs; all rules apply within this class only
STYLE = (
    ".heun-run table{border-collapse:collapse;margin:.3em 0 .6em}"
    ".heun-run td,.heun-run th{padding:.1em .6em;text-align:right;white-space:nowrap;font-weight:normal}"
    ".heun-run th{border-bottom:1px solid currentColor;vertical-align:bottom}"
    ".heun-run .left{text-align:left}.heun-run .wide{overflow-x:auto}"
    ".heun-run h3{font-size:1em;margin:.9em 0 .2em}.heun-run h3 small{font-weight:normal}"
    ".heun-run p{margin:.1em 0}.heun-run ul{margin:.1em 0;padding:0;list-style:none}"
    ".heun-run .across th{text-align:left;padding-top:.5em;font-style:italic;border-bottom:none}"
)


def format_text(study: Study, instants: Array | None, units: str | None, selection: str | Sequence[str] | None) -> str:
    """Return heading, summary and tables as `heun run` writes them; of requested reports the tables alone.

    instants: (n,) [s], or None for the extremes
    selection: reports or entries, as in `solve`, or None
    """
    parsed = None
    if selection is not None:
        parsed = parse_choice(
            selection.split(",") if isinstance(selection, str) else selection, "only", "study.measure"
        )
    parts = _make_parts(study, instants, read_display_units("units", units), parsed)
    return render_text(parts.make_document())


def _make_parts(study: Study, instants: Array | None, units: Units, requested: ReportChoice | None = None) -> RunParts:
    """Make heading, summary and tables of the reports that are shown by default, or the tables of those requested, as
    far as they were solved for.
    """
    solved = study.options.selection
    spec = study.spec
    what = (
        select_reports(requested, spec, find_default_reports(spec))
        if requested is not None or not solved.entries
        else solved
    )
    what = replace(what, reports=what.reports & solved.reports or solved.reports)
    is_explicit = (requested is not None or spec.report.results is not None) and "foundation" in what.reports
    narrowed = _narrow_study(study, what)
    query = TablesQuery(what, instants, details=is_explicit, full=False)
    parts = make_run_parts(narrowed, replace(make_labels(spec), units=units), query, has_summary=requested is None)
    study.later_warnings.update(narrowed.later_warnings)
    return parts


def _narrow_study(study: Study, what: Selection) -> Study:
    """Copy the study with the results of the selected reports only."""
    results, reports = study.results, what.reports
    blocks: dict[str, Any] = {block: {} for block, report in REPORT_OF.items() if report not in reports}
    blocks |= {} if IMPULSES in reports else {IMPULSES: []}
    blocks |= {} if EVENTS in reports else {EVENTS: {}}
    blocks |= {} if "joints" in reports else {"certain_sums": []}
    options = replace(study.options, requested_reports=reports)
    return replace(study, options=options, results=dataclasses.replace(results, **blocks))


def render_html(study: Study, instants: Array | None) -> str:
    """Render heading and tables as an HTML fragment without scripts; all text from the spec is escaped."""
    parts = _make_parts(study, instants, Units())
    body = [make_element("style", STYLE), make_element("h3", escape_text(parts.title))]
    body += [make_element("p", escape_text(f"{label}: {text}" if label else text)) for label, text in parts.facts]
    body += [render_table(table) for table in parts.collect_tables()]
    return make_element("div", "\n".join(body), class_="heun-run")


def write_results(file: str | os.PathLike[str], forms: Mapping[str, Callable[[], str]]) -> None:
    """Write the results in the format of the file's ending. Raises UsageError, OSError."""
    path = Path(file)
    form = forms.get(path.suffix.lower())
    if form is None:
        message = f"save {path.name}: unknown file extension; accepted: {', '.join(forms)}"
        raise UsageError(Problem("bad-option", message, hint="save diagrams with study.plot(...).save(file)"))
    path.write_text(form(), encoding="utf-8", newline="\n")


INSTALL = 'pip install "heuncli[pandas]"; study[PATH].values needs only NumPy'


def make_frame(run: LockedRun, signals: Sequence[Signal], units: bool, *, is_explicit: bool) -> pd.DataFrame:
    """Make a frame with one column per number and one row per instant. Raises UsageError [missing-extra], [bad-option].

    is_explicit: whether the caller named the signals; then one without instants is an error, else it is left out
    """
    if importlib.util.find_spec("pandas") is None:
        message = "frame: requires pandas, which is not installed"
        raise UsageError(Problem("missing-extra", message, hint=INSTALL))
    timeless = next((signal for signal in signals if signal.times is None), None)
    if is_explicit and timeless is not None:
        hint = f'use study["{timeless.path}"].values'
        raise UsageError(Problem("bad-option", f"frame: {timeless.path} does not depend on time", hint=hint))
    import pandas as pd

    columns, unit_names, errors = {}, {}, {}
    times = run.results.time.copy()  # the index may keep a reference
    for signal in signals:
        if signal.times is None or signal.path == "time":
            continue
        flat = signal.values.reshape(len(times), -1)
        for component, column in zip(signal.components, flat.T, strict=True):
            path = f"{signal.path}.{component}" if component else signal.path
            name = format_head(path, signal.unit) if units else path
            columns[name], unit_names[name], errors[name] = column.copy(), signal.unit, signal.error
    frame = pd.DataFrame(columns, index=pd.Index(times, name="time [s]" if units else "time"))
    frame.attrs = {"units": unit_names, "errors": errors, "title": run.results.title}
    return frame


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
        """Return the figure as a notebook shows it."""
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
