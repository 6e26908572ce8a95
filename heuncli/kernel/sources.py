"""What the compiled kernel is made from, so that one made from older text is noticed before it runs.

The digest of the sources is compiled in (memory.py). Impure: reads the kernel's files and their times.
"""

from __future__ import annotations

import os

from heuncli.kernel.modules import DECLARED, MODULES

TYPE_CHECKING = False  # `heun --version` does without typing and pathlib
if TYPE_CHECKING:
    from collections.abc import Iterable

COMPILED = (".so", ".pyd")
KEEPER = "memory"  # the module that holds the digest; each compilation makes it anew
SOURCES = frozenset(f"{name}.py" for name in (*MODULES, *DECLARED, "headers"))


def digest(folder: str) -> str:
    """A name that is a C identifier for the text of all that is compiled, and of what makes its headers; 3 ms."""
    import hashlib  # only builds ask, and checkouts in which something was edited

    text = hashlib.sha256()
    for name in sorted(SOURCES):
        with open(os.path.join(folder, name), "rb") as file:
            content = file.read()
        text.update(f"{name} {len(content)}\n".encode())
        text.update(content)
    return f"h{text.hexdigest()}"


def newer_than_compiled(folder: str, names: Iterable[str]) -> list[str]:
    """Which of a folder's files are sources that look newer than the last compilation; 0.1 ms on a quick disk."""
    keeper = next(name for name in names if name.startswith(f"{KEEPER}.") and name.endswith(COMPILED))
    last = os.stat(os.path.join(folder, keeper)).st_mtime_ns
    return sorted(name for name in names if name in SOURCES and os.stat(f"{folder}/{name}").st_mtime_ns > last)
