"""Types of the values of a spec: numbers with a dimension, functions of time, vectors, ends.

Each reads a value with the validation context, which holds the parameters, joints and tables of the scene.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from itertools import chain, islice
from typing import Annotated, Any

from heuncli.base import units as u
from heuncli.base.errors import Finding
from heuncli.base.records import record, replace
from heuncli.base.spelling import spend_effort, suggest
from heuncli.base.units import is_in_range
from heuncli.scene.expressions.programs import Expression, TableFunction
from heuncli.scene.expressions.scope import NO_NAMES
from heuncli.scene.file_format.entries import Entry, OneOf, Preprocessor, Tag
from heuncli.scene.file_format.foreign_words import FORM_HINTS
from heuncli.scene.file_format.labels import MAX_TEXT, check_plain_text
from heuncli.scene.file_format.plain_reading import CoreSchema
from heuncli.scene.file_format.quantity import (
    Scope,
    describe_kind,
    match_quantity,
    read_condition,
    read_function,
    read_number,
)

TABLE_HINT = "for example tables: {NAME: {x: [...], y: [...], interpolation: cubic}}"
TEXT_SCHEMA = {"type": "string", "minLength": 1, "maxLength": MAX_TEXT}
HELD_TABLE = 1  # kind of a table (scene/expressions/programs.py) that is constant outside its range


@record
class ReadContext:
    """What values may refer to: on loading and in time; the points of each body and of the ground, for hints."""

    load: Scope
    time: Scope
    points: Mapping[str, Collection[str]] = NO_NAMES


class ValueReader:
    """A value that `read` converts; a number or a text in the JSON Schema."""

    def __init__(self, dimension: u.Dimension | None = None) -> None:
        self.dimension = dimension

    def read(self, value: Any, info: Any) -> Any:
        raise NotImplementedError

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        return {"type": "function-plain", "function": {"type": "with-info", "function": self.read}}

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        return self.make_json_schema()

    def make_json_schema(self) -> dict[str, Any]:
        """Return the JSON Schema of the value: a number, or a text that is a number with a unit or an expression."""
        description = {"description": u.describe(self.dimension)} if self.dimension is not None else {}
        return {"anyOf": [{"type": "number"}, {"type": "string"}], **description}


class SiNumber(ValueReader):
    """A number of a dimension, in SI."""

    def read(self, value: Any, info: Any) -> float:
        if type(value) is float and is_in_range(value):
            return value
        return read_number(value, self.dimension, info.context.load)


class DirectionComponent(SiNumber):
    """A component of a direction; only ratios matter, so all three may be lengths."""

    def read(self, value: Any, info: Any) -> float:
        is_expression = type(value) is str and match_quantity(value) is None
        return read_number(value, None, info.context.load) if is_expression else super().read(value, info)


class TimeFunction(ValueReader):
    """A function of time, of one dimension."""

    def read(self, value: Any, info: Any) -> Expression:
        return read_function(value, self.dimension, info.context.time)


class LoadFunction(ValueReader):
    """A function of time, of coordinates, and of a load's own variables, which are given by name with their
    quantity.
    """

    def __init__(self, dimension: u.Dimension | None, variables: Mapping[str, str]) -> None:
        super().__init__(dimension)
        self.own = variables

    def read(self, value: Any, info: Any) -> Expression:
        return read_function(value, self.dimension, replace(info.context.time, own=self.own))


class NumberOrTable(SiNumber):
    """A number of a dimension, or the name of a table of force over deflection or moment over rotation."""

    def __init__(self, dimension: u.Dimension, variable: str) -> None:
        super().__init__(dimension)
        self.of = variable

    def read(self, value: Any, info: Any) -> Any:
        if type(value) is str and value.strip() in info.context.time.tables:
            scope = replace(info.context.time, own={self.of: self.of})
            return read_function(f"-table({value.strip()}, {self.of})", None, scope)
        return super().read(value, info)


class TorqueCurve(ValueReader):
    """A motor's torque over its speed: the name of a table, or an expression in `rate`."""

    def read(self, value: Any, info: Any) -> Expression:
        scope = replace(info.context.time, own={"rate": "rate"})
        is_table = type(value) is str and value.strip() in scope.tables
        return read_function(f"table({value.strip()}, rate)" if is_table else value, self.dimension, scope)


class ConditionValue(ValueReader):
    """A condition on time and coordinates."""

    def read(self, value: Any, info: Any) -> Expression:
        return read_condition(value, info.context.time)


class ImpulseCondition(ValueReader):
    """A condition on time and coordinates at which an impulse acts."""

    def read(self, value: Any, info: Any) -> Expression:
        if type(value) is dict:
            message = "an impulse needs a condition in time and coordinates, not one on a number of the results"
            raise Finding("condition", message, "for example guide.travel > 0.2, or shaft.rate < 0 and t > 1")
        return read_condition(value, info.context.time)


class DependentNumber(ValueReader):
    """A number whose dimension depends on another key: an expression that knows its dimension."""

    def read(self, value: Any, info: Any) -> Expression:
        return read_function(value, None, info.context.load)


class CutOffPeriod(DependentNumber):
    """The period of an oscillation at the cut-off of a low pass, or its frequency in Hz: in the dimension of x."""

    def read(self, value: Any, info: Any) -> Expression:
        written = match_quantity(value) if type(value) is str else None
        if written is None or written.unit not in FREQUENCIES:
            return super().read(value, info)
        frequency = written.value * FREQUENCIES[written.unit]
        if not is_in_range(frequency) or frequency <= 0.0:
            raise Finding("table-form", f"a cut-off of {value}", "give a frequency above 0, for example 20 Hz")
        return replace(Expression.from_number(1.0 / frequency), dimension=u.TIME)


class PartList(ValueReader):
    """A list whose items are read later by the model of their type; here it only has to be a list."""

    def read(self, value: Any, info: Any) -> list[Any]:
        if type(value) is not list:
            raise Finding("wrong-kind", f"expected a list, found {describe_kind(value)}", FORM_HINTS["shapes"])
        return value

    def make_json_schema(self) -> dict[str, Any]:
        return {"type": "array"}


class WholeNumber(ValueReader):
    """A whole number."""

    def read(self, value: Any, info: Any) -> int:
        count = read_number(value, u.NUMBER, info.context.load)
        if count != int(count):
            raise Finding("wrong-kind", f"expected a whole number, found {count:g}", f"for example {math.floor(count)}")
        return int(count)


class VersionNumber(ValueReader):
    """The version of the format."""

    def read(self, value: Any, info: Any) -> int:
        if type(value) is bool or value != 1:
            message = f"expected format version 1, found {describe_kind(value) if type(value) is not int else value}"
            raise Finding("version", message, "write 'heun: 1', or use a newer heun")
        return 1

    def make_json_schema(self) -> dict[str, Any]:
        return {"const": 1}


class PlainText(ValueReader):
    """A line of text for readers."""

    def read(self, value: Any, info: Any) -> str:
        return check_plain_text(value)

    def make_json_schema(self) -> dict[str, Any]:
        return TEXT_SCHEMA


class StrictBoolean:
    """`true` or `false`, and nothing that could be taken for them."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        return {"type": "bool", "strict": True}


def is_bare_name(value: Any, parameters: Mapping[str, float | None]) -> bool:
    """Whether a value is a single word that is not the name of a parameter."""
    return type(value) is str and value.isidentifier() and value not in parameters


class SmoothTable(ValueReader):
    """The name of a table that is a smooth curve over a quantity of another dimension; or, where allowed, a number.

    A corner would need infinite accelerations where it is passed, a jump in curvature a jump in acceleration.
    """

    def __init__(self, dimension: u.Dimension | None, x_dimension: u.Dimension, allows_number: bool) -> None:
        super().__init__(dimension)
        self.over, self.constant = x_dimension, allows_number

    def read(self, value: Any, info: Any) -> TableFunction | float:
        tables = info.context.time.tables
        if type(value) is str and value in tables:
            if tables[value] is None:
                raise Finding("table-curve", f"the table {value} could not be read", "its own error is reported")
            return self.require_smooth(tables[value])
        if self.constant and not is_bare_name(value, info.context.load.parameters):
            return read_number(value, self.dimension, info.context.load)
        hint = suggest(value, tables, "tables") if type(value) is str and tables else TABLE_HINT
        raise Finding("table-curve", f"expected the name of a table, found {describe_kind(value)}", hint)

    def require_smooth(self, table: TableFunction) -> TableFunction:
        """Return the table. Raises Finding if it is not smooth or has other dimensions."""
        if table.interpolation not in ("cubic", "natural"):
            message = f"table {table.name} has {table.interpolation} interpolation, so it is not smooth"
            raise Finding("table-curve", message, "write interpolation: cubic")
        if table.kind == HELD_TABLE:
            raise Finding("table-curve", f"the table {table.name} has a kink at its ends", "remove outside: hold")
        for table_dimension, expected, axis in zip(
            table.dimensions, (self.over, self.dimension), ("x", "y"), strict=True
        ):
            if table_dimension is not None and expected is not None and table_dimension != expected:
                message = (
                    f"the {axis} of table {table.name} is {u.describe(table_dimension)}, expected "
                    f"{u.describe(expected)}"
                )
                raise Finding("dimension", message, f"for example {axis}_unit: {u.si_unit(expected)}")
        return table


class ExpectedValue(ValueReader):
    """A number, nested lists of numbers, or null for an indeterminate result; the numbers as expressions with their
    dimension.
    """

    def read(self, value: Any, info: Any) -> Any:
        if value is None:
            return None
        if type(value) is list:
            if not value:
                raise Finding("wrong-kind", "expected a number, a list of numbers, or null, found an empty list",
                              "null is for a result that must be open")  # fmt: skip
            return tuple(self.read(member, info) for member in value)
        return read_function(value, None, info.context.load)

    def make_json_schema(self) -> dict[str, Any]:
        return {"type": ["number", "string", "array", "null"]}


class TextOrMapping:
    """A mapping that may be written as one word instead: body.point."""

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        return {"anyOf": [{"type": "string", "description": "body.point"}, handler(schema)]}


FREQUENCIES = {"Hz": 1.0, "kHz": 1e3}
Anything = Annotated[float, SiNumber()]
Number = Annotated[float, SiNumber(u.NUMBER)]
Mass = Annotated[float, SiNumber(u.MASS)]
Length = Annotated[float, SiNumber(u.LENGTH)]
Time = Annotated[float, SiNumber(u.TIME)]
Angle = Annotated[float, SiNumber(u.ANGLE)]
Rate = Annotated[float, SiNumber(u.RATE)]
Velocity = Annotated[float, SiNumber(u.VELOCITY)]
Acceleration = Annotated[float, SiNumber(u.ACCELERATION)]
Inertia = Annotated[float, SiNumber(u.INERTIA)]
Density = Annotated[float, SiNumber(u.DENSITY)]
LineDensity = Annotated[float, SiNumber(u.LINE_DENSITY)]
Area = Annotated[float, SiNumber(u.AREA)]
AreaMoment = Annotated[float, SiNumber(u.AREA_MOMENT)]
Pressure = Annotated[float, SiNumber(u.PRESSURE)]
Force = Annotated[float, SiNumber(u.FORCE)]
Moment = Annotated[float, SiNumber(u.MOMENT)]
Impulse = Annotated[float, SiNumber(u.IMPULSE)]
AngularImpulse = Annotated[float, SiNumber(u.ANGULAR_IMPULSE)]
Stiffness = Annotated[float, SiNumber(u.STIFFNESS)]
TurningStiffness = Annotated[float, SiNumber(u.TURNING_STIFFNESS)]
Damping = Annotated[float, SiNumber(u.DAMPING)]
TurningDamping = Annotated[float, SiNumber(u.TURNING_DAMPING)]
Count = Annotated[int, WholeNumber(u.NUMBER)]
Either = Annotated[Expression, DependentNumber()]
CutOff = Annotated[Expression, CutOffPeriod()]
AngleInTime = Annotated[Expression, TimeFunction(u.ANGLE)]
RateInTime = Annotated[Expression, TimeFunction(u.RATE)]
VelocityInTime = Annotated[Expression, TimeFunction(u.VELOCITY)]
LengthInTime = Annotated[Expression, TimeFunction(u.LENGTH)]
ForceInTime = Annotated[Expression, TimeFunction(u.FORCE)]
LineForceInTime = Annotated[Expression, TimeFunction(u.LINE_FORCE)]
MomentInTime = Annotated[Expression, TimeFunction(u.MOMENT)]
OwnSpringForce = Annotated[Expression, LoadFunction(u.FORCE, {"length": "length", "rate": "speed"})]
OwnTurnTorque = Annotated[Expression, LoadFunction(u.MOMENT, {"angle": "angle", "rate": "rate"})]
OwnDamperTorque = Annotated[Expression, LoadFunction(u.MOMENT, {"rate": "rate"})]
OwnDamperForce = Annotated[Expression, LoadFunction(u.FORCE, {"rate": "speed", "speed": "speed"})]
MotorCurve = Annotated[Expression, TorqueCurve(u.MOMENT)]
ShiftLaw = Annotated[Any, NumberOrTable(u.STIFFNESS, "deflection")]
TurnLaw = Annotated[Any, NumberOrTable(u.TURNING_STIFFNESS, "turn")]
NumberInTime = Annotated[Expression, TimeFunction(u.NUMBER)]
TruthInTime = Annotated[Expression, ConditionValue()]
StrikeInTime = Annotated[Expression, ImpulseCondition()]
EitherInTime = Annotated[Expression, TimeFunction()]
Switch = Annotated[bool, StrictBoolean()]
FormatVersion = Annotated[int, VersionNumber()]
Text = Annotated[str, PlainText()]
Expected = Annotated[Any, ExpectedValue()]

Lift = Annotated[Any, SmoothTable(None, u.ANGLE, allows_number=False)]
PathPart = Annotated[Any, SmoothTable(u.LENGTH, u.LENGTH, allows_number=True)]

Position = tuple[Length, Length, Length]
Ratio = Annotated[float, DirectionComponent(u.NUMBER)]
Direction = tuple[Ratio, Ratio, Ratio]
Matrix = tuple[Direction, Direction, Direction]
StiffnessRow = tuple[Stiffness, Stiffness, Stiffness]
TurningStiffnessRow = tuple[TurningStiffness, TurningStiffness, TurningStiffness]
CouplingRow = tuple[Force, Force, Force]
DampingRow = tuple[Damping, Damping, Damping]
TurningDampingRow = tuple[TurningDamping, TurningDamping, TurningDamping]
CouplingDampingRow = tuple[Impulse, Impulse, Impulse]
Tensor = tuple[tuple[Inertia, Inertia, Inertia], tuple[Inertia, Inertia, Inertia], tuple[Inertia, Inertia, Inertia]]


def form_tag(value: Any) -> str:
    """Return the tag of the form that a value has, for keys that accept several forms."""
    if type(value) is list:
        return "rows" if value and type(value[0]) is list else "list"
    return "single" if value is None or isinstance(value, str | int | float) else "mapping"


FORM = OneOf(form_tag)
PointOrName = Annotated[Annotated[Position, Tag("list")] | Annotated[str, Tag("single")], FORM]


class EndEntry(Entry):
    """{body, at}, or body.point."""

    body: str
    at: PointOrName | None = None


def parse_end(value: Any, info: Any) -> Any:
    """Convert 'crank.pin' to {body: crank, at: pin}. Raises Finding."""
    if type(value) is list:
        hint = f"for a point of the ground write {{body: ground, at: {format_list(value)}}}"
        raise Finding("end", "an end cannot be a list", hint)
    if type(value) is not str:
        return value
    body, dot, point = value.partition(".")
    if not dot or not body or not point or "." in point:
        raise Finding("end", f"'{value}' is not of the form body.point", end_hint(value, info.context.points))
    return {"body": body, "at": point}


def format_list(values: list[Any]) -> str:
    return f"[{', '.join(map(str, values))}]" if len(values) == 3 else "[x, y, z]"


def end_hint(word: str, points: Mapping[str, Collection[str]]) -> str:
    """Return a hint with the ends that a word may stand for: the points of a body, or the points of that name."""
    of_body = (f"{word}.{point}" for point in points.get(word, ()))
    of_ground = (f"ground.{point}" for point in points.get("ground", ()) if word in ("origin", "world", "base"))
    of_point = (f"{body}.{word}" for body, names in points.items() if word in names)
    if spend_effort(len(points)) and (candidates := [*islice(chain(of_body, of_ground, of_point), 4)]):
        return f"did you mean {', or '.join(candidates)}?"
    if word in points:
        return f"define a point under {'ground' if word == 'ground' else f'bodies: {word}'}: points: {{top: [0, 0, 0]}}"
    return "an end is body.point, ground.point or {body: name, at: [x, y, z]}"


def parse_body_or_end(value: Any, info: Any) -> Any:
    """Convert 'crank' to {body: crank} and 'crank.pin' to {body: crank, at: pin}."""
    if type(value) is str and "." not in value:
        return {"body": value}
    return parse_end(value, info)


def require_two_limits(value: Any, info: Any) -> Any:
    """Require a list [low, high]; either may be null. Raises Finding."""
    if type(value) is not list or len(value) != 2:
        found = f"{len(value)} values" if type(value) is list else describe_kind(value)
        raise Finding("wrong-kind", f"expected [low, high], found {found}", "null means no limit: [null, 0.2]")
    return value


AnEnd = Annotated[EndEntry, Preprocessor(parse_end), TextOrMapping()]
BodyOrEnd = Annotated[EndEntry, Preprocessor(parse_body_or_end), TextOrMapping()]
AngleLimits = Annotated[tuple[Angle | None, Angle | None], Preprocessor(require_two_limits)]
LengthLimits = Annotated[tuple[Length | None, Length | None], Preprocessor(require_two_limits)]
