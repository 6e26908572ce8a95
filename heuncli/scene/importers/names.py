"""Names of other programs' files, made names of a spec: a letter, then letters, digits and _; none twice, none taken.

A name that is one already stays as it is, of whatever script. Another has its foreign characters replaced by _, and a
number behind it where that makes two alike.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence

from heuncli.scene.expressions.grammar import RESERVED
from heuncli.scene.file_format.names import CAUSES, GROUND, is_name
from heuncli.scene.file_format.source import WORDS

LONGEST = 80  # characters of a name: what is longer cannot be read in a table
FOREIGN = re.compile(r"\W+")
# What names no entry in any block: one rule for all of them, as a joint's name serves its parameter and its drive, too.
TAKEN = RESERVED | CAUSES | {GROUND, *(word for word in WORDS if word)}
NUMBERS = frozenset({"inf", "infinity", "nan"})  # read as numbers that are none, in any case of their letters


class Namer:
    """Gives names that differ; one for each place where they must: the bodies, the joints, the points of a body."""

    def __init__(self, kind: str) -> None:
        """kind: what a name is called that has nothing of its own: `link`, `joint`."""
        self.kind = kind
        self.given: set[str] = set()
        self.count: dict[str, int] = {}

    def name(self, wanted: str) -> str:
        """A name like the wanted one, that was not given before."""
        base = name = cleaned(wanted, self.kind)
        while name in self.given:
            self.count[base] = self.count.get(base, 1) + 1
            name = f"{base}_{self.count[base]}"
        self.given.add(name)
        return name


def names_of(kind: str, wanted: Sequence[str]) -> list[str]:
    """Names for these, in their order: those that are names stay as they are, whatever others are made into."""
    namer = Namer(kind)
    kept = {text for text in wanted if cleaned(text, kind) == text}
    namer.given |= kept
    names: list[str] = []
    for text in wanted:
        names.append(text if text in kept else namer.name(text))
        kept.discard(text)  # of two alike one keeps it
    return names


def cleaned(wanted: str, kind: str) -> str:
    """The name that is meant by a text, as a spec may have it."""
    # letters that look alike to a reader are one to the program: as Python's own names, and those of expressions
    text = FOREIGN.sub("_", unicodedata.normalize("NFKC", wanted)).strip("_")[:LONGEST]
    if not is_name(text):  # it begins with a digit, or is empty; or holds what is no part of a name after all
        text = f"{kind}_{''.join(letter for letter in text if is_name(f'a{letter}'))}".rstrip("_")
    return f"{text}_1" if text in TAKEN or text.lower() in NUMBERS else text


def called(kind: str, name: str, wanted: str) -> str:
    """The remark of an entry whose name is not the file's: `link "panda-link1"`."""
    return "" if name == wanted else f'{kind} "{wanted}"'
