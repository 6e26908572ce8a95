"""The drawing of `heun model --sketch`: the assembled machine as text; nothing is solved for it."""

from __future__ import annotations

from heuncli.app.cli.figure_options import render_text, require_width
from heuncli.app.commands.model.request import ModelRequest
from heuncli.output.figures.scenes import make_assembly_figure
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.setup import attach_locations


def render_sketch(spec: Spec, request: ModelRequest) -> str:
    """Render the drawing as text. Raises UsageError, and SolveError if the scene does not close."""
    require_width(request.width)
    with attach_locations(spec):
        figure = make_assembly_figure(spec, request.view)
    return render_text(figure._replace(title=""), request.width, request.output)
