"""What a command reads is not written over: refused before anything is solved. Impure: looks at the files."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from heuncli.app.cli.entry import UsageError
from heuncli.base.errors import Problem
from heuncli.base.files import STDOUT
from heuncli.scene.file_format.reading import name_of


def require_other_file(output: str | None, specs: Sequence[str], option: str = "-o", are: str = "spec") -> None:
    """The output must not go into what the results are made from: the specs, and all that has been read so far.

    For None and `-` that is standard output, which a shell may have led to the end of a spec (`>>`).
    are: what the specs are called, where they are none: `model`.
    """
    to_stdout = output is None or output == STDOUT
    state = _of_standard_output() if to_stdout else _state(output)
    if state is None:
        return
    name = name_of(state)
    itself = name in specs or (not to_stdout and any(same_file(output, spec) for spec in specs))
    if itself or name is not None:
        part = "table" if are == "spec" else "part"
        what = f"the {are} itself" if itself else f"a {part} of the {are}"
        where = "standard output" if to_stdout else f"{option} {output}"
        raise UsageError(Problem("bad-option", f"{where}: that is {what}", hint="name another file"))


def same_file(one: str | None, other: str | None) -> bool:
    """Whether two names are of one file, or would be."""
    states = _state(one), _state(other)
    if states[0] is not None and states[1] is not None:
        return os.path.samestat(states[0], states[1])
    return one is not None and other is not None and _led_to(one) == _led_to(other)


def _led_to(name: str) -> str:
    """The path that a name leads to; in a folder that is gone, the name."""
    try:
        return os.path.realpath(name)
    except (OSError, ValueError):
        return name


def _state(name: str | None) -> os.stat_result | None:
    """What stands under a name; None where nothing does, or for standard output."""
    if name is None or name == STDOUT:
        return None
    from pathlib import Path  # 3 ms that only files need

    try:
        return Path(name).stat()
    except (OSError, ValueError):
        return None


def _of_standard_output() -> os.stat_result | None:
    try:
        return os.fstat(sys.stdout.fileno()) if sys.stdout is not None else None
    except (OSError, ValueError):  # one that is none of the system's
        return None
