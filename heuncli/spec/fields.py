"""The kinds of values that keys of a spec take: numbers with a dimension, values in time, vectors, ends.

Each is read in a context, in which the parameters, joints and tables of the scene are known. Models are classes of our
own: a validation library takes longer to import, and to build its validators, than all the rest of a small run.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, ClassVar, NamedTuple, Self, get_type_hints

from heuncli.errors import Finding
from heuncli.expressions import units as u
from heuncli.expressions.programs import Expression
from heuncli.records import record
from heuncli.spec.quantity import Scope, in_time, kind_of, number


@record
class Context:
    """What values may refer to: on loading, and in time."""

    load: Scope
    time: Scope


class Key(NamedTuple):
    """What a field of a model is to its reader: the key as users write it, and its value where it is left out."""

    alias: str | None = None
    default: Any = ...
    annotation: Any = None

    @property
    def required(self) -> bool:
        """Whether it must be given."""
        return self.default is ...


def Field(*, alias: str | None = None, default: Any = ...) -> Any:
    """A field whose key is no name in Python, or whose default is none of its type."""
    return Key(alias, default)


class Model:
    """A mapping with known keys; spec/reading.py reads it by the annotations of its fields."""

    def __init__(self, **values: Any) -> None:
        self.__dict__.update(values)

    def __init_subclass__(cls) -> None:
        for name in cls.__annotations__:
            given = cls.__dict__.get(name, ...)
            if isinstance(given, Key) and given.default is not ...:
                setattr(cls, name, given.default)
                cls._given = {**cls._given, name: given}
            elif isinstance(given, Key):
                delattr(cls, name)
                cls._given = {**cls._given, name: given}

    _given: ClassVar[dict[str, Key]] = {}

    def replaced(self, **changes: Any) -> Self:
        """The same with other values."""
        return type(self)(**{**self.__dict__, **changes})

    def given(self) -> dict[str, Any]:
        """The values of all fields, in their order."""
        return {name: getattr(self, name) for name in fields_of(type(self))}


FIELDS: dict[type[Model], dict[str, Key]] = {}  # of the models that have been asked for


def fields_of(model: type[Model]) -> dict[str, Key]:
    """The fields of a model, those it inherits first."""
    if model in FIELDS:
        return FIELDS[model]
    hints = get_type_hints(model, include_extras=True)
    models = [cls for cls in reversed(model.__mro__) if cls is not object]
    names = dict.fromkeys(name for cls in models for name in cls.__annotations__)
    FIELDS[model] = {
        name: Key(model._given.get(name, Key()).alias, getattr(model, name, ...), hints[name])
        for name in names
        if not name.startswith("_")
    }
    return FIELDS[model]


def keys_of(model: type[Model]) -> tuple[str, ...]:
    """The keys of a mapping, as users write them."""
    return tuple(field.alias or name for name, field in fields_of(model).items())


class Value:
    """A value that is read by `read`."""

    def __init__(self, dimension: u.Dimension | None = None) -> None:
        self.dimension = dimension

    def read(self, value: Any, context: Context) -> Any:
        """The value meant. Raises Finding."""
        raise NotImplementedError


class Before(NamedTuple):
    """What is done to a value before it is read by its type."""

    change: Callable[[Any], Any]


class Tag(NamedTuple):
    """Which form of a value this alternative takes: single, list, rows, mapping."""

    form: str


class Form(NamedTuple):
    """Tells the form of a value that may have several."""

    of: Callable[[Any], str]


class Si(Value):
    """A number of a dimension, in SI."""

    def read(self, value: Any, context: Context) -> float:
        if type(value) is float and value - value == 0.0:
            return value
        return number(value, self.dimension, context.load)


class InTime(Value):
    """A value in time of a dimension."""

    def read(self, value: Any, context: Context) -> Expression:
        return in_time(value, self.dimension, context.time)


class OfEither(Value):
    """A number whose dimension depends on another key: an expression that knows its dimension."""

    def read(self, value: Any, context: Context) -> Expression:
        return in_time(value, None, context.load)


class InParts(Value):
    """A list whose parts are read by themselves, each by the model of its type; here only that it is a list."""

    def read(self, value: Any, context: Context) -> list[Any]:
        if type(value) is not list:
            raise Finding("wrong-kind", f"expected a list, found {kind_of(value)}")
        return value


class Whole(Value):
    """A whole number."""

    def read(self, value: Any, context: Context) -> int:
        found = number(value, u.NUMBER, context.load)
        if found != int(found):
            raise Finding("wrong-kind", f"expected a whole number, found {found:g}")
        return int(found)


class Version(Value):
    """The version of the format."""

    def read(self, value: Any, context: Context) -> int:
        if type(value) is bool or value != 1:
            message = f"this is heun's format version 1, found {kind_of(value) if type(value) is not int else value}"
            raise Finding("version", message, "write 'heun: 1', or use a newer heun")
        return 1


class NumbersOrOpen(Value):
    """A number, lists of them, or null for what is open; the numbers as expressions that know their dimension."""

    def read(self, value: Any, context: Context) -> Any:
        if value is None:
            return None
        if type(value) is list:
            if not value:
                raise Finding("wrong-kind", "expected a number, a list of numbers, or null for what must be open")
            return tuple(self.read(member, context) for member in value)
        return in_time(value, None, context.load)


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
Count = Annotated[int, Whole(u.NUMBER)]
Either = Annotated[Expression, OfEither()]
AngleInTime = Annotated[Expression, InTime(u.ANGLE)]
LengthInTime = Annotated[Expression, InTime(u.LENGTH)]
ForceInTime = Annotated[Expression, InTime(u.FORCE)]
MomentInTime = Annotated[Expression, InTime(u.MOMENT)]
EitherInTime = Annotated[Expression, InTime()]
FormatVersion = Annotated[int, Version()]
Expected = Annotated[Any, NumbersOrOpen()]

Position = tuple[Length, Length, Length]
Direction = tuple[Number, Number, Number]
Matrix = tuple[Direction, Direction, Direction]
Tensor = tuple[tuple[Inertia, Inertia, Inertia], tuple[Inertia, Inertia, Inertia], tuple[Inertia, Inertia, Inertia]]


def kind_of_form(value: Any) -> str:
    """Which of its forms a value has, for keys that take several."""
    if type(value) is list:
        return "rows" if value and type(value[0]) is list else "list"
    return "single" if value is None or isinstance(value, str | int | float) else "mapping"


FORM = Form(kind_of_form)
PointOrName = Annotated[Annotated[Position, Tag("list")] | Annotated[str, Tag("single")], FORM]


class End(Model):
    """{body, at}, or body.point."""

    body: str
    at: PointOrName | None = None


def split_end(value: Any) -> Any:
    """'crank.pin' as {body: crank, at: pin}."""
    if type(value) is not str:
        return value
    body, dot, point = value.partition(".")
    if not dot or not body or not point or "." in point:
        raise Finding(
            "end", f"'{value}' is not an end", "an end is body.point, ground.point or {body: name, at: [x, y, z]}"
        )
    return End(body=body, at=point)


def split_body_or_end(value: Any) -> Any:
    """'crank' as {body: crank}, 'crank.pin' as {body: crank, at: pin}."""
    if type(value) is str and "." not in value:
        return End(body=value, at=None)
    return split_end(value)


AnEnd = Annotated[End, Before(split_end)]
BodyOrEnd = Annotated[End, Before(split_body_or_end)]
