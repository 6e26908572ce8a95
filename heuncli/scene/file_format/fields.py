"""The kinds of values that keys of a spec take: numbers with a dimension, values in time, vectors, ends.

Each reads by way of the validation's context, in which the parameters, joints and tables of the scene are known.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from itertools import chain, islice
from typing import Annotated, Any

from pydantic_core import core_schema

from heuncli.base import units as u
from heuncli.base.errors import Finding
from heuncli.base.nearest import afford, did_you_mean
from heuncli.base.number_range import is_in_range
from heuncli.base.records import record, replace
from heuncli.scene.expressions.grammar import NONE
from heuncli.scene.expressions.programs import Expression, TableFunction
from heuncli.scene.file_format.entries import Before, Entry, OneOf, Tag
from heuncli.scene.file_format.quantity import Scope, condition, in_time, kind_of, number, unit_in
from heuncli.scene.file_format.words import FORMS

A_TABLE = "such as tables: {NAME: {x: [...], y: [...], interpolation: cubic}}"
HELD = 1  # a table's kind (scene/expressions/programs.py): beyond its ends it stays


@record
class Context:
    """What values may refer to: on loading, and in time; the points of each body and of the ground, for hints."""

    load: Scope
    time: Scope
    points: Mapping[str, Collection[str]] = NONE


class ReadValue:
    """A value that is read by `read`; in the JSON Schema a number or a text."""

    def __init__(self, dimension: u.Dimension | None = None) -> None:
        self.dimension = dimension

    def read(self, value: Any, info: Any) -> Any:
        raise NotImplementedError

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.with_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        return self.in_json_schema()

    def in_json_schema(self) -> dict[str, Any]:
        """What a value may be: a number, or a text that is a number with a unit, or an expression."""
        description = {"description": u.describe(self.dimension)} if self.dimension is not None else {}
        return {"anyOf": [{"type": "number"}, {"type": "string"}], **description}


class Si(ReadValue):
    """A number of a dimension, in SI."""

    def read(self, value: Any, info: Any) -> float:
        if type(value) is float and is_in_range(value):
            return value
        return number(value, self.dimension, info.context.load)


class Component(Si):
    """A component of a direction, of which the ratios count: all three may be lengths."""

    def read(self, value: Any, info: Any) -> float:
        is_expression = type(value) is str and unit_in(value) is None
        return number(value, None, info.context.load) if is_expression else super().read(value, info)


class InTime(ReadValue):
    """A value in time of a dimension."""

    def read(self, value: Any, info: Any) -> Expression:
        return in_time(value, self.dimension, info.context.time)


class InOwn(ReadValue):
    """A value in time, coordinates, and what the load itself acts between: own names with their quantities."""

    def __init__(self, dimension: u.Dimension | None, own: Mapping[str, str]) -> None:
        super().__init__(dimension)
        self.own = own

    def read(self, value: Any, info: Any) -> Expression:
        return in_time(value, self.dimension, replace(info.context.time, own=self.own))


class OrTable(Si):
    """A number of a dimension, or the name of a table of force over deflection, moment over turn."""

    def __init__(self, dimension: u.Dimension, of: str) -> None:
        super().__init__(dimension)
        self.of = of

    def read(self, value: Any, info: Any) -> Any:
        if type(value) is str and value.strip() in info.context.time.tables:
            own = replace(info.context.time, own={self.of: self.of})
            return in_time(f"-table({value.strip()}, {self.of})", None, own)
        return super().read(value, info)


class CurveValue(ReadValue):
    """A motor's torque over its speed: the name of a table, or an expression in `rate`."""

    def read(self, value: Any, info: Any) -> Expression:
        scope = replace(info.context.time, own={"rate": "rate"})
        named = type(value) is str and value.strip() in scope.tables
        return in_time(f"table({value.strip()}, rate)" if named else value, self.dimension, scope)


class Truth(ReadValue):
    """A condition in time."""

    def read(self, value: Any, info: Any) -> Expression:
        return condition(value, info.context.time)


class StrikingTruth(ReadValue):
    """A condition in time and coordinates at which a blow strikes."""

    def read(self, value: Any, info: Any) -> Expression:
        if type(value) is dict:
            message = "a blow strikes at a condition in time and coordinates, not at a number of the results"
            raise Finding("condition", message, "such as guide.travel > 0.2, or shaft.rate < 0 and t > 1")
        return condition(value, info.context.time)


class OfEither(ReadValue):
    """A number whose dimension depends on another key: an expression that knows its dimension."""

    def read(self, value: Any, info: Any) -> Expression:
        return in_time(value, None, info.context.load)


class InParts(ReadValue):
    """A list whose parts are read by themselves, each by the model of its type; here only that it is a list."""

    def read(self, value: Any, info: Any) -> list[Any]:
        if type(value) is not list:
            raise Finding("wrong-kind", f"expected a list, found {kind_of(value)}", FORMS["shapes"])
        return value

    def in_json_schema(self) -> dict[str, Any]:
        return {"type": "array"}


class Whole(ReadValue):
    """A whole number."""

    def read(self, value: Any, info: Any) -> int:
        count = number(value, u.NUMBER, info.context.load)
        if count != int(count):
            raise Finding("wrong-kind", f"expected a whole number, found {count:g}", f"{math.floor(count)}, say")
        return int(count)


class Version(ReadValue):
    """The version of the format."""

    def read(self, value: Any, info: Any) -> int:
        if type(value) is bool or value != 1:
            message = f"this is heun's format version 1, found {kind_of(value) if type(value) is not int else value}"
            raise Finding("version", message, "write 'heun: 1', or use a newer heun")
        return 1

    def in_json_schema(self) -> dict[str, Any]:
        return {"const": 1}


class YesOrNo:
    """`true` or `false`, and nothing that could be taken for them."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.bool_schema(strict=True)


def is_a_name(value: Any, parameters: Mapping[str, float | None]) -> bool:
    """Whether a value is a single word that is not a parameter's name."""
    return type(value) is str and value.isidentifier() and value not in parameters


class Smooth(ReadValue):
    """The name of a table that is a smooth curve, of values of a dimension over another; or a number, where it may be.

    One with a corner would ask for infinite accelerations where it is passed, and one that bends by jumps for jumps.
    """

    def __init__(self, dimension: u.Dimension | None, over: u.Dimension, constant: bool) -> None:
        super().__init__(dimension)
        self.over, self.constant = over, constant

    def read(self, value: Any, info: Any) -> TableFunction | float:
        tables = info.context.time.tables
        if type(value) is str and value in tables:
            if tables[value] is None:
                raise Finding("table-curve", f"the table {value} could not be read", "what is wrong with it is told")
            return self.smooth(tables[value])
        if self.constant and not is_a_name(value, info.context.load.parameters):
            return number(value, self.dimension, info.context.load)
        hint = did_you_mean(value, tables, "tables") if type(value) is str and tables else A_TABLE
        raise Finding("table-curve", f"expected the name of a table, found {kind_of(value)}", hint)

    def smooth(self, table: TableFunction) -> TableFunction:
        """The table, if it is smooth and of these dimensions."""
        if table.interpolation not in ("cubic", "natural"):
            message = f"the table {table.name} is {table.interpolation}: it does not bend evenly"
            raise Finding("table-curve", message, "interpolation: cubic")
        if table.kind == HELD:
            raise Finding("table-curve", f"the table {table.name} has a corner at its ends", "leave outside: hold out")
        for given, asked, axis in zip(table.dimensions, (self.over, self.dimension), ("x", "y"), strict=True):
            if given is not None and asked is not None and given != asked:
                message = f"the {axis} of table {table.name} is {u.describe(given)}, expected {u.describe(asked)}"
                raise Finding("dimension", message, f"{axis}_unit: {u.si_unit(asked)}, say")
        return table


class NumbersOrOpen(ReadValue):
    """A number, lists of them, or null for what is open; the numbers as expressions that know their dimension."""

    def read(self, value: Any, info: Any) -> Any:
        if value is None:
            return None
        if type(value) is list:
            if not value:
                raise Finding("wrong-kind", "expected a number, a list of numbers, or null, found an empty list",
                              "null is for what must be open")  # fmt: skip
            return tuple(self.read(member, info) for member in value)
        return in_time(value, None, info.context.load)

    def in_json_schema(self) -> dict[str, Any]:
        return {"type": ["number", "string", "array", "null"]}


class AsText:
    """A mapping that may be written as one word instead: body.point."""

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        return {"anyOf": [{"type": "string", "description": "body.point"}, handler(schema)]}


Anything = Annotated[float, Si()]
Number = Annotated[float, Si(u.NUMBER)]
Mass = Annotated[float, Si(u.MASS)]
Length = Annotated[float, Si(u.LENGTH)]
Time = Annotated[float, Si(u.TIME)]
Angle = Annotated[float, Si(u.ANGLE)]
Rate = Annotated[float, Si(u.RATE)]
Velocity = Annotated[float, Si(u.VELOCITY)]
Acceleration = Annotated[float, Si(u.ACCELERATION)]
Inertia = Annotated[float, Si(u.INERTIA)]
Density = Annotated[float, Si(u.DENSITY)]
LineDensity = Annotated[float, Si(u.LINE_DENSITY)]
Area = Annotated[float, Si(u.AREA)]
AreaMoment = Annotated[float, Si(u.AREA_MOMENT)]
Pressure = Annotated[float, Si(u.PRESSURE)]
Force = Annotated[float, Si(u.FORCE)]
Moment = Annotated[float, Si(u.MOMENT)]
Impulse = Annotated[float, Si(u.IMPULSE)]
AngularImpulse = Annotated[float, Si(u.ANGULAR_IMPULSE)]
Stiffness = Annotated[float, Si(u.STIFFNESS)]
TurningStiffness = Annotated[float, Si(u.TURNING_STIFFNESS)]
Damping = Annotated[float, Si(u.DAMPING)]
TurningDamping = Annotated[float, Si(u.TURNING_DAMPING)]
Count = Annotated[int, Whole(u.NUMBER)]
Either = Annotated[Expression, OfEither()]
AngleInTime = Annotated[Expression, InTime(u.ANGLE)]
RateInTime = Annotated[Expression, InTime(u.RATE)]
VelocityInTime = Annotated[Expression, InTime(u.VELOCITY)]
LengthInTime = Annotated[Expression, InTime(u.LENGTH)]
ForceInTime = Annotated[Expression, InTime(u.FORCE)]
LineForceInTime = Annotated[Expression, InTime(u.LINE_FORCE)]
MomentInTime = Annotated[Expression, InTime(u.MOMENT)]
OwnSpringForce = Annotated[Expression, InOwn(u.FORCE, {"length": "length", "rate": "speed"})]
OwnTurnTorque = Annotated[Expression, InOwn(u.MOMENT, {"angle": "angle", "rate": "rate"})]
OwnDamperTorque = Annotated[Expression, InOwn(u.MOMENT, {"rate": "rate"})]
OwnDamperForce = Annotated[Expression, InOwn(u.FORCE, {"rate": "speed", "speed": "speed"})]
MotorCurve = Annotated[Expression, CurveValue(u.MOMENT)]
ShiftLaw = Annotated[Any, OrTable(u.STIFFNESS, "deflection")]
TurnLaw = Annotated[Any, OrTable(u.TURNING_STIFFNESS, "turn")]
NumberInTime = Annotated[Expression, InTime(u.NUMBER)]
TruthInTime = Annotated[Expression, Truth()]
StrikeInTime = Annotated[Expression, StrikingTruth()]
EitherInTime = Annotated[Expression, InTime()]
Switch = Annotated[bool, YesOrNo()]
FormatVersion = Annotated[int, Version()]
Expected = Annotated[Any, NumbersOrOpen()]

Lift = Annotated[Any, Smooth(None, u.ANGLE, constant=False)]
PathPart = Annotated[Any, Smooth(u.LENGTH, u.LENGTH, constant=True)]

Position = tuple[Length, Length, Length]
Ratio = Annotated[float, Component(u.NUMBER)]
Direction = tuple[Ratio, Ratio, Ratio]
Matrix = tuple[Direction, Direction, Direction]
Tensor = tuple[tuple[Inertia, Inertia, Inertia], tuple[Inertia, Inertia, Inertia], tuple[Inertia, Inertia, Inertia]]


def kind_of_form(value: Any) -> str:
    """Which of its forms a value has, for keys that take several."""
    if type(value) is list:
        return "rows" if value and type(value[0]) is list else "list"
    return "single" if value is None or isinstance(value, str | int | float) else "mapping"


FORM = OneOf(kind_of_form)
PointOrName = Annotated[Annotated[Position, Tag("list")] | Annotated[str, Tag("single")], FORM]


class EndEntry(Entry):
    """{body, at}, or body.point."""

    body: str
    at: PointOrName | None = None


def split_end(value: Any, info: Any) -> Any:
    """'crank.pin' as {body: crank, at: pin}."""
    if type(value) is list:
        hint = f"a point of the ground is {{body: ground, at: {in_brackets(value)}}}"
        raise Finding("end", "an end is no list", hint)
    if type(value) is not str:
        return value
    body, dot, point = value.partition(".")
    if not dot or not body or not point or "." in point:
        raise Finding("end", f"'{value}' is not an end", end_hint(value, info.context.points))
    return {"body": body, "at": point}


def in_brackets(values: list[Any]) -> str:
    return f"[{', '.join(map(str, values))}]" if len(values) == 3 else "[x, y, z]"


def end_hint(word: str, points: Mapping[str, Collection[str]]) -> str:
    """Which ends a word may stand for: the points of a body, or the point of that name."""
    of_body = (f"{word}.{point}" for point in points.get(word, ()))
    of_ground = (f"ground.{point}" for point in points.get("ground", ()) if word in ("origin", "world", "base"))
    of_point = (f"{body}.{word}" for body, names in points.items() if word in names)
    if afford(len(points)) and (own := [*islice(chain(of_body, of_ground, of_point), 4)]):
        return f"did you mean {', or '.join(own)}?"
    if word in points:
        return f"name a point under {'ground' if word == 'ground' else f'bodies: {word}'}: points: {{top: [0, 0, 0]}}"
    return "an end is body.point, ground.point or {body: name, at: [x, y, z]}"


def split_body_or_end(value: Any, info: Any) -> Any:
    """'crank' as {body: crank}, 'crank.pin' as {body: crank, at: pin}."""
    if type(value) is str and "." not in value:
        return {"body": value}
    return split_end(value, info)


def two_limits(value: Any, info: Any) -> Any:
    """[low, high], either of them null."""
    if type(value) is not list or len(value) != 2:
        found = f"{len(value)} values" if type(value) is list else kind_of(value)
        raise Finding("wrong-kind", f"expected [low, high], found {found}", "null is no limit: [null, 0.2]")
    return value


AnEnd = Annotated[EndEntry, Before(split_end), AsText()]
BodyOrEnd = Annotated[EndEntry, Before(split_body_or_end), AsText()]
AngleLimits = Annotated[tuple[Angle | None, Angle | None], Before(two_limits)]
LengthLimits = Annotated[tuple[Length | None, Length | None], Before(two_limits)]
