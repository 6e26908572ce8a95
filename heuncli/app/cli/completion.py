"""Completion of a command line in a shell: files, options' values, and names from the spec on the line.

The spec is read as plain data, so it may still be invalid; an unreadable one gives no completions. Impure: reads files.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import typer

SPECS = (".yaml", ".yml")
REDUCERS = ("max", "min", "abs", "first", "final", "at")
BLOCKS = {  # word of a name in a path of results: the block of the spec that holds such names
    "BODY": "bodies",
    "JOINT": "joints",
    "FORCE": "forces",
    "SECTION": "sections",
    "STOP": "stops",
    "COUPLING": "couplings",
    "SENSOR": "sensors",
}
SETTABLE = ("gravity", "space", "title")
MAX_COMPLETIONS = 400  # most completions to offer
# Completions never contain characters that a shell would run, expand or split, or that a terminal would not show: no
# name of a valid spec contains any.
SAFE_WORD = re.compile(r"[\w.,:=+\- ]*")
SAFE_FILE = re.compile(r"(?![-~])[\w./,:=+@%~ -]*")


def complete_files(incomplete: str) -> list[str]:
    """List the folders and specs that begin with the text."""
    folder, start = os.path.split(incomplete)
    try:
        with os.scandir(folder or ".") as entries:
            entries_found = [(entry.name, entry.is_dir()) for entry in entries]
    except OSError:
        return []
    matching = sorted(
        (name, is_folder) for name, is_folder in entries_found if name.startswith(start) and not name.startswith(".")
    )
    names = [name + "/" * is_folder for name, is_folder in matching if is_folder or name.endswith(SPECS)]
    return [os.path.join(folder, name) for name in names if SAFE_FILE.fullmatch(name)]  # noqa: PTH118  # as it was typed


def complete_overrides(data: dict[str, Any], incomplete: str) -> Iterator[str]:
    """Yield what --set may name: parameters, dotted keys of entries."""
    from heuncli.scene.file_format.names import as_mapping

    yield from (f"{name}=" for name in (*as_mapping(data.get("parameters")), *SETTABLE))
    if "." in incomplete:
        for block, entries in data.items():
            for name, entry in as_mapping(entries).items():
                yield from (f"{block}.{name}.{key}=" for key in as_mapping(entry))
    else:
        yield from (
            f"{block}." for block, entries in data.items() if isinstance(entries, dict) and block != "parameters"
        )


def complete_labels(data: dict[str, Any], incomplete: str) -> Iterator[str]:
    """Yield what --label may name."""
    from heuncli.scene.file_format import labels
    from heuncli.scene.file_format.names import SceneNames

    names = SceneNames.from_data(data)
    yield from (f"{block}.{name}=" for block in labels.BLOCKS for name in names.entries[block])
    yield from (f"points.{owner}.{point}=" for owner, points in names.points.items() for point in points)


def complete_cases(data: dict[str, Any], incomplete: str) -> Iterator[str]:
    """Yield the load cases, and the word for all of them."""
    from heuncli.scene.file_format.names import ALL_CASES, as_mapping

    case_names = as_mapping(data.get("cases"))
    yield from (*case_names, ALL_CASES) if case_names else ()


def complete_only(data: dict[str, Any], incomplete: str) -> Iterator[str]:
    """Yield reports and single entries of them, each after those already typed."""
    from heuncli.results.results_schema import REPORTS, SHARES
    from heuncli.scene.file_format.names import as_mapping

    prefix = incomplete[: incomplete.rfind(",") + 1]
    blocks = ("joints", "sections", "forces", "bodies", "stops")
    entries = [f"{block}.{name}" for block in blocks for name in as_mapping(data.get(block))]
    yield from (prefix + word for word in (*REPORTS, SHARES, *entries))


def complete_bodies(data: dict[str, Any], incomplete: str) -> Iterator[str]:
    """Yield the names of the bodies, for --body."""
    from heuncli.scene.file_format.names import as_mapping

    yield from as_mapping(data.get("bodies"))


def complete_measures(data: dict[str, Any], incomplete: str) -> Iterator[str]:
    """Yield reducers and the paths of numbers."""
    reducer, space, _ = incomplete.rpartition(" ")
    if not space:
        yield from REDUCERS
    yield from (reducer + space + path for path in iter_paths(data))


def complete_collectives(data: dict[str, Any], incomplete: str) -> Iterator[str]:
    """Yield paths of numbers, each after those already typed."""
    prefix = incomplete[: incomplete.rfind(",") + 1]
    yield from (prefix + path for path in iter_paths(data))


def iter_paths(data: dict[str, Any]) -> Iterator[str]:
    """Yield the paths of the numbers that a scene may have."""
    from heuncli.results.path_words import NAMES
    from heuncli.results.results_schema import ROWS, XYZ
    from heuncli.scene.file_format.names import SceneNames

    names = SceneNames.from_data(data)
    points = [
        f"{body}.{point}" for body, point_names in names.points.items() if body != "ground" for point in point_names
    ]
    known: dict[str, Iterable[str]] = {word: names.entries[block] for word, block in BLOCKS.items()}
    known |= {"POINT": points, "EVENT": names.entries["events"]}
    for row in ROWS:
        words = row.path.split(".")
        name_words = [word for word in words if word in NAMES]
        if not row.units or (name_words and name_words[0] not in known) or len(name_words) > 1:
            continue
        ends = [f".{letter}" for letter in XYZ] if row.shape and row.shape[-1].letters == XYZ else [""]
        for name in known[name_words[0]] if name_words else [""]:
            path = ".".join(name if word in NAMES else word for word in words)
            yield from (path + end for end in ends)


def _complete_from_spec(
    words: Callable[[dict[str, Any], str], Iterator[str]],
) -> Callable[[typer.Context, str], list[str]]:
    """Make a completion from a function of the spec that stands on the command line."""

    def complete(ctx: typer.Context, incomplete: str) -> list[str]:
        """Complete a word from the spec that stands on the line; nothing if it cannot be read."""
        given = _find_typed_spec()
        if given is None:
            return []
        from heuncli.base.errors import Finding, HeunError
        from heuncli.scene.file_format.names import as_mapping
        from heuncli.scene.file_format.source import read_source

        try:
            data = read_source(given, None).data
        except (HeunError, Finding):
            return []
        known = words(as_mapping(data), incomplete)
        matches = dict.fromkeys(word for word in known if word.startswith(incomplete) and SAFE_WORD.fullmatch(word))
        return [*matches][:MAX_COMPLETIONS]

    return complete


def _find_typed_spec() -> str | None:
    """Return the spec on the command line that is being completed."""
    return next((word for word in read_typed_words()[2:] if word.endswith(SPECS) and Path(word).is_file()), None)


def read_typed_words() -> list[str]:
    """Return the words of the command line that is being completed, `heun` first.

    They are read from what the shell hands over, because typer stops parsing at an option that lacks its value.
    """
    line = os.environ.get("_TYPER_COMPLETE_ARGS") or os.environ.get("COMP_WORDS") or ""
    return re.findall(r"(?:[^\s\\]|\\.)+", line)


def _complete_files(ctx: typer.Context, incomplete: str) -> list[str]:
    """Complete the name of a file."""
    return complete_files(incomplete)


COMPLETIONS: dict[str, Callable[[typer.Context, str], list[str]]] = {
    "spec": _complete_files,
    "set": _complete_from_spec(complete_overrides),
    "label": _complete_from_spec(complete_labels),
    "case": _complete_from_spec(complete_cases),
    "only": _complete_from_spec(complete_only),
    "measure": _complete_from_spec(complete_measures),
    "collective": _complete_from_spec(complete_collectives),
    "body": _complete_from_spec(complete_bodies),
}
