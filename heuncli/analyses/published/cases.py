"""The published cases that come with heun: a spec each, and the numbers that others published of it.

The numbers of a case stand in numbers/CASE.yaml, as text, so that the digits that were printed are known:

    about, source      what the case is, who published it
    tables             each with `where` it stands in the source, its `kind` (KINDS), and `of`: paths into the results
                       with a number, a list (x, y, z) or a mapping of instants to these; and, where they are needed,
                       `at` (the instant of all), `case` (a load case of the spec), `axes` (of joint loads), `let`
                       (names of an exact expression), `error` (the source's own, a share of the largest number of the
                       table) with `because`
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import yaml

from heuncli.analyses.published.files import numbers_of, spec_of
from heuncli.base.named_tuples import NamedTuple

KINDS = {
    "printed": "printed in the source",
    "formula": "a published formula, evaluated to the digits shown",
    "exact": "a published expression",
    "second program": "published data, solved by a second program to the digits shown",
}
NEEDED = frozenset({"where", "kind", "of"})
KNOWN = NEEDED | {"at", "case", "axes", "let", "error", "because"}


class PublishedNumber(NamedTuple):
    """One number: its path, its instant (None: a state's), its text, and the line of its file."""

    path: str
    at: float | None
    text: str
    line: int


class PublishedTable(NamedTuple):
    """Numbers that stand in one place of a source; error: the source's own, as a share of the largest of them."""

    where: str
    kind: str
    numbers: tuple[PublishedNumber, ...]
    case: str = ""
    axes: str = "world"
    let: tuple[tuple[str, str], ...] = ()
    error: float = 0.0
    because: str = ""


class PublishedCase(NamedTuple):
    """A case: its name, what it is, its source, its spec as text, its tables of numbers."""

    name: str
    about: str
    source: str
    spec: str
    tables: tuple[PublishedTable, ...]


class Lined(str):
    """A scalar of a file as it is written, with its line."""

    line: int


def case_of(name: str) -> PublishedCase:
    """The case of a name, one of `names`."""
    return read(name, numbers_of(name), spec_of(name))


def read(name: str, text: str, spec: str) -> PublishedCase:
    """A case from the texts of its numbers and of its spec. Raises ValueError where the first is none."""
    data = _plain(yaml.compose(text, Loader=yaml.BaseLoader))
    return PublishedCase(name, str(data["about"]), str(data["source"]), spec, tuple(map(_table, data["tables"])))


def _plain(node: Any) -> Any:
    """Mappings, lists, and every scalar as it is written."""
    if isinstance(node, yaml.MappingNode):
        return {key.value: _plain(value) for key, value in node.value}
    if isinstance(node, yaml.SequenceNode):
        return [_plain(value) for value in node.value]
    found = Lined(node.value)
    found.line = node.start_mark.line + 1
    return found


def _table(data: Mapping[str, Any]) -> PublishedTable:
    known = NEEDED <= data.keys() <= KNOWN and data["kind"] in KINDS
    if not known or ("error" in data) != ("because" in data):
        raise ValueError(f"a table of published numbers has {', '.join(data)}")
    at = float(data["at"]) if "at" in data else None
    numbers = tuple(one for path, value in data["of"].items() for one in _numbers(path, value, at))
    given: dict[str, Any] = {key: str(data[key]) for key in ("where", "kind", "case", "axes", "because") if key in data}
    let = tuple((name, str(text)) for name, text in data.get("let", {}).items())
    return PublishedTable(numbers=numbers, let=let, error=float(data.get("error", 0)), **given)


def _numbers(path: str, value: Any, at: float | None) -> Iterator[PublishedNumber]:
    """The numbers under a path: one, those of a vector, or those at instants."""
    if isinstance(value, dict):
        for instant, there in value.items():
            yield from _numbers(path, there, float(instant))
    elif isinstance(value, list):
        for axis, component in zip("xyz", value, strict=False):
            yield from _numbers(f"{path}.{axis}", component, at)
    else:
        yield PublishedNumber(path, at, str(value), value.line)
