"""Lines that a GitHub workflow reads from the output of a step, and shows at the line of the file that they name.

    ::error file=FILE,line=3,col=5,title=TITLE::MESSAGE

In the message % and the ends of lines are written as %25, %0D and %0A, in a property also : and , (%3A, %2C).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import PurePath

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape_lines

MAX_OF_KIND = 9  # of a kind: GitHub shows ten, and the last one gives the number of further ones
MESSAGE_ESCAPES = {"%": "%25", "\r": "%0D", "\n": "%0A"}
PROPERTY_ESCAPES = MESSAGE_ESCAPES | {":": "%3A", ",": "%2C"}


class Annotation(NamedTuple):
    """An annotation: `error`, `warning` or `notice`, its place in a file, and its text."""

    kind: str
    title: str
    message: str
    file: str = ""
    line: int = 0
    column: int = 0

    def __str__(self) -> str:
        file = PurePath(self.file).as_posix() if self.file else ""  # GitHub finds no file that begins with ./
        named_values = (("file", file), ("line", self.line), ("col", self.column), ("title", self.title))
        properties = ",".join(
            f"{name}={_escape(str(value), PROPERTY_ESCAPES)}" for name, value in named_values if value
        )
        message = _escape(self.message, MESSAGE_ESCAPES)
        return f"::{self.kind}{' ' * bool(properties)}{properties}::{message}"


def _escape(text: str, escapes: dict[str, str]) -> str:
    """Escape control characters of terminals, and then the characters that would end a message or property."""
    visible = "\r".join(map(escape_lines, text.split("\r")))
    return "".join(escapes.get(letter, letter) for letter in visible)


def iter_lines(annotations: Iterable[Annotation]) -> Iterator[str]:
    """Yield the lines: at most nine of a kind, and then one that gives the number of further ones."""
    counts: dict[str, int] = {}
    for annotation in annotations:
        counts[annotation.kind] = counts.get(annotation.kind, 0) + 1
        if counts[annotation.kind] <= MAX_OF_KIND:
            yield f"{annotation}\n"
    for kind, count in counts.items():
        if count > MAX_OF_KIND:
            more = count - MAX_OF_KIND
            yield f"{Annotation(kind, f'{more} more', f'{more} more of this kind: see the log or the report')}\n"
