"""`heun plot SPEC polar joints.NAME`: a vector over a turn, as the curve of its tip."""

from __future__ import annotations

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.solving import choice
from heuncli.app.cli.units import units
from heuncli.app.commands.plot.asked import PlotAsked
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.sources import require_joints, solution, specs_of
from heuncli.base.errors import Problem
from heuncli.loads.kinetostatics.joint_axes import JOINT_AXES
from heuncli.output.drawing.figure import Figure
from heuncli.output.figures.planes import LETTERS, attitudes_for
from heuncli.output.figures.polar import polar
from heuncli.output.figures.turning import angles_of
from heuncli.output.snapshots import measure
from heuncli.results.results_schema import SPACE
from heuncli.results.run_places import words_of
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import names_in
from heuncli.scene.file_format.rules.outcome import NumberKind, result
from heuncli.study.ask.measure import MeasureRequest

FORCE_OF = {"joints": 2, "sections": 2, "foundation": 1}  # of whole entries, by how many words these have
BELOW_FOUNDATION = 3  # words of foundation.supports.NAME
SUCH_AS = "such as polar joints.main, or polar foundation"


def draw(asked: PlotAsked, request: PlotRequest) -> Figure:
    """The figure. Raises UsageError, NotDrawable, SpecError and what solving raises."""
    if not asked.paths:
        raise UsageError(Problem("bad-option", "heun plot polar: of what is not said", hint=SUCH_AS))
    axes = "world" if request.axes is None else choice("--axes", request.axes, JOINT_AXES)
    view = None if request.view is None else choice("--view", request.view, LETTERS)
    paths = [_with_force(path) for path in asked.paths]
    require_joints(paths, request)
    specs = specs_of(asked.files, request)
    for _, spec in specs:
        measure.check([MeasureRequest("", path) for path in paths], spec, "heun plot")
        _require_vectors(paths, spec)
    sources = []
    for name, spec in specs:
        needed = [*paths, *angles_of(spec)]
        sources.append(solution(name, spec, [*needed, *attitudes_for(needed, spec)], request))
    return polar(sources, paths, units(request.units), axes, view)


def _with_force(path: str) -> str:
    """A path to a vector; of a joint, a section or the foundation without more the force."""
    words = path.split(".")
    whole = len(words) == FORCE_OF.get(words[0])
    part = words[:2] in (["foundation", "supports"], ["foundation", "elements"]) and len(words) == BELOW_FOUNDATION
    return f"{path}.force" if whole or part else path


def _require_vectors(paths: list[str], spec: Spec) -> None:
    """Raise UsageError for paths that are known to lead to no vector."""
    names, runs = names_in(spec), {name: section.from_ is not None for name, section in spec.sections.items()}
    for path in paths:
        found = result(words_of(path), names, runs)
        if isinstance(found, NumberKind) and found.known and (found.axes != (SPACE,) or not found.timed):
            message = f"polar {path}: a polar diagram is of a vector over the instants, and this is none"
            raise UsageError(Problem("bad-option", message, hint=SUCH_AS))
