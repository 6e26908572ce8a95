"""Stand-in for `import cython` if the kernel runs as plain Python.

Cython is a build requirement only, and its own stand-in cannot represent objects behind pointers: here a pointer to one
struct is the object itself, a pointer to the first of many is the list of them, and any other name is a type that does
nothing.
"""

from __future__ import annotations

from typing import Any


class _Type:
    """A C type as an annotation or a cast: indexing returns a type again, calling returns the value."""

    def __getitem__(self, _: Any) -> _Type:
        return self

    def __call__(self, x: Any = 0) -> Any:
        return x


class _Block:
    """The head of a block, like `nogil`."""

    def __enter__(self) -> None:
        return None

    def __exit__(self, *_: Any) -> None:
        return None


class _Cython:
    compiled = False
    NULL = None
    nogil = _Block()

    @staticmethod
    def address(x: Any) -> Any:
        """A pointer to an object is the object."""
        return x

    @staticmethod
    def cast(_: Any, x: Any, **__: Any) -> Any:
        return x

    def __getattr__(self, _: str) -> Any:
        return _Type()  # pointer, double, p_double, ...


cython: Any = _Cython()  # Any: as a type, too
