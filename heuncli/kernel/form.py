"""Which of the kernel's two forms runs, compiled or plain Python; nothing of it is loaded yet.

HEUN_KERNEL at run time:

    unset                 compiled where that is there, else plain
    pure                  the plain .py files, also where the compiled module lies beside them
    compiled, require     compiled, or an error that says so

Impure: reads HEUN_KERNEL.
"""

from __future__ import annotations

import os
from importlib.machinery import EXTENSION_SUFFIXES

from heuncli.base.errors import HeunError, Problem
from heuncli.kernel.modules import NAME
from heuncli.kernel.sources import digest_code, digest_texts, newer_than

TYPE_CHECKING = False  # `heun --version` does without typing and pathlib
if TYPE_CHECKING:
    from typing import Literal

PACKAGE = __package__ or "heuncli.kernel"
FOLDER = os.path.dirname(__file__)
FILES = frozenset(os.listdir(FOLDER))
MOST_NAMED = 5  # files in a message: a line's worth


class KernelError(HeunError):
    """HEUN_KERNEL asks for what is not there, or what is there is out of date."""

    exit_code = 2


def find_compiled() -> str:
    """The name of the compiled kernel's file, as Python would import it; empty where there is none."""
    return next((f"{NAME}{suffix}" for suffix in EXTENSION_SUFFIXES if f"{NAME}{suffix}" in FILES), "")


def refuse_leftovers() -> None:
    """Raises KernelError for modules that an older heun compiled one by one: they would run in place of plain files."""
    left = sorted(file for file in FILES if file.endswith((".so", ".pyd")) and file.partition(".")[0] != NAME)
    if left:
        message = f"compiled files of an older heun lie among the kernel's: {left[0]}, {len(left)} in all"
        raise KernelError(
            Problem("stale-kernel", message, hint="python -m heuncli.build removes them and compiles anew")
        )


def edited_since_compiled(compiled: str) -> list[str]:
    """Names of modules whose code was edited since the kernel was compiled; none where only their times look like it.

    Only a checkout is looked at: what is installed is not edited, and the times of its files mean nothing.
    """
    if not os.path.exists(os.path.join(FOLDER, "..", "..", "pyproject.toml")):
        return []
    newer = newer_than(FOLDER, compiled)
    if not newer:
        return []
    from heuncli.kernel import compiled as kernel  # type: ignore[attr-defined]

    if digest_texts(FOLDER) == kernel.TEXT_DIGEST:
        return []
    return [name for name in newer if digest_code(FOLDER, [name]) != {name: kernel.CODE_DIGESTS.get(name)}]


def choose(wish: str) -> Literal["compiled", "pure"]:
    """Which form runs for a value of HEUN_KERNEL. Raises KernelError for one that is unknown or cannot be had."""
    if wish not in ("", "pure", "compiled", "require"):
        message = f"HEUN_KERNEL is '{wish}'; known: pure, compiled, require"
        raise KernelError(Problem("unknown-kernel", message, hint="unset it to let heun choose"))
    compiled = find_compiled()
    refuse_leftovers()
    if wish in ("compiled", "require") and not compiled:
        message = f"HEUN_KERNEL={wish}, but this heun has no compiled kernel"
        hint = "install again where a C compiler is at hand, or unset HEUN_KERNEL to run the slower plain one"
        raise KernelError(Problem("kernel-not-compiled", message, hint=hint))
    if not compiled or wish == "pure":
        return "pure"
    if edited := edited_since_compiled(compiled):
        named = ", ".join(f"{name}.py" for name in edited[:MOST_NAMED])
        more = f" and {len(edited) - MOST_NAMED} more" if len(edited) > MOST_NAMED else ""
        message = f"the compiled kernel is older than its text: {named}{more} changed since"
        hint = "compile it again with: python -m heuncli.build; or run the slower plain one: HEUN_KERNEL=pure"
        raise KernelError(Problem("stale-kernel", message, hint=hint))
    return "compiled"


KERNEL = choose(os.environ.get("HEUN_KERNEL", ""))
