"""The names that an expression may use, and the errors of names and of their dimensions."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from types import MappingProxyType
from typing import Any

from heuncli.base.errors import Finding
from heuncli.base.joint_kinds import RATES, TYPES
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.base.spelling import find_similar, suggest
from heuncli.base.units import Dimension, describe, si_expression_hint
from heuncli.scene.expressions.codegen import CalculationCache
from heuncli.scene.expressions.names import ARITY, OTHER_NAMES, RESERVED
from heuncli.scene.expressions.programs import TableFunction

COORDINATES_BY_TYPE = {  # by joint type, of the joints with one coordinate
    kind.name: (quantity, RATES[quantity])
    for kind in TYPES.values()
    for quantity in kind.coordinates
    if kind.coordinates == (quantity,)
}
NO_COORDINATE_HINT = "only pins and slides have coordinates: shaft.angle, guide.travel"
NO_NAMES: Mapping[str, Any] = MappingProxyType({})


@record
class Scope:
    """The names that an expression may use. A parameter or table with value None is known, but was itself in error.

    joints: the type of each joint
    points: the points of each body and of the ground
    in_time: whether time, coordinates and points may be used
    given: the parameters that have a dimension, as they are written
    with_units: numbers may have units, and compared values need the same dimension
    calculations: cache of numbers of parameters alone, from a spec with the same names
    own: the quantities of the load itself by name, such as `length` of a spring
    """

    parameters: Mapping[str, float | None] = NO_NAMES
    joints: Mapping[str, str] = NO_NAMES
    tables: Mapping[str, TableFunction | None] = NO_NAMES
    in_time: bool = False
    given: Mapping[str, DimensionedParameter] = NO_NAMES
    points: Mapping[str, Collection[str]] = NO_NAMES
    with_units: bool = False
    calculations: CalculationCache | None = None
    own: Mapping[str, str] = NO_NAMES


class DimensionedParameter(NamedTuple):
    """A parameter with a dimension, as it is written."""

    dimension: Dimension
    text: str

    def describe_dimension(self, name: str) -> str:
        """Describe the dimension in words."""
        return f"{name} = {self.text} is {describe(self.dimension)}"


class DependentError(Finding):
    """A value on which this one depends is in error; that error is reported, and this one is not."""

    def __init__(self) -> None:
        super().__init__("follows", "depends on a value with an error", "correct that error first")


def find_dimension(scope: Scope, name: str) -> Dimension | None:
    """Return the dimension of a parameter, if it has one."""
    parameter = scope.given.get(name)
    return parameter.dimension if parameter is not None else None


def describe_dimensions(text: str, scope: Scope) -> str | None:
    """Describe the dimensions of the parameters in a text, as a hint."""
    names = dict.fromkeys(found[0] for found in re.finditer(r"[^\W\d]\w*", text) if found[0] in scope.given)
    return ", ".join(scope.given[name].describe_dimension(name) for name in names) or None


def unknown_name_finding(scope: Scope, name: str, kind: str) -> Finding:
    """Make the error of an unknown name; kind: parameter or function."""
    if name in OTHER_NAMES:
        return Finding("unknown-name", f"'{name}' is not a {kind}", f"write {OTHER_NAMES[name]}")
    if kind == "parameter" and name in scope.joints:
        words = COORDINATES_BY_TYPE.get(scope.joints[name])
        hint = f"write {name}.{words[0]} or {name}.{words[1]}" if words else NO_COORDINATE_HINT
        return Finding("unknown-name", f"'{name}' is a joint, not a number", hint)
    known = (scope.parameters, RESERVED) if kind == "parameter" else (ARITY,)
    message, suggestion = f"'{name}' is not a {kind}", find_similar(name, *known)
    is_near = suggestion is not None and suggestion.lower() == name.lower()
    if not is_near and kind == "parameter" and (unit := si_expression_hint("", name)) is not None:
        return Finding("unknown-name", message, f"write e.g. 20 {name}" if scope.with_units else unit)
    if kind == "parameter" and scope.own and suggestion is None:
        return Finding("unknown-name", message, f"quantities of the load itself: {', '.join(scope.own)}")
    listed = scope.parameters if kind == "parameter" else sorted(ARITY)
    hint = f"did you mean {suggestion}?" if suggestion else suggest(name, listed, f"{kind}s")
    return Finding("unknown-name", message, hint)
