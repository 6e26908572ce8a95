"""What the words of `heun plot` ask for: files first, then one kind of picture and what it is of."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath

from heuncli.cli.entry import UsageError
from heuncli.cli.files import STDOUT
from heuncli.errors import Problem
from heuncli.named_tuples import NamedTuple

SPECS, SWEEPS = (".yaml", ".yml"), (".sqlite", ".csv", ".db")
USAGE = "such as heun plot engine.yaml joints.main.force, or heun plot engine.yaml scene"
KINDS = ("scene", "modes", "balance", "polar")


class PlotAsked(NamedTuple):
    """The files, the kind of picture, and the paths that it is of."""

    files: Sequence[str]
    what: str
    paths: Sequence[str]


def asked(words: Sequence[str]) -> PlotAsked:
    """What the words mean. Raises UsageError."""
    files = [word for word in words if _is_file(word)]
    rest = [word for word in words if not _is_file(word)]
    if not files:
        raise UsageError(Problem("bad-option", "heun plot: no spec is named", hint=USAGE))
    kinds = [word for word in rest if word in KINDS]
    if PurePath(files[0]).suffix.lower() in SWEEPS:
        return PlotAsked(files, "sweep", rest)
    if not rest:
        raise UsageError(Problem("bad-option", "heun plot: what is to be drawn is not said", hint=USAGE))
    if len(kinds) > 1 or (kinds and kinds[0] != rest[0]):
        message = f"heun plot: {', '.join(rest)}: one kind of picture at a time"
        raise UsageError(Problem("bad-option", message, hint="call it once for each"))
    return PlotAsked(files, kinds[0] if kinds else _of_paths(rest), rest[len(kinds) :])


def _of_paths(paths: Sequence[str]) -> str:
    """Whether paths are of whole sections, whose diagrams are drawn, or of numbers over time."""
    whole = [path for path in paths if path.startswith("sections.") and path.count(".") == 1]
    return "sections" if whole and len(whole) == len(paths) else "history"


def _is_file(word: str) -> bool:
    return word == STDOUT or PurePath(word).suffix.lower() in (*SPECS, *SWEEPS)
