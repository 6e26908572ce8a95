"""`heun plot SPEC modes`: the shapes of small oscillations."""

from __future__ import annotations

import numpy as np

from heuncli.analyses.modes.moved_bodies import MovedBodies, moved_bodies
from heuncli.analyses.modes.without import without
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.left_out import named
from heuncli.app.cli.solving import warn
from heuncli.app.commands.plot.asked import PlotAsked
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.sources import require_no_paths, specs_of
from heuncli.base.errors import Finding, Problem
from heuncli.output.drawing.figure import Figure
from heuncli.output.figures.mode_shapes import mode_shapes
from heuncli.output.machine_geometry.machine import machine_of
from heuncli.output.machine_geometry.views import AZIMUTH, ELEVATION, SceneView, turned, usual, view_of


def draw(asked: PlotAsked, request: PlotRequest) -> Figure:
    """The figure. Raises UsageError, NotDrawable, SpecError, SolveError."""
    require_no_paths(asked)
    specs = specs_of(asked.files, request)
    if len(specs) > 1:
        message = f"heun plot modes: of one scene in one case, and {len(specs)} are named"
        raise UsageError(Problem("bad-option", message, hint="call it once for each"))
    ((_, spec),) = specs
    entries = named(spec, request.without)
    found = moved_bodies(without(spec, entries), entries)
    warn(spec, None, request.quiet)
    return mode_shapes(found, machine_of(spec), _view(found, request))


def _view(found: MovedBodies, request: PlotRequest) -> SceneView:
    """From where the modes are seen. Raises UsageError."""
    if request.view is None:
        seen = usual(found.scene, np.concatenate([found.places, found.centres]))
        across = all(found.moves_across(k, seen.toward) for k in range(len(found.turns)))
        return seen if across else turned(AZIMUTH, ELEVATION, found.scene.mechanism.gravity)
    try:
        return view_of(request.view, found.scene.mechanism.gravity)
    except Finding as finding:
        message = f"--view {request.view}: {finding.message}"
        raise UsageError(Problem("bad-option", message, hint=finding.hint)) from None
