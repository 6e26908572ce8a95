"""The specs in folders and below them, each folder once. Impure: reads folders.

Links may lead from a folder into one that it stands in, or into the same one a thousand times: a folder is what it is,
not what it is called. What cannot be looked into is told in its place, and the rest is found all the same.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from heuncli.base.errors import Problem, SourceLocation
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.reading import STANDARD_INPUT

SPECS = frozenset({".yaml", ".yml"})
SKIPPED = "broken"  # folders of specs that are wrong on purpose


class Found(NamedTuple):
    """A spec, and the folder in which it was looked for (None: it was named itself).

    problem: why a folder cannot be looked into, in place of a spec.
    """

    path: str
    below: str | None = None
    problem: Problem | None = None


class PassedBy(NamedTuple):
    """A folder that is not looked into, and why, in words."""

    path: str
    reason: str


def specs_below(argument: str, passed_by: list[PassedBy]) -> Iterator[Found]:
    """The file itself, or every spec in the folder and below it, sorted; not in hidden folders and `broken` ones."""
    if argument == STANDARD_INPUT or not os.path.isdir(argument):  # noqa: PTH112  # Path's raises where the way there is closed
        yield Found(argument)
        return
    seen: dict[tuple[int, int], str] = {}
    waiting = [(str(Path(argument)), True)]  # the next one last: folders may be nested deeper than functions
    while waiting:
        path, is_folder = waiting.pop()
        if not is_folder:
            yield Found(path, argument)
            continue
        try:
            state = Path(path).stat()
            known = seen.setdefault((state.st_dev, state.st_ino), path)
            if known == path:
                waiting += reversed(entries_of(path, passed_by))
            else:
                passed_by.append(PassedBy(path, f"it is the folder {known} once more"))
        except OSError as error:
            yield Found(path, argument, cannot_look_into(path, error))


def entries_of(folder: str, passed_by: list[PassedBy]) -> list[tuple[str, bool]]:
    """Specs, and folders to be looked into, sorted; and whether it is a folder. Raises OSError."""
    with os.scandir(folder) as entries:
        found = sorted((entry.path, entry.name, leads_to_folder(entry)) for entry in entries)
    passed_by += [PassedBy(path, "") for path, name, is_folder in found if is_folder and name == SKIPPED]
    return [
        (path, is_folder)
        for path, name, is_folder in found
        if (name != SKIPPED and not name.startswith(".") if is_folder else Path(name).suffix in SPECS)
    ]


def leads_to_folder(entry: os.DirEntry[str]) -> bool:
    """Whether it is a folder, or a link to one; a link in a circle is none."""
    try:
        return entry.is_dir()
    except OSError:
        return False


def cannot_look_into(path: str, error: OSError) -> Problem:
    """Why a folder cannot be looked into."""
    hint = "look at its permissions, or name the folders beside it; the others are checked"
    message = f"the folder cannot be looked into: {error.strerror or error}"
    return Problem("unreadable", message, SourceLocation(path, 1, 1), hint)
