"""The kernel's modules: those that are compiled, those that only declare, the one made of them; digests of their code.

A compiled kernel made from other code is detected by the digests before it runs. Comments, docstrings and empty lines
do not count. The digests are compiled in (one_module.py).

Impure: reads the kernel's files and their times.
"""

from __future__ import annotations

import os

TYPE_CHECKING = False  # `heun --version` does without typing and pathlib
if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

NAME = "compiled"

MODULES = (
    "evaluator",
    "expressions",
    "jets",
    "intervals",
    "spans",
    "span_tables",
    "enclosure",
    "paths",
    "tangent_motion",
    "carried_points",
    "cams",
    "plane",
    "plane_rows",
    "sheaves",
    "rolling",
    "tracks",
    "conditions",
    "strains",
    "kinematics",
    "tree",
    "bushings",
    "closures",
    "loads",
    "orthogonal",
    "joint_friction",
    "selection",
    "response",
    "columns",
    "sticking",
    "tangent_loads",
    "tangent_friction",
    "tangent",
    "solutions",
    "memory",
    "workspace",
    "components",
    "attitudes",
    "dense",
    "bernstein",
    "load_ranges",
    "points",
    "course",
    "watches",
    "events",
    "contacts",
    "contact_rounding",
    "landing",
    "following",
    "stages",
    "linear",
    "collocation",
    "judging",
    "step_ends",
    "steps",
    "integration",
)

# Structs and inlined functions, which the compiled modules take into themselves.
DECLARED = ("algebra", "programs", "scene", "values", "stepping")


SOURCES = frozenset((*MODULES, *DECLARED, "headers", "modules", "one_module"))


def digest_texts(folder: str) -> str:
    """Return a digest of all the text; takes 3 ms."""
    import hashlib  # only builds ask, and checkouts in which something was edited

    texts = (f"{name}\n{read_module(folder, name)}" for name in sorted(SOURCES))
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()


def digest_code(folder: str, names: Iterable[str] = SOURCES) -> dict[str, str]:
    """Return a digest of the code of each of some files; takes 10 ms a file."""
    import hashlib

    return {
        name: hashlib.sha256("\n".join(iter_code_lines(read_module(folder, name))).encode()).hexdigest()
        for name in names
    }


def read_module(folder: str, name: str) -> str:
    """Read the text of a module."""
    with open(os.path.join(folder, f"{name}.py"), encoding="utf-8") as file:
        return file.read()


def iter_code_lines(text: str) -> Iterator[str]:
    """Yield the lines of a text without comments, docstrings and lines that are empty then; the same for every Python
    version.
    """
    import io
    from tokenize import COMMENT, DEDENT, INDENT, NEWLINE, NL, STRING, generate_tokens

    lines = text.splitlines()
    tokens = [token for token in generate_tokens(io.StringIO(text).readline) if token.type not in (NL, INDENT, DEDENT)]
    code = [token for token in tokens if token.type != COMMENT]
    ends = [NEWLINE, *(token.type for token in code)]  # of the token before each
    docs = [
        token
        for token, before, after in zip(code, ends, ends[2:], strict=False)
        if (before, token.type, after) == (NEWLINE, STRING, NEWLINE)
    ]
    for token in docs:
        lines[token.start[0] - 1 : token.end[0]] = [""] * (token.end[0] - token.start[0] + 1)
    for token in tokens:
        if token.type == COMMENT:
            row, column = token.start
            lines[row - 1] = lines[row - 1][:column]
    return (line.rstrip() for line in lines if line.strip())


def find_newer_modules(folder: str, compiled_file: str) -> list[str]:
    """Return the modules whose text looks newer than the compiled kernel; takes 0.1 ms on a fast disk."""
    last = os.stat(os.path.join(folder, compiled_file)).st_mtime_ns
    return sorted(name for name in SOURCES if os.stat(os.path.join(folder, f"{name}.py")).st_mtime_ns > last)
