"""Named tuples that are created quickly, for small records.

For its users and for type checkers `NamedTuple` is `typing.NamedTuple`. That one writes each class as source and
compiles it on import, which takes a tenth of a millisecond, and a small run imports a hundred; here the code of the
constructor is compiled once for each number of fields and gets the field names of each class.
"""

from __future__ import annotations

from _collections import _tuplegetter  # type: ignore[import-not-found]

TYPE_CHECKING = False  # that of `typing` is not imported: `heun --version` does without
if TYPE_CHECKING:
    from collections.abc import Iterable
    from types import CodeType
    from typing import Any, Self
    from typing import NamedTuple as NamedTuple
else:

    class _Maker(type):
        """Makes an ordinary class of each that is derived from NamedTuple."""

        def __new__(maker, name, bases, own):
            if not bases:
                return super().__new__(maker, name, bases, own)
            return named(type(name, (TupleMethods,), {"__slots__": (), **own}))

    class NamedTuple(metaclass=_Maker):
        """To derive from: annotations are the fields, what is assigned to them their defaults."""


class TupleMethods(tuple["Any", ...]):
    """The methods that all named tuples share."""

    __slots__ = ()
    _fields: tuple[str, ...] = ()

    @classmethod
    def _make(cls, values: Iterable[Any]) -> Self:
        """Make a tuple of an iterable of its values."""
        made = tuple.__new__(cls, values)
        if len(made) != len(cls._fields):
            raise TypeError(f"Expected {len(cls._fields)} arguments, got {len(made)}")
        return made

    def _replace(self, **changes: Any) -> Self:
        """Return a copy with some fields changed."""
        made = self._make(map(changes.pop, self._fields, self))
        if changes:
            raise ValueError(f"Got unexpected field names: {list(changes)!r}")
        return made

    def _asdict(self) -> dict[str, Any]:
        """Return the fields by name."""
        return dict(zip(self._fields, self))  # noqa: B905 - as many as there are fields

    def __getnewargs__(self) -> tuple[Any, ...]:
        return tuple(self)

    def __repr__(self) -> str:
        pairs = zip(self._fields, self)  # noqa: B905
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in pairs)})"


def named(cls: Any) -> Any:
    """Make a tuple class a named tuple: its annotations become fields, in their order, and assigned values their
    defaults.
    """
    names = cls._fields = tuple(cls.__annotations__)
    setattr(cls, "__match_args__", names)  # noqa: B010 - type checkers know of no such assignment
    defaults = cls._field_defaults = {name: cls.__dict__[name] for name in names if name in cls.__dict__}
    if [*defaults] != [*names[len(names) - len(defaults) :]]:
        raise TypeError(f"{cls.__name__}: a field without a default follows one that has a default")
    for place, name in enumerate(names):
        setattr(cls, name, _tuplegetter(place, f"Alias for field number {place}"))
    function: Any = type(named)
    make = function(_constructor_code(len(names)).replace(co_varnames=("_cls", *names)), {"new": tuple.__new__})
    make.__qualname__, make.__defaults__ = f"{cls.__name__}.__new__", tuple(defaults.values())
    cls.__new__ = make
    return cls


_CODES: dict[int, CodeType] = {}


def _constructor_code(count: int) -> CodeType:
    """Return the code of a function that makes a tuple of `count` arguments."""
    if count not in _CODES:
        arguments = "".join(f"_{place}, " for place in range(count))
        _CODES[count] = eval(f"lambda _cls, {arguments}: new(_cls, ({arguments}))").__code__
    return _CODES[count]
