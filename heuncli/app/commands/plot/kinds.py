"""The kinds of pictures, and which options mean something to each: one that would do nothing is refused."""

from __future__ import annotations

from collections.abc import Iterator
from typing import cast

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.options import Request, fields_of
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple


class PictureKind(NamedTuple):
    """A kind of picture: what it is of, in words, and the fields of the request that it heeds beside EVERY."""

    what: str
    heeds: tuple[str, ...]


EVERY = ("words", "output", "width", "time_limit", "quiet")
SCENE = ("set", "case")
SOLVING = (*SCENE, "method", "step", "tolerance", "no_reduce", "least_norm")
KINDS = {
    "history": PictureKind("numbers over time", ("x", "measured", "axes", "units", *SOLVING)),
    "sections": PictureKind("section diagrams", ("at", "tension_side", "units", *SOLVING)),
    "polar": PictureKind("polar diagrams", ("axes", "view", "units", *SOLVING)),
    "scene": PictureKind("scenes", ("at", "view", "units", *SOLVING)),
    "modes": PictureKind("mode shapes", ("view", "without", *SCENE)),
    "balance": PictureKind("harmonics by orders", ("units", *SCENE)),
    "sweep": PictureKind("sweeps", ("units",)),
}


def require_heeded(kind: str, request: PlotRequest) -> None:
    """Raise UsageError for options that mean nothing to that kind of picture, all of them."""
    problems = list(_unheeded(kind, request))
    if problems:
        raise UsageError(*problems)


def _unheeded(kind: str, request: PlotRequest) -> Iterator[Problem]:
    """What is wrong with options that are given."""
    own = KINDS[kind]
    for field in fields_of(cast("type[Request]", PlotRequest)):
        name = field.name
        if name in EVERY or name in own.heeds or getattr(request, name) == request._field_defaults[name]:
            continue
        of = [other.what for other in KINDS.values() if name in other.heeds]
        message = f"{field.option.words[0]} does nothing to {own.what}"
        yield Problem("bad-option", message, hint=f"leave it out: it is of {', '.join(of)}")
    if request.output is not None and request.width is not None:
        yield Problem("bad-option", "--width is of pictures in letters, not of files", hint="leave it out, or -o FILE")
