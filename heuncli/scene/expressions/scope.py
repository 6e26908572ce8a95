"""The names that an expression may use, and the errors of other names and of dimensions.

For the names that other programs and heun's results use, the accepted ones are proposed. A point of a body is named
points.BODY.POINT.x, or points.POINT.x if only one body has it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from heuncli.base.errors import Finding
from heuncli.base.joint_kinds import RATES, TYPES
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.base.spelling import find_similar, suggest
from heuncli.base.units import Dimension, describe, unit_place_hint
from heuncli.results.results_schema import ROWS, SHARED_BLOCKS
from heuncli.scene.expressions.codegen import MAX_NODES, CalculationCache
from heuncli.scene.expressions.motion_laws import ARGUMENTS
from heuncli.scene.expressions.programs import POINTS, TableFunction

# Names

CONSTANTS = {"pi": math.pi, "deg": math.pi / 180.0, "rpm": math.pi / 30.0}
UNARY_FUNCTIONS = (
    "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs", "sign", "step",
)  # fmt: skip
ARITY: dict[str, tuple[int, int]] = {
    **dict.fromkeys(UNARY_FUNCTIONS, (1, 1)),
    "atan2": (2, 2),
    **dict.fromkeys(("min", "max", "hypot"), (2, MAX_NODES)),
    "table": (2, 2),
    **{name: (count, count) for name, count in ARGUMENTS.items()},
}
WORDS = frozenset({"if", "else", "and", "or", "not"})
RESERVED = frozenset({"t", *CONSTANTS, *ARITY, *WORDS})
LIBRARIES = frozenset({"math", "np", "numpy", "sp", "Math"})  # prefixes of functions in other programs

OTHER_NAMES = {  # names from other programs, and heun's
    "arcsin": "asin", "arccos": "acos", "arctan": "atan", "arctan2": "atan2", "ln": "log", "fabs": "abs", "sgn": "sign",
    "heaviside": "step", "time": "t", "PI": "pi", "Pi": "pi", "π": "pi", "degrees": "deg", "pow": "**", "sqr": "**2",
    "interp": "table(NAME, ...)", "lookup": "table(NAME, ...)", "spline": "table(NAME, ...)",
}  # fmt: skip
RESULT_BLOCKS = SHARED_BLOCKS | {"sensors", "stops", "couplings"}  # blocks of the results that follow from the motion
REACTIONS = frozenset(
    row.path.split(".")[2]
    for row in ROWS
    if row.path.startswith(("joints.JOINT.", "stops.STOP.")) and set(row.units) & {"N", "N·m"}
) - {"shares"}
LAW_HINT = (
    "a law may use t, parameters and coordinates such as shaft.angle, shaft.rate, guide.travel, guide.speed; "
    "a condition may use {of: joints.NAME.force.z, below: 0}"
)


# Point names

GROUND = "ground"
QUANTITIES = ("x", "y", "z", "vx", "vy", "vz")
POINT_FORM_HINT = f"a point is {POINTS}.BODY.POINT.x, y, z [m] or .vx, .vy, .vz [m/s], world axes"

Points = Mapping[str, Collection[str]]  # names of the points of each body and of the ground


def resolve_point(text: str, words: Sequence[str], points: Points) -> tuple[str, str, str]:
    """Return body, point and quantity of the words after `points`. Raises Finding."""
    *names, quantity = words
    if quantity not in QUANTITIES or len(names) not in (1, 2):
        raise Finding(
            "unknown-coordinate",
            f"'{text}' is not a coordinate of a point",
            suggest_point_form(names, quantity, points),
        )
    if len(names) == 1:
        names = [find_owner(text, names[0], points), names[0]]
    elif names[0] not in points:
        hint = suggest(names[0], points, "bodies")
        raise Finding("unknown-body", f"'{text}': '{names[0]}' is not a body", hint)
    elif names[1] not in points[names[0]]:
        hint = suggest(names[1], points[names[0]], f"points of {names[0]}")
        raise Finding("unknown-point", f"'{text}': {names[0]} has no point '{names[1]}'", hint)
    return names[0], names[1], quantity


def suggest_point_form(names: Sequence[str], quantity: str, points: Points) -> str:
    """Suggest the valid form: for points.drill.bit.position.x, as in results, points.drill.bit.x."""
    if len(names) == 3 and names[0] in points and names[2] in ("position", "velocity") and quantity in tuple("xyz"):
        key = quantity if names[2] == "position" else f"v{quantity}"
        return f"write {POINTS}.{names[0]}.{names[1]}.{key}"
    return POINT_FORM_HINT


def find_owner(text: str, point: str, points: Points) -> str:
    """Find the only body that has a point of that name, else the ground. Raises Finding."""
    owners = [body for body, body_points in points.items() if point in body_points and body != GROUND]
    if not owners and point in points.get(GROUND, ()):
        return GROUND
    if len(owners) == 1:
        return owners[0]
    if owners:
        named = ", ".join(f"{POINTS}.{body}.{point}" for body in owners)
        raise Finding("unknown-point", f"'{text}': several bodies have a point {point}", f"name one: {named}")
    if point in points:
        body_points = [f"{POINTS}.{point}.{name}" for name in points[point]]
        hint = f"name a point of it: {', '.join(body_points)}" if body_points else f"bodies: {point}: has no points"
        raise Finding("unknown-point", f"'{text}': {point} is a body", hint)
    known = [name for body_points in points.values() for name in body_points]
    raise Finding("unknown-point", f"'{text}': no body has a point '{point}'", suggest(point, known, "points"))


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
    with_units: compared values need the same dimension, and a unit goes before a parameter of its name
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
    if not is_near and kind == "parameter" and (unit := unit_place_hint(name)) is not None:
        return Finding("unknown-name", message, unit)
    if kind == "parameter" and scope.own and suggestion is None:
        return Finding("unknown-name", message, f"quantities of the load itself: {', '.join(scope.own)}")
    listed = scope.parameters if kind == "parameter" else sorted(ARITY)
    hint = f"did you mean {suggestion}?" if suggestion else suggest(name, listed, f"{kind}s")
    return Finding("unknown-name", message, hint)
