"""What a shell may complete on a command line: spec files, and the names of the spec that stands on it.

The spec is read as plain data, so that it may still be wrong; what cannot be read completes nothing. What reads it is
imported where a shell asks: `--help` passes here, too. Impure: reads files.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import typer

SPECS = (".yaml", ".yml")
HOWS = ("max", "min", "abs", "first", "final", "at")
OF_BLOCK = {
    "BODY": "bodies",
    "JOINT": "joints",
    "FORCE": "forces",
    "SECTION": "sections",
    "STOP": "stops",
    "COUPLING": "couplings",
}
SETTABLE = ("gravity", "space", "title")
MOST = 400  # completions that are offered
# What a shell would run, expand or split, and what a terminal would not show as it is, is never put on a command line:
# no name of a sound spec has any of it.
IN_WORDS = re.compile(r"[\w.,:=+\- ]*")
IN_FILES = re.compile(r"(?![-~])[\w./,:=+@%~ -]*")


def files(incomplete: str) -> list[str]:
    """Folders and specs that begin so."""
    folder, start = os.path.split(incomplete)
    try:
        with os.scandir(folder or ".") as entries:
            found = [(entry.name, entry.is_dir()) for entry in entries]
    except OSError:
        return []
    named = sorted(
        (name, is_folder) for name, is_folder in found if name.startswith(start) and not name.startswith(".")
    )
    kept = [name + "/" * is_folder for name, is_folder in named if is_folder or name.endswith(SPECS)]
    return [os.path.join(folder, name) for name in kept if IN_FILES.fullmatch(name)]  # noqa: PTH118  # as it was typed


def sets(data: dict[str, Any], incomplete: str) -> Iterator[str]:
    """What --set may name: parameters, dotted keys of entries."""
    from heuncli.scene.file_format.names import mapping

    yield from (f"{name}=" for name in (*mapping(data.get("parameters")), *SETTABLE))
    if "." in incomplete:
        for block, entries in data.items():
            for name, entry in mapping(entries).items():
                yield from (f"{block}.{name}.{key}=" for key in mapping(entry))
    else:
        yield from (
            f"{block}." for block, entries in data.items() if isinstance(entries, dict) and block != "parameters"
        )


def cases(data: dict[str, Any], incomplete: str) -> Iterator[str]:
    """The load cases, and all of them."""
    from heuncli.scene.file_format.names import ALL_CASES, mapping

    own = mapping(data.get("cases"))
    yield from (*own, ALL_CASES) if own else ()


def only(data: dict[str, Any], incomplete: str) -> Iterator[str]:
    """Reports, and single entries of them, behind those that are given."""
    from heuncli.results.results_schema import REPORTS, SHARES
    from heuncli.scene.file_format.names import mapping

    given = incomplete[: incomplete.rfind(",") + 1]
    blocks = ("joints", "sections", "forces", "bodies", "stops")
    entries = [f"{block}.{name}" for block in blocks for name in mapping(data.get(block))]
    yield from (given + word for word in (*REPORTS, SHARES, *entries))


def bodies(data: dict[str, Any], incomplete: str) -> Iterator[str]:
    """The bodies."""
    from heuncli.scene.file_format.names import mapping

    yield from mapping(data.get("bodies"))


def measures(data: dict[str, Any], incomplete: str) -> Iterator[str]:
    """How a number is taken over the run, and the paths of numbers."""
    how, space, _ = incomplete.rpartition(" ")
    if not space:
        yield from HOWS
    yield from (how + space + path for path in paths(data))


def collectives(data: dict[str, Any], incomplete: str) -> Iterator[str]:
    """Paths of numbers, behind those that are given."""
    given = incomplete[: incomplete.rfind(",") + 1]
    yield from (given + path for path in paths(data))


def paths(data: dict[str, Any]) -> Iterator[str]:
    """The paths of the numbers that a scene may have."""
    from heuncli.results.results_schema import NAMES, ROWS, XYZ
    from heuncli.scene.file_format.names import Names

    names = Names.of(data)
    points = [f"{body}.{point}" for body, own in names.points.items() if body != "ground" for point in own]
    known: dict[str, Iterable[str]] = {word: names.entries[block] for word, block in OF_BLOCK.items()}
    known |= {"POINT": points, "EVENT": names.entries["events"]}
    for row in ROWS:
        words = row.path.split(".")
        placed = [word for word in words if word in NAMES]
        if not row.units or (placed and placed[0] not in known) or len(placed) > 1:
            continue
        ends = [f".{letter}" for letter in XYZ] if row.shape and row.shape[-1].letters == XYZ else [""]
        for name in known[placed[0]] if placed else [""]:
            path = ".".join(name if word in NAMES else word for word in words)
            yield from (path + end for end in ends)


def _of_spec(words: Callable[[dict[str, Any], str], Iterator[str]]) -> Callable[[typer.Context, str], list[str]]:
    """A completion by the spec that stands on the command line."""

    def complete(ctx: typer.Context, incomplete: str) -> list[str]:
        given = _spec_on(os.environ)
        if given is None:
            return []
        from heuncli.base.errors import Finding, HeunError
        from heuncli.scene.file_format.names import mapping
        from heuncli.scene.file_format.source import read

        try:
            data = read(given, None).data
        except (HeunError, Finding):
            return []
        known = words(mapping(data), incomplete)
        found = dict.fromkeys(word for word in known if word.startswith(incomplete) and IN_WORDS.fullmatch(word))
        return [*found][:MOST]

    return complete


def _spec_on(environment: Mapping[str, str]) -> str | None:
    """The spec on the command line, as the shell hands it over: an option that lacks its value ends typer's reading."""
    line = environment.get("_TYPER_COMPLETE_ARGS") or environment.get("COMP_WORDS") or ""
    words = re.findall(r"(?:[^\s\\]|\\.)+", line)[2:]
    return next((word for word in words if word.endswith(SPECS) and Path(word).is_file()), None)


def _files(ctx: typer.Context, incomplete: str) -> list[str]:
    return files(incomplete)


BY_WORD: dict[str, Callable[[typer.Context, str], list[str]]] = {
    "spec": _files, "set": _of_spec(sets), "case": _of_spec(cases), "only": _of_spec(only),
    "measure": _of_spec(measures), "collective": _of_spec(collectives), "body": _of_spec(bodies),
}  # fmt: skip
