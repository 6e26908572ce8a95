"""Progress messages of long computations; they are dropped unless a listener was set."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_LISTENER: ContextVar[Callable[[str], None] | None] = ContextVar("listener", default=None)


@contextmanager
def progress_listener(write: Callable[[str], None] | None) -> Iterator[None]:
    """Send progress messages to `write` inside the `with` block; None drops them."""
    token = _LISTENER.set(write)
    try:
        yield
    finally:
        _LISTENER.reset(token)


def current_listener() -> Callable[[str], None] | None:
    """Return the function that receives progress messages, or None."""
    return _LISTENER.get()
