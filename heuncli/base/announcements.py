"""What long work tells before it is done: nobody listens unless a listener was set."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_LISTENER: ContextVar[Callable[[str], None] | None] = ContextVar("listener", default=None)


@contextmanager
def listening(write: Callable[[str], None] | None) -> Iterator[None]:
    """Hand what is announced in here to `write`."""
    token = _LISTENER.set(write)
    try:
        yield
    finally:
        _LISTENER.reset(token)


def listener() -> Callable[[str], None] | None:
    """Who listens, if anybody does."""
    return _LISTENER.get()
