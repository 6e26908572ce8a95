"""The command in this process, with what it wrote: for families that run it thousands of times."""

from __future__ import annotations

import contextlib
import io
import sys
from collections.abc import Iterator, Sequence

from heuncli.app.cli.entry import enter
from tests.shared.command import Done


def run_command(words: Sequence[str], text: str = "") -> Done:
    """Run one command line; text is its standard input."""
    out, err = io.TextIOWrapper(io.BytesIO(), "utf-8"), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), _standard_input(text):
        code = enter(words)
    out.flush()
    return Done(code, out.buffer.getvalue().decode(), err.getvalue())  # type: ignore[attr-defined]


@contextlib.contextmanager
def _standard_input(text: str) -> Iterator[None]:
    """Standard input that holds a text."""
    before, sys.stdin = sys.stdin, io.TextIOWrapper(io.BytesIO(text.encode()))
    try:
        yield
    finally:
        sys.stdin = before
