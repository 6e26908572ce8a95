"""What the words of `heun plot` ask for: files first, then one kind of picture and what it is of."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path, PurePath

from heuncli.app.cli.entry import UsageError
from heuncli.app.commands.plot.kinds import KINDS
from heuncli.base.errors import Problem
from heuncli.base.files import STDOUT
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.nearest import nearest

SPECS, SWEEPS = (".yaml", ".yml"), (".sqlite", ".csv", ".db")
USAGE = "such as heun plot engine.yaml joints.main.force, or heun plot engine.yaml scene"
OF_PATHS, OF_SWEEPS = ("history", "sections"), "sweep"  # kinds that no word names
NAMED = tuple(kind for kind in KINDS if kind not in (*OF_PATHS, OF_SWEEPS))


class PlotAsked(NamedTuple):
    """The files, the kind of picture, and the paths that it is of."""

    files: Sequence[str]
    what: str
    paths: Sequence[str]


def asked(words: Sequence[str]) -> PlotAsked:
    """What the words mean. Raises UsageError."""
    files = [word for k, word in enumerate(words) if _is_file(word, first=k == 0)]
    rest = [word for word in words if word not in files]
    if not files:
        raise _refused("no spec is named", USAGE)
    if not all(words):
        raise _refused("an empty word", USAGE)
    swept = [file for file in files if _ending(file) in SWEEPS]
    if swept:
        if len(swept) < len(files):
            raise _refused(f"{', '.join(files)}: specs and sweeps in one picture", "call it once for each")
        return PlotAsked(files, OF_SWEEPS, rest)
    if not rest:
        raise _refused("what is to be drawn is not said", USAGE)
    kinds = [word for word in rest if word in NAMED]
    if len(kinds) > 1 or (kinds and kinds[0] != rest[0]):
        raise _refused(f"{', '.join(rest)}: one kind of picture at a time", "call it once for each")
    return PlotAsked(files, kinds[0] if kinds else _of_paths(rest), rest[len(kinds) :])


def _of_paths(paths: Sequence[str]) -> str:
    """Whether paths are of whole sections, whose diagrams are drawn, or of numbers over time. Raises UsageError."""
    whole = [path for path in paths if path.startswith("sections.") and path.count(".") == 1]
    if whole and len(whole) < len(paths):
        other = next(path for path in paths if path not in whole)
        message = f"{whole[0]} is a diagram along a bar, {other} a number over time: one kind of picture at a time"
        raise _refused(message, f"call it once for each; over time {whole[0]}.N, say")
    meant = nearest(paths[0], NAMED) if "." not in paths[0] else None
    if meant is not None:
        raise _refused(f"'{paths[0]}' is no kind of picture", f"did you mean {meant}?")
    return "sections" if whole else "history"


def _is_file(word: str, *, first: bool) -> bool:
    """Whether a word names a file: by how it ends; the first one also because it is there."""
    return word == STDOUT or _ending(word) in (*SPECS, *SWEEPS) or (first and _is_there(word))


def _ending(word: str) -> str:
    """How a name ends; of one sweep of a store, as sweep.sqlite:2, how that of the store does."""
    name, colon, number = word.rpartition(":")
    return PurePath(name if colon and number.isdecimal() else word).suffix.lower()


def _is_there(word: str) -> bool:
    """Whether there is a file or folder of that name; a word that can be none is none."""
    try:
        return word != "" and Path(word).exists()
    except (OSError, ValueError):
        return False


def _refused(message: str, hint: str) -> UsageError:
    return UsageError(Problem("bad-option", f"heun plot: {message}", hint=hint))
