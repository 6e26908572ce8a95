"""Turn names from other programs' files into valid spec names: a letter, then letters, digits and _; unique and not
reserved.

A valid name, in any script, stays as it is. In others, invalid characters become _, and a number is appended where two
names would be equal.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence

from heuncli.scene.expressions.grammar import RESERVED
from heuncli.scene.file_format.names import CAUSE_NAMES, GROUND, is_name
from heuncli.scene.file_format.source import WORD_VALUES

MAX_NAME_LENGTH = 80  # characters; longer names are unreadable in tables
INVALID_CHARACTERS = re.compile(r"\W+")
# Names that no entry may have, in any block, as a joint's name is also used for its parameter and its drive.
RESERVED_WORDS = RESERVED | CAUSE_NAMES | {GROUND, *(word for word in WORD_VALUES if word)}
NUMBER_WORDS = frozenset({"inf", "infinity", "nan"})  # words that float() accepts, in upper or lower case


class Namer:
    """Assigns unique names within one scope: the bodies, the joints, or the points of one body."""

    def __init__(self, kind: str) -> None:
        """kind: the word used where a text yields no valid name: `link`, `joint`"""
        self.kind = kind
        self.used_names: set[str] = set()
        self.count: dict[str, int] = {}

    def assign(self, original: str) -> str:
        """Assign a name like the original that is not assigned yet."""
        base = name = clean_name(original, self.kind)
        while name in self.used_names:
            self.count[base] = self.count.get(base, 1) + 1
            name = f"{base}_{self.count[base]}"
        self.used_names.add(name)
        return name


def assign_names(kind: str, originals: Sequence[str]) -> list[str]:
    """Assign unique names in order. Originals that are valid names stay as they are, even if another is cleaned to the
    same name.
    """
    namer = Namer(kind)
    unchanged = {text for text in originals if clean_name(text, kind) == text}
    namer.used_names |= unchanged
    names: list[str] = []
    for text in originals:
        names.append(text if text in unchanged else namer.assign(text))
        unchanged.discard(text)  # only the first of two equal names keeps it
    return names


def clean_name(original: str, kind: str) -> str:
    """Turn a text into a valid spec name."""
    # NFKC unifies letters that look alike, as in Python's names and in expressions
    text = INVALID_CHARACTERS.sub("_", unicodedata.normalize("NFKC", original)).strip("_")[:MAX_NAME_LENGTH]
    if not is_name(text):  # it begins with a digit, is empty, or still holds an invalid character
        text = f"{kind}_{''.join(letter for letter in text if is_name(f'a{letter}'))}".rstrip("_")
    return f"{text}_1" if text in RESERVED_WORDS or text.lower() in NUMBER_WORDS else text


def format_original_name(kind: str, name: str, original: str) -> str:
    """Make the remark for an entry that is renamed: `link "panda-link1"`. Empty if the name is the file's."""
    return "" if name == original else f'{kind} "{original}"'
