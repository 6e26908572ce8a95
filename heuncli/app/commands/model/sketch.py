"""The drawing of `heun model --sketch`: the machine as it is assembled, in letters; nothing is solved for it."""

from __future__ import annotations

from heuncli.app.cli.figure_letters import in_letters, require_width
from heuncli.app.commands.model.request import ModelRequest
from heuncli.output.figures.scenes import as_assembled
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.error_places import placed


def sketch(spec: Spec, request: ModelRequest) -> str:
    """The drawing as text. Raises UsageError, and SolveError where the scene does not close."""
    require_width(request.width)
    with placed(spec):
        figure = as_assembled(spec, request.view)
    return in_letters(figure._replace(title=""), request.width, request.output)
