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
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from typing import Annotated, Any, Self, TypeAlias, TypeVar, dataclass_transform

T = TypeVar("T")
Pointer = Annotated[T, "by its address"]
Size: TypeAlias = int
ZEROS = {"int": 0, "Size": 0, "float": 0.0, "bool": False}


class Fields(type):
    """Make slots of a class's annotations: a struct has its fields and no others."""

    def __new__(mcs, name: str, bases: tuple[type, ...], names: dict[str, Any]) -> Fields:
        names["__slots__"] = tuple(names.get("__annotations__", ()))
        return super().__new__(mcs, name, bases, names)


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
    """A row of a table (multibody/tree/tables.py): in plain Python made from nested tuples, as NumPy gives them."""

    def __init__(self, row: Iterable[Any]) -> None:
        known = vars(sys.modules[type(self).__module__])
        for (name, kind), value in zip(type(self).__annotations__.items(), row, strict=True):
            setattr(self, name, known[kind](*value) if kind in known else value)


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
