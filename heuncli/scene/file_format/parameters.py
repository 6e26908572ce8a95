"""Values of a scene: its parameters, and what `--set` and load cases put in place of values.

Parameters are numbers that may refer to each other in any order. Settings from the command line, and those of a load
case, are put into the plain data before anything reads it.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from heuncli.base.errors import Finding, Problem, SourceLocation, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.base.spelling import suggest
from heuncli.results.results_schema import parse_index
from heuncli.scene.expressions.scope import DimensionedParameter
from heuncli.scene.file_format.names import NAMED_BLOCKS, as_mapping
from heuncli.scene.file_format.quantity import DependentError, ParameterValue, Scope, read_function
from heuncli.scene.file_format.source import Path_, SourceFile, parse_plain_scalar, parse_source

# Parameters

MAX_LISTED_NAMES = 12  # names of a cycle that a message lists
CIRCLE_HINT = "give one of them as a number"


class _UnknownParameter(Exception):
    """A parameter that has to be evaluated first."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.name = name


class _Values(dict[str, float | None]):
    """Known values; looking up one that is given but not yet known raises _UnknownParameter."""

    def __init__(self, block: dict[str, Any]) -> None:
        super().__init__()
        self.block = block
        self.used_names: set[object] = set()

    def __contains__(self, name: object) -> bool:
        self.used_names.add(name)
        return name in self.block

    def __missing__(self, name: str) -> float | None:
        raise _UnknownParameter(name)


@record
class Parameters:
    """Evaluated parameters.

    values: in SI; None for wrong ones
    given_quantities: those with a dimension, as written
    findings: what is wrong
    uses: the names that each parameter looks up
    """

    values: dict[str, float | None]
    given_quantities: dict[str, DimensionedParameter]
    findings: list[tuple[str, Finding]]
    uses: dict[str, set[object]]


def evaluate_parameters(block: dict[str, Any], earlier: Parameters | None = None) -> Parameters:
    """Evaluate the parameters of a block.

    earlier: results of an earlier evaluation that remain valid
    """
    values = _Values(block)
    given_quantities: dict[str, DimensionedParameter] = {}
    uses: dict[str, set[object]] = {name: set() for name in block}
    if earlier is not None:
        values.update(earlier.values)
        given_quantities.update(earlier.given_quantities)
        uses.update(earlier.uses)
    scope = Scope(parameters=values, given=given_quantities)
    findings: list[tuple[str, Finding]] = []
    for first in block:
        pending = {first: None}  # ordered: the last one is evaluated next
        while pending:
            name = next(reversed(pending))
            if name in values.keys():  # noqa: SIM118  # `in values` asks whether it is given
                pending.popitem()
                continue
            values.used_names = uses[name]
            try:
                expression = read_function(block[name], None, scope)
                values[name] = expression.constant
                if expression.dimension is not None:
                    given_quantities[name] = DimensionedParameter(expression.dimension, expression.source.strip())
            except _UnknownParameter as unknown:
                if unknown.name in pending:
                    chain = list(pending)
                    cycle = [*chain[chain.index(unknown.name) :], unknown.name]
                    message = f"circular reference between parameters: {' -> '.join(abbreviate_names(cycle))}"
                    findings.append((unknown.name, Finding("parameter-circle", message, CIRCLE_HINT)))
                    values.update(dict.fromkeys(cycle))
                else:
                    pending[unknown.name] = None
            except DependentError:
                values[name] = None
            except Finding as finding:
                values[name] = None
                findings.append((name, finding))
    return Parameters({name: values[name] for name in block}, given_quantities, findings, uses)


def abbreviate_names(names: list[str]) -> list[str]:
    """Abbreviate a long list of names to its two ends."""
    omitted = len(names) - MAX_LISTED_NAMES
    return names if omitted <= 0 else [*names[: MAX_LISTED_NAMES - 2], f"({omitted} more)", *names[-2:]]


# Overrides

# a number that YAML reads the same way
PLAIN_NUMBER = re.compile(r"[+-]?[0-9]{1,18}(\.[0-9]{0,18})?([eE][+-]?[0-9]{1,3})?")
HEAD_KEYS = ("title", "gravity", "space", "report")  # keys without a dot that are not parameters


class Setting(NamedTuple):
    """A value that replaces another: a parameter's name or a dotted key, the value, and the locations of value and
    key.
    """

    key: str
    value: Any
    location: SourceLocation
    key_location: SourceLocation


def parse_settings(values_by_key: Mapping[str, ParameterValue]) -> tuple[list[Setting], list[Problem]]:
    """Parse what the command line or a variant sets, texts as YAML; return the settings and what cannot be parsed."""
    settings: list[Setting] = []
    problems: list[Problem] = []
    for key, new_value in values_by_key.items():
        text = new_value if isinstance(new_value, str) else new_value.format()
        option = f"--set {key}={text}"
        location = SourceLocation(option, 1, len(key) + 2, key)
        try:
            value = new_value.to_entry() if not isinstance(new_value, str) else _parse_text(option, new_value)
        except SpecError as error:
            problems += [Problem(p.code, p.message, location, p.hint) for p in error.problems]
            continue
        settings.append(Setting(key, value, location, SourceLocation(option, 1, 1)))
    return settings, problems


def _parse_text(option: str, text: str) -> Any:
    """Parse a value in the form of `--set`. Raises SpecError."""
    if PLAIN_NUMBER.fullmatch(text):
        return parse_plain_scalar(text)
    return parse_source(option, text if text.strip() else "''", "").data


def apply_settings(
    data: dict[str, Any], settings: Sequence[Setting]
) -> tuple[dict[str, Any], dict[Path_, SourceLocation], list[Problem]]:
    """Return the data with values replaced, the locations of these values, and the problems with them."""
    if not settings:
        return data, {}, []
    data = {**data}
    locations: dict[Path_, SourceLocation] = {}
    problems: list[Problem] = []
    for key, value, location, key_location in settings:
        path = parse_path(key, data)
        reason = set_value(data, path, value)
        if reason is not None:
            problems.append(Problem("no-such-key", reason[0], key_location, reason[1]))
        locations[path] = location._replace(path=".".join(map(str, path)))
    return data, locations, problems


def iter_si_warnings(
    old_data: dict[str, Any], new_data: dict[str, Any], locations: Mapping[Path_, SourceLocation]
) -> Iterator[Problem]:
    """Yield warnings for plain numbers that replace numbers with a unit other than the SI unit."""
    from heuncli.base.units import parse_unit, si_unit  # only needed if something is set
    from heuncli.scene.file_format.quantity import match_quantity

    for path, location in locations.items():
        old, new = get_value(old_data, path), get_value(new_data, path)
        old_quantity = match_quantity(old) if type(old) is str and type(new) in (int, float) and new != 0 else None
        if old_quantity is None:
            continue
        unit = old_quantity.unit
        try:
            size, dimension = parse_unit(unit)
        except Finding:
            continue
        if size != 1.0:
            message = f"{new:.9g} is taken to be in {si_unit(dimension)}; the file gives it in {unit}"
            yield Problem("set-in-si", message, location, f"give the unit: --set {location.path}='{new:.9g} {unit}'")


def get_value(data: Any, path: Path_) -> Any:
    """Return the value at a path, or None."""
    for part in path:
        data = get_child(data, part)
    return data


def parse_path(key: str, data: dict[str, Any]) -> Path_:
    """Parse a parameter's name or a dotted key into a path; numbers are indices into lists."""
    if "." not in key and (key in as_mapping(data.get("parameters")) or key not in HEAD_KEYS):
        return ("parameters", key)
    path: list[str | int] = []
    node: Any = data
    for word in key.split("."):
        index = parse_index(word) if type(node) is list else None
        part: str | int = word if index is None else index
        node = get_child(node, part)
        path.append(part)
    return tuple(path)


def get_child(node: Any, part: str | int) -> Any:
    """Return the value under a key of a mapping or at an index of a list, or None."""
    if type(node) is dict:
        return node.get(part)
    return node[part] if type(node) is list and isinstance(part, int) and part < len(node) else None


def is_list_index(node: list[Any], part: str | int) -> bool:
    return isinstance(part, int) and part < len(node)


def set_value(data: dict[str, Any], path: Path_, value: Any) -> tuple[str, str] | None:
    """Store a value in the data. Returns None, or why it cannot be stored and a hint.

    What users name (a parameter, a body, a point) must exist; other keys may be new, the format checks them. Containers
    along the path are copied; all others stay shared with the original data.
    """
    node: Any = data
    for depth, part in enumerate(path):
        parent_key = path[depth - 1] if depth else None
        if type(node) is list:
            if not is_list_index(node, part):
                return (
                    f"'{'.'.join(map(str, path[:depth]))}' has no entry {part}",
                    f"entries are numbered from 0 to {len(node) - 1}",
                )
        elif type(node) is not dict:
            parent_path = ".".join(map(str, path[:depth]))
            return f"'{parent_path}' is a value without keys", f"set it as a whole: --set {parent_path}=..."
        elif part not in node:
            if (depth == 1 and parent_key in NAMED_BLOCKS) or parent_key == "points":
                kind = {"bodies": "body", "points": "point"}.get(str(parent_key), str(parent_key).removesuffix("s"))
                return f"there is no {kind} '{part}' to set", suggest(str(part), node, str(parent_key))
            if depth < len(path) - 1:
                node[part] = {}
        elif node[part] is None and depth < len(path) - 1:
            node[part] = {}
        if depth < len(path) - 1:
            node[part] = copy.copy(node[part])
            node = node[part]
    node[path[-1]] = value
    return None


# Cases

CASES = "cases"
NESTED_CASE_HINT = "a case sets values of the model; write another case next to it"


def get_case_values(data: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Return the values that each load case sets, by name, from plain data of any shape."""
    return {name: as_mapping(as_mapping(case).get("set")) for name, case in as_mapping(data.get(CASES)).items()}


def list_case_settings(name: str, source: SourceFile) -> list[Setting]:
    """List the settings of a load case. Raises SpecError [unknown-case]."""
    cases = get_case_values(as_mapping(source.data))
    if name not in cases:
        hint = suggest(name, cases, "cases") if cases else "cases: {NAME: {set: {PARAMETER: VALUE}}}"
        raise SpecError(Problem("unknown-case", f"there is no load case '{name}'", source.location((CASES,)), hint))
    path = (CASES, name, "set")
    return [
        Setting(key, value, source.location((*path, key)), source.location((*path, key), prefer_key=True))
        for key, value in cases[name].items()
    ]


def iter_case_problems(data: dict[str, Any], source: SourceFile) -> Iterator[Problem]:
    """Yield what the load cases set but cannot, so that it is reported with the other problems of the file."""
    for name in get_case_values(data):
        settings = list_case_settings(name, source)
        for setting in settings:
            if setting.key.split(".")[0] == CASES:
                yield Problem("no-such-key", f"'{setting.key}' in a load case", setting.key_location, NESTED_CASE_HINT)
        yield from apply_settings(data, [setting for setting in settings if setting.key.split(".")[0] != CASES])[2]
