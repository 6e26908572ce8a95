"""`heun plot SPEC scene [BODY.POINT...]`: draw the machine, its loads, and the paths of points."""

from __future__ import annotations

from heuncli.app.cli.units import parse_units
from heuncli.app.cli.views import require_view
from heuncli.app.commands.plot.plot_target import PlotTarget
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.sources import list_extreme_paths, load_specs, parse_instants, solve_source
from heuncli.output.drawing.figure import Figure
from heuncli.output.figures.courses import make_title
from heuncli.output.figures.scenes import make_scene_figure
from heuncli.output.figures.traces import CENTER
from heuncli.output.snapshots import measure
from heuncli.study.queries.measure import MeasureRequest

REPORTS = ("bodies", "joints", "impulses")  # positions and loads


def draw(target: PlotTarget, request: PlotRequest) -> Figure:
    """Draw the figure, one panel per run. Raises UsageError, SpecError and what solving raises."""
    require_view(request.view)
    names = [word.removeprefix("points.").removeprefix("bodies.") for word in target.paths]
    paths = [_make_path(name) for name in names]
    specs = load_specs(target.files, request)
    for _, spec in specs:
        measure.require_known_paths([MeasureRequest("", path) for path in paths], spec, "heun plot")
    needed = [*paths, *REPORTS]
    sources = [
        solve_source(name, spec, [*needed, *list_extreme_paths(request.at, spec)], request) for name, spec in specs
    ]
    units_shown = parse_units(request.units)
    times_by_source = [None if request.at is None else parse_instants(source, request.at) for source in sources]
    figures = [
        make_scene_figure(source, units_shown, times, request.view, names)
        for source, times in zip(sources, times_by_source, strict=True)
    ]
    if len(figures) == 1:
        return figures[0]
    named_figures = list(zip(sources, figures, strict=True))
    words = [f"{source.name}: {sentence}" for source, each in named_figures for sentence in each.words]
    panels = [panel for each in figures for panel in each.panels]
    notes = [f"{source.name}: {note}" for source, each in named_figures for note in each.notes]
    return Figure(make_title(sources), words, panels, (), notes)


def _make_path(name: str) -> str:
    """Return the path in the results of a traced point."""
    body, _, point = name.partition(".")
    return f"bodies.{body}.{CENTER}" if point == CENTER else f"points.{name}.position"
