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
from heuncli.kernel.modules import NAME, SOURCES, digest_code, digest_texts, find_newer_modules

TYPE_CHECKING = False  # `heun --version` does without typing and pathlib
if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
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


def is_checkout() -> bool:
    """Return whether the kernel's files are those of a checkout: installed files are not edited, and their times mean
    nothing.
    """
    return os.path.exists(os.path.join(FOLDER, "..", "..", "pyproject.toml"))


def edited_since_compiled(compiled_file: str) -> list[str]:
    """Return the modules of a checkout that are newer than the compiled kernel and differ from it in their code."""
    newer = find_newer_modules(FOLDER, compiled_file) if is_checkout() else []
    return find_differing_modules(newer) if newer else []


def find_differing_modules(names: Iterable[str] = SOURCES) -> list[str]:
    """Return which modules of a checkout have other code than those the kernel was compiled of, sorted.

    The times of files do not count. Of all modules it takes 3 ms, or a second if there is any difference.
    """
    if not find_compiled() or not is_checkout():
        return []
    from heuncli.kernel import compiled as kernel  # type: ignore[attr-defined]

    if digest_texts(FOLDER) == kernel.TEXT_DIGEST:
        return []
    return [name for name in sorted(names) if digest_code(FOLDER, [name]) != {name: kernel.CODE_DIGESTS.get(name)}]


def make_stale_problem(modules: Sequence[str]) -> Problem:
    """Make the problem of a compiled kernel from which these modules differ."""
    named = ", ".join(f"{name}.py" for name in modules[:MAX_NAMES])
    more = f" and {len(modules) - MAX_NAMES} more" if len(modules) > MAX_NAMES else ""
    message = f"the compiled kernel is older than its source: {named}{more} changed since"
    hint = "recompile with: python -m heuncli.build; or use the slower plain kernel: HEUN_KERNEL=pure"
    return Problem("stale-kernel", message, hint=hint)


def find_stale_problem() -> Problem | None:
    """Return the problem of a compiled kernel that runs although it is not of these sources, or None.

    At the start only files newer than it are compared. An older file may differ, too: of another branch, or beside a
    kernel that was copied. So this is asked when heun has failed in a way that nobody foresaw.
    """
    modules = find_differing_modules() if KERNEL == "compiled" else []
    return make_stale_problem(modules) if modules else None


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
        raise KernelError(make_stale_problem(edited))
    return "compiled"


KERNEL = choose_form(os.environ.get("HEUN_KERNEL", ""))
