"""Words of paths, with positions along a series of cuts among them: `M2@0.28`, `M2@end`, `M2.7`, `M2@0.28:before`."""

from __future__ import annotations

import re
from collections.abc import Sequence

from heuncli.results.results_schema import parse_index

NO_RUN = "@ gives a position along a series of cuts (section with from, to and count): leave it out"
NUMBER = r"(?:\d+(?:\.\d+)?|\.\d+)(?:e[+-]?\d+)?"
POSITION_WORD = re.compile(
    rf"@(?P<at>start|end|{NUMBER})(?P<unit>[^\W\d_]*)(?::(?P<side>\w*))?(?=\.|\Z)", re.IGNORECASE
)
INDEX_WORD = re.compile(r"(?P<cut>\d+):(?P<side>\w*)\Z", re.ASCII)


def split_path(path: str) -> list[str]:
    """Split a path into words. A position is one word, even with points in its number; it begins with @."""
    head, separator, _ = path.partition("@")
    if not separator:
        return path.split(".")
    match = POSITION_WORD.match(path, len(head))
    end = len(path) if match is None else match.end()
    words = [*head.removesuffix(".").split("."), path[len(head) : end]]
    return words + path[end + 1 :].split(".") if end < len(path) else words


def join_path(words: Sequence[str]) -> str:
    """Join words to a path."""
    return ".".join(words).replace(".@", "@")


def find_position_word(words: Sequence[str]) -> str | None:
    """Return the word of a path that is a position, by its @; None if there is none."""
    return next((word for word in words if word.startswith("@")), None)


def is_cut_word(word: str) -> bool:
    """Whether a word means a position or a cut, and not a component."""
    return word.startswith("@") or INDEX_WORD.match(word) is not None or parse_index(word) is not None
