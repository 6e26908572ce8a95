"""Stand-in for `import cython` where the kernel runs as plain Python.

Cython is a build requirement only, and its own stand-in knows no objects behind pointers: here a pointer to one struct
is the object itself, a pointer to the first of many is the list of them, and every other name means "do nothing".
"""

from __future__ import annotations

from typing import Any


class _Type:
    """A C type as an annotation or a cast: indexing gives a type again, calling gives the value back."""

    def __getitem__(self, _: Any) -> _Type:
        return self

    def __call__(self, x: Any = 0) -> Any:
        return x


class _Block:
    """What is both a decorator and the head of a block, like `nogil`."""

    def __call__(self, f: Any) -> Any:
        return f

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

    def __getattr__(self, name: str) -> Any:
        if name in ("cfunc", "ccall", "inline", "cclass", "final"):
            return lambda f: f
        if name in ("exceptval", "locals", "returns", "boundscheck", "wraparound", "cdivision"):
            return lambda *a, **k: lambda f: f
        return _Type()  # pointer, double, p_double, ...


cython = _Cython()
