"""Hints for unknown words: the nearest known one, or all known ones where they are few."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any

MOST_LISTED = 20


def nearest(word: str, known: Iterable[str]) -> str | None:
    """The known word most like this one, if any is like it."""
    import difflib  # only on the way to an error

    known = list(known)
    for name in known:
        if name.lower() == word.lower():
            return name
    matches = difflib.get_close_matches(word, known, 1, 0.65)
    return matches[0] if matches else None


def misspelt(data: Mapping[str, Any], known: Collection[str]) -> dict[str, Any]:
    """Values under unknown keys, by the known key that each resembles: a misspelt key is not reported as missing."""
    by_known_key = {word: value for key, value in data.items() if key not in known and (word := nearest(key, known))}
    return {word: value for word, value in by_known_key.items() if word not in data}


def did_you_mean(word: str, known: Iterable[str], kind: str) -> str | None:
    """'did you mean x?', or the list of what is known, or that there is none."""
    known = list(known)
    meant = nearest(word, known)
    if meant is not None:
        return f"did you mean {meant}?"
    if not known:
        return f"there are no {kind}"
    listed = ", ".join(known[:MOST_LISTED])
    return f"known {kind}: {listed}" + (", ..." if len(known) > MOST_LISTED else "")
