"""Find the specs in folders and their subfolders, each folder once, or those that `-k` selects.

A link may lead from a folder to one of its parents, or to the same folder many times; so folders are identified by
device and inode, not by path. A folder that cannot be read is reported in its place, and the others are still searched.
Impure: reads folders and files.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from heuncli.app.cli.entry import UsageError
from heuncli.base.errors import Finding, HeunError, Problem, SourceLocation
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes
from heuncli.scene.file_format.source import MAX_SIZE, read_source

SPECS = frozenset({".yaml", ".yml"})
SKIPPED_FOLDER = "broken"  # folders of deliberately invalid specs
PLAIN_TITLE = re.compile(r"^title:[ \t]+(?![|>&*!\"'\[{])([^#\n]*)", re.MULTILINE)


class FoundSpec(NamedTuple):
    """A spec that was found.

    path: its file
    folder: the folder that was searched, or None if the spec was named directly
    problem: why a folder cannot be read, in place of a spec
    """

    path: str
    folder: str | None = None
    problem: Problem | None = None


class SkippedFolder(NamedTuple):
    """A folder that is not searched, and why, in words."""

    path: str
    reason: str


def find_specs(argument: str, skipped: list[SkippedFolder]) -> Iterator[FoundSpec]:
    """Yield the file itself, or every spec in the folder and below it, sorted; hidden folders and those named `broken`
    are skipped.
    """
    if argument == STANDARD_INPUT or not os.path.isdir(argument):  # noqa: PTH112  # Path's raises where the way there is closed
        yield FoundSpec(argument)
        return
    seen: dict[tuple[int, int], str] = {}
    pending = [(str(Path(argument)), True)]  # a stack: folders may be nested deeper than the recursion limit
    while pending:
        path, is_folder = pending.pop()
        if not is_folder:
            yield FoundSpec(path, argument)
            continue
        try:
            state = Path(path).stat()
            known = seen.setdefault((state.st_dev, state.st_ino), path)
            if known == path:
                pending += reversed(list_entries(path, skipped))
            else:
                skipped.append(SkippedFolder(path, f"same folder as {known}"))
        except OSError as error:
            yield FoundSpec(path, argument, make_unreadable_problem(path, error))


def list_entries(folder: str, skipped: list[SkippedFolder]) -> list[tuple[str, bool]]:
    """List the specs and the folders to search, sorted, each with whether it is a folder. Raises OSError."""
    with os.scandir(folder) as entries:
        entries_found = sorted((entry.path, entry.name, leads_to_directory(entry)) for entry in entries)
    skipped += [
        SkippedFolder(path, "") for path, name, is_folder in entries_found if is_folder and name == SKIPPED_FOLDER
    ]
    return [
        (path, is_folder)
        for path, name, is_folder in entries_found
        if (name != SKIPPED_FOLDER and not name.startswith(".") if is_folder else Path(name).suffix in SPECS)
    ]


def leads_to_directory(entry: os.DirEntry[str]) -> bool:
    """Return whether an entry is a folder or a link to one; a circular link is none."""
    try:
        return entry.is_dir()
    except OSError:
        return False


def make_unreadable_problem(path: str, error: OSError) -> Problem:
    """Make the problem of a folder that cannot be read."""
    hint = "check its permissions, or give the other folders; these are checked"
    message = f"the folder cannot be read: {error.strerror or error}"
    return Problem("unreadable", message, SourceLocation(path, 1, 1), hint)


def select_specs(specs: Sequence[FoundSpec], text: str) -> list[FoundSpec]:
    """Return the specs with the text in path or title. Raises UsageError if there is none."""
    needle = text.casefold()
    chosen = [spec for spec in specs if needle in spec.path.casefold() or needle in read_title(spec).casefold()]
    if not chosen:
        hint = "it is looked for in paths and titles, in capitals or not"
        raise UsageError(Problem("nothing-to-check", f"-k {text}: none of {len(specs)} specs", hint=hint))
    return chosen


def read_title(spec: FoundSpec) -> str:
    """Return the title of a spec; empty if it has none or cannot be read, which the check reports later."""
    if spec.problem is not None or spec.path == STANDARD_INPUT:
        return ""
    try:
        text = read_bytes(spec.path, MAX_SIZE).decode("utf-8", "replace")
        if (plain := PLAIN_TITLE.search(text)) is not None:
            return plain[1]
        data = read_source(spec.path, None).data if "title" in text else {}
    except (Finding, HeunError):
        return ""
    title = data.get("title") if isinstance(data, dict) else None
    return title if isinstance(title, str) else ""
