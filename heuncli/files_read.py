"""Which files one command has read, by what they are and not by what they are called: none of them is written over.

A link, a hard link, another spelling or `/dev/fd/3` is the same file. Impure: remembers from one call to the next.
"""

from __future__ import annotations

import os
import stat

_READ: dict[tuple[int, int], str] = {}  # device and number of each file -> the name it was read by


def forget() -> None:
    """Another command begins."""
    _READ.clear()


def remember(state: os.stat_result, name: str) -> None:
    """This is being read; a pipe or a device is no content that could be lost."""
    if stat.S_ISREG(state.st_mode):
        _READ.setdefault((state.st_dev, state.st_ino), name)


def name_of(state: os.stat_result) -> str | None:
    """By what name it was read, if it was."""
    return _READ.get((state.st_dev, state.st_ino)) if stat.S_ISREG(state.st_mode) else None
