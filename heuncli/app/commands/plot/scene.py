"""`heun plot SPEC scene [BODY.POINT...]`: draw the machine, its loads, and the paths of points."""

from __future__ import annotations

import numpy as np

from heuncli.app.cli.figure_options import require_view
from heuncli.app.cli.target import parse_units
from heuncli.app.commands.plot.plot_target import PlotTarget
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.sources import list_extreme_paths, load_specs, parse_instants, solve_source
from heuncli.output.drawing.figure import Figure
from heuncli.output.figures.courses import FigureSource, make_title
from heuncli.output.figures.scenes import make_scene_figure
from heuncli.output.figures.traces import CENTER
from heuncli.output.figures.worst_instant import find_worst_instant
from heuncli.output.snapshots import measure
from heuncli.results.results import Array
from heuncli.study.queries.measure import MeasureRequest

WORST = "worst"  # the instant of the greatest joint force, which is the default
INSTANT_WORDS = {"start": "first"}  # words of --at that only scenes know
REPORTS = ("bodies", "joints", "forces", "impulses")  # positions and loads


def draw(target: PlotTarget, request: PlotRequest) -> Figure:
    """Draw the figure, one panel per run. Raises UsageError, SpecError and what solving raises."""
    require_view(request.view)
    names = [word.removeprefix("points.").removeprefix("bodies.") for word in target.paths]
    paths = [_make_path(name) for name in names]
    specs = load_specs(target.files, request)
    for _, spec in specs:
        measure.require_known_paths([MeasureRequest("", path) for path in paths], spec, "heun plot")
    needed = [*paths, *REPORTS]
    instants = request.at and ",".join(INSTANT_WORDS.get(word.strip(), word) for word in request.at.split(","))
    words = instants and ",".join(word for word in instants.split(",") if word != WORST)
    sources = [
        solve_source(name, spec, [*needed, *list_extreme_paths(words or None, spec)], request) for name, spec in specs
    ]
    units_shown = parse_units(request.units)
    times_by_source = [None if not words else _find_times(source, words, instants != words) for source in sources]
    figures = [
        make_scene_figure(source, units_shown, times, request.view, names)
        for source, times in zip(sources, times_by_source, strict=True)
    ]
    if len(figures) == 1:
        return figures[0]
    named_figures = list(zip(sources, figures, strict=True))
    sentences = [f"{source.name}: {sentence}" for source, each in named_figures for sentence in each.words]
    panels = [panel for each in figures for panel in each.panels]
    notes = [f"{source.name}: {note}" for source, each in named_figures for note in each.notes]
    return Figure(make_title(sources), sentences, panels, (), notes)


def _find_times(source: FigureSource, words: str, has_worst: bool) -> Array:
    """Return the instants of --at, (n,) ascending; has_worst: with that of the greatest joint force."""
    times = parse_instants(source, words)
    return np.union1d(times, find_worst_instant(source.study).time) if has_worst else times


def _make_path(name: str) -> str:
    """Return the path in the results of a traced point."""
    body, _, point = name.partition(".")
    return f"bodies.{body}.{CENTER}" if point == CENTER else f"points.{name}.position"
