"""Stand-in for `import cython` where Cython is not installed: the kernel's files then run as plain Python.

Cython is a build requirement only; every name the kernel takes from it is given here with the meaning "do nothing".
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
    def __call__(self, f: Any) -> Any:
        return f

    def __enter__(self) -> None:
        return None

    def __exit__(self, *_: Any) -> None:
        return None


class _Cython:
    compiled = False
    nogil = _Block()

    def __getattr__(self, name: str) -> Any:
        if name in ("cfunc", "ccall", "inline"):
            return lambda f: f
        if name in ("exceptval", "locals", "returns", "boundscheck", "wraparound", "cdivision"):
            return lambda *a, **k: lambda f: f
        return _Type()


cython = _Cython()
