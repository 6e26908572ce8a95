"""The kinds of figures, and which options apply to each; an option without effect is refused."""

from __future__ import annotations

from collections.abc import Iterator
from typing import cast

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.options import Request, list_fields
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple


class FigureKind(NamedTuple):
    """A kind of figure.

    what: its name in messages
    options: the fields of the request that apply to it, besides COMMON_OPTIONS
    """

    what: str
    options: tuple[str, ...]


COMMON_OPTIONS = ("words", "output", "width", "title", "time_limit", "quiet")
SCENE_OPTIONS = ("set", "label", "case")
SOLVER_OPTIONS = (*SCENE_OPTIONS, "method", "step", "tolerance", "no_reduce", "least_norm")
KINDS = {
    "history": FigureKind("numbers over time", ("x", "measured", "axes", "units", *SOLVER_OPTIONS)),
    "sections": FigureKind("section diagrams", ("at", "tension_side", "units", *SOLVER_OPTIONS)),
    "polar": FigureKind("polar diagrams", ("axes", "view", "units", *SOLVER_OPTIONS)),
    "scene": FigureKind("scenes", ("at", "view", "units", *SOLVER_OPTIONS)),
    "modes": FigureKind("mode shapes", ("view", "without", *SCENE_OPTIONS)),
    "balance": FigureKind("harmonics by orders", ("units", *SCENE_OPTIONS)),
    "sweep": FigureKind("sweeps", ("units",)),
}


def require_applicable_options(kind: str, request: PlotRequest) -> None:
    """Raise UsageError with every option that has no effect on this kind of figure."""
    problems = list(_iter_problems(kind, request))
    if problems:
        raise UsageError(*problems)


def _iter_problems(kind: str, request: PlotRequest) -> Iterator[Problem]:
    """Yield the problems of the given options."""
    figure_kind = KINDS[kind]
    for field in list_fields(cast("type[Request]", PlotRequest)):
        name = field.name
        if (
            name in COMMON_OPTIONS
            or name in figure_kind.options
            or getattr(request, name) == request._field_defaults[name]
        ):
            continue
        others = [other.what for other in KINDS.values() if name in other.options]
        message = f"{field.option.words[0]} has no effect on {figure_kind.what}"
        yield Problem("bad-option", message, hint=f"leave it out: it applies to {', '.join(others)}")
    if request.output is not None and request.width is not None:
        yield Problem("bad-option", "--width applies to text drawings, not to files", hint="leave it out, or -o FILE")
