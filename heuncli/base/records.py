"""Frozen records: what one stage of the computation passes to the next.

`@record` behaves like `@dataclass(frozen=True, eq=False)`: fields from the annotations, given by position or by name,
none set afterwards, each record equal only to itself. A dataclass is written as source and compiled on import, half a
millisecond each, and a small run imports sixty; a record class takes a hundredth of that. Defaults are shared by all
records of a class, so they must be immutable. An immutable mapping is `MappingProxyType({})`; records and named tuples
with such defaults are sent between processes, so they can be pickled.
"""

from __future__ import annotations

import copyreg
from types import MappingProxyType
from typing import Any, TypeVar, dataclass_transform

T = TypeVar("T")


def restore_mapping(items: dict[Any, Any]) -> MappingProxyType[Any, Any]:
    """Restore a read-only mapping that was pickled as its items."""
    return MappingProxyType(items)


copyreg.pickle(MappingProxyType, lambda mapping: (restore_mapping, (dict(mapping),)))


@dataclass_transform(frozen_default=True, eq_default=False)
def record(cls: type[T]) -> type[T]:
    """Make a class a frozen record whose annotated names are its fields, after those of a record that it extends."""
    inherited = getattr(cls, "__record_fields__", ())
    names = tuple(dict.fromkeys((*inherited, *cls.__annotations__)))
    known = frozenset(names)
    optional = {*cls.__dict__, *(name for name in inherited if hasattr(cls, name))}
    required = frozenset(names) - optional
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
    made.__init__, made.__repr__ = __init__, _repr
    made.__setattr__ = made.__delattr__ = _refuse_change
    made.__record_fields__, made.__record_known__, made.__record_copy__ = names, known, staticmethod(_copy)
    return cls


def replace(original: T, **changes: Any) -> T:
    """Return a copy of a record with some fields changed. Raises TypeError for an unknown field."""
    cls: Any = type(original)
    if not changes.keys() <= cls.__record_known__:
        raise TypeError(f"{cls.__name__}: fields unknown: {', '.join(sorted(changes.keys() - cls.__record_known__))}")
    copy: T = cls.__record_copy__(original)
    copy.__dict__.update(changes)
    return copy


def _copy(original: T) -> T:
    """Return a record with the same fields."""
    cls: Any = type(original)
    copy: T = object.__new__(cls)
    given = copy.__dict__  # complete after the loop
    for name in cls.__record_fields__:
        given[name] = getattr(original, name)
    return copy


def fields(instance: Any) -> dict[str, Any]:
    """Return the fields of a record and their values."""
    return {name: getattr(instance, name) for name in type(instance).__record_fields__}


def _refuse_change(self: Any, name: str, *value: Any) -> None:
    """Raise AttributeError: records are frozen."""
    raise AttributeError(f"{type(self).__name__}.{name} cannot be changed: records are frozen")


def _repr(self: Any) -> str:
    """Format a record with its fields."""
    return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in fields(self).items())})"
