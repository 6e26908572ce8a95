"""`heun plot SPEC polar joints.NAME`: draw the curve of a vector's tip over a turn."""

from __future__ import annotations

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.solving import require_choice
from heuncli.app.cli.target import parse_units
from heuncli.app.commands.plot.plot_target import PlotTarget
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.sources import load_specs, require_joint_paths, solve_source
from heuncli.base.errors import Problem
from heuncli.loads.kinetostatics.reactions import JOINT_AXES
from heuncli.output.drawing.figure import Figure
from heuncli.output.figures.planes import AXIS_LETTERS, list_rotation_paths
from heuncli.output.figures.polar import make_polar_figure
from heuncli.output.figures.tips import list_firing_paths
from heuncli.output.figures.turning import list_angle_paths
from heuncli.output.snapshots import measure
from heuncli.results.path_words import split_path
from heuncli.results.results_schema import SPACE
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import collect_scene_names
from heuncli.scene.file_format.rules.outcome import NumberKind, resolve_path
from heuncli.study.queries.measure import MeasureRequest

ENTRY_LENGTH = {"joints": 2, "sections": 2, "foundation": 1}  # number of words of a path to a whole entry
FOUNDATION_PART_LENGTH = 3  # words of foundation.supports.NAME
SUCH_AS = "for example polar joints.main, or polar foundation"


def draw(target: PlotTarget, request: PlotRequest) -> Figure:
    """Draw the figure. Raises UsageError, NotDrawable, SpecError and what solving raises."""
    if not target.paths:
        raise UsageError(Problem("bad-option", "heun plot polar: no vector is given", hint=SUCH_AS))
    axes = "world" if request.axes is None else require_choice("--axes", request.axes, JOINT_AXES)
    view = None if request.view is None else require_choice("--view", request.view, AXIS_LETTERS)
    paths = [_append_force(path) for path in target.paths]
    require_joint_paths(paths, request)
    specs = load_specs(target.files, request)
    for _, spec in specs:
        measure.require_known_paths([MeasureRequest("", path) for path in paths], spec, "heun plot")
        _require_vectors(paths, spec)
    sources = []
    for name, spec in specs:
        needed = [*paths, *list_angle_paths(spec), *list_firing_paths(spec)]
        sources.append(solve_source(name, spec, [*needed, *list_rotation_paths(needed, spec)], request))
    return make_polar_figure(sources, paths, parse_units(request.units), axes, view)


def _append_force(path: str) -> str:
    """Return the path to a vector: of a joint, a section or the foundation that of its force."""
    words = path.split(".")
    is_entry = len(words) == ENTRY_LENGTH.get(words[0])
    is_foundation_part = (
        words[:2] in (["foundation", "supports"], ["foundation", "elements"]) and len(words) == FOUNDATION_PART_LENGTH
    )
    return f"{path}.force" if is_entry or is_foundation_part else path


def _require_vectors(paths: list[str], spec: Spec) -> None:
    """Raise UsageError for paths that are known to lead to no vector."""
    names, runs = (
        collect_scene_names(spec),
        {name: section.from_ is not None for name, section in spec.sections.items()},
    )
    for path in paths:
        number_kind = resolve_path(split_path(path), names, runs)
        if (
            isinstance(number_kind, NumberKind)
            and number_kind.is_known
            and (number_kind.axes != (SPACE,) or not number_kind.is_timed)
        ):
            message = f"polar {path}: not a vector over time"
            raise UsageError(Problem("bad-option", message, hint=SUCH_AS))
