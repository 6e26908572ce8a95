"""Choose which form of the kernel runs, compiled or plain Python; no kernel module is loaded before.

HEUN_KERNEL at run time:

    unset                 compiled if it exists, else plain
    pure                  the plain .py files, even if the compiled module exists
    compiled, require     compiled, or an error if it does not exist

Impure: reads HEUN_KERNEL.
"""

from __future__ import annotations

import os
from importlib.machinery import EXTENSION_SUFFIXES

from heuncli.base.errors import HeunError, Problem
from heuncli.kernel.modules import NAME, digest_code, digest_texts, find_newer_modules

TYPE_CHECKING = False  # `heun --version` does without typing and pathlib
if TYPE_CHECKING:
    from typing import Literal

PACKAGE = __package__ or "heuncli.kernel"
FOLDER = os.path.dirname(__file__)
FILES = frozenset(os.listdir(FOLDER))
MAX_NAMES = 5  # files in a message: a line's worth


class KernelError(HeunError):
    """HEUN_KERNEL asks for a form that does not exist, or the compiled kernel is out of date."""

    exit_code = 2


def find_compiled() -> str:
    """Return the file name of the compiled kernel, as Python would import it; empty if there is none."""
    return next((f"{NAME}{suffix}" for suffix in EXTENSION_SUFFIXES if f"{NAME}{suffix}" in FILES), "")


def refuse_leftovers() -> None:
    """Raises KernelError for modules that an older heun compiled one by one: they would hide the plain files."""
    leftovers = sorted(file for file in FILES if file.endswith((".so", ".pyd")) and file.partition(".")[0] != NAME)
    if leftovers:
        message = f"compiled files of an older heun in the kernel folder: {leftovers[0]}, {len(leftovers)} in total"
        raise KernelError(Problem("stale-kernel", message, hint="python -m heuncli.build removes them and recompiles"))


def edited_since_compiled(compiled_file: str) -> list[str]:
    """Return the modules whose code was edited since the kernel was compiled; a newer time alone does not count.

    Only a checkout is checked: installed files are not edited, and their times mean nothing.
    """
    if not os.path.exists(os.path.join(FOLDER, "..", "..", "pyproject.toml")):
        return []
    newer = find_newer_modules(FOLDER, compiled_file)
    if not newer:
        return []
    from heuncli.kernel import compiled as kernel  # type: ignore[attr-defined]

    if digest_texts(FOLDER) == kernel.TEXT_DIGEST:
        return []
    return [name for name in newer if digest_code(FOLDER, [name]) != {name: kernel.CODE_DIGESTS.get(name)}]


def choose_form(setting: str) -> Literal["compiled", "pure"]:
    """Return which form runs for a value of HEUN_KERNEL. Raises KernelError if it is unknown or not available."""
    if setting not in ("", "pure", "compiled", "require"):
        message = f"HEUN_KERNEL is '{setting}'; accepted: pure, compiled, require"
        raise KernelError(Problem("unknown-kernel", message, hint="unset it to let heun choose"))
    compiled = find_compiled()
    refuse_leftovers()
    if setting in ("compiled", "require") and not compiled:
        message = f"HEUN_KERNEL={setting}, but this heun has no compiled kernel"
        hint = "reinstall with a C compiler available, or unset HEUN_KERNEL to use the slower plain kernel"
        raise KernelError(Problem("kernel-not-compiled", message, hint=hint))
    if not compiled or setting == "pure":
        return "pure"
    if edited := edited_since_compiled(compiled):
        named = ", ".join(f"{name}.py" for name in edited[:MAX_NAMES])
        more = f" and {len(edited) - MAX_NAMES} more" if len(edited) > MAX_NAMES else ""
        message = f"the compiled kernel is older than its source: {named}{more} changed since"
        hint = "recompile with: python -m heuncli.build; or use the slower plain kernel: HEUN_KERNEL=pure"
        raise KernelError(Problem("stale-kernel", message, hint=hint))
    return "compiled"


KERNEL = choose_form(os.environ.get("HEUN_KERNEL", ""))
