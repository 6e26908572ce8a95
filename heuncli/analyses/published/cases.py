"""The published cases that come with heun: a spec each, and the numbers that others published.

The numbers of a case are in numbers/CASE.yaml, as text, so that the printed digits are known:
    about, source      what the case is, who published it
    tables             each with `where` it is in the source, its `kind` (KINDS), and `of`: paths into the results
                       with a number, a list (x, y, z) or a mapping of instants to these; and, where they are needed,
                       `at` (the instant of all), `case` (a load case of the spec), `axes` (of joint loads), `let`
                       (names of an exact expression), `error` (the source's own, a share of the largest number of the
                       table) with `because`
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from heuncli.base.named_tuples import NamedTuple

FOLDER = Path(__file__).parent


def list_names() -> tuple[str, ...]:
    """Return the names of all cases, sorted."""
    return tuple(sorted(path.stem for path in (FOLDER / "numbers").glob("*.yaml")))


def spec_of(name: str) -> str:
    """Return the spec of a case, as text."""
    return (FOLDER / "specs" / f"{name}.yaml").read_text(encoding="utf-8")


def numbers_of(name: str) -> str:
    """Return the file of the numbers of a case, as text."""
    return (FOLDER / "numbers" / f"{name}.yaml").read_text(encoding="utf-8")


KINDS = {
    "printed": "printed in the source",
    "formula": "a published formula, evaluated to the digits shown",
    "exact": "a published expression",
    "second program": "published data, solved by a second program to the digits shown",
}
REQUIRED_KEYS = frozenset({"where", "kind", "of"})
ALLOWED_KEYS = REQUIRED_KEYS | {"at", "case", "axes", "let", "error", "because"}


class PublishedNumber(NamedTuple):
    """One number: its path, its time (None for a state), its text, and the line of its file."""

    path: str
    time: float | None
    text: str
    line: int


class PublishedTable(NamedTuple):
    """Numbers from one place of a source; error: the source's own, relative to the largest of them."""

    where: str
    kind: str
    numbers: tuple[PublishedNumber, ...]
    case: str = ""
    axes: str = "world"
    let: tuple[tuple[str, str], ...] = ()
    error: float = 0.0
    because: str = ""


class PublishedCase(NamedTuple):
    """A case: its name, description, source, spec as text, and tables of numbers."""

    name: str
    description: str
    source: str
    spec: str
    tables: tuple[PublishedTable, ...]


class LocatedText(str):
    """A scalar of a file as it is written, with its line."""

    line: int


def read_case(name: str) -> PublishedCase:
    """Return the case with this name, one of `names`."""
    return parse_case(name, numbers_of(name), spec_of(name))


def parse_case(name: str, text: str, spec: str) -> PublishedCase:
    """Return a case from the texts of its numbers and of its spec. Raises ValueError if the first is invalid."""
    data = _to_plain_data(yaml.compose(text, Loader=yaml.BaseLoader))
    return PublishedCase(name, str(data["about"]), str(data["source"]), spec, tuple(map(_parse_table, data["tables"])))


def _to_plain_data(node: Any) -> Any:
    """Convert YAML nodes to mappings, lists, and scalars as they are written."""
    if isinstance(node, yaml.MappingNode):
        return {key.value: _to_plain_data(value) for key, value in node.value}
    if isinstance(node, yaml.SequenceNode):
        return [_to_plain_data(value) for value in node.value]
    scalar = LocatedText(node.value)
    scalar.line = node.start_mark.line + 1
    return scalar


def _parse_table(data: Mapping[str, Any]) -> PublishedTable:
    """Parse one table of a case: where it was published, and its numbers. Raises ValueError for other keys."""
    is_valid = REQUIRED_KEYS <= data.keys() <= ALLOWED_KEYS and data["kind"] in KINDS
    if not is_valid or ("error" in data) != ("because" in data):
        raise ValueError(f"a table of published numbers has {', '.join(data)}")
    time = float(data["at"]) if "at" in data else None
    numbers = tuple(one for path, value in data["of"].items() for one in _iter_numbers(path, value, time))
    texts: dict[str, Any] = {key: str(data[key]) for key in ("where", "kind", "case", "axes", "because") if key in data}
    let = tuple((name, str(text)) for name, text in data.get("let", {}).items())
    return PublishedTable(numbers=numbers, let=let, error=float(data.get("error", 0)), **texts)


def _iter_numbers(path: str, value: Any, time: float | None) -> Iterator[PublishedNumber]:
    """Yield the numbers under a path: one, those of a vector, or those at instants."""
    if isinstance(value, dict):
        for instant, nested in value.items():
            yield from _iter_numbers(path, nested, float(instant))
    elif isinstance(value, list):
        for axis, component in zip("xyz", value, strict=False):
            yield from _iter_numbers(f"{path}.{axis}", component, time)
    else:
        yield PublishedNumber(path, time, str(value), value.line)
