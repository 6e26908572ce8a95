"""`heun plot SPEC sections.NAME...`: N, Q1, Q2, T, M1, M2 along bars."""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.units import units
from heuncli.app.commands.plot.asked import PlotAsked
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.sources import extremes_asked, instants_before_horizon, solution, specs_of
from heuncli.base.errors import Problem, SpecError
from heuncli.base.nearest import nearest
from heuncli.output.drawing.figure import Figure
from heuncli.output.figures.courses import Pictured
from heuncli.output.figures.diagrams import diagrams
from heuncli.scene.file_format.models import Spec

MOST_NAMES = 12  # of the known runs of cuts an error lists


def draw(asked: PlotAsked, request: PlotRequest) -> Figure:
    """The figure. Raises UsageError, SpecError and what solving raises."""
    names = [path.partition(".")[2] for path in asked.paths]
    specs = specs_of(asked.files, request)
    for _, spec in specs:
        _require_runs(names, spec)
    _require_one_kind([spec for _, spec in specs])
    needed = [[*_needed(names, spec), *extremes_asked(request.at, spec)] for _, spec in specs]
    sources = [solution(name, spec, paths, request) for (name, spec), paths in zip(specs, needed, strict=True)]
    return diagrams(sources, names, units(request.units), _asked_instants(sources, request.at), request.tension_side)


def _require_runs(names: Sequence[str], spec: Spec) -> None:
    """Raise SpecError for a name that is no section, UsageError for one that is a single cut."""
    known = [name for name, section in spec.sections.items() if section.from_ is not None]
    for name in names:
        section = spec.sections.get(name)
        if section is None:
            listed = ", ".join(known[:MOST_NAMES]) + (", ..." if len(known) > MOST_NAMES else "")
            found = f"known runs of cuts: {listed}" if known else "there is no run of cuts in it"
            near = nearest(name, known)
            hint = f"did you mean sections.{near}?" if near else "a section with from, to and count"
            message = f"heun plot: sections.{name}: there is no such section in {spec.path}; {found}"
            raise SpecError(Problem("unknown-path", message, hint=hint))
        if section.from_ is None:
            message = f"heun plot: sections.{name} is one cut: there is no way along it to draw a diagram over"
            hint = f"give the section from, to and count; or its loads over time: sections.{name}.M1"
            raise UsageError(Problem("bad-option", message, hint=hint))


def _require_one_kind(specs: Sequence[Spec]) -> None:
    """Raise UsageError where of some specs forces would be drawn, and of others the impulses of a blow."""
    if len({spec.analysis.type == "impulse" for spec in specs}) > 1:
        message = "heun plot: impulses of a blow (type: impulse) and forces do not stand over each other"
        raise UsageError(Problem("bad-option", message, hint="draw them one after the other"))


def _needed(names: Sequence[str], spec: Spec) -> list[str]:
    """The paths into the results that the diagrams need."""
    return [f"impulses.0.sections.{name}" if spec.analysis.type == "impulse" else f"sections.{name}" for name in names]


def _asked_instants(sources: Sequence[Pictured], words: str | None) -> list[float] | None:
    """The instants of --at, which all runs must reach, before their horizons. Raises UsageError."""
    if words is None:
        return None
    found: list[float] = []
    for source in sources:
        found = instants_before_horizon(source, words).tolist()
    return found
