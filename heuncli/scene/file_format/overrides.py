"""`--set`: values from the command line put into the plain data before anything reads it."""

from __future__ import annotations

import copy
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from heuncli.base.errors import Finding, Problem, SourceLocation, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.nearest import did_you_mean
from heuncli.results.results_schema import counted
from heuncli.scene.file_format.names import NAMED, mapping
from heuncli.scene.file_format.source import Path_, parse, plain

FIGURE = re.compile(r"[+-]?[0-9]{1,18}(\.[0-9]{0,18})?([eE][+-]?[0-9]{1,3})?")  # that YAML could but read as itself
OWN = ("title", "gravity", "space", "report")  # keys without a dot, beside the parameters


class Setting(NamedTuple):
    """A value in the place of another: a parameter's name or a dotted key, the value, and where both stand."""

    key: str
    value: Any
    location: SourceLocation
    key_location: SourceLocation


def of_words(given: Mapping[str, str]) -> tuple[list[Setting], list[Problem]]:
    """What the command line sets, as YAML; and what cannot be read of it."""
    settings: list[Setting] = []
    problems: list[Problem] = []
    for key, text in given.items():
        word = f"--set {key}={text}"
        place = SourceLocation(word, 1, len(key) + 2, key)
        try:
            value = plain(text) if FIGURE.fullmatch(text) else parse(word, text if text.strip() else "''", "").data
        except SpecError as error:
            problems += [Problem(p.code, p.message, place, p.hint) for p in error.problems]
            continue
        settings.append(Setting(key, value, place, SourceLocation(word, 1, 1)))
    return settings, problems


def override(
    data: dict[str, Any], settings: Sequence[Setting]
) -> tuple[dict[str, Any], dict[Path_, SourceLocation], list[Problem]]:
    """The data with values replaced, the locations of these, and the problems with them."""
    if not settings:
        return data, {}, []
    data = {**data}
    locations: dict[Path_, SourceLocation] = {}
    problems: list[Problem] = []
    for key, value, location, key_location in settings:
        path = path_of(key, data)
        reason = put(data, path, value)
        if reason is not None:
            problems.append(Problem("no-such-key", reason[0], key_location, reason[1]))
        locations[path] = location._replace(path=".".join(map(str, path)))
    return data, locations, problems


def taken_in_si(
    before: dict[str, Any], after: dict[str, Any], locations: Mapping[Path_, SourceLocation]
) -> Iterator[Problem]:
    """Warnings of plain numbers in place of numbers with a unit that is not the SI's own."""
    from heuncli.base.units import parse_unit, si_unit  # where something is set
    from heuncli.scene.file_format.quantity import unit_in

    for path, location in locations.items():
        old, new = at(before, path), at(after, path)
        found = unit_in(old) if type(old) is str and type(new) in (int, float) and new != 0 else None
        if found is None:
            continue
        unit = found[2].strip()
        try:
            size, dimension = parse_unit(unit)
        except Finding:
            continue
        if size != 1.0:
            message = f"{new:.9g} is taken in {si_unit(dimension)}; the file gives it in {unit}"
            yield Problem("set-in-si", message, location, f"with the unit: --set {location.path}='{new:.9g} {unit}'")


def at(data: Any, path: Path_) -> Any:
    """The value at a path, None where there is none."""
    for part in path:
        data = below(data, part)
    return data


def path_of(key: str, data: dict[str, Any]) -> Path_:
    """A parameter's name, or a dotted key; numbers are indices in lists."""
    if "." not in key and (key in mapping(data.get("parameters")) or key not in OWN):
        return ("parameters", key)
    path: list[str | int] = []
    node: Any = data
    for word in key.split("."):
        place = counted(word) if type(node) is list else None
        part: str | int = word if place is None else place
        node = below(node, part)
        path.append(part)
    return tuple(path)


def below(node: Any, part: str | int) -> Any:
    """The value under a key or at an index of a list; None where there is none."""
    if type(node) is dict:
        return node.get(part)
    return node[part] if type(node) is list and isinstance(part, int) and part < len(node) else None


def in_list(node: list[Any], part: str | int) -> bool:
    return isinstance(part, int) and part < len(node)


def put(data: dict[str, Any], path: Path_, value: Any) -> tuple[str, str] | None:
    """Store a value; or return why it cannot be stored, with a hint.

    What users name (a parameter, a body, a point) must be there; other keys may be new: the format judges them. What
    the path leads through is copied, all beside it is shared with the data of which these are a copy.
    """
    node: Any = data
    for depth, part in enumerate(path):
        above = path[depth - 1] if depth else None
        if type(node) is list:
            if not in_list(node, part):
                return (
                    f"'{'.'.join(map(str, path[:depth]))}' has no entry {part}",
                    f"entries are counted from 0 to {len(node) - 1}",
                )
        elif type(node) is not dict:
            whole = ".".join(map(str, path[:depth]))
            return f"'{whole}' is a value without keys", f"set it as a whole: --set {whole}=..."
        elif part not in node:
            if (depth == 1 and above in NAMED) or above == "points":
                kind = {"bodies": "body", "points": "point"}.get(str(above), str(above).removesuffix("s"))
                return f"there is no {kind} '{part}' to set", did_you_mean(str(part), node, str(above))
            if depth < len(path) - 1:
                node[part] = {}
        elif node[part] is None and depth < len(path) - 1:
            node[part] = {}
        if depth < len(path) - 1:
            node[part] = copy.copy(node[part])
            node = node[part]
    node[path[-1]] = value
    return None
