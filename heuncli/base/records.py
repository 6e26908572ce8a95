"""Frozen records: what one stage hands to the next.

`@record` is to its users what `@dataclass(frozen=True, eq=False)` is: fields from the annotations, given by place or by
name, none set afterwards, each record equal to itself alone. A dataclass is written as source and compiled when it is
imported, half a millisecond each, and a small run imports sixty; a record class takes a hundredth of that. Defaults are
shared by all records of a class, so they must be immutable. A mapping that is one is `MappingProxyType({})`; records
and named tuples that hold such defaults are sent between processes, so they can be pickled.
"""

from __future__ import annotations

import copyreg
from types import MappingProxyType
from typing import Any, TypeVar, dataclass_transform

T = TypeVar("T")


def restore_mapping(items: dict[Any, Any]) -> MappingProxyType[Any, Any]:
    """Make the read-only mapping that was pickled as its items."""
    return MappingProxyType(items)


copyreg.pickle(MappingProxyType, lambda mapping: (restore_mapping, (dict(mapping),)))


@dataclass_transform(frozen_default=True, eq_default=False)
def record(cls: type[T]) -> type[T]:
    """A class whose annotated names are the fields of its records."""
    names = tuple(cls.__annotations__)
    known = frozenset(names)
    required = frozenset(name for name in names if name not in cls.__dict__)
    first_optional = max((i + 1 for i, name in enumerate(names) if name in required), default=0)

    def __init__(self: T, *values: Any, **named: Any) -> None:
        own = self.__dict__
        if not values and named.keys() == known:  # all by their names
            own.update(named)
            return
        own.update(zip(names, values))  # noqa: B905 - too many are seen by their number
        if not named:
            if first_optional <= len(values) <= len(names):
                return
        else:
            own.update(named)
            if len(own) == len(values) + len(named) and known.issuperset(named) and required.issubset(own):
                return
        twice = [*names[: len(values)], *named]
        wrong = (required - own.keys()) or (own.keys() - known) or {n for n in twice if twice.count(n) > 1}
        raise TypeError(f"{cls.__name__}: fields missing, unknown or given twice: {', '.join(sorted(wrong))}")

    made: Any = cls
    made.__init__, made.__repr__ = __init__, _text
    made.__setattr__ = made.__delattr__ = _frozen
    made.__record_fields__, made.__record_known__, made.__record_copy__ = names, known, staticmethod(_copy)
    return cls


def replace(one: T, **changes: Any) -> T:
    """A record like this one but for some fields."""
    cls: Any = type(one)
    if not changes.keys() <= cls.__record_known__:
        raise TypeError(f"{cls.__name__}: fields unknown: {', '.join(sorted(changes.keys() - cls.__record_known__))}")
    made: T = cls.__record_copy__(one)
    made.__dict__.update(changes)
    return made


def _copy(one: T) -> T:
    """A record with the same fields."""
    cls: Any = type(one)
    made: T = object.__new__(cls)
    given = made.__dict__  # complete, as that of `one` is
    for name in cls.__record_fields__:
        given[name] = getattr(one, name)
    return made


def fields(one: Any) -> dict[str, Any]:
    """The fields of a record and their values."""
    return {name: getattr(one, name) for name in type(one).__record_fields__}


def _frozen(self: Any, name: str, *value: Any) -> None:
    raise AttributeError(f"{type(self).__name__}.{name} cannot be changed: records are frozen")


def _text(self: Any) -> str:
    return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in fields(self).items())})"
