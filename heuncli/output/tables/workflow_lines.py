"""Lines that a GitHub workflow reads from what a step prints, and shows at the line of the file they name.

    ::error file=FILE,line=3,col=5,title=TITLE::MESSAGE

In the message % and the ends of lines are written as %25, %0D and %0A, in a property also : and , (%3A, %2C).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import PurePath

from heuncli.base.foreign_text import shown_lines
from heuncli.base.named_tuples import NamedTuple

MOST = 9  # of a kind: a step shows ten, of which the last says how many more there are
IN_MESSAGES = {"%": "%25", "\r": "%0D", "\n": "%0A"}
IN_PROPERTIES = IN_MESSAGES | {":": "%3A", ",": "%2C"}


class Annotation(NamedTuple):
    """What is to be shown: `error`, `warning` or `notice`, where, and the words."""

    kind: str
    title: str
    message: str
    file: str = ""
    line: int = 0
    column: int = 0

    def __str__(self) -> str:
        file = PurePath(self.file).as_posix() if self.file else ""  # a workflow finds none that begins with ./
        given = (("file", file), ("line", self.line), ("col", self.column), ("title", self.title))
        properties = ",".join(f"{name}={_written(str(value), IN_PROPERTIES)}" for name, value in given if value)
        message = _written(self.message, IN_MESSAGES)
        return f"::{self.kind}{' ' * bool(properties)}{properties}::{message}"


def _written(text: str, codes: dict[str, str]) -> str:
    """A text with what would end it written by its code; what steers a terminal is escaped before."""
    visible = "\r".join(map(shown_lines, text.split("\r")))
    return "".join(codes.get(letter, letter) for letter in visible)


def lines(annotations: Iterable[Annotation]) -> Iterator[str]:
    """The lines: at most nine of a kind, and then one that says how many more there are."""
    shown: dict[str, int] = {}
    for annotation in annotations:
        shown[annotation.kind] = shown.get(annotation.kind, 0) + 1
        if shown[annotation.kind] <= MOST:
            yield f"{annotation}\n"
    for kind, count in shown.items():
        if count > MOST:
            more = count - MOST
            yield f"{Annotation(kind, f'{more} more', f'{more} more like these: see the log, or the report')}\n"
