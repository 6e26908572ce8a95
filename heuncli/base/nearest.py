"""Hints for unknown words: the nearest known one, or all known ones where they are few.

To look for the nearest word among all names of a large scene takes as long as the scene is large; to look for it again
for each of thousands of unknown ones takes as long as its square. So the first dozens of a file get suggestions.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from itertools import chain, islice
from typing import Any

MOST_LISTED = 20
LONGEST = 60  # characters of a word for which another one is suggested: comparing goes by the square of the length
EFFORT = 16_000_000  # pairs of characters compared for a file, a quarter of a second: 40 words among 5,000 names of 5

SETS = (set, frozenset)  # have no order: it changes from run to run
OVERHEAD = 4  # characters that a name costs by itself


class _Effort:
    """What is left of the effort for the file at hand. State of the module: hints are made in forty places."""

    left = EFFORT


def begin_file() -> None:
    """Another file is read: its first problems get suggestions again."""
    _Effort.left = EFFORT


def afford(effort: int) -> bool:
    """Whether a search of that effort is still made for this file; if so, it counts."""
    if effort > _Effort.left:
        _Effort.left = 0  # from here on none: not one here and one there
        return False
    _Effort.left -= effort
    return True


def nearest(word: str, *known: Collection[str]) -> str | None:
    """The known word most like this one, if any is like it, and if it is still looked for."""
    if len(word) > LONGEST or not afford(sum(map(len, known)) * (len(word) + OVERHEAD) ** 2):
        return None
    return _most_like(word, chain.from_iterable(sorted(one) if isinstance(one, SETS) else one for one in known))


def _most_like(word: str, known: Iterable[str]) -> str | None:
    import difflib  # only on the way to an error

    comparable = [name for name in known if len(name) <= LONGEST]
    for name in comparable:
        if name.lower() == word.lower():
            return name
    matches = difflib.get_close_matches(word, comparable, 1, 0.65)
    return matches[0] if matches else None


def misspelt(data: Mapping[str, Any], known: Collection[str]) -> dict[str, Any]:
    """Values under unknown keys, by the known key that each resembles: a misspelt key is not reported as missing."""
    # whatever was suggested before: what else is wrong with an entry does not depend on that
    unknown = {key: value for key, value in data.items() if key not in known and len(key) <= LONGEST}
    by_known_key = {word: value for key, value in unknown.items() if (word := _most_like(key, known))}
    return {word: value for word, value in by_known_key.items() if word not in data}


def did_you_mean(word: str, known: Collection[str], kind: str) -> str:
    """'did you mean x?', or the list of what is known, or that there is none."""
    meant = nearest(word, known)
    if meant is not None:
        return f"did you mean {meant}?"
    if not known:
        return f"there are no {kind}"
    return f"known {kind}: {listed(known)}"


def listed(known: Collection[str]) -> str:
    """The first words of some; of a set, which has no order of its own, in that of the alphabet."""
    known = sorted(known) if isinstance(known, SETS) else known
    return ", ".join(islice(known, MOST_LISTED)) + (", ..." if len(known) > MOST_LISTED else "")
