"""Words of paths, and places along a run of cuts among them: `M2@0.28`, `M2@end`, `M2.7`, `M2@0.28:before`."""

from __future__ import annotations

import re
from collections.abc import Sequence

from heuncli.results.results_schema import counted

NO_RUN = "@ names a place along a run of cuts: sections with from, to and count; leave it out"
NUMBER = r"(?:\d+(?:\.\d+)?|\.\d+)(?:e[+-]?\d+)?"
MARKED = re.compile(rf"@(?P<at>start|end|{NUMBER})(?P<unit>[^\W\d_]*)(?::(?P<side>\w*))?(?=\.|\Z)", re.IGNORECASE)
COUNTED = re.compile(r"(?P<cut>\d+):(?P<side>\w*)\Z", re.ASCII)


def words_of(path: str) -> list[str]:
    """The words of a path. A place is one of them, whatever points are in its number; it begins with @."""
    head, marked, _ = path.partition("@")
    if not marked:
        return path.split(".")
    found = MARKED.match(path, len(head))
    behind = len(path) if found is None else found.end()
    words = [*head.removesuffix(".").split("."), path[len(head) : behind]]
    return words + path[behind + 1 :].split(".") if behind < len(path) else words


def path_of(words: Sequence[str]) -> str:
    """The path that has these words."""
    return ".".join(words).replace(".@", "@")


def marked(words: Sequence[str]) -> str | None:
    """The word among those of a path that is a place by its @."""
    return next((word for word in words if word.startswith("@")), None)


def names_a_cut(word: str) -> bool:
    """Whether a word is meant for a place or a cut, and for no component."""
    return word.startswith("@") or COUNTED.match(word) is not None or counted(word) is not None
