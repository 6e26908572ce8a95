"""A long text on a terminal goes through a pager; everywhere else it goes straight through. Impure: processes."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys

from heuncli.cli import terminal
from heuncli.cli.output import emit

DEFAULT = ("less", "-FRX")


def show(text: str, output: str | None, paged: bool = True) -> None:
    """Write a text: to a file, to a pipe as it is, to a terminal page by page where it has more lines than that."""
    command = _command() if output is None and paged and terminal.present() else None
    if command is None or text.count("\n") < shutil.get_terminal_size().lines:
        emit(text, output)
        return
    try:
        subprocess.run(command, input=text.encode(), check=False, shell=isinstance(command, str))
    except OSError:
        emit(text)


def _command() -> str | tuple[str, ...] | None:
    """What PAGER says, else less; None where there is none, or no terminal to read keys from."""
    asked = os.environ.get("PAGER")
    if sys.stdin is None or not sys.stdin.isatty() or asked in ("", "cat"):
        return None
    return asked or (DEFAULT if shutil.which(DEFAULT[0]) else None)
