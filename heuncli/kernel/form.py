"""Which of the kernel's two forms runs, compiled or plain Python; nothing of it is loaded yet.

HEUN_KERNEL at run time:

    unset                 compiled where all modules are, else plain
    pure                  the plain .py files, also where compiled ones lie beside them
    compiled, require     compiled, or an error that says so

Impure: reads HEUN_KERNEL; for the plain form it puts a finder into sys.meta_path.
"""

from __future__ import annotations

import os
import sys
from importlib.machinery import EXTENSION_SUFFIXES, SOURCE_SUFFIXES, FileFinder, ModuleSpec, SourceFileLoader

from heuncli.errors import HeunError, Problem
from heuncli.kernel.modules import MODULES
from heuncli.kernel.sources import digest, newer_than_compiled

TYPE_CHECKING = False  # `heun --version` does without typing and pathlib
if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import ModuleType
    from typing import Literal

PACKAGE = __package__ or "heuncli.kernel"
FOLDER = os.path.dirname(__file__)
FILES = frozenset(os.listdir(FOLDER))
MOST_NAMED = 5  # files in a message: a line's worth


class KernelError(HeunError):
    """HEUN_KERNEL asks for what is not there, or what is there is out of date."""

    exit_code = 2


class PlainFiles:
    """A finder for sys.meta_path that sees the kernel's source files and not the compiled ones beside them."""

    def __init__(self) -> None:
        self.finder = FileFinder(FOLDER, (SourceFileLoader, SOURCE_SUFFIXES))

    def find_spec(self, name: str, path: Sequence[str] | None, target: ModuleType | None = None) -> ModuleSpec | None:
        return self.finder.find_spec(name) if name.startswith(f"{PACKAGE}.") else None


def is_built(name: str) -> bool:
    """Whether a compiled form of the kernel's module lies beside its source."""
    return any(f"{name}{suffix}" in FILES for suffix in EXTENSION_SUFFIXES)


def edited_since_compiled() -> list[str]:
    """Names of sources that were edited since the kernel was compiled; none where only their times look like it.

    Only a checkout is looked at: what is installed is not edited, and the times of its files mean nothing.
    """
    if not os.path.exists(os.path.join(FOLDER, "..", "..", "pyproject.toml")):
        return []
    newer = newer_than_compiled(FOLDER, FILES)
    if not newer:
        return []
    try:
        from heuncli.kernel.memory import compiled_from  # it needs no other module of the kernel
    except ImportError:  # compiled before there were digests
        return newer
    return newer if compiled_from() != digest(FOLDER) else []


def choose(wish: str) -> Literal["compiled", "pure"]:
    """Which form runs for a value of HEUN_KERNEL. Raises KernelError for one that is unknown or cannot be had.

    All modules are of one form: a compiled one calls its neighbours as C functions.
    """
    if wish not in ("", "pure", "compiled", "require"):
        message = f"HEUN_KERNEL is '{wish}'; known: pure, compiled, require"
        raise KernelError(Problem("unknown-kernel", message, hint="unset it to let heun choose"))
    missing = [name for name in MODULES if not is_built(name)]
    if wish in ("compiled", "require") and missing:
        message = f"HEUN_KERNEL={wish}, but this heun has no compiled kernel (missing: {', '.join(missing)})"
        hint = "install again where a C compiler is at hand, or unset HEUN_KERNEL to run the slower plain one"
        raise KernelError(Problem("kernel-not-compiled", message, hint=hint))
    if missing or wish == "pure":
        return "pure"
    if edited := edited_since_compiled():
        more = f" and {len(edited) - MOST_NAMED} more" if len(edited) > MOST_NAMED else ""
        message = f"the compiled kernel is older than its text: {', '.join(edited[:MOST_NAMED])}{more} changed since"
        hint = "compile it again with: python -m heuncli.build; or run the slower plain one: HEUN_KERNEL=pure"
        raise KernelError(Problem("stale-kernel", message, hint=hint))
    return "compiled"


KERNEL = choose(os.environ.get("HEUN_KERNEL", ""))
if KERNEL == "pure":
    sys.meta_path.insert(0, PlainFiles())
