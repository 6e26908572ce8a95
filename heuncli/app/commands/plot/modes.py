"""`heun plot SPEC modes`: draw the shapes of small oscillations."""

from __future__ import annotations

import numpy as np

from heuncli.analyses.modes import BodyModes, exclude_entries, find_body_modes
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.solving import print_warnings
from heuncli.app.cli.without_option import find_excluded
from heuncli.app.commands.plot.plot_target import PlotTarget
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.sources import load_specs, require_no_paths
from heuncli.base.errors import Finding, Problem
from heuncli.output.drawing.figure import Figure
from heuncli.output.figures.mode_shapes import make_mode_shapes
from heuncli.output.machine_geometry.machine import make_machine
from heuncli.output.machine_geometry.views import (
    AZIMUTH,
    ELEVATION,
    SceneView,
    choose_view,
    make_view_at_angles,
    parse_view,
)


def draw(target: PlotTarget, request: PlotRequest) -> Figure:
    """Draw the figure. Raises UsageError, NotDrawable, SpecError, SolveError."""
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
