"""The form of the kernel's structs, written once, for C (headers.py generates its declarations) and for plain Python.

    class Bounds(Value):
        low: float
        high: float

The fields are those annotated, in that order. An annotation stands for this type of the field in C:

    int, float, bool, Size     int, double, bint, Py_ssize_t
    Vec3                       the struct itself
    tuple[Vec3, Vec3]          two of them
    list[float]                a pointer to the first of many; in plain Python all of them
    Pointer[Programs]          a pointer to one; in plain Python the one

    _: Computed                no field: those below it are the kernel's own (Record)
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from typing import Annotated, Any, Self, TypeAlias, TypeVar, dataclass_transform

T = TypeVar("T")
Pointer = Annotated[T, "by its address"]
Size: TypeAlias = int
ZEROS = {"int": 0, "Size": 0, "float": 0.0, "bool": False}
ZERO: Any = None  # the value of a field that a row may leave out


class Computed:
    """Mark of where a record's fields begin that no row gives."""


class Fields(type):
    """Make slots of a class's annotations: a struct has its fields and no others."""

    row_fields: frozenset[str]  # fields that a row may give
    required_fields: frozenset[str]  # and those that it must give

    def __new__(mcs, name: str, bases: tuple[type, ...], names: dict[str, Any]) -> Fields:
        annotations = names.get("__annotations__", {})
        fields = list(annotations)
        known = fields[: fields.index("_")] if "_" in fields else fields
        annotations.pop("_", None)
        optional = {field for field in fields if field in names and names.pop(field) is ZERO}
        names["__slots__"] = tuple(annotations)
        made = super().__new__(mcs, name, bases, names)
        made.row_fields, made.required_fields = frozenset(known), frozenset(known) - optional
        return made


class Struct(metaclass=Fields):
    """A struct in plain Python."""

    @classmethod
    def blank(cls) -> Self:
        """Return a struct with all fields zero, as C has it at first; pointers are null."""
        instance = cls.__new__(cls)
        for name, kind in cls.__annotations__.items():
            setattr(instance, name, make_zero(kind, vars(sys.modules[cls.__module__])))
        return instance


class Record(Struct):
    """A row of a table (multibody/tree/tables.py), packed by the names of its fields, or a row of the plain kernel."""

    def __init__(self, **given: Any) -> None:
        """Make a row to be packed: matrices and vectors as arrays or sequences of numbers, yes and no as 1 and 0.

        Raises TypeError for a field that is missing, unknown or the kernel's own.
        """
        cls = type(self)
        wrong = (cls.required_fields - given.keys()) or (given.keys() - cls.row_fields)
        if wrong:
            raise TypeError(f"{cls.__name__}: fields missing or unknown: {', '.join(sorted(wrong))}")
        for name, value in given.items():
            setattr(self, name, value)

    def collect_fields(self) -> dict[str, Any]:
        """Return the fields that are given, with their values."""
        return {name: getattr(self, name) for name in type(self).__annotations__ if hasattr(self, name)}

    def replace(self, **changes: Any) -> Self:
        """Return a copy of a row to be packed with other values, or more of them."""
        return type(self)(**self.collect_fields() | changes)

    @classmethod
    def from_numbers(cls, row: Iterable[Any]) -> Self:
        """Return a row of the plain kernel from nested tuples, as NumPy gives them."""
        instance = cls.__new__(cls)
        known = vars(sys.modules[cls.__module__])
        for (name, kind), value in zip(cls.__annotations__.items(), row, strict=True):
            setattr(instance, name, known[kind](*value) if kind in known else value)
        return instance


@dataclass_transform(eq_default=False)
class Value(Struct):
    """A struct that is passed by value: made from all its fields, and never changed in place."""

    def __init_subclass__(cls) -> None:
        names = tuple(cls.__annotations__)
        lines = (f"def __init__(self, {', '.join(names)}):", *(f" self.{name} = {name}" for name in names))
        made: dict[str, Any] = {}
        exec("\n".join(lines), made)
        cls.__init__ = made["__init__"]  # type: ignore[method-assign]


def make_zero(kind: str, structs: dict[str, Any]) -> Any:
    """Return the zero of a kind of field; structs: the structs that it may name."""
    if kind in ZEROS:
        return ZEROS[kind]
    if kind.startswith("tuple["):
        return tuple(make_zero(part.strip(), structs) for part in kind[6:-1].split(","))
    return structs[kind].blank() if kind in structs else None
