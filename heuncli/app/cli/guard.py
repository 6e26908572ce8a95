"""Refuse outputs that would overwrite the command's inputs, before anything is solved. Impure: reads file status."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from heuncli.base.errors import Problem, UsageError
from heuncli.base.files import STDOUT
from heuncli.scene.file_format.reading import find_name_read


def require_other_file(output: str | None, specs: Sequence[str], option: str = "-o", kind: str = "spec") -> None:
    """Require that the output is none of the specs, nor any file read so far. Raises UsageError.

    For None and `-` the output is standard output, which a shell may append to a spec (`>>`).

    kind: what the input files are called in the message, if not specs: `model`
    """
    to_stdout = output is None or output == STDOUT
    state = _read_stdout_status() if to_stdout else _read_status(output)
    if state is None:
        return
    name = find_name_read(state)
    is_spec = name in specs or (not to_stdout and any(is_same_file(output, spec) for spec in specs))
    if is_spec or name is not None:
        member = "table" if kind == "spec" else "part"
        what = f"the {kind} itself" if is_spec else f"a {member} of the {kind}"
        where = "standard output" if to_stdout else f"{option} {output}"
        raise UsageError(Problem("bad-option", f"{where}: would overwrite {what}", hint="name another file"))


def is_same_file(one: str | None, other: str | None) -> bool:
    """Return whether two names lead to the same file, or would if it existed."""
    states = _read_status(one), _read_status(other)
    if states[0] is not None and states[1] is not None:
        return os.path.samestat(states[0], states[1])
    return one is not None and other is not None and _resolve_path(one) == _resolve_path(other)


def _resolve_path(name: str) -> str:
    """Return the real path of a name, or the name itself if its folder is gone."""
    try:
        return os.path.realpath(name)
    except (OSError, ValueError):
        return name


def _read_status(name: str | None) -> os.stat_result | None:
    """Return the status of a file, or None if it does not exist or is standard output."""
    if name is None or name == STDOUT:
        return None
    from pathlib import Path  # 3 ms that only files need

    try:
        return Path(name).stat()
    except (OSError, ValueError):
        return None


def _read_stdout_status() -> os.stat_result | None:
    try:
        return os.fstat(sys.stdout.fileno()) if sys.stdout is not None else None
    except (OSError, ValueError):  # a stream without a file descriptor
        return None
