"""`heun plot SPEC scene`, `modes` and `balance`: draw the machine, its mode shapes, its mass effects."""

from __future__ import annotations

import numpy as np

from heuncli.analyses.balancing.study import balance
from heuncli.analyses.modes.study import BodyModes, exclude_entries, find_body_modes
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.figure_output import require_view
from heuncli.app.cli.solving import find_excluded, print_warnings
from heuncli.app.cli.target import parse_units
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.sources import (
    PlotTarget,
    list_extreme_paths,
    load_specs,
    parse_instants,
    require_no_paths,
    solve_source,
)
from heuncli.base.errors import Finding, Problem
from heuncli.output.drawing.figure import Figure
from heuncli.output.figures.courses import FigureSource, make_title
from heuncli.output.figures.mode_shapes import make_mode_shapes
from heuncli.output.figures.orders import BalancedScene, make_orders_figure
from heuncli.output.figures.posed_machine import find_worst_instant
from heuncli.output.figures.scenes import CENTER, make_scene_figure
from heuncli.output.machine_geometry.machine import make_machine
from heuncli.output.machine_geometry.views import (
    AZIMUTH,
    ELEVATION,
    SceneView,
    choose_view,
    make_view_at_angles,
    parse_view,
)
from heuncli.output.tables import measure
from heuncli.results.results import Array
from heuncli.study.queries.measure import MeasureRequest

WORST = "worst"  # the instant of the greatest joint force, which is the default
INSTANT_WORDS = {"start": "first"}  # words of --at that only scenes know
REPORTS = ("bodies", "joints", "forces", "impulses")  # positions and loads


def draw_scene(target: PlotTarget, request: PlotRequest) -> Figure:
    """Draw the machine at some instants, one panel per run. Raises UsageError, SpecError and what solving raises."""
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


def draw_modes(target: PlotTarget, request: PlotRequest) -> Figure:
    """Draw the shapes of small oscillations. Raises UsageError, NotDrawable, SpecError, SolveError."""
    require_no_paths(target)
    specs = load_specs(target.files, request)
    if len(specs) > 1:
        message = f"heun plot modes: expected one model in one load case, found {len(specs)}"
        raise UsageError(Problem("bad-option", message, hint="call it once for each"))
    ((_, spec),) = specs
    entries = find_excluded(spec, request.without)
    moved = find_body_modes(exclude_entries(spec, entries), entries)
    print_warnings(spec, None, request.quiet)
    return make_mode_shapes(moved, make_machine(spec), _choose_view(moved, request))


def _choose_view(moved: BodyModes, request: PlotRequest) -> SceneView:
    """Return the direction of view. Raises UsageError."""
    if request.view is None:
        usual_view = choose_view(moved.scene, np.concatenate([moved.places, moved.centres]))
        is_visible = all(moved.is_transverse(k, usual_view.eye_direction) for k in range(len(moved.turns)))
        return usual_view if is_visible else make_view_at_angles(AZIMUTH, ELEVATION, moved.scene.mechanism.gravity)
    try:
        return parse_view(request.view, moved.scene.mechanism.gravity)
    except Finding as finding:
        message = f"--view {request.view}: {finding.message}"
        raise UsageError(Problem("bad-option", message, hint=finding.hint)) from None


def draw_balance(target: PlotTarget, request: PlotRequest) -> Figure:
    """Draw the loads on the foundation by order. Raises UsageError, SpecError, SolveError."""
    require_no_paths(target)
    sources = []
    for name, spec in load_specs(target.files, request):
        sources.append(BalancedScene(name, balance(spec)))
        print_warnings(spec, None, request.quiet)
    return make_orders_figure(sources, parse_units(request.units))
