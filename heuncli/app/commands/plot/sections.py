"""`heun plot SPEC sections.NAME...`: draw N, Q1, Q2, T, M1, M2 along bars."""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.target import parse_units
from heuncli.app.commands.plot.plot_target import PlotTarget
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.sources import list_extreme_paths, load_specs, parse_instants, solve_source
from heuncli.base.errors import Problem, SpecError
from heuncli.base.spelling import find_similar
from heuncli.output.drawing.figure import Figure
from heuncli.output.figures.courses import FigureSource
from heuncli.output.figures.diagrams import make_diagrams
from heuncli.scene.file_format.models import Spec

MAX_NAMES = 12  # of known series of cuts in an error message


def draw(target: PlotTarget, request: PlotRequest) -> Figure:
    """Draw the figure. Raises UsageError, SpecError and what solving raises."""
    names = [path.partition(".")[2] for path in target.paths]
    specs = load_specs(target.files, request)
    for _, spec in specs:
        _require_runs(names, spec)
    _require_one_kind([spec for _, spec in specs])
    path_lists = [[*_list_paths(names, spec), *list_extreme_paths(request.at, spec)] for _, spec in specs]
    sources = [solve_source(name, spec, paths, request) for (name, spec), paths in zip(specs, path_lists, strict=True)]
    return make_diagrams(
        sources, names, parse_units(request.units), _parse_instants(sources, request.at), request.tension_side
    )


def _require_runs(names: Sequence[str], spec: Spec) -> None:
    """Raise SpecError for a name that is no section, UsageError for one that is a single cut."""
    known = [name for name, section in spec.sections.items() if section.from_ is not None]
    for name in names:
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


def _require_one_kind(specs: Sequence[Spec]) -> None:
    """Raise UsageError if forces would be drawn for some specs, and impulses for others."""
    if len({spec.analysis.type == "impulse" for spec in specs}) > 1:
        message = "plot: impulses (type: impulse) and forces cannot share one diagram"
        raise UsageError(Problem("bad-option", message, hint="draw them separately"))


def _list_paths(names: Sequence[str], spec: Spec) -> list[str]:
    """List the paths of the results that the diagrams need."""
    return [f"impulses.0.sections.{name}" if spec.analysis.type == "impulse" else f"sections.{name}" for name in names]


def _parse_instants(sources: Sequence[FigureSource], words: str | None) -> list[float] | None:
    """Return the instants of --at, which all runs must reach before their horizons. Raises UsageError."""
    if words is None:
        return None
    times: list[float] = []
    for source in sources:
        times = parse_instants(source, words).tolist()
    return times
