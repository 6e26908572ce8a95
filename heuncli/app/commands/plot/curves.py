"""`heun plot SPEC PATH...`, `sections.NAME` and `polar`: draw numbers over time, along bars, over a turn."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.solving import collect_results, require_choice
from heuncli.app.cli.target import parse_units
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.sources import (
    PlotTarget,
    list_extreme_paths,
    load_specs,
    parse_instants,
    require_joint_paths,
    solve_source,
)
from heuncli.base.errors import Problem, SpecError
from heuncli.base.spelling import find_similar
from heuncli.loads.kinetostatics.reactions import JOINT_AXES
from heuncli.output.drawing.figure import Figure
from heuncli.output.figures.courses import FigureSource, list_angle_paths
from heuncli.output.figures.curves import MeasuredPoints
from heuncli.output.figures.diagrams import make_diagrams
from heuncli.output.figures.histories import make_history
from heuncli.output.figures.polar import make_polar_figure
from heuncli.output.figures.tips import AXIS_LETTERS, list_firing_paths, list_rotation_paths
from heuncli.output.tables import measure
from heuncli.results.path_words import split_path
from heuncli.results.results_schema import DEFLECTIONS, EVENTS, IMPULSES, SPACE
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import collect_scene_names
from heuncli.scene.file_format.rules.outcome import NumberKind, resolve_path
from heuncli.study.queries.measure import MeasureRequest
from heuncli.study.queries.measure_uncertainty import find_unit


def draw_history(target: PlotTarget, request: PlotRequest) -> Figure:
    """Draw numbers over time. Raises UsageError, NotDrawable, SpecError and what solving raises."""
    paths = [*target.paths, *([] if request.x is None else [request.x])]
    require_joint_paths(paths, request)
    specs = load_specs(target.files, request)
    for name, spec in specs:
        measure.require_known_paths([MeasureRequest("", path) for path in paths], spec, f"heun plot {name}".rstrip())
    points = _read_points(target, request, specs[0][1])
    needed = [*paths, IMPULSES, EVENTS]  # these are marked in the figure
    sources = [solve_source(name, spec, needed, request) for name, spec in specs]
    return make_history(sources, target.paths, parse_units(request.units), request.x, points)


def _read_points(target: PlotTarget, request: PlotRequest, spec: Spec) -> list[MeasuredPoints]:
    """Read the points of each --with FILE. Raises SpecError with every problem of any of the files."""
    x_unit = "s" if request.x is None else find_unit(request.x, spec)
    y_units = [find_unit(path, spec) for path in target.paths]
    return collect_results([partial(_read_file, words, x_unit, y_units) for words in request.measured])


def _read_file(words: str, x_unit: str, y_units: Sequence[str]) -> MeasuredPoints:
    """Read measured points from the columns of a CSV file that `--with` names."""
    from heuncli.output.figures.measurements import parse_points_query, read_points  # rarely used

    return read_points(parse_points_query(words), x_unit, y_units)


MAX_NAMES = 12  # of known series of cuts in an error message


def draw_sections(target: PlotTarget, request: PlotRequest) -> Figure:
    """Draw section forces along bars. Raises UsageError, SpecError and what solving raises."""
    names = [path.partition(".")[2] for path in target.paths]
    specs = load_specs(target.files, request)
    for _, spec in specs:
        _require_cut_series(names, spec)
    _require_one_kind([spec for _, spec in specs])
    path_lists = [[*_list_paths(names, spec), *list_extreme_paths(request.at, spec)] for _, spec in specs]
    sources = [solve_source(name, spec, paths, request) for (name, spec), paths in zip(specs, path_lists, strict=True)]
    return make_diagrams(
        sources, names, parse_units(request.units), _parse_common_instants(sources, request.at), request.tension_side
    )


def _require_cut_series(names: Sequence[str], spec: Spec) -> None:
    """Raise SpecError for a name that is no section, UsageError for one that is a single cut."""
    known = [name for name, section in spec.sections.items() if section.from_ is not None]
    for name, _, quantity in (entry.partition(".") for entry in names):
        section = spec.sections.get(name)
        if section is None:
            listed = ", ".join(known[:MAX_NAMES]) + (", ..." if len(known) > MAX_NAMES else "")
            known_text = f"known series of cuts: {listed}" if known else "it has no series of cuts"
            near = find_similar(name, known)
            hint = f"did you mean sections.{near}?" if near else "define a section with from, to and count"
            message = f"plot: sections.{name}: there is no such section in {spec.path}; {known_text}"
            raise SpecError(Problem("unknown-path", message, hint=hint))
        if section.from_ is None:
            message = f"plot: sections.{name} is a single cut, not a series of cuts along a bar"
            hint = f"give the section from, to and count; or its loads over time: sections.{name}.M1"
            raise UsageError(Problem("bad-option", message, hint=hint))
        quantities = [f"deflection{tail}" for tail in ("", *(f".{component}" for component in DEFLECTIONS))]
        if quantity and (section.beam_theory is None or spec.analysis.type == "impulse" or quantity not in quantities):
            message = f"plot: sections.{name} has no {quantity}"
            hint = "give the section `deflection: true`: heun explain stresses"
            if section.beam_theory is not None:
                hint = f"it has {', '.join(quantities)}; none of an impulse"
            raise UsageError(Problem("bad-option", message, hint=hint))


def _require_one_kind(specs: Sequence[Spec]) -> None:
    """Raise UsageError if forces would be drawn for some specs, and impulses for others."""
    if len({spec.analysis.type == "impulse" for spec in specs}) > 1:
        message = "plot: impulses (type: impulse) and forces cannot share one diagram"
        raise UsageError(Problem("bad-option", message, hint="draw them separately"))


def _list_paths(names: Sequence[str], spec: Spec) -> list[str]:
    """List the paths of the results that the diagrams need."""
    prefix = "impulses.0.sections" if spec.analysis.type == "impulse" else "sections"
    return list(dict.fromkeys(f"{prefix}.{name.partition('.')[0]}" for name in names))


def _parse_common_instants(sources: Sequence[FigureSource], words: str | None) -> list[float] | None:
    """Return the instants of --at in any of the runs, which all runs must reach before their horizons. Raises
    UsageError.
    """
    if words is None:
        return None
    times = sorted({time for source in sources for time in parse_instants(source, words).tolist()})
    for source in sources if len(sources) > 1 else ():
        try:
            parse_instants(source, ",".join(map(repr, times)))
        except UsageError as error:
            hint = "give instants that all runs reach, in seconds, or call it once for each"
            own = (
                f"{source.name}: {problem.message}; one figure shows all runs at the same instants"
                for problem in error.problems
            )
            raise UsageError(*(Problem("bad-option", message, hint=hint) for message in own)) from None
    return times


ENTRY_LENGTH = {"joints": 2, "sections": 2, "foundation": 1}  # number of words of a path to a whole entry
FOUNDATION_PART_LENGTH = 3  # words of foundation.supports.NAME
SUCH_AS = "for example polar joints.main, or polar foundation"


def draw_polar(target: PlotTarget, request: PlotRequest) -> Figure:
    """Draw vectors by size and direction. Raises UsageError, NotDrawable, SpecError and what solving raises."""
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
    names = collect_scene_names(spec)
    cut_series = {name: section.from_ is not None for name, section in spec.sections.items()}
    for path in paths:
        number_kind = resolve_path(split_path(path), names, cut_series)
        if (
            isinstance(number_kind, NumberKind)
            and number_kind.is_known
            and (number_kind.axes != (SPACE,) or not number_kind.is_timed)
        ):
            message = f"polar {path}: not a vector over time"
            raise UsageError(Problem("bad-option", message, hint=SUCH_AS))
