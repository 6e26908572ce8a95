"""`heun plot SPEC scene [BODY.POINT...]`: the machine where it stands, what acts on it, and how points of it go."""

from __future__ import annotations

from heuncli.app.cli.units import units
from heuncli.app.cli.views import require_view
from heuncli.app.commands.plot.asked import PlotAsked
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.sources import extremes_asked, instants_before_horizon, solution, specs_of
from heuncli.output.drawing.figure import Figure
from heuncli.output.figures.courses import title_of
from heuncli.output.figures.scenes import scene
from heuncli.output.figures.traces import CENTER
from heuncli.output.snapshots import measure
from heuncli.study.ask.measure import MeasureRequest

REPORTS = ("bodies", "joints", "impulses")  # of the results: where all of it stands, and what acts


def draw(asked: PlotAsked, request: PlotRequest) -> Figure:
    """The figure, a panel a run. Raises UsageError, SpecError and what solving raises."""
    require_view(request.view)
    names = [word.removeprefix("points.").removeprefix("bodies.") for word in asked.paths]
    paths = [_path(name) for name in names]
    specs = specs_of(asked.files, request)
    for _, spec in specs:
        measure.check([MeasureRequest("", path) for path in paths], spec, "heun plot")
    needed = [*paths, *REPORTS]
    sources = [solution(name, spec, [*needed, *extremes_asked(request.at, spec)], request) for name, spec in specs]
    shown = units(request.units)
    ats = [None if request.at is None else instants_before_horizon(source, request.at) for source in sources]
    figures = [scene(source, shown, at, request.view, names) for source, at in zip(sources, ats, strict=True)]
    if len(figures) == 1:
        return figures[0]
    several = list(zip(sources, figures, strict=True))
    words = [f"{source.name}: {sentence}" for source, each in several for sentence in each.words]
    panels = [panel for each in figures for panel in each.panels]
    notes = [f"{source.name}: {note}" for source, each in several for note in each.notes]
    return Figure(title_of(sources), words, panels, (), notes)


def _path(name: str) -> str:
    """The path in the results of a point that is traced."""
    body, _, point = name.partition(".")
    return f"bodies.{body}.{CENTER}" if point == CENTER else f"points.{name}.position"
